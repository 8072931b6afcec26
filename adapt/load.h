#pragma once
// The loads that a feed is chosen by, and how each of them changes with the feed.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "machine/adapt_settings.h"

namespace camber::adapt {

/// Loads of one tooth passing. chip_min is the thickest chip as well, bounded from below.
enum class Load : std::uint8_t { force, torque, deflection, form_error, chip, power, chip_min };
/// Loads that are recorded; chip_min is `chip`.
inline constexpr std::size_t kLoads = 6;
inline constexpr std::size_t index_of(Load load) {
  return static_cast<std::size_t>(load == Load::chip_min ? Load::chip : load);
}

/// How a load is shown.
struct LoadText {
  std::string_view key;   ///< key of [adapt] limits and of the JSON: "force_N"
  std::string_view name;  ///< "lateral force"
  std::string_view unit;  ///< "N"
  double scale = 1;       ///< shown = scale * inside
  int decimals = 0;
};
const LoadText& text_of(Load load);

struct LoadLimit {
  Load load = Load::force;
  double value = 0;  ///< N, N mm, mm, W
};

/// Those that are given, in the order of Load.
std::vector<LoadLimit> limits_of(const machine::AdaptLimits& limits);

/// Load of one place of the path at the feed v:
///
///   L(v) = |edge + shear (v / v0)^p|
///
/// The chip thickness is proportional to the feed wherever the motion of a tooth passing bounds it, so that an affine
/// force law (K h + K_e) makes every component of the force affine in v, p = 1; k(h) = k_1.1 h^-m makes p = 1 - m. The
/// edge term does not depend on v. The greatest of such components over a tooth passing is convex in v; `edge` and
/// `shear` are its secant between two feeds. A chip that is bounded by the depth of an allowance grows less than that:
/// the load is then overestimated above v0.
struct LoadCurve {
  float edge = 0, shear = 0;

  double at(double ratio, double exponent) const;
  /// The largest v / v0 for which L stays within `limit` on [0, v / v0]; infinite where no feed exceeds it, 0 where the
  /// edge term alone does.
  double max_ratio(double limit, double exponent) const;
};

/// The loads of one tooth passing as functions of the feed.
struct LoadPoint {
  double feed_mm_per_s = 0;  ///< v0: actual feed at which they were observed
  float exponent = 1;        ///< p of all loads but the chip, whose is 1
  std::array<LoadCurve, kLoads> curve{};

  double at(Load load, double feed_mm_per_s) const;
  /// The greatest feed that keeps a limit.
  double max_feed_mm_per_s(const LoadLimit& limit) const;
};

}  // namespace camber::adapt
