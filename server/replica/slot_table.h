// Which body a region means by a slot number.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace aureole {

/// Slots below this are allowed on the wire.
inline constexpr std::uint32_t replica_slots_max = 1'000'000;

/// Memory grows with the slots that are bound (in pages), not with their numbers.
class SlotTable {
 public:
  struct Binding {
    std::uint64_t stamp =
        0;  ///< ReplicaStore's stamp of the body at binding; 0: of no body any more.
    std::uint32_t body = 0;  ///< Index into ReplicaStore's pool, if the stamp still holds.
    bool bound = false;
  };

  /// From now on `slot` means this body. Requires slot < replica_slots_max.
  void bind(std::uint32_t slot, std::uint32_t body, std::uint64_t stamp);
  /// nullptr if it was never bound.
  const Binding* find(std::uint32_t slot) const {
    const std::size_t page = slot / page_slots;
    if (page >= pages_.size() || !pages_[page]) return nullptr;
    const Binding& binding = (*pages_[page])[slot % page_slots];
    return binding.bound ? &binding : nullptr;
  }
  void clear() { pages_.clear(); }

 private:
  static constexpr std::size_t page_slots = 256;
  using Page = std::array<Binding, page_slots>;
  std::vector<std::unique_ptr<Page>> pages_;
};

}  // namespace aureole
