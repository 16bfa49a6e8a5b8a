// A whole gateway, with its renderer, between made-up regions and headless players.
#include <cmath>

#include "renderer/jpeg_encoder.h"
#include "tests/unit/gateway/support/running_gateway.h"

using namespace aureole;
using namespace aureole::test;

TEST_CASE("A player joins, is welcomed, and sees pictures of the size asked for") {
  Stage2 stage;
  ViewClient client(stage.client());
  REQUIRE(client.connect());
  const Json welcome = welcome_of(client);
  REQUIRE(welcome["version"] == 1);
  REQUIRE(welcome["resumed"] == false);
  REQUIRE(welcome["token"].get<std::string>().size() == 32);
  REQUIRE(welcome["world"]["name"] == "small");
  REQUIRE(welcome["regions"].size() == 2);
  REQUIRE(welcome["regions"][0]["name"] == "west");
  REQUIRE(welcome["regions"][0]["colour"].get<std::string>().size() == 7);
  REQUIRE(welcome["throwables"].size() == 4);
  REQUIRE(welcome["tick_ms"] == 16);

  REQUIRE(client.wait_for_pictures(30));
  const auto picture = client.newest_picture();
  const auto pixels = render::decode_jpeg(picture->jpeg);
  REQUIRE(pixels);
  REQUIRE(pixels->width == 320);
  REQUIRE(pixels->height == 180);
  REQUIRE(picture->width == 320);
  REQUIRE(picture->height == 180);
  REQUIRE(picture->number >= 30);
  REQUIRE(picture->world_us > 16'000'000);
  REQUIRE(picture->made_in_us > 0);
  // Sky, ground and bodies: not one colour.
  const auto& bytes = pixels->bgrx;
  REQUIRE(std::abs(bytes[1] - bytes[bytes.size() - 3]) > 10);

  stage.gateway.wait_for([&] { return stage.west.has_avatar(player_in(welcome)); });
  const auto status = client.wait_for_text("\"region\":\"west\"");
  REQUIRE(status);
  const Json told = Json::parse(*status);
  REQUIRE(told["bodies"] == 71);
  REQUIRE(told["players"] == 1);
  REQUIRE(told["regions_up"] == 2);
  REQUIRE(told["position"][0] == -5.0);
}

TEST_CASE("Inputs reach the region once and in order, and pictures say which ones they contain") {
  Stage2 stage;
  ViewClient client(stage.client());
  REQUIRE(client.connect());
  (void)welcome_of(client);
  for (std::uint32_t seq = 1; seq <= 40; ++seq) client.send_input(seq, seq % 2, 0.01 * seq, 0);
  client.send(R"({"type":"action","seq":41,"action":"throw","item":2,"yaw":0.5,"pitch":0.1})");
  RunningGateway::wait_for([&] {
    const auto picture = client.newest_picture();
    return picture && picture->input_seq == 41;
  });
  std::uint32_t sequence = 0;
  for (const auto& command : stage.west.applied()) {
    REQUIRE(command.sequence() == ++sequence);
    REQUIRE(command.gateway() == 5);
  }
  REQUIRE(sequence == 42);  // join, 40 inputs that each change a key, throw
  REQUIRE(stage.west.applied().back().kind() == wire::CommandKind::throw_body);
  REQUIRE(stage.west.applied().back().item() == 1);
  REQUIRE(stage.east.applied().empty());
}

TEST_CASE("A client that takes nothing in does not slow another one") {
  Stage2 stage;
  ViewClientOptions silent_options = stage.client();
  silent_options.acknowledges = false;
  ViewClient silent(silent_options), stalled(stage.client()), healthy(stage.client());
  REQUIRE(silent.connect());
  REQUIRE(stalled.connect());
  REQUIRE(healthy.connect());
  REQUIRE(stalled.wait_for_pictures(5));
  stalled.stall();
  REQUIRE(silent.wait_for_pictures(3));
  const std::size_t before = healthy.pictures();
  REQUIRE(healthy.wait_for_pictures(before + 120));
  REQUIRE(silent.pictures() == 3);  // one window, and not one more
}

