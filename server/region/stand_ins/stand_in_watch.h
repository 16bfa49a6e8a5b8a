// Catches stand-ins that take a blow: an interaction that should have brought both sides together.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <unordered_map>
#include <vector>

#include "server/aura/migration_policy.h"
#include "server/base/ids.h"
#include "server/base/tick.h"
#include "server/physics/physics_world.h"

namespace aureole {

/// A stand-in that is struck swallows the impulse without any overlap, so that overlap alone would
/// not show it. What tells is its load: the impulse of one step between it and a body of ours. What
/// a resting body put on it when the two were cut is the base; a rise above that by more than the
/// stand-in's mass × `missed_mps` is a missed interaction.
///
/// A load may also rise without a blow. What leans on several stand-ins and loses one of them,
/// since that one is a body again, or has gone, leans on the others: in a heap with its whole
/// weight and that of what lies on it, from one step to the next, while nothing moves. What gets
/// another one is held between things that do not give way. Whoever lies still is pressed then, so
/// that both sides come together, but has struck nothing. Nor has who lies still and has fallen for
/// a single step, because Bullet lost their contact for so long and then found it again (seen in a
/// heap): the next step bears its weight twice.
class StandInWatch {
 public:
  /// The body would not count as still any more: a weaker blow leaves it at rest.
  static constexpr double missed_mps = still_speed_mps;
  /// A pair whose load rises by so much already counts as moving, and is brought together.
  static constexpr double pressed_mps = 0.025;
  /// Of a pair that rests: how long its load may find its level after the cut, and again when the
  /// body has lost or got another stand-in.
  static constexpr std::int64_t settling_ticks = 16;
  /// No load that finds its level rises by so much in one step: a blow, even then.
  static constexpr double blow_mps = 1.0;
  static constexpr std::int64_t pressed_ticks = 32;

  /// `still`: whether the body on our side lies still; `mass_kg` of a prototype.
  template <class IsStill, class MassOf>
  void look(const PhysicsWorld& physics, Tick now, IsStill&& still, MassOf&& mass_kg) {
    loads_.clear();
    struck_now_.clear();
    if (!physics.stand_in_ids().empty()) physics.stand_in_loads(loads_);
    note_cut(physics.stand_in_ids(), now);
    for (const StandInLoad& load : loads_)
      judge(load, now, still(load.body),
            {mass_kg(load.body_prototype), mass_kg(load.stand_in_prototype)});
    forget(now);
  }

  /// Whether the body has lately leant harder on a stand-in than when they were cut.
  bool is_pressed(BodyId body, Tick now) const;
  /// Appends all of whom that is true, ascending.
  void append_pressed(Tick now, std::vector<BodyId>& bodies) const;
  /// Pairs that rose above the limit so far.
  std::uint64_t struck() const { return struck_; }
  /// Those of the last look.
  struct Struck {
    BodyId stand_in, body;
    Tick tick;
    double rise_mps = 0;
  };
  std::span<const Struck> struck_now() const { return struck_now_; }

 private:
  struct Pair {
    Tick first, last;
    bool cut_at_rest = false;
    bool struck = false;
    float base_ns = 0;
    float shifted_ns = 0;  ///< What it bore at most while load shifted to it.
  };
  struct Masses {
    double body_kg, stand_in_kg;
  };
  void note_cut(std::span<const BodyId> stand_ins, Tick now);
  bool may_shift(BodyId body, Tick now) const;
  void judge(const StandInLoad& load, Tick now, bool still, const Masses& masses);
  void forget(Tick now);

  std::vector<StandInLoad> loads_;
  std::map<std::pair<BodyId, BodyId>, Pair> pairs_;
  std::map<BodyId, Tick> pressed_;   ///< Until when.
  std::map<BodyId, Tick> cut_anew_;  ///< When the stand-ins that each leans on changed.
  std::vector<BodyId> stand_ins_;    ///< As of the last look; ascending.
  std::map<BodyId, Tick> fresh_;     ///< Of these, since when, if not for long.
  Tick last_look_;
  std::uint64_t struck_ = 0;
  std::vector<Struck> struck_now_;
};

}  // namespace aureole
