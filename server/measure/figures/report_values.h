// Numbers out of a run's report, for those who draw and judge them: what is missing is missing.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string_view>
#include <vector>

namespace aureole {

struct Sample {
  double t_s = 0;  ///< End of its bucket.
  double value = 0;
};

/// The member of that name, if it is a finite number.
std::optional<double> number_in(const nlohmann::json& object, std::string_view key);

/// The report's own buckets, or those of the run beside it that `reference` names; an empty array
/// if it has none.
const nlohmann::json& buckets_of(const nlohmann::json& report, std::string_view reference = {});

/// Buckets without that number are left out.
std::vector<Sample> by_bucket(const nlohmann::json& buckets, std::string_view key);

/// By server: how many bodies it hosts at the end of each bucket.
std::vector<std::vector<Sample>> bodies_by_server(const nlohmann::json& buckets);

/// By the names on the way to it, such as "last_10_s/efficiency".
std::optional<double> number_at(const nlohmann::json& report, std::string_view path);

/// Over all buckets; nothing if one of them does not have it.
std::optional<double> sum_of(const nlohmann::json& report, std::string_view key);

/// The busiest server's mean frame (ms) by its parts, in the last two buckets.
struct FrameParts {
  static constexpr std::array<std::string_view, 4> names = {"physics", "aura", "decide", "wire"};
  std::array<double, 4> ms{};
  double total() const { return ms[0] + ms[1] + ms[2] + ms[3]; }
};
std::optional<FrameParts> last_parts(const nlohmann::json& report);

/// Over the last two buckets: each server's mean frame (ms), sorted.
std::vector<double> last_server_ms(const nlohmann::json& report);
/// The middle one of them.
std::optional<double> median_server_ms(const nlohmann::json& report);

/// The same over the two buckets before those.
std::optional<double> median_server_ms_before(const nlohmann::json& report);

/// What one server sends in a second (bytes), over the whole run.
std::optional<double> bytes_per_server_and_s(const nlohmann::json& report);

}  // namespace aureole