TEST_CASE("Hostile messages end their own connection with a sentence, and no other") {
  Stage2 stage;
  ViewClient good(stage.client());
  REQUIRE(good.connect());
  (void)welcome_of(good);

  const auto refused = [&](bool joins, const std::string& text) {
    auto o = stage.client();
    o.joins = joins;
    ViewClient bad(o);
    REQUIRE(bad.connect());
    if (joins) (void)welcome_of(bad);
    bad.send(text);
    const auto error = bad.wait_for_text("\"error\"");
    REQUIRE(error);
    REQUIRE(bad.wait_for_end());
    return Json::parse(*error)["message"].get<std::string>();
  };
  REQUIRE(refused(true, "{").find("JSON") != std::string::npos);
  REQUIRE(refused(true, R"({"type":"input","seq":1,"keys":999,"yaw":0,"pitch":0})").find("keys") !=
          std::string::npos);
  REQUIRE(refused(true, R"({"type":"join","version":1,"width":640,"height":360})").find("once") !=
          std::string::npos);
  REQUIRE(refused(false, R"({"type":"ack","frame":1})").find("join") != std::string::npos);
  REQUIRE(
      refused(false, R"({"type":"join","version":9,"width":640,"height":360})").find("version") !=
      std::string::npos);

  auto o = stage.client();
  o.joins = false;
  ViewClient binary(o), huge(o), flood(o);
  REQUIRE(binary.connect());
  binary.send_binary("abc");
  REQUIRE(binary.wait_for_text("must be text"));
  REQUIRE(huge.connect());
  huge.send(std::string(5'000, ' '));
  REQUIRE(huge.wait_for_end());
  REQUIRE(flood.connect());
  for (int i = 0; i < 1'000; ++i) flood.send(R"({"type":"ping","t":1})");
  REQUIRE(flood.wait_for_end());

  o.origin = "http://evil.example";
  ViewClient foreign(o);
  REQUIRE_FALSE(foreign.connect());

  const std::size_t before = good.pictures();
  REQUIRE(good.wait_for_pictures(before + 10));
  good.send(R"({"type":"ping","t":12.5})");
  REQUIRE(good.wait_for_text(R"({"t":12.5,"type":"pong"})"));
}

TEST_CASE("A player who loses the connection goes on with the same avatar under a newer session") {
  Stage2 stage;
  std::string token;
  {
    ViewClient client(stage.client());
    REQUIRE(client.connect());
    const Json welcome = welcome_of(client);
    token = welcome["token"];
    REQUIRE(client.wait_for_text("\"region\":\"west\""));
    client.drop();
    RunningGateway::wait_for([&] { return applied_kind(stage.west, wire::CommandKind::lost); });
  }
  ViewClient again(stage.client(token));
  REQUIRE(again.connect());
  const Json welcome = welcome_of(again);
  REQUIRE(welcome["resumed"] == true);
  REQUIRE(welcome["token"] == token);
  RunningGateway::wait_for(
      [&] { return stage.west.applied().back().kind() == wire::CommandKind::join; });
  const auto applied = stage.west.applied();
  REQUIRE(applied.back().session() > applied.front().session());
  REQUIRE(applied.back().target() == BodyId::avatar(player_in(welcome)).value);

  again.send(R"({"type":"leave"})");
  REQUIRE(again.wait_for_end());
  RunningGateway::wait_for([&] { return !stage.west.has_avatar(player_in(welcome)); });
}

TEST_CASE(
    "The same token in a second window closes the first one, and nobody is told that it is lost") {
  Stage2 stage;
  ViewClient first(stage.client());
  REQUIRE(first.connect());
  const std::string token = welcome_of(first)["token"];
  ViewClient second(stage.client(token));
  REQUIRE(second.connect());
  (void)welcome_of(second);
  REQUIRE(first.wait_for_text("another window"));
  REQUIRE(first.wait_for_end());
  const std::size_t before = second.pictures();
  REQUIRE(second.wait_for_pictures(before + 20));
  REQUIRE_FALSE(applied_kind(stage.west, wire::CommandKind::lost));
}

TEST_CASE("Grabbing takes the body in the crosshair, then lets go; and says when there is none") {
  Stage2 stage;
  ViewClient client(stage.client());
  REQUIRE(client.connect());
  const Json welcome = welcome_of(client);
  REQUIRE(client.wait_for_text("\"region\":\"west\""));
  client.send(R"({"type":"action","seq":1,"action":"grab","yaw":3.1,"pitch":0.5})");
  REQUIRE(client.wait_for_text("\"notice\":\"Nothing"));
  // From the eye at (-5, 1.7, 0) down to the third body at (-5, 0.3, -4), which does not move.
  client.send(fmt::format(R"({{"type":"action","seq":2,"action":"grab","yaw":0,"pitch":{}}})",
                          -std::atan2(1.4, 4.0)));
  RunningGateway::wait_for([&] { return applied_kind(stage.west, wire::CommandKind::grab); });
  const BodyId taken{stage.west.applied().back().target()};
  REQUIRE(taken == BodyId::world(2));
  REQUIRE(client.wait_for_text("\"carrying\":true"));
  client.send(R"({"type":"action","seq":3,"action":"grab","yaw":0,"pitch":0})");
  REQUIRE(client.wait_for_text("\"carrying\":false"));
  REQUIRE(stage.west.applied().back().target() == 0);
}

TEST_CASE("Tools get all bodies and pictures from any camera, the same pixels each time") {
  FakeRegion west(world(), {.id = RegionId{0}, .bodies = 30});
  FakeRegion east(world(), {.id = RegionId{1}, .bodies = 20});
  RunningGateway gateway({west.address(), east.address()});
  gateway.wait_until_healthy();
  // Drawn time is a little behind: it has to reach the first states.
  Json replicas;
  RunningGateway::wait_for([&] {
    replicas = Json::parse(gateway.get("/api/replicas").body);
    return replicas["bodies"].size() == 50 && replicas["bodies"][0]["asleep"] == true;
  });
  REQUIRE(replicas["bodies"].size() == 50);
  REQUIRE(replicas["bodies"][0]["id"] == std::to_string(BodyId::world(0).value));
  REQUIRE(replicas["bodies"][0]["owner"] == "west");
  REQUIRE(replicas["bodies"][49]["owner"] == "east");
  REQUIRE(replicas["bodies"][0]["asleep"] == true);

  const std::string view = "/api/frame.jpg?x=4&y=3&z=12&yaw=0.3&pitch=-0.2&w=320&h=180&format=ppm";
  const auto first = gateway.get(view), second = gateway.get(view);
  REQUIRE(first.status == 200);
  REQUIRE(first.body.size() == std::string("P6\n320 180\n255\n").size() + 320 * 180 * 3);
  REQUIRE(first.body == second.body);
  REQUIRE(gateway.get(view + "&tint=1").body != first.body);
  REQUIRE(gateway.get(view + "&boundaries=1").body != first.body);
  const auto moved =
      gateway.get("/api/frame.jpg?x=4.01&y=3&z=12&yaw=0.3&pitch=-0.2&w=320&h=180&format=ppm");
  REQUIRE(moved.body != first.body);
  const auto jpeg = gateway.get("/api/frame.jpg?x=0&y=3&z=12&w=320&h=180");
  REQUIRE(jpeg.head.find("image/jpeg") != std::string::npos);
  const auto* data = reinterpret_cast<const std::uint8_t*>(jpeg.body.data());
  REQUIRE(render::decode_jpeg(std::span(data, jpeg.body.size())));
  REQUIRE(gateway.get("/api/frame.jpg?x=0").status == 400);
  REQUIRE(gateway.get("/api/nothing").status == 404);
  REQUIRE(gateway.get("/../etc/passwd").status == 404);
}

TEST_CASE(
    "A gateway that is full says so, and a region that applies nothing costs its players only") {
  FakeRegion west(world(), {.id = RegionId{0}, .bodies = 3, .applies = false});
  FakeRegion east(world(), {.id = RegionId{1}});
  RunningGateway gateway({west.address(), east.address()}, /*max_players=*/2);
  gateway.wait_until_healthy();
  ViewClientOptions o;
  o.gateway = gateway.at;
  ViewClient a(o), b(o), c(o);
  REQUIRE(a.connect());
  (void)welcome_of(a);
  REQUIRE(b.connect());
  (void)welcome_of(b);
  REQUIRE(c.connect());
  REQUIRE(c.wait_for_text("is full"));
  for (std::uint32_t seq = 1; seq <= 300; ++seq) a.send_input(seq, seq % 2, 0, 0);
  REQUIRE(a.wait_for_text("cannot keep up"));
  REQUIRE(a.wait_for_end());
  REQUIRE(b.wait_for_pictures(b.pictures() + 10));
}

TEST_CASE("Who joins while a region is missing is told which, again and again, and kept") {
  FakeRegion east(world(), {.id = RegionId{1}, .bodies = 3});
  PeerAddress nobody{PeerId::region(RegionId{0}), {"127.0.0.1", 1}};
  RunningGateway gateway({nobody, east.address()});
  ViewClientOptions options;
  options.gateway = gateway.at;
  ViewClient client(options);
  REQUIRE(client.connect());
  for (int times = 0; times < 3; ++times) {
    const auto word = client.wait_for_text("\"waiting\"");
    REQUIRE(word);
    CHECK(Json::parse(*word)["missing"] == Json::array({"west"}));
  }
  CHECK(gateway.rejection().empty());
}

TEST_CASE("Places of those who have gone without a word do not fill the world") {
  FakeRegion west(world(), {.id = RegionId{0}}), east(world(), {.id = RegionId{1}});
  RunningGateway gateway({west.address(), east.address()}, 2);
  gateway.wait_until_healthy();
  ViewClientOptions options;
  options.gateway = gateway.at;
  std::string token;
  for (const bool at_once : {false, true}) {
    ViewClient client(options);
    REQUIRE(client.connect());
    const Json welcome = welcome_of(client);
    if (!at_once) {
      token = welcome["token"];
      REQUIRE(client.wait_for_text("\"region\":\"west\""));
    }
    client.drop();
    RunningGateway::wait_for([&] { return gateway.status()["players"] == 0; });
  }
  ViewClient third(options);
  REQUIRE(third.connect());
  const auto error = third.wait_for_text("\"error\"");
  REQUIRE(error);
  CHECK(error->find("places of 2 players") != std::string::npos);
  REQUIRE(third.wait_for_end());

  // Whoever comes back has a place already; and when it is given up somebody else may have it.
  options.token = token;
  ViewClient back(options);
  REQUIRE(back.connect());
  CHECK(welcome_of(back)["resumed"] == true);
  back.send(R"({"type":"leave"})");
  REQUIRE(back.wait_for_end());
  options.token.clear();
  RunningGateway::wait_for([&] {
    ViewClient next(options);
    REQUIRE(next.connect());
    const auto answer = next.wait_for_text("\"type\"");
    return answer && answer->find("\"welcome\"") != std::string::npos;
  });
}

TEST_CASE("A session number that somebody made up spoils that one player, and nobody else") {
  Stage2 stage;
  ViewClient victim(stage.client());
  REQUIRE(victim.connect());
  const Json welcome = welcome_of(victim);
  RunningGateway::wait_for([&] { return stage.west.has_avatar(player_in(welcome)); });
  stage.west.make_up_session(player_in(welcome), session_max);
  REQUIRE(victim.wait_for_end());

  ViewClient again(stage.client(welcome["token"]));
  REQUIRE(again.connect());
  const auto error = again.wait_for_text("\"error\"");
  REQUIRE(error);
  CHECK(error->find("join without a token") != std::string::npos);

  ViewClient other(stage.client());
  REQUIRE(other.connect());
  const PlayerId fresh = player_in(welcome_of(other));
  RunningGateway::wait_for([&] { return stage.west.has_avatar(fresh); });
  for (const auto& command : stage.west.applied())
    if (command.player() == fresh.value) CHECK(command.session() < session_max / 2);
}

TEST_CASE("A gateway that no region will ever take says so to its owner") {
  FakeRegion west(world(), {.id = RegionId{0}}), east(world(), {.id = RegionId{1}});
  SECTION("of another world") {
    WorldDefinition other = world();
    other.hash += 1;
    RunningGateway gateway({west.address(), east.address()}, 8, other);
    RunningGateway::wait_for([&] { return !gateway.rejection().empty(); });
    CHECK(gateway.rejection().find("another world") != std::string::npos);
  }
  SECTION("under a number that another one has") {
    RunningGateway first({west.address(), east.address()});
    first.wait_until_healthy();
    RunningGateway second({west.address(), east.address()}, 8, world(), Incarnation{2});
    RunningGateway::wait_for([&] { return !first.rejection().empty(); });
    CHECK(first.rejection().find("--number") != std::string::npos);
    CHECK(second.rejection().empty());
  }
}

TEST_CASE("A message that is too long is answered with a sentence") {
  Stage2 stage;
  ViewClient client(stage.client());
  REQUIRE(client.connect());
  (void)welcome_of(client);
  client.send(R"({"type":"ping","t":1,"x":")" + std::string(5000, 'x') + "\"}");
  const auto error = client.wait_for_text("\"error\"");
  REQUIRE(error);
  CHECK(error->find("4096") != std::string::npos);
  REQUIRE(client.wait_for_end());
}
