// Drawing for one player, held back by everything that says the browser has enough.
#include "server/gateway/players/player_view.h"

#include <spdlog/spdlog.h>

#include "server/net/world_clock.h"

namespace aureole {
namespace {

/// An avatar may be missing for a moment while its region restarts; then the view stands still.
constexpr std::int64_t missing_avatar_us = 3'000'000;

}  // namespace

bool PlayerView::is_free() const {
  return !drawing_ && !connection_->picture_waiting() && session_->pacing().has_room();
}

void PlayerView::due(std::int64_t now_us) {
  overdue_ = true;
  // Drawing that takes long is the gateway's fault, not the browser's.
  if (!drawing_ && !is_free()) session_->pacing().held_back();
  retry(now_us);
}

void PlayerView::retry(std::int64_t now_us) {
  if (overdue_ && !ended_ && is_free()) draw(now_us);
}

render::Camera PlayerView::camera(const Moment& moment, std::int64_t now_us) {
  render::Camera camera;
  if (const ReplicaPose* avatar = moment.find(BodyId::avatar(session_->player()))) {
    camera = stage_.builder.avatar_camera(*avatar, session_->look());
    last_eye_ = stage_.builder.eye(avatar->position);
    last_eye_us_ = now_us;
    return camera;
  }
  if (!last_eye_ || now_us - last_eye_us_ > missing_avatar_us)
    return stage_.builder.overview_camera();
  camera.eye = last_eye_->relative_to({});
  camera.yaw_rad = session_->look().yaw;
  camera.pitch_rad = session_->look().pitch;
  return camera;
}

void PlayerView::draw(std::int64_t now_us) {
  const SharedMoment moment = stage_.moments.at(now_us);
  if (!moment) return;
  const ViewMessage& wish = session_->view();
  PictureRequest request;
  request.scene = stage_.moments.scene(*moment, wish.region_colours);
  request.view.camera = camera(*moment, now_us);
  request.view.width = session_->picture_width();
  request.view.height = session_->picture_height();
  request.view.show_boundaries = wish.boundaries;
  const BodyId avatar = BodyId::avatar(session_->player());
  request.view.hidden_key = moment->find(avatar) ? avatar.value : 0;
  request.quality = session_->pacing().quality();

  PictureHeader header;
  header.world_us = static_cast<std::uint64_t>(std::max<std::int64_t>(moment->world_us, 0));
  header.input_seq = session_->commands().contained_input(moment->world_us);
  header.width = static_cast<std::uint16_t>(request.view.width);
  header.height = static_cast<std::uint16_t>(request.view.height);
  const bool queued = stage_.pool.submit(
      std::move(request), [view = weak_from_this(), header](const Result<Picture>& picture) {
        if (const auto self = view.lock()) self->drawn(picture, header);
      });
  if (!queued) return;
  drawing_ = true;
  overdue_ = false;
}

void PlayerView::drawn(const Result<Picture>& picture, PictureHeader header) {
  drawing_ = false;
  if (ended_) return;
  if (!picture) {
    spdlog::error("a picture could not be made: {}", picture.error().message);
    return;
  }
  stage_.totals.pictures += 1;
  stage_.totals.bytes += picture->bytes->size();
  stage_.totals.render_us += picture->render_us;
  stage_.totals.encode_us += picture->encode_us;
  header.number = next_number_++;
  header.made_in_us = picture->render_us + picture->encode_us;
  connection_->send_picture({header.number, encode_picture_header(header), picture->bytes});
  retry(monotonic_us());
}

}  // namespace aureole
