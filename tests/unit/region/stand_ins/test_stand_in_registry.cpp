// Stand-ins put up and taken down by what their owners say, on a physics world of their own.
#include "server/region/stand_ins/stand_ins.h"

#include "tests/support/catch.h"

using namespace aureole;

namespace {

constexpr BodyId theirs = BodyId::world(0), ours = BodyId::world(1);
constexpr RegionId owner{1};

/// A box of another server, and a sleeping one of ours on top of it.
struct Pair {
  std::vector<BodyDefinition> prototypes{{BoxShape{{0.5f, 0.5f, 0.5f}}}};
  std::vector<StaticDefinition> statics{{}};
  PhysicsWorld physics{{}, prototypes, statics};
  StandIns stand_ins{physics, Whereabouts({{-200, -10, -200}, {200, 100, 200}}, 1)};

  static NewBody box(BodyId id, double y, double x = 0) {
    NewBody body{id, PrototypeId{0}, {}};
    body.state.position = {x, y, 0};
    body.state.activation = Activation::asleep;
    return body;
  }
  Pair() {
    const NewBody top = box(ours, 1.5);
    physics.add(std::span(&top, 1));
    stand_ins.note_ours(std::span(&top, 1));
    tell(RestingNews::Kind::rests, Tick{1});
  }
  void tell(RestingNews::Kind kind, Tick now) { tell(kind, box(theirs, 0.5), now); }
  void tell(RestingNews::Kind kind, const NewBody& body, Tick now) {
    const RestingNews news{kind, owner, body};
    stand_ins.take(std::span(&news, 1), now);
  }
  bool stands() const { return physics.is_stand_in(theirs); }
};

}  // namespace

TEST_CASE("what leant on a stand-in wakes when its body has left its place") {
  Pair pair;
  RemoteAura aura{.id = theirs, .host = owner, .room = {}, .company = {}};
  pair.stand_ins.tidy(std::span(&aura, 1), Tick{2});
  REQUIRE(pair.stands());
  REQUIRE(pair.physics.is_asleep(ours));
  aura.left_its_place = true;
  pair.stand_ins.tidy(std::span(&aura, 1), Tick{3});
  REQUIRE_FALSE(pair.stands());
  REQUIRE_FALSE(pair.physics.is_asleep(ours));
}

TEST_CASE("a stand-in that is gone wakes what leant on it, one that is handed over stays a while") {
  Pair gone, handed_over;
  gone.tell(RestingNews::Kind::gone, Tick{2});
  REQUIRE_FALSE(gone.stands());
  REQUIRE_FALSE(gone.physics.is_asleep(ours));
  handed_over.tell(RestingNews::Kind::handed_over, Tick{2});
  handed_over.stand_ins.tidy({}, Tick{2 + StandIns::grace_ticks});
  REQUIRE(handed_over.stands());
  REQUIRE(handed_over.physics.is_asleep(ours));
  handed_over.stand_ins.tidy({}, Tick{3 + StandIns::grace_ticks});
  REQUIRE_FALSE(handed_over.stands());
  REQUIRE_FALSE(handed_over.physics.is_asleep(ours));
}

TEST_CASE(
    "who sleeps inside another server's body wakes, who has sunk into it a little sleeps on") {
  for (const double depth : {0.05, 0.3}) {
    Pair pair;
    const NewBody inside = Pair::box(BodyId::world(2), 5);
    pair.physics.add(std::span(&inside, 1));
    pair.tell(RestingNews::Kind::rests, Pair::box(BodyId::world(3), 6 - depth), Tick{2});
    REQUIRE(pair.physics.is_asleep(inside.id) == (depth < 0.1));
  }
}

TEST_CASE("while its owner cannot be heard a stand-in stays; what is not told again then goes") {
  Pair pair;
  pair.stand_ins.tidy({}, Tick{1000});
  REQUIRE(pair.stands());
  pair.tell(RestingNews::Kind::told_all, Tick{1001});
  pair.stand_ins.tidy({}, Tick{1001 + StandIns::grace_ticks});
  REQUIRE(pair.stands());
  pair.stand_ins.tidy({}, Tick{1002 + StandIns::grace_ticks});
  REQUIRE_FALSE(pair.stands());
}

TEST_CASE("what none of ours is near to does not stand until one of ours comes") {
  Pair pair;
  const NewBody far = Pair::box(BodyId::world(2), 0.5, 100);
  pair.tell(RestingNews::Kind::rests, far, Tick{2});
  REQUIRE_FALSE(pair.physics.is_stand_in(far.id));
  REQUIRE(pair.stand_ins.size() == 1);
  const NewBody coming = Pair::box(BodyId::world(3), 20, 92);
  pair.stand_ins.note_ours(std::span(&coming, 1));
  REQUIRE(pair.physics.is_stand_in(far.id));
  REQUIRE(pair.physics.stand_in(far.id).state.position == far.state.position);
  REQUIRE(pair.stand_ins.size() == 2);
}

TEST_CASE("where only what is near is told all stand, wherever ours are") {
  Pair pair;
  StandIns all{pair.physics, std::nullopt};
  const RestingNews news{RestingNews::Kind::rests, owner, Pair::box(BodyId::world(2), 0.5, 100)};
  all.take(std::span(&news, 1), Tick{2});
  all.look_around();
  REQUIRE(pair.physics.is_stand_in(news.body.id));
}

TEST_CASE("what none of ours is near to any more is put away, and comes back for the next one") {
  Pair pair;
  pair.stand_ins.look_around();
  REQUIRE(pair.stands());
  pair.physics.remove(std::span(&ours, 1));
  pair.stand_ins.look_around();
  REQUIRE_FALSE(pair.stands());
  REQUIRE(pair.stand_ins.size() == 0);
  pair.stand_ins.tidy({}, Tick{1000});  // Its owner has not taken its word back.
  const NewBody next = Pair::box(BodyId::world(2), 3);
  pair.stand_ins.note_ours(std::span(&next, 1));
  REQUIRE(pair.stands());
}

TEST_CASE("what does not stand is moved, taken back and born again by its owner's word alone") {
  Pair pair;
  const NewBody far = Pair::box(BodyId::world(2), 0.5, 100);
  NewBody here = Pair::box(far.id, 0.5, 4);
  const NewBody coming = Pair::box(BodyId::world(3), 20, 100);
  const auto come = [&] { pair.stand_ins.note_ours(std::span(&coming, 1)); };
  pair.tell(RestingNews::Kind::rests, far, Tick{2});
  SECTION("moved to where ours are") {
    pair.tell(RestingNews::Kind::rests, here, Tick{3});
    REQUIRE(pair.physics.stand_in(far.id).state.position == here.state.position);
    come();
    REQUIRE(pair.physics.stand_in(far.id).state.position == here.state.position);
  }
  SECTION("taken back") {
    pair.tell(RestingNews::Kind::gone, far, Tick{3});
    come();
    REQUIRE_FALSE(pair.physics.is_stand_in(far.id));
  }
  SECTION("left its place") {
    RemoteAura aura{.id = far.id, .host = owner, .room = {}, .company = {}};
    aura.left_its_place = true;
    pair.stand_ins.tidy(std::span(&aura, 1), Tick{3});
    come();
    REQUIRE_FALSE(pair.physics.is_stand_in(far.id));
  }
  SECTION("a body of ours under that name") {
    pair.physics.add(std::span(&far, 1));
    come();
    REQUIRE(pair.physics.contains(far.id));
    REQUIRE_FALSE(pair.physics.is_stand_in(far.id));
  }
  pair.stand_ins.look_around();
  REQUIRE(pair.stands());
}
