// Hearing auras: differences on the wire, whole sets in memory.
#include "server/region/auras/aura_exchange.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "protocol/wire.h"
#include "protocol/wire_values.h"
#include "server/base/merge_in.h"
#include "server/base/prefetch.h"
#include "server/region/auras/aura_wire.h"
#include "server/region/handoff/handoff.h"

namespace aureole {
namespace {

using namespace aura_wire;

/// News of resting bodies that may wait for a step; more than this is made up.
constexpr std::size_t resting_news_max = 4 * AuraExchange::max_auras;

/// What an aura and its motion both tell.
template <class Told>
void take_motion(const Told& told, RemoteAura& remote) {
  QuantisedPosition position;
  std::copy_n(told.position()->Data(), position.size(), position.begin());
  remote.asleep = (told.flags() & asleep_flag) != 0;
  remote.resting = (told.flags() & resting_flag) != 0;
  remote.left_its_place = (told.flags() & left_flag) != 0;
  remote.speed_mps = told.speed() * speed_step_mps;
  remote.room.centre = dequantise(position).vector();
  for (flatbuffers::uoffset_t axis = 0; axis < 3; ++axis)
    remote.room.half_spine[axis] = told.half_spine()->Get(axis) * spine_step_m;
  remote.room.girth_m = told.girth() * girth_step_m;
  remote.company.label = told.cluster();
  remote.company.size_class = told.company() & Company::size_class_max;
  remote.company.changes =
      std::min<std::uint8_t>((told.company() >> changes_shift) & 3, Company::changes_max);
  remote.company.crowded = (told.company() & crowded_flag) != 0;
  remote.company.lately = (told.company() & lately_flag) != 0;
}

Result<RemoteAura> from_wire(const wire::Aura& aura, RegionId host) {
  if (!BodyId{aura.id()}.valid()) return Error{"an aura of a body that cannot be"};
  if (!(aura.mass_kg() > 0) || !std::isfinite(aura.mass_kg()))
    return Error::format("an aura of a body of {} kg", aura.mass_kg());
  RemoteAura remote;
  remote.id = BodyId{aura.id()};
  remote.host = host;
  remote.mass_kg = double{aura.mass_kg()};
  take_motion(aura, remote);
  return remote;
}

bool is_before(const RemoteAura& aura, BodyId id) {
  return aura.id < id;
}

/// Index of the body's aura; the end if there is none. Honest servers ask in the order of the
/// list: then it is near `hint`, where the one before was found.
std::size_t place_of(std::span<const RemoteAura> auras, BodyId id, std::size_t hint) {
  constexpr std::size_t near = 4;
  for (std::size_t i = hint; i < std::min(hint + near, auras.size()); ++i)
    if (auras[i].id == id) return i;
  const auto at = std::lower_bound(auras.begin(), auras.end(), id, is_before);
  return at != auras.end() && at->id == id ? static_cast<std::size_t>(at - auras.begin())
                                           : auras.size();
}

/// Takes out those of the bodies that are there; sorts `gone`.
void take_out(std::vector<RemoteAura>& auras, std::vector<BodyId>& gone) {
  if (gone.empty()) return;
  std::sort(gone.begin(), gone.end());
  std::erase_if(auras, [&](const RemoteAura& aura) {
    return std::binary_search(gone.begin(), gone.end(), aura.id);
  });
}

/// Puts auras in; of several of one body the last one counts. Sorts `told`.
void put_in(std::vector<RemoteAura>& auras, std::vector<RemoteAura>& told) {
  const auto by_id = [](const RemoteAura& a, const RemoteAura& b) { return a.id < b.id; };
  // Honest servers tell in this order.
  if (!std::is_sorted(told.begin(), told.end(), by_id))
    std::stable_sort(told.begin(), told.end(), by_id);
  const auto known = static_cast<std::ptrdiff_t>(auras.size());
  for (std::size_t i = 0; i < told.size(); ++i) {
    if (i + 1 < told.size() && told[i + 1].id == told[i].id) continue;
    const auto end = auras.begin() + known;
    const auto at = std::lower_bound(auras.begin(), end, told[i].id, is_before);
    if (at != end && at->id == told[i].id)
      *at = told[i];
    else
      auras.push_back(told[i]);
  }
  merge_in(auras, known, by_id);
}

}  // namespace

void AuraExchange::link_up(RegionId id) {
  peers_[id] = {};
  peers_[id].up = true;
  changed_ = true;
}

void AuraExchange::link_down(RegionId id) {
  peers_[id] = {};
  changed_ = true;
}

Result<Tick> AuraExchange::receive(RegionId from, std::span<const std::byte> payload,
                                   std::size_t prototypes, std::size_t regions) {
  const auto* message = verified<wire::Auras>(payload);
  if (message == nullptr) return Error{"an auras message is not valid"};
  if (!is_wire_tick(message->tick()))
    return Error::format("an auras message of tick {}; expected at most {} from 0", message->tick(),
                         wire_tick_max);
  const auto too_many = [](const auto* list) {
    return list != nullptr && list->size() > max_auras;
  };
  if (too_many(message->auras()) || too_many(message->moved()) || too_many(message->removed()) ||
      too_many(message->pulls()) || too_many(message->resting()) ||
      too_many(message->handed_over()))
    return Error::format("more than {} auras in one message", max_auras);
  heard_.clear();
  auto& [moved, auras, news, gone, pulls] = heard_;
  Peer& peer = peers_[from];
  if (!peer.heard) news.push_back({RestingNews::Kind::told_all, from, {}});
  if (message->moved() != nullptr) {
    moved.reserve(message->moved()->size());
    for (const auto* how : *message->moved()) {
      const BodyId id =
          how->slot() < peer.their_slots.size() ? peer.their_slots[how->slot()] : BodyId{};
      const std::size_t at = place_of(peer.theirs, id, moved.empty() ? 0 : moved.back().aura + 1);
      if (at == peer.theirs.size())
        return Error::format("an aura in slot {} moves, in which there is none", how->slot());
      moved.push_back({at, how});
    }
  }
  if (message->auras() != nullptr) {
    auras.reserve(message->auras()->size());
    for (const auto* aura : *message->auras()) {
      auto remote = from_wire(*aura, from);
      if (!remote) return remote.error();
      auras.push_back(*remote);
    }
  }
  const auto take_gone = [&](const flatbuffers::Vector<std::uint64_t>* list,
                             RestingNews::Kind kind) {
    if (list == nullptr) return;
    for (std::uint64_t id : *list) {
      gone.push_back(BodyId{id});
      news.push_back({kind, from, {BodyId{id}, {}, {}}});
    }
  };
  take_gone(message->removed(), RestingNews::Kind::gone);
  take_gone(message->handed_over(), RestingNews::Kind::handed_over);
  if (message->resting() != nullptr) {
    for (const auto* resting : *message->resting()) {
      auto body = decode_resting(*resting, prototypes);
      if (!body) return body.error();
      news.push_back({RestingNews::Kind::rests, from, *body});
    }
  }
  if (message->pulls() != nullptr) {
    const auto* to = message->pulls_to();
    if (to == nullptr || to->size() != message->pulls()->size())
      return Error{"an auras message asks for bodies without saying where they shall go"};
    const auto* known = message->pulls_known();
    if (known == nullptr || known->size() != message->pulls()->size())
      return Error{"an auras message asks for bodies without saying what it knows of them"};
    for (flatbuffers::uoffset_t i = 0; i < to->size(); ++i) {
      if (to->Get(i) >= regions)
        return Error::format("an auras message asks for a body for region {}; the world has {}",
                             to->Get(i), regions);
      constexpr auto most = static_cast<std::uint8_t>(Company::Hold::changed_twice);
      if (known->Get(i) > most)
        return Error::format(
            "an auras message asks for a body of which it knows {}; expected 0 to {}",
            known->Get(i), most);
      pulls.push_back({BodyId{message->pulls()->Get(i)},
                       RegionId{to->Get(i)},
                       {},
                       static_cast<Company::Hold>(known->Get(i))});
    }
  }
  const Tick told_at{message->tick()};
  if (heard_.empty()) return told_at;
  if (peer.theirs.size() + auras.size() > 4 * max_auras ||
      resting_news_.size() + news.size() > resting_news_max)
    return Error{"a region projects more auras than a world can hold"};

  peer.heard = true;
  // Slots mean what they meant before this message.
  for (const auto& [aura, how] : moved) take_motion(*how, peer.theirs[aura]);
  take_out(peer.theirs, gone);
  if (message->auras() != nullptr) {
    for (const auto* aura : *message->auras()) {
      if (aura->slot() == no_slot) continue;
      if (peer.their_slots.size() <= aura->slot()) peer.their_slots.resize(aura->slot() + 1u);
      peer.their_slots[aura->slot()] = BodyId{aura->id()};
    }
  }
  put_in(peer.theirs, auras);
  resting_news_.insert(resting_news_.end(), news.begin(), news.end());
  // Only the newest message's requests are still meant: they are repeated until they are met.
  peer.pulls.swap(pulls);
  changed_ = true;
  return told_at;
}

std::vector<HandoverRequest> AuraExchange::take_in() {
  if (!changed_) return {};
  std::map<BodyId, HandoverRequest> requested;
  told_.clear();
  const auto by_id = [](const Told& a, const Told& b) { return a.id < b.id; };
  for (const auto& [id, peer] : peers_) prefetch_beginning(peer.theirs);
  for (auto& [id, peer] : peers_) {
    for (const HandoverRequest& pull : peer.pulls) {
      const HandoverRequest heard{pull.body, pull.to, id, pull.known};
      const auto [at, fresh] = requested.try_emplace(pull.body, heard);
      if (!fresh && pull.to < at->second.to) at->second = heard;
    }
    peer.pulls.clear();
    if (peer.theirs.empty()) continue;
    told_by_one_.clear();
    for (const RemoteAura& aura : peer.theirs) told_by_one_.push_back({aura.id, &aura});
    // Of equal ones the merge puts those first that were there: the lower number's.
    told_before_.swap(told_);
    told_.resize(told_before_.size() + told_by_one_.size());
    std::merge(told_before_.begin(), told_before_.end(), told_by_one_.begin(), told_by_one_.end(),
               told_.begin(), by_id);
  }
  remote_.clear();
  for (const Told& told : told_)
    if (remote_.empty() || remote_.back().id != told.id) remote_.push_back(*told.aura);
  std::vector<HandoverRequest> requests;
  for (const auto& [body, request] : requested) requests.push_back(request);
  return requests;
}

bool AuraExchange::has_heard(RegionId id) const {
  const auto it = peers_.find(id);
  return it != peers_.end() && it->second.heard;
}

bool AuraExchange::tells(RegionId id) const {
  const auto it = peers_.find(id);
  return it != peers_.end() && !it->second.projected.empty();
}

bool AuraExchange::hears_of(RegionId id) const {
  const auto it = peers_.find(id);
  return it != peers_.end() && !it->second.theirs.empty();
}

std::span<const RestingNews> AuraExchange::take_resting_news() {
  taken_news_.clear();
  taken_news_.swap(resting_news_);
  return taken_news_;
}

}  // namespace aureole
