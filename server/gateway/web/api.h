// What tools and operators ask over HTTP: health, status, replicas, single pictures.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/gateway/pictures/moments.h"
#include "server/gateway/pictures/render_pool.h"
#include "server/gateway/players/player_hub.h"
#include "server/gateway/region_subscriber.h"
#include "server/worlds/world.h"

namespace aureole {

/// Pictures of the last full second, all players together.
struct PictureRates {
  double per_s = 0, render_ms = 0, encode_ms = 0, bytes = 0;  ///< The last three: mean of one.
};

std::string status_json(const WorldDefinition& world, const RegionSubscriber& regions,
                        const std::vector<PlayerReport>& players, const PictureRates& pictures,
                        std::optional<std::int64_t> world_us);

/// Every body at one moment, ascending by id; ids are decimal texts because they pass 2^53.
std::string replicas_json(const WorldDefinition& world, const Moment& moment);

struct FrameQuery {
  render::View view;
  bool tinted = false;
  PictureFormat format = PictureFormat::jpeg;
  int quality = 90;
};

/// `x=&y=&z=` (m, within ±8192), `yaw=&pitch=` (rad), `w=&h=` (16 … 1920 × 16 … 1080), `tint=0|1`,
/// `boundaries=0|1`, `quality=1…100`, `format=jpg|ppm`. The position must be given; unknown keys
/// and whatever is out of range are Errors.
Result<FrameQuery> parse_frame_query(std::string_view query);

}  // namespace aureole
