// From the text of a world file to a checked and completed world.
#include "server/worlds/world_file.h"

#include "server/base/check.h"
#include "server/worlds/reading/arrangement.h"
#include "server/worlds/reading/world_parts.h"
#include "server/worlds/region_tiling.h"

namespace aureole {
namespace {

/// What --regions splits: "extent" if the file has one, the bounds otherwise.
Rectangle read_extent(const JsonNode& root, const Box3& bounds) {
  if (const auto node = root.find("extent")) {
    for (const char* side : {"min_x", "max_x", "min_z", "max_z"}) (void)node->at(side);
    return read_area(*node);
  }
  return {bounds.min.x(), bounds.min.z(), bounds.max.x(), bounds.max.z()};
}

/// Four aura radii of the largest body: narrower, and auras of non-neighbours may overlap.
struct NeededWidth {
  double radius_m = 0;
  std::string body;
  double metres() const { return 4 * radius_m; }
};
NeededWidth needed_width(const WorldDefinition& world) {
  NeededWidth needed;
  for (const Prototype& p : world.prototypes) {
    const double radius = aura_radius_m(double{bounding_radius(p.body.shape)}, world.tolerances);
    if (radius > needed.radius_m) needed = {radius, p.name};
  }
  return needed;
}

std::string why(const NeededWidth& needed) {
  return fmt::format(
      "expected at least {:.4g} m (4 aura radii of {:.4g} m of the largest body, \"{}\")",
      needed.metres(), needed.radius_m, needed.body);
}

void check_widths(const JsonNode& regions, const WorldDefinition& world) {
  const NeededWidth needed = needed_width(world);
  if (const auto i = too_narrow(world.regions, needed.metres())) {
    const RegionDefinition& r = world.regions[*i];
    JsonNode item = regions.items(1, regions_max)[*i];
    item.refuse(
        fmt::format("region \"{}\" is {:g} m wide, {}", r.name, width_m(r.area), why(needed)));
  }
}

std::optional<std::string> split(WorldDefinition& world, const Rectangle& extent, int count) {
  if (count < 1 || count > regions_max) {
    return fmt::format("found {} regions to split the world into, expected 1 to {}", count,
                       regions_max);
  }
  const NeededWidth needed = needed_width(world);
  if (split_width_m(extent, count) < needed.metres()) {
    return fmt::format("{} regions would be {:.4g} m wide, {}: at most {} regions fit", count,
                       split_width_m(extent, count), why(needed),
                       largest_split(extent, needed.metres()));
  }
  world.regions = split_extent(extent, count);
  // Hosts were named among the regions that are gone.
  for (WorldBody& body : world.bodies) body.host.reset();
  return {};
}

void read_world(const JsonNode& root, WorldDefinition& world, const WorldFileOptions& options) {
  if (!root.object({"$schema", "name", "description", "physics", "tolerances", "bounds", "extent",
                    "max_bodies", "max_thrown_per_player", "mode", "regions", "palettes",
                    "definitions", "statics", "bodies", "injectors", "spawn_points", "throwables",
                    "avatar"})) {
    return;
  }
  WorldReading reading(root, world);
  world.name = root.at("name").text(name_bytes_max);
  if (const auto d = root.find("description")) world.description = d->text(8192);
  if (const auto p = root.find("physics")) read_physics(*p, world.physics);
  if (const auto t = root.find("tolerances")) read_tolerances(*t, world.tolerances);
  if (const auto m = root.find("mode")) world.mode = read_mode(*m);
  if (options.mode) world.mode = *options.mode;
  const JsonNode bounds = root.at("bounds");
  world.bounds = read_box(bounds, bounds_m);
  if (root.ok() && (world.bounds.min.array() >= world.bounds.max.array()).any()) {
    bounds.refuse("found bounds without a volume, expected min below max on each axis");
  }
  if (const auto n = root.find("max_bodies")) {
    world.max_bodies =
        static_cast<std::uint32_t>(n->integer(1, static_cast<std::int64_t>(world_bodies_max)));
  }
  if (const auto n = root.find("max_thrown_per_player")) {
    world.max_thrown_per_player = static_cast<std::uint32_t>(n->integer(0, 10'000));
  }
  const JsonNode regions = root.at("regions");
  read_regions(regions, reading);
  const Rectangle extent = read_extent(root, world.bounds);
  if (!root.ok()) return;
  if (const auto s = root.find("statics")) read_statics(*s, reading);
  if (const auto b = root.find("bodies")) read_bodies(*b, reading);
  if (const auto i = root.find("injectors")) read_injectors(*i, reading);
  if (!root.ok()) return;
  read_spawn_points(root.at("spawn_points"), reading);
  const auto throwables = root.find("throwables");
  read_throwables(throwables ? &*throwables : nullptr, reading, root);
  const auto avatar = root.find("avatar");
  read_avatar(avatar ? &*avatar : nullptr, reading, root);
  if (!root.ok()) return;
  world.prototypes = reading.prototypes.take();
  if (!options.regions) {
    check_widths(regions, world);
  } else if (const auto mistake = split(world, extent, *options.regions)) {
    regions.refuse(*mistake);
  }
}

/// Keys of the file stand in the sentences: they must not speak to the terminal.
Error printable(Error error) {
  for (char& c : error.message)
    if ((c >= 0 && c < 0x20) || c == 0x7f) c = '?';
  return error;
}

}  // namespace

Result<WorldDefinition> parse_world(std::string_view text, std::string_view where,
                                    const WorldFileOptions& options) {
  auto document = JsonDocument::parse(text, where);
  if (!document) return printable(document.error());
  JsonProblems problems(where);
  WorldDefinition world;
  read_world(document->root(problems), world, options);
  if (problems.any()) return printable(problems.error());
  world.hash = world_hash(world);
  return world;
}

RegionId region_at(const std::vector<RegionDefinition>& regions, double x, double z) {
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (regions[i].area.contains(x, z)) return RegionId{static_cast<std::uint16_t>(i)};
  }
  AUREOLE_CHECK(false, "regions tile the plane and positions are finite");
  return RegionId{};
}

}  // namespace aureole
