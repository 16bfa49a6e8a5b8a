// How far apart two bodies' shapes are, and whether they met between two ticks, without any world:
// for those who check what servers did with bodies that no single one of them has.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "server/base/ids.h"
#include "server/physics/body.h"

namespace aureole {

/// Measures the shapes that Bullet lets collide: two boxes with sharp edges, everything else with
/// edges as round as Bullet's collision detection has them (0.04 m and less; faces are exact). The
/// answers depend on nothing but the arguments. Use it from one thread at a time.
class ShapeProbe {
 public:
  /// Further apart than this, separation() says infinity (m).
  static constexpr float reach_m = 0.1f;

  /// `prototypes` must outlive the probe; ids are indices into them.
  explicit ShapeProbe(std::span<const BodyDefinition> prototypes);
  ~ShapeProbe();
  ShapeProbe(ShapeProbe&&) noexcept;
  ShapeProbe& operator=(ShapeProbe&&) noexcept;

  /// Signed distance of two shapes (unit: m), to about a millimetre: negative is the depth of the
  /// deepest overlap, of a compound's children the deepest of any two. The poses must be sane.
  float separation(PrototypeId a, const BodyState& pose_a, PrototypeId b,
                   const BodyState& pose_b) const;

  /// A body that goes straight from one pose to the next, with the orientation that it starts with.
  struct Sweep {
    PrototypeId prototype;
    BodyState from;
    BodyState to;
  };
  /// The fraction of the way (0 … 1) at which the two first overlap by more than `slop_m` (≥ 0);
  /// none if they never do. An overlap that lasts for less than a millimetre of their way past each
  /// other, or less than 1/256 of it, may be missed.
  std::optional<float> swept_contact(const Sweep& a, const Sweep& b, float slop_m) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aureole
