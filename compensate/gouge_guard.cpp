#include "compensate/gouge_guard.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace camber::compensate {
namespace {

using Cell = std::array<long, 3>;

Cell cell_of(const Vec3& p, double size) {
  return {std::lround(std::floor(p.x() / size)), std::lround(std::floor(p.y() / size)),
          std::lround(std::floor(p.z() / size))};
}

/// Lifts up and down each axis apart, so that the larger of two of one sense stays.
struct Lift {
  Vec3 positive = Vec3::Zero(), negative = Vec3::Zero();
  void raise(const Vec3& to) {
    positive = positive.cwiseMax(to);
    negative = negative.cwiseMin(to);
  }
  void raise(const Lift& from, double fraction) {
    positive = positive.cwiseMax(fraction * from.positive);
    negative = negative.cwiseMin(fraction * from.negative);
  }
  Vec3 sum() const { return positive + negative; }
};

double fade(double distance, double reach) {
  if (distance >= reach) return 0;
  const double c = std::cos(kPi / 2 * distance / reach);
  return c * c;
}

}  // namespace

Guard::Guard(const ShiftPath& path, double limit_mm, double reach_mm) : limit_mm_(limit_mm), reach_mm_(reach_mm) {
  for (const ControlPoint& p : path.points()) place_mm_.push_back(p.place_mm);
  clear();
}

void Guard::clear() { lift_mm_.assign(place_mm_.size(), Vec3::Zero()); }

void Guard::learn(const Observed& observed, double depth_p999_mm) {
  std::map<std::size_t, Lift> asked;  // by the path's points
  for (std::size_t i = 0; i < observed.points.size(); ++i) {
    const Observation& o = observed.points[i];
    if (!observed.compensated[i] || !observed.judged(i) || o.error_mm >= -limit_mm_) continue;
    const double needed = std::min(-o.error_mm, std::max(depth_p999_mm, limit_mm_)) - kWanted * limit_mm_;
    const std::size_t nearest = o.place.upper_fraction < 0.5 ? o.place.lower : o.place.lower + 1;
    asked[nearest].raise(needed * o.normal);
  }
  std::map<Cell, std::vector<std::size_t>> cells;
  for (std::size_t k = 0; k < place_mm_.size(); ++k) cells[cell_of(place_mm_[k], reach_mm_)].push_back(k);
  std::map<std::size_t, Lift> spread;
  for (const auto& [at, lift] : asked) {
    const Cell c = cell_of(place_mm_[at], reach_mm_);
    for (long i = c[0] - 1; i <= c[0] + 1; ++i)
      for (long j = c[1] - 1; j <= c[1] + 1; ++j)
        for (long k = c[2] - 1; k <= c[2] + 1; ++k) {
          const auto near = cells.find({i, j, k});
          if (near == cells.end()) continue;
          for (const std::size_t n : near->second)
            if (const double fraction = fade((place_mm_[n] - place_mm_[at]).norm(), reach_mm_); fraction > 0)
              spread[n].raise(lift, fraction);
        }
  }
  for (const auto& [at, lift] : spread) lift_mm_[at] += lift.sum();
}

double Guard::lift_mm(const Observation& o) const {
  const Vec3 lift =
      (1 - o.place.upper_fraction) * lift_mm_[o.place.lower] + o.place.upper_fraction * lift_mm_[o.place.lower + 1];
  return std::max(0.0, o.normal.dot(lift));
}

void Guard::apply_to(std::vector<Observation>& observations) const {
  for (Observation& o : observations) o.error_mm = -lift_mm(o);
}

std::size_t fit_lifts(ShiftPath& path, std::span<const Observation> lifts, const FitShiftOptions& options) {
  const std::vector<Vec3> before = path.shifts();
  path.set_shifts(std::vector<Vec3>(before.size(), Vec3::Zero()));
  FitShiftOptions unbound = options;
  unbound.max_shift_mm = std::numeric_limits<double>::infinity();
  unbound.bounded = false;
  fit_shift(path, lifts, unbound);
  for (std::size_t p = 0; p < before.size(); ++p) path.points()[p].shift_mm += before[p];
  return path.cut_to(options.max_shift_mm);
}

}  // namespace camber::compensate
