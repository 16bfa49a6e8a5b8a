// One player's pictures: when one is drawn, from which camera, and when the next may follow.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "server/gateway/pictures/moments.h"
#include "server/gateway/pictures/render_pool.h"
#include "server/gateway/players/player_session.h"
#include "server/gateway/web/connection.h"

namespace aureole {

/// Sums over all pictures of the gateway; whoever reads them takes differences.
struct PictureTotals {
  std::uint64_t pictures = 0, bytes = 0, render_us = 0, encode_us = 0;
};

/// What all views draw with.
struct Stage {
  const SceneBuilder& builder;
  Moments& moments;
  RenderPool& pool;
  PictureTotals& totals;
};

/// At most one picture of a view is being drawn at any time, and none while the browser is behind:
/// what it gets next is then drawn as late as possible, and is new.
class PlayerView : public std::enable_shared_from_this<PlayerView> {
 public:
  PlayerView(Stage& stage, std::shared_ptr<Connection> connection,
             std::shared_ptr<PlayerSession> session)
      : stage_(stage), connection_(std::move(connection)), session_(std::move(session)) {}

  /// A picture is due (60 times a second).
  void due(std::int64_t now_us);
  /// Something has become free: a picture that was due and could not be drawn is drawn now.
  void retry(std::int64_t now_us);
  /// No more pictures.
  void end() { ended_ = true; }

 private:
  bool is_free() const;
  void draw(std::int64_t now_us);
  void drawn(const Result<Picture>& picture, PictureHeader header);
  render::Camera camera(const Moment& moment, std::int64_t now_us);

  Stage& stage_;
  std::shared_ptr<Connection> connection_;
  std::shared_ptr<PlayerSession> session_;
  std::uint32_t next_number_ = 1;
  bool drawing_ = false;
  bool overdue_ = false;
  bool ended_ = false;
  std::optional<WorldPosition> last_eye_;
  std::int64_t last_eye_us_ = 0;
};

}  // namespace aureole
