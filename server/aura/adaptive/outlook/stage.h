// The bodies that one decision is about, with their auras.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "server/aura/migration_policy.h"
#include "server/aura/shapes/aura_capsule.h"
#include "server/aura/shapes/box_rows.h"
#include "server/aura/sleepers.h"

namespace aureole {

/// First come those of `MigrationSituation::hosted`, in their order, then sleepers: whose auras
/// reach out of the region at once, others when something finds them. Everything that is said of
/// bodies in a decision names them by their numbers on the stage.
class Stage {
 public:
  /// Begins a decision; the situation must outlive it. Of `hosted` nobody is on it yet.
  void begin(const MigrationSituation& situation);
  /// The next one of `hosted`, as large as it is by itself.
  void add(const HostedBody& body, const AuraCapsule& aura);
  /// When all of them are on it: lets those in whose auras reach out of the region.
  void add_sleepers_beyond();

  /// Grows while it is asked.
  std::uint32_t size() const { return static_cast<std::uint32_t>(bodies_.size()); }
  const HostedBody& body(std::uint32_t number) const { return *bodies_[number]; }
  /// Who is not shown is on the stage as a sleeper: nothing of it has to be fetched to know that.
  bool is_asleep(std::uint32_t number) const {
    return number >= situation_->hosted.size() || bodies_[number]->asleep;
  }
  /// Valid until somebody comes, like box().
  const AuraCapsule& aura(std::uint32_t number) const { return auras_[number]; }
  /// The box around it.
  const AuraBox& box(std::uint32_t number) const { return boxes_[number]; }
  void set_aura(std::uint32_t number, const AuraCapsule& aura);

  /// To be called after auras have been set: find() knows them by their size at this moment.
  void sort_boxes();
  /// Appends the numbers of all whose boxes overlap `box`, each once; sleepers that are found come
  /// on the stage.
  void find(const AuraBox& box, std::vector<std::uint32_t>& found);
  /// A sleeper that is found comes on the stage.
  std::optional<std::uint32_t> number_of(BodyId id);
  /// Replaces `found` by all that share a contact with the body, but for those awake that the
  /// decision is not shown; sleepers come on the stage, wherever they are. Returns how many it
  /// touches; see ContactSource. Who is asked for again has not changed since.
  std::size_t find_touching(std::uint32_t number, std::vector<std::uint32_t>& found);
  /// Who is going to be asked for in find_touching(): see ContactSource::fetch_touching().
  void fetch_touching(std::uint32_t number, FetchStep step) const;

  /// The numbers of all who are on it now, by their ids. Valid until somebody comes.
  std::span<const std::uint32_t> ascending();

 private:
  static constexpr std::uint32_t none = static_cast<std::uint32_t>(-1);
  void find_sleepers(const RoughBox& asked);
  std::uint32_t admit(Sleepers::Place place);
  std::uint32_t& number_at(Sleepers::Place place);
  void note_slots();
  void look_up_touching(std::uint32_t number);

  const MigrationSituation* situation_ = nullptr;
  std::vector<const HostedBody*> bodies_;
  std::vector<AuraCapsule> auras_;
  std::vector<AuraBox> boxes_;
  BoxRows rows_;              ///< Boxes by number, …
  std::uint32_t sorted_ = 0;  ///< … of those below.
  struct SleeperHit {
    Sleepers::Place sleeper;
    std::pair<std::int32_t, float> place;
  };
  std::vector<SleeperHit> hits_;                  ///< Only used within find().
  std::vector<std::uint32_t> number_of_sleeper_;  ///< By place; `none`: not on the stage.
  std::vector<Sleepers::Place> admitted_;         ///< Places with a number.
  std::vector<std::uint32_t> ascending_;
  /// By HostedBody::slot; filled when contacts are first asked for.
  std::vector<std::uint32_t> number_in_slot_;
  std::vector<std::uint32_t> slots_;  ///< Only used within find_touching().
  /// What find_touching() has answered: a stretch of `touching_`, and what it returned.
  struct Touching {
    std::uint32_t begin = none, end = 0;
    std::size_t touched = 0;
  };
  std::vector<Touching> touching_of_;  ///< By number.
  std::vector<std::uint32_t> touching_;
};

}  // namespace aureole
