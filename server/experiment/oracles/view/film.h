// A whole run without faults: the states and owners of all bodies at all ticks, and how much of it
// took more than one server.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/experiment/network/simulated_network.h"
#include "server/experiment/oracles/view/world_view.h"
#include "server/worlds/world.h"

namespace aureole {

class Film {
 public:
  struct Shot {
    BodyState state;
    RegionId owner;
  };
  /// The first moments of a film show nothing: the oracles look at what is past.
  static constexpr int begins = WorldView::delay_ticks + 1;

  Film(const WorldDefinition& world, NetworkTiming timing, int ticks);

  int moments() const { return static_cast<int>(moments_.size()); }
  /// Null: nobody had it then.
  const Shot* at(int moment, BodyId id) const;
  const Shot* last(BodyId id) const { return at(moments() - 1, id); }
  /// The tick of world time that a moment shows.
  static Tick tick_of(int moment) { return Tick{moment + 1 - WorldView::delay_ticks}; }
  /// "at tick 37, world body 3 on r1"
  std::string place(int moment, BodyId id) const;

  /// How often the body was handed over.
  std::uint64_t handoffs(BodyId id) const;
  std::uint64_t handoffs() const;
  /// Resting copies of others' bodies at once, over all servers.
  std::uint64_t stand_ins_max() const { return stand_ins_max_; }

 private:
  std::vector<std::map<BodyId, Shot>> moments_;
  std::map<BodyId, std::uint64_t> handoffs_;
  std::uint64_t stand_ins_max_ = 0;
};

}  // namespace aureole
