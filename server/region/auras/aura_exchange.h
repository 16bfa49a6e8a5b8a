// Auras between servers: ours told to whom they concern, theirs kept as they were told.
#pragma once

#include <array>
#include <boost/container/flat_map.hpp>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "protocol/frame.h"
#include "protocol/frame_pool.h"
#include "protocol/quantise.h"
#include "protocol/wire.h"
#include "server/aura/migration_policy.h"
#include "server/base/ids.h"
#include "server/base/prefetch.h"
#include "server/base/result.h"
#include "server/base/tick.h"
#include "server/physics/body.h"

namespace aureole {

/// What the exchange asks of whoever hosts the bodies.
class AuraBodies {
 public:
  virtual ~AuraBodies() = default;
  virtual double mass_kg(BodyId id) const = 0;
  /// Exact pose and prototype of a hosted body.
  virtual NewBody resting_body(BodyId id) const = 0;
  /// Whether a body that is not hosted any more was handed to another server.
  virtual bool was_handed_over(BodyId id) const = 0;
};

/// What others said of their resting bodies since the last take_in(), in the order it was said.
struct RestingNews {
  enum class Kind : std::uint8_t {
    rests,        ///< A body lies as `body` says.
    gone,         ///< It is not projected to us any more.
    handed_over,  ///< The same, and another server will project it.
    told_all,     ///< The first word over a new link: what has not been told again is gone.
  };
  Kind kind{};
  RegionId from;
  NewBody body;  ///< told_all: nothing of it; gone, handed_over: only the id.
};

/// An aura is sent when it is new, in short when it has changed, and withdrawn when it concerns the
/// receiver no longer; one that stays as it is costs nothing (section 3.2 of the paper). When a
/// link ends, all that was told over it is forgotten on both sides.
class AuraExchange {
 public:
  void link_up(RegionId peer);
  void link_down(RegionId peer);

  /// Checks a FrameType::auras payload and remembers what it says until take_in(), in room that
  /// does not grow with the number of messages; nothing of a bad one is taken. `prototypes`
  /// and `regions`: how many there are. Returns the sender's tick.
  Result<Tick> receive(RegionId from, std::span<const std::byte> payload, std::size_t prototypes,
                       std::size_t regions);
  /// From now on what has arrived counts. Returns what others asked us to hand over, ascending by
  /// body.
  std::vector<HandoverRequest> take_in();
  /// News of resting bodies; the caller's until the next call.
  std::span<const RestingNews> take_resting_news();
  /// What others project to us now, ascending by body; one entry a body: of two servers that both
  /// claim it the lower number's.
  std::span<const RemoteAura> remote() const { return remote_; }
  /// Whether the peer has told what it projects since its link came up.
  bool has_heard(RegionId peer) const;
  /// Whether auras of ours are known to the peer, as far as we have told it.
  bool tells(RegionId peer) const;
  /// Whether auras of the peer's are known to us. What is told and heard of travels in order: both
  /// ends find the same at the same message.
  bool hears_of(RegionId peer) const;
  /// Whether anything was heard, or a link came or went, since the last announce().
  bool has_changed() const { return changed_; }

  /// Begins to bring near what announce() and take_frame() ask of every peer.
  void fetch() const { prefetch_beginning(peers_, 64 * cache_line); }
  /// Prepares this tick's frames from what the policy decided.
  void announce(Tick now, const MigrationDecision& decision, const AuraBodies& bodies);
  /// The frame for one linked peer, or nothing if there is nothing to say of auras.
  SharedBytes take_frame(RegionId peer);
  /// A message without auras: that we have stepped. Peers hear one or the other as often as
  /// signs_of_life.h says, so that silence means something.
  SharedBytes sign_of_life(Tick now);

  /// Auras in one message at most; far more than a boundary can hold.
  static constexpr std::size_t max_auras = 65'536;
  /// Auras that can be told in short at a time, over one link; any more are told whole.
  static constexpr std::uint16_t no_slot = 65'535;
  /// A resting body that creeps is told anew when it is this far from where it was told (m, rad).
  static constexpr double creep_m = 0.001;
  static constexpr double creep_rad = 0.003;
  /// Farther from where it rested than this, a body that moves is not there any more (m).
  static constexpr double left_m = 0.02;

