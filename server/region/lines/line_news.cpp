// A crowd is optional, and checked.
#include "server/region/lines/line_news.h"

namespace aureole {

Result<LineNews> read_line_news(const wire::RegionStatus& status) {
  LineNews news{.level = {status.line_level(), status.next_line_level()},
                .level_below = status.line_level_below()};
  if (const auto* bytes = status.crowd_below()) {
    auto crowd = Crowd::decoded({bytes->data(), bytes->size()});
    if (!crowd) return crowd.error();
    news.crowd_below = *crowd;
  }
  news.gain = status.line_gain();
  news.awake = status.awake();
  return news;
}

}  // namespace aureole
