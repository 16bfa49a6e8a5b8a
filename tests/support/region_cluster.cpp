// The in-memory network of region cores.
#include "tests/support/region_cluster.h"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "server/replica/recovery_answer.h"

namespace aureole::testing {

WorldDefinition flat_world(int columns, double width) {
  WorldDefinition world;
  world.name = "flat";
  for (int i = 0; i < columns; ++i) {
    RegionDefinition region{"r" + std::to_string(i), {}};
    if (i > 0) region.area.min_x = i * width;
    if (i + 1 < columns) region.area.max_x = (i + 1) * width;
    world.regions.push_back(region);
  }
  world.bounds.min = {-500, -20, -500};
  world.bounds.max = {1000, 500, 500};
  const auto prototype = [](std::string name, Shape shape, float mass) {
    Prototype p;
    p.name = std::move(name);
    p.body.shape = std::move(shape);
    p.body.mass_kg = mass;
    return p;
  };
  world.prototypes.push_back(prototype("ball", SphereShape{0.3f}, 1));
  world.prototypes.push_back(prototype("box", BoxShape{{0.5f, 0.5f, 0.5f}}, 2));
  world.prototypes.push_back(prototype("plank", BoxShape{{1.0f, 0.1f, 0.2f}}, 2));
  world.prototypes.push_back(prototype("avatar", CapsuleShape{0.35f, 1.8f}, 80));
  world.prototypes[3].body.upright = true;
  world.prototypes[3].body.friction = 0;
  world.avatar = avatar_prototype;
  WorldStatic ground;
  ground.name = "ground";
  world.statics.push_back(ground);
  world.spawn_points.push_back({{10, 0.95, 0}, 0});
  for (auto& item : world.throwables) item = {"ball", ball, 20};
  world.hash = 1;
  return world;
}

BodyId put(WorldDefinition& world, PrototypeId prototype, WorldPosition at,
           Eigen::Vector3f velocity, Activation activation) {
  WorldBody body;
  body.prototype = prototype;
  body.state.position = at;
  body.state.linear_velocity = velocity;
  body.state.activation = activation;
  world.bodies.push_back(body);
  return BodyId::world(static_cast<std::uint32_t>(world.bodies.size() - 1));
}

RegionCluster::RegionCluster(const WorldDefinition& world, int delay_ticks)
    : world_(world),
      delay_ticks_(delay_ticks),
      store_(std::make_unique<ReplicaStore>(world.prototypes.size())) {
  const int count = static_cast<int>(world.regions.size());
  for (int i = 0; i < count; ++i) {
    incarnations_.push_back(Incarnation{1});
    cores_.push_back(std::make_unique<RegionCore>(world, RegionId{static_cast<std::uint16_t>(i)},
                                                  incarnations_.back()));
  }
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j)
      if (i != j) core(i).peer_up(PeerId{static_cast<std::uint16_t>(j)}, Incarnation{1});
    core(i).peer_up(PeerId::gateway(0), Incarnation{1});
    store_->region_up(RegionId{static_cast<std::uint16_t>(i)});
  }
}

void RegionCluster::hand_over(int from, int to, const SharedBytes& bytes) {
  const auto frame = decode_frame(*bytes);
  if (!frame) throw std::logic_error(frame.error().message);
  if (auto taken = core(to).receive(PeerId{static_cast<std::uint16_t>(from)}, *frame); !taken)
    faults_.push_back(taken.error().message);
}

void RegionCluster::deliver() {
  for (auto& [ends, queue] : links_) {
    if (silent_[ends] || !is_alive(ends.second)) continue;
    while (!queue.empty() && queue.front().arrives <= now_) {
      const SharedBytes bytes = queue.front().frame;
      queue.pop_front();
      hand_over(ends.first, ends.second, bytes);
    }
  }
  for (auto& [to, answers] : store_answers_) {
    if (is_alive(to) && store_)
      for (const SharedBytes& bytes : answers)
        hand_over(PeerId::gateway(0).value, to, bytes);
    answers.clear();
  }
}

void RegionCluster::take_of_store(int from, const SharedBytes& bytes) {
  if (!store_) return;
  const auto frame = decode_frame(*bytes);
  const RegionId region{static_cast<std::uint16_t>(from)};
  if (frame->type == FrameType::replica_update) {
    if (auto taken = store_->apply(region, frame->payload); !taken)
      faults_.push_back(taken.error().message);
  } else if (frame->type == FrameType::recovery_query) {
    auto answer = answer_recovery(*store_, region, frame->payload);
    if (!answer) return faults_.push_back(answer.error().message);
    for (const SharedBytes& part : *answer) store_answers_[from].push_back(part);
  }
}

void RegionCluster::collect() {
  for (int i = 0; i < static_cast<int>(cores_.size()); ++i) {
    if (!is_alive(i)) continue;
    for (const Outgoing& out : core(i).outbox()) {
      if (!out.to.is_region()) {
        take_of_store(i, out.frame);
        continue;
      }
      const auto ends = std::pair(i, static_cast<int>(out.to.value));
      if (cut_[ends]) continue;
      links_[ends].push_back({now_ + 1 + delay_ticks_, out.frame});
    }
  }
}

void RegionCluster::write_disks() {
  if (!has_disks_) return;
  for (int i = 0; i < static_cast<int>(cores_.size()); ++i) {
    if (!is_alive(i) || disk_stopped_[i]) continue;
    if (const SharedBytes snapshot = core(i).snapshot_due()) {
      disks_[i] = *snapshot;
      core(i).snapshot_written(now_);
    }
  }
}

void RegionCluster::step(int ticks) {
  for (int n = 0; n < ticks; ++n) {
    now_ = now_ + 1;
    deliver();
    for (auto& c : cores_)
      if (c) c->step(now_);
    collect();
    write_disks();
  }
}