 private:
  /// As it travels: equal bytes need not be sent again.
  struct Sent {
    QuantisedPosition position{};
    std::array<std::int8_t, 3> half_spine{};
    std::uint8_t flags = 0, company = 0;
    std::uint16_t girth = 0, speed = 0, cluster = 0;
    friend bool operator==(const Sent& a, const Sent& b) {
      static_assert(std::has_unique_object_representations_v<Sent>);
      return std::memcmp(&a, &b, sizeof(Sent)) == 0;  // Not field by field.
    }
  };
  /// What a peer is to know after this tick.
  struct Wanted {
    BodyId id;
    Sent sent;
  };
  struct Projection {
    BodyId id;
    Sent sent;
    std::uint16_t slot = no_slot;
    bool rested = false;     ///< Whether `position` and `orientation` were told.
    WorldPosition position;  ///< Where it was last said to rest.
    Eigen::Quaternionf orientation{Eigen::Quaternionf::Identity()};
  };
  struct Peer {
    bool up = false;
    bool greeted = false;               ///< Something was sent over this link.
    bool heard = false;                 ///< Something was received over this link.
    std::vector<Projection> projected;  ///< What the peer knows of us; ascending.
    std::vector<std::uint16_t> free_slots;
    std::uint16_t next_slot = 0;             ///< Those from here on were never taken.
    std::vector<RemoteAura> theirs;          ///< What we know of the peer; ascending.
    std::vector<BodyId> their_slots;         ///< Whom the peer means by each slot.
    std::vector<HandoverRequest> pulls;      ///< Of the newest message, until take_in().
    std::vector<Wanted> wanted;              ///< Only used within announce(); kept for its memory.
    std::vector<Projection> projected_anew;  ///< The same.
    SharedBytes frame;
  };
  /// What goes into a frame.
  struct Message {
    std::vector<wire::Aura> auras;
    std::vector<wire::AuraMotion> moved;
    std::vector<wire::Resting> resting;
    std::vector<std::uint64_t> removed, handed_over;

    bool empty() const {
      return auras.empty() && moved.empty() && resting.empty() && removed.empty() &&
             handed_over.empty();
    }
    void clear() {
      auras.clear();
      moved.clear();
      resting.clear();
      removed.clear();
      handed_over.clear();
    }
  };
  /// What one frame that has come says.
  struct Heard {
    struct Moved {
      std::size_t aura;  ///< Index in `theirs`.
      const wire::AuraMotion* how;
    };
    std::vector<Moved> moved;
    std::vector<RemoteAura> auras;
    std::vector<RestingNews> news;
    std::vector<BodyId> gone;
    std::vector<HandoverRequest> pulls;

    bool empty() const { return auras.empty() && moved.empty() && news.empty() && pulls.empty(); }
    void clear() {
      moved.clear();
      auras.clear();
      news.clear();
      gone.clear();
      pulls.clear();
    }
  };
  static Sent as_sent(const ProjectedAura& aura);
  static std::uint16_t take_slot(Peer& peer);
  static void tell(Peer& peer, const Wanted& wanted, Projection& projection, bool known,
                   const AuraBodies& bodies, Message& message);
  SharedBytes frame_for(Peer& peer, const std::vector<HandoverRequest>& pulls, Tick now,
                        const AuraBodies& bodies);

  /// Auras themselves are too large to be sorted.
  struct Told {
    BodyId id;
    const RemoteAura* aura = nullptr;
  };
  boost::container::flat_map<RegionId, Peer> peers_;
  std::vector<RemoteAura> remote_;
  std::vector<Told> told_, told_before_, told_by_one_;  ///< Only used within take_in().
  Heard heard_;                                         ///< Only used within receive().
  std::vector<Sent> sent_;  ///< Only used within announce(), like the next two.
  Message message_;
  flatbuffers::FlatBufferBuilder builder_;
  FramePool frames_{16};  ///< Those of two ticks to eight neighbours.
  std::vector<RestingNews> resting_news_, taken_news_;
  bool changed_ = true;
};

}  // namespace aureole
