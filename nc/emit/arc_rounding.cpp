#include "nc/emit/arc_rounding.h"

#include <cmath>

#include "nc/emit/number_style.h"

namespace camber::nc {
namespace {

double round_mm(double value_mm, double unit_mm, int decimals) {
  return rounded(value_mm / unit_mm, decimals) * unit_mm;
}

ArcWords words_of(const WantedArc& arc) {
  ArcWords words;
  words.start_mm = arc.start_mm;
  words.end_mm = arc.end_mm;
  words.plane = arc.plane;
  words.clockwise = arc.sweep_rad < 0;
  words.absolute_centre = arc.absolute_centre;
  words.turns = arc.turns;
  return words;
}

void set_centre(ArcWords& words, int axis, double value) {
  (axis == 0 ? words.i_mm : axis == 1 ? words.j_mm : words.k_mm) = value;
}

bool keeps_sweep(const ArcResult& result, const WantedArc& arc) {
  return result.error.empty() && std::abs(result.arc.sweep_rad - arc.sweep_rad) < kPi;
}

/// Nearest point to the wished centre from which start and end are equally far.
Vec3 agreeing_centre(const WantedArc& arc, const PlaneAxes& axes) {
  if (arc.full_turn) return arc.center_mm;
  Vec3 across = arc.end_mm - arc.start_mm;
  across[axes.normal] = 0;
  across.normalize();
  const Vec3 middle = 0.5 * (arc.start_mm + arc.end_mm);
  return arc.center_mm - (arc.center_mm - middle).dot(across) * across;
}

std::optional<RoundedArc> round_centre(const WantedArc& arc, const PlaneAxes& axes, double unit_mm, int decimals) {
  const double step = unit_mm * std::pow(10.0, -decimals);
  const Vec3 centre = agreeing_centre(arc, axes);
  const Vec3 origin = arc.absolute_centre ? Vec3(Vec3::Zero()) : arc.start_mm;
  std::optional<RoundedArc> best;
  double best_cost = 0;
  for (const double di : {0.0, -step, step})
    for (const double dj : {0.0, -step, step}) {
      RoundedArc candidate;
      candidate.first_mm = round_mm(centre[axes.first] - origin[axes.first] + di, unit_mm, decimals);
      candidate.second_mm = round_mm(centre[axes.second] - origin[axes.second] + dj, unit_mm, decimals);
      ArcWords words = words_of(arc);
      set_centre(words, axes.first, candidate.first_mm);
      set_centre(words, axes.second, candidate.second_mm);
      const ArcResult result = make_arc(words);
      if (!keeps_sweep(result, arc) || result.radius_difference_mm > step) continue;
      const double away = std::hypot(result.arc.center_mm[axes.first] - centre[axes.first],
                                     result.arc.center_mm[axes.second] - centre[axes.second]);
      const double cost = away + 2 * result.radius_difference_mm;
      if (best && cost >= best_cost) continue;
      best = candidate;
      best_cost = cost;
    }
  return best;
}

std::optional<RoundedArc> round_radius(const WantedArc& arc, const PlaneAxes& axes, double unit_mm, int decimals) {
  const Vec3 centre = agreeing_centre(arc, axes);
  const auto in_plane = [&](const Vec3& v) { return std::hypot(v[axes.first], v[axes.second]); };
  const double radius = in_plane(arc.start_mm - centre), chord = in_plane(arc.end_mm - arc.start_mm);
  double r = round_mm(radius, unit_mm, decimals);
  if (2 * r < chord) r += unit_mm * std::pow(10.0, -decimals);
  for (const double sign : {1.0, -1.0}) {
    ArcWords words = words_of(arc);
    words.r_mm = round_mm(sign * r, unit_mm, decimals);
    const ArcResult result = make_arc(words);
    // Near half a turn both signs are close; the one on the right side of half a turn is wanted.
    const bool large = std::abs(std::remainder(arc.sweep_rad, 4 * kPi)) > kPi;
    if (keeps_sweep(result, arc) && (sign < 0) == large) return RoundedArc{0, 0, *words.r_mm};
  }
  return std::nullopt;
}

}  // namespace

std::optional<RoundedArc> round_arc(const WantedArc& arc, double unit_mm, int decimals) {
  const PlaneAxes axes = axes_of(arc.plane);
  const double chord = std::hypot(arc.end_mm[axes.first] - arc.start_mm[axes.first],
                                  arc.end_mm[axes.second] - arc.start_mm[axes.second]);
  if (!arc.full_turn && chord < 1e-6) return std::nullopt;
  return arc.by_radius ? round_radius(arc, axes, unit_mm, decimals) : round_centre(arc, axes, unit_mm, decimals);
}

}  // namespace camber::nc