void RegionCluster::cut_link(int a, int b) {
  for (const auto& ends : {std::pair(a, b), std::pair(b, a)}) {
    links_[ends].clear();
    cut_[ends] = true;
    if (is_alive(ends.first)) core(ends.first).peer_down(PeerId{static_cast<std::uint16_t>(ends.second)});
  }
}

void RegionCluster::link(int a, int b) {
  if (!is_alive(a) || !is_alive(b)) return;
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
    links_[{from, to}].clear();
    cut_[{from, to}] = false;
    silent_[{from, to}] = false;
    core(from).peer_up(PeerId{static_cast<std::uint16_t>(to)},
                       incarnations_[static_cast<std::size_t>(to)]);
  }
}

void RegionCluster::reset_link(int a, int b) {
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)})
    if (is_alive(from)) core(from).peer_down(PeerId{static_cast<std::uint16_t>(to)});
  link(a, b);
}

void RegionCluster::restart(int i) {
  const auto at = static_cast<std::size_t>(i);
  incarnations_[at] = Incarnation{incarnations_[at].value + 1};
  cores_[at] = std::make_unique<RegionCore>(world_, RegionId{static_cast<std::uint16_t>(i)},
                                            incarnations_[at]);
  for (int j = 0; j < static_cast<int>(cores_.size()); ++j)
    if (j != i) reset_link(i, j);
}

void RegionCluster::give_disks() {
  has_disks_ = true;
  for (auto& c : cores_) c->enable_snapshots();
}

void RegionCluster::kill(int i, Sent sent) {
  for (int j = 0; j < static_cast<int>(cores_.size()); ++j) {
    if (j == i) continue;
    if (sent == Sent::arrives && is_alive(j))
      for (const Message& message : links_[{i, j}]) hand_over(i, j, message.frame);
    cut_link(i, j);
  }
  if (store_) store_->region_down(RegionId{static_cast<std::uint16_t>(i)});
  store_answers_[i].clear();
  cores_[static_cast<std::size_t>(i)].reset();
}

Status RegionCluster::start_again(int i, Disk disk) {
  const auto at = static_cast<std::size_t>(i);
  incarnations_[at] = Incarnation{incarnations_[at].value + 1};
  cores_[at] = std::make_unique<RegionCore>(world_, RegionId{static_cast<std::uint16_t>(i)},
                                            incarnations_[at]);
  if (has_disks_) core(i).enable_snapshots();
  disk_stopped_[i] = false;
  const Status status = core(i).recover(disk == Disk::kept ? disks_[i] : Bytes{});
  for (int j = 0; j < static_cast<int>(cores_.size()); ++j)
    if (j != i) link(i, j);
  if (store_) {
    store_->region_up(RegionId{static_cast<std::uint16_t>(i)});
    core(i).peer_up(PeerId::gateway(0), store_incarnation_);
  }
  return status;
}

bool RegionCluster::recovering() const {
  return std::any_of(cores_.begin(), cores_.end(),
                     [](const auto& c) { return !c || c->recovering(); });
}

void RegionCluster::kill_store() {
  store_.reset();
  store_answers_.clear();
  for (auto& c : cores_)
    if (c) c->peer_down(PeerId::gateway(0));
}

void RegionCluster::start_store() {
  store_ = std::make_unique<ReplicaStore>(world_.prototypes.size());
  store_incarnation_ = Incarnation{store_incarnation_.value + 1};
  for (std::size_t i = 0; i < cores_.size(); ++i) {
    if (!cores_[i]) continue;
    store_->region_up(RegionId{static_cast<std::uint16_t>(i)});
    cores_[i]->peer_up(PeerId::gateway(0), store_incarnation_);
  }
}

void RegionCluster::command(PlayerCommand command, std::optional<int> to) {
  if (!to) to = owner(BodyId::avatar(command.player));
  if (!to) throw std::logic_error("the avatar is in flight");
  const Frame frame{FrameType::commands, 0, encode_commands(std::span(&command, 1))};
  if (auto taken = core(*to).receive(PeerId::gateway(0), frame); !taken)
    faults_.push_back(taken.error().message);
}

std::optional<int> RegionCluster::owner(BodyId id) const {
  std::optional<int> found;
  for (std::size_t i = 0; i < cores_.size(); ++i) {
    if (!cores_[i] || !cores_[i]->hosting().hosts(id)) continue;
    if (found) throw std::logic_error("two regions simulate one body");
    found = static_cast<int>(i);
  }
  return found;
}

std::size_t RegionCluster::bodies_in_world() const {
  std::set<BodyId> ids;
  for (std::size_t i = 0; i < cores_.size(); ++i) {
    if (!cores_[i]) continue;
    for (BodyId id : cores_[i]->physics().ids()) {
      static_cast<void>(owner(id));
      ids.insert(id);
    }
    for (std::size_t j = 0; j < cores_.size(); ++j) {
      if (i == j) continue;
      const auto& journal = cores_[i]->journal(RegionId{static_cast<std::uint16_t>(j)});
      for (const auto& entry : journal.unacknowledged()) {
        if (entry.type != FrameType::handoff || journal.is_taken(entry)) continue;
        const auto group =
            decode_handoff(entry.payload, world_.prototypes.size(), world_.statics.size());
        for (const auto& b : group->bodies) ids.insert(b.body.id);
      }
    }
  }
  return ids.size();
}

BodyState RegionCluster::state(BodyId id) const {
  const auto at = owner(id);
  if (!at) throw std::logic_error("the body is in flight");
  return cores_[static_cast<std::size_t>(*at)]->physics().state(id);
}

}  // namespace aureole::testing
