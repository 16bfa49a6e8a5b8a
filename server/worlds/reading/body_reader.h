// What bodies are made of, read from JSON: shapes, masses, materials, colours, poses.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/worlds/reading/json_reader.h"
#include "server/worlds/world.h"

namespace aureole {

/// Ranges shared by the reader and the schema.
inline constexpr NumberRange coordinate_m{-100'000, 100'000, "m"};
/// Of the world's bounds: as far as positions can be told to other servers (protocol/quantise.h).
inline constexpr NumberRange bounds_m{-8192, 8192, "m"};
inline constexpr NumberRange length_m{0.01, 1000, "m"};
inline constexpr NumberRange mass_kg{0, 1e6, "kg", true};
inline constexpr NumberRange speed_mps{-1000, 1000, "m/s"};
inline constexpr NumberRange angle_deg{-360, 360, "degrees"};
inline constexpr std::size_t name_bytes_max = 64;
inline constexpr std::size_t hull_points_max = 64;
inline constexpr std::size_t compound_children_max = 16;

Eigen::Vector3d read_vector(const JsonNode& node, const NumberRange& range);
/// {"yaw_deg", "pitch_deg", "roll_deg"}: yaw about y, then pitch about x, then roll about z, each
/// about the axes that the ones before have turned; or {"quaternion": [x, y, z, w]}.
Eigen::Quaternionf read_orientation(const JsonNode& node);
Colour read_colour(const JsonNode& node);

/// A shape about its centre of mass, and where that lies in the frame the file gave it in.
struct CentredShape {
  Shape shape{SphereShape{0.5f}};
  Eigen::Vector3f centre{0, 0, 0};
};
CentredShape read_shape(const JsonNode& node, bool plane_allowed = false);

/// A body definition of a file: not yet a prototype, because the colour is chosen where it is used.
struct BodyMaterial {
  std::string name;
  BodyDefinition body;
  Eigen::Vector3f centre{0, 0, 0};
  std::vector<Colour> colours;  ///< Of the definition; empty if it names none.
};

/// The definitions and palettes that a file names, to be referred to by its bodies.
class NamedParts {
 public:
  /// Reads "palettes" and "definitions" of the file's root, if there.
  explicit NamedParts(const JsonNode& root);

  /// The name of a definition, or a definition in place.
  BodyMaterial read_body(const JsonNode& node) const;
  /// "#rrggbb", the name of a palette, or an array of "#rrggbb".
  std::vector<Colour> read_colours(const JsonNode& node) const;

 private:
  BodyMaterial read_definition(const JsonNode& node) const;

  std::map<std::string, std::vector<Colour>> palettes_;
  std::map<std::string, BodyMaterial> definitions_;
};

/// Gives each different body one place in the world's table: equal ones are merged.
class PrototypeTable {
 public:
  /// The index of this body in this colour; a mistake at `node` when the table is full.
  PrototypeId add(const BodyMaterial& material, Colour colour, const JsonNode& node);
  std::vector<Prototype> take() { return std::move(prototypes_); }

  static constexpr std::size_t size_max = 4096;

 private:
  std::map<std::string, PrototypeId> known_;  ///< By their bytes.
  std::vector<Prototype> prototypes_;
};

/// Every number of a shape or a body as bytes, for comparing and for the world hash; -0 is 0.
std::string canonical_bytes(const Shape& shape);
std::string canonical_bytes(const BodyDefinition& body);

}  // namespace aureole
