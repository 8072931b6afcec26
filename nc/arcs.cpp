#include "nc/arcs.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace camber::nc {
namespace {

constexpr double kSamePlaceMm = 1e-6;          ///< rounding of G91 sums and of inches, far below any resolution
constexpr double kChordOverDiameterMm = 0.01;  ///< programs with three decimals make half turns that miss by this

const std::optional<double>& centre_word(const ArcWords& words, int axis) {
  return axis == 0 ? words.i_mm : axis == 1 ? words.j_mm : words.k_mm;
}

/// The centre from I J K; an empty error when there is one.
std::string centre_from_words(const ArcWords& words, const PlaneAxes& axes, Vec3& centre) {
  const auto& a = centre_word(words, axes.first);
  const auto& b = centre_word(words, axes.second);
  const auto& across = centre_word(words, axes.normal);
  const char* const letters = "IJK";
  if (!words.absolute_centre && across && *across != 0)
    return fmt::format("{} does not belong to an arc in this plane; {} and {} were expected", letters[axes.normal],
                       letters[std::min(axes.first, axes.second)], letters[std::max(axes.first, axes.second)]);
  centre = words.start_mm;
  if (words.absolute_centre) {
    if (!a || !b)
      return fmt::format("an arc with an absolute centre (G90.1) needs both {} and {}",
                         letters[std::min(axes.first, axes.second)], letters[std::max(axes.first, axes.second)]);
    centre[axes.first] = *a;
    centre[axes.second] = *b;
  } else {
    centre[axes.first] += a.value_or(0);
    centre[axes.second] += b.value_or(0);
  }
  return {};
}

/// The centre from R: on the perpendicular of the chord, on the left of the way for a G3 of up to half a turn.
std::string centre_from_radius(const ArcWords& words, const PlaneAxes& axes, Vec3& centre) {
  const double dx = words.end_mm[axes.first] - words.start_mm[axes.first];
  const double dy = words.end_mm[axes.second] - words.start_mm[axes.second];
  const double chord = std::hypot(dx, dy), radius = std::abs(*words.r_mm);
  if (radius == 0) return "R0 is no arc; a radius other than zero was expected";
  if (chord < kSamePlaceMm)
    return "an arc with R ends where it starts, which leaves its centre open; an arc by its centre was expected for a "
           "full turn";
  if (chord > 2 * radius + kChordOverDiameterMm)
    return fmt::format(
        "the end of the arc is {:.4f} mm from its start; with R {:.4f} mm at most {:.4f} mm can be reached", chord,
        radius, 2 * radius);
  const double height = std::sqrt(std::max(0.0, radius * radius - 0.25 * chord * chord));
  const bool left = words.clockwise == (*words.r_mm < 0);
  const double side = (left ? 1.0 : -1.0) * height / chord;
  centre = words.start_mm;
  centre[axes.first] = 0.5 * (words.start_mm[axes.first] + words.end_mm[axes.first]) - side * dy;
  centre[axes.second] = 0.5 * (words.start_mm[axes.second] + words.end_mm[axes.second]) + side * dx;
  return {};
}

double sweep_of(const ArcWords& words, const PlaneAxes& axes, const Vec3& centre) {
  const double x0 = words.start_mm[axes.first] - centre[axes.first],
               y0 = words.start_mm[axes.second] - centre[axes.second];
  const double x1 = words.end_mm[axes.first] - centre[axes.first], y1 = words.end_mm[axes.second] - centre[axes.second];
  double sweep = std::atan2(x0 * y1 - y0 * x1, x0 * x1 + y0 * y1);  // counter-clockwise, -pi..pi
  if (words.clockwise) sweep = -sweep;
  const bool closed = std::hypot(x1 - x0, y1 - y0) < kSamePlaceMm || (words.spiral && std::abs(sweep) < 1e-9);
  if (closed)
    sweep = 2 * kPi;
  else if (sweep <= 0)
    sweep += 2 * kPi;
  sweep += 2 * kPi * (words.turns - 1);
  return words.clockwise ? -sweep : sweep;
}

}  // namespace

Vec3 normal_of(Plane plane) { return Vec3::Unit(axes_of(plane).normal); }

PlaneAxes axes_of(Plane plane) {
  switch (plane) {
    case Plane::zx:
      return {2, 0, 1};
    case Plane::yz:
      return {1, 2, 0};
    case Plane::xy:
      break;
  }
  return {0, 1, 2};
}

ArcResult make_arc(const ArcWords& words) {
  ArcResult result;
  const PlaneAxes axes = axes_of(words.plane);
  const bool by_centre = words.i_mm || words.j_mm || words.k_mm;
  Vec3 centre = words.start_mm;
  if (by_centre && words.r_mm)
    result.error = "the arc has both R and a centre (I J K); one of them was expected";
  else if (words.r_mm)
    result.error = centre_from_radius(words, axes, centre);
  else if (by_centre)
    result.error = centre_from_words(words, axes, centre);
  else
    result.error = "the arc has neither a centre nor a radius; I J K or R was expected";
  if (words.turns < 1) result.error = fmt::format("P{} turns; one or more was expected", words.turns);
  if (!result.error.empty()) return result;

  const auto radius_at = [&](const Vec3& p) {
    return std::hypot(p[axes.first] - centre[axes.first], p[axes.second] - centre[axes.second]);
  };
  result.start_radius_mm = radius_at(words.start_mm);
  result.end_radius_mm = radius_at(words.end_mm);
  result.radius_difference_mm = std::abs(result.end_radius_mm - result.start_radius_mm);
  if (result.start_radius_mm < 1e-9 || result.end_radius_mm < 1e-9) {
    result.is_point = std::max(result.start_radius_mm, result.end_radius_mm) <= kPointMm;
    if (!result.is_point)
      result.error = "the centre of the arc lies on its start or its end; an arc with a radius was expected";
    return result;
  }
  result.arc.center_mm = centre;
  result.arc.normal = normal_of(words.plane);
  result.arc.sweep_rad = sweep_of(words, axes, centre);
  result.arc.by_radius = words.r_mm.has_value();
  return result;
}

}  // namespace camber::nc
