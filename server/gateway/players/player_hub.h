// All players of this gateway: who comes, who goes, and whose commands go where.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/gateway/pictures/moments.h"
#include "server/gateway/players/player_session.h"
#include "server/gateway/players/player_view.h"
#include "server/gateway/region_subscriber.h"
#include "server/gateway/web/connection.h"
#include "server/worlds/world.h"

namespace aureole {

struct PlayerHubOptions {
  std::uint16_t gateway = 0;
  int max_players = 32;
};

/// What operators see of a player.
struct PlayerReport {
  std::string name;
  std::string region;
  double fps = 0;
  int quality = 0;
  double scale = 1;
  int width = 0, height = 0;
  double round_trip_ms = 0;
  std::size_t unapplied = 0;
};

/// Runs on the io_context's one thread. A connection has a *seat* from the moment it opens; with
/// `join` it asks for its avatar, and once the regions have said what they know (a player who comes
/// back may have an avatar anywhere) it gets a session.
class PlayerHub {
 public:
  /// Everything must outlive it.
  PlayerHub(const WorldDefinition& world, RegionSubscriber& regions, Stage& stage,
            const PlayerHubOptions& options);
  ~PlayerHub();

  void connected(std::shared_ptr<Connection> connection);
  /// A region's update was taken in: commands may have been applied.
  void region_updated(RegionId region, std::int64_t now_us);
  /// Who waits to join may do so now.
  void regions_changed(std::int64_t now_us);

  /// 60 times a second: commands out, pictures due.
  void frame(std::int64_t now_us);
  /// Four times a second.
  void send_status(std::int64_t now_us);
  /// Ends all connections without a word; pages come back by themselves.
  void stop();

  std::size_t player_count() const;
  std::vector<PlayerReport> reports(std::int64_t now_us) const;

 private:
  struct Seat;
  struct Departing {
    std::shared_ptr<PlayerSession> session;
    std::int64_t until_us;
    bool avatar_seen = false;
  };
  using SeatId = std::uint64_t;

  void on_text(Seat& seat, std::string_view text, std::int64_t now_us);
  void on_closed(SeatId id, const std::string& reason);
  void on_join(Seat& seat, JoinMessage message, std::int64_t now_us);
  void try_admit(Seat& seat, std::int64_t now_us);
  void admit(Seat& seat, std::int64_t now_us);
  void on_message(Seat& seat, const BrowserMessage& message, std::int64_t now_us);
  Status on_action(Seat& seat, const ActionMessage& message, std::int64_t now_us);
  void on_leave(Seat& seat, std::int64_t now_us);
  Status play(Seat& seat, std::int64_t now_us);
  void send_commands(PlayerSession& session, std::int64_t now_us);
  void send_status(Seat& seat, std::int64_t now_us);
  Status replace_lost_avatar(Seat& seat, std::int64_t now_us);
  void serve_departing(std::int64_t now_us);
  void end_session(Seat& seat);
  void refuse(Seat& seat, const std::string& sentence);

  /// Region to which a player's commands go: the owner of the avatar, or where it would appear.
  RegionId home_of(PlayerId player) const;
  std::uint16_t spawn_of(PlayerId player) const;
  RegionId spawn_region(PlayerId player) const;
  /// Higher than `after` and than all that is known of this player; an Error if there is none.
  Result<std::uint32_t> new_session(PlayerId player, std::uint32_t after);
  std::size_t abandoned_avatars() const;

  const WorldDefinition& world_;
  RegionSubscriber& regions_;
  Stage& stage_;
  PlayerHubOptions options_;
  std::map<SeatId, std::unique_ptr<Seat>> seats_;
  std::vector<Departing> departing_;
  SeatId next_seat_ = 1;
  std::uint32_t newest_session_ = 0;
  /// Connections may outlive the hub by a turn of the loop; their events then find nobody.
  std::shared_ptr<int> alive_ = std::make_shared<int>();
};

}  // namespace aureole
