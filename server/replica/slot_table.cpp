// Binding slots to bodies.
#include "server/replica/slot_table.h"

#include "server/base/check.h"

namespace aureole {

void SlotTable::bind(std::uint32_t slot, std::uint32_t body, std::uint64_t stamp) {
  AUREOLE_CHECK(slot < replica_slots_max, "slots are checked when a message is read");
  const std::size_t page = slot / page_slots;
  if (page >= pages_.size()) pages_.resize(page + 1);
  if (!pages_[page]) pages_[page] = std::make_unique<Page>();
  (*pages_[page])[slot % page_slots] = {stamp, body, true};
}

}  // namespace aureole
