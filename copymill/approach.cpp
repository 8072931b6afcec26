#include "copymill/approach.h"

#include <algorithm>
#include <cmath>

namespace camber::copymill {
namespace {

constexpr double kStep_mm = 0.2;  ///< distance of the places at which a way is checked
constexpr int kDirections = 24;   ///< directions in which an entry from the side is tried

}  // namespace

Runner::Ended Approach::follow(const Pass& pass) {
  Pass whole = pass;
  if (runner_.at()) start_near(whole, *runner_.at());
  std::vector<Pass> pieces = in_material(whole);
  // The nearest end of an open row first is for those who order passes; pieces keep the pass's direction.
  for (Pass& piece : pieces)
    if (cut_piece(std::move(piece)) != Runner::Ended::done) return runner_.ended();
  return Runner::Ended::done;
}

Runner::Ended Approach::cut(const std::vector<Vec3>& points, bool closed, double feed_share) {
  std::vector<Vec3> way{*runner_.at()};
  if (runner_.cut(points, closed, feed_share) != Runner::Ended::done || !options_.remembers) return runner_.ended();
  way.insert(way.end(), points.begin(), points.end());
  if (closed && !points.empty()) way.push_back(points.front());
  ways_.push_back(std::move(way));
  return Runner::Ended::done;
}

std::vector<Pass> Approach::in_material(const Pass& pass) const {
  return stretches_in_material(standing_, cut_.shape, pass, options_.more_than_mm, lead_mm(), join_mm());
}

Runner::Ended Approach::finish(const Pass& pass) {
  constexpr double kAlong_mm = 0.005;  // rows beside a wall are this near to the pass along it
  const double step = std::min(standing_.cell_mm(), 0.25 * cut_.shape.radius_mm);
  const auto left_out = [&](const Vec3& p) {
    return std::ranges::all_of(ways_, [&](const std::vector<Vec3>& way) { return distance_mm(way, p) > kAlong_mm; });
  };
  for (Pass& piece : stretches(pass, step, left_out, lead_mm(), join_mm()))
    if (cut_piece(std::move(piece)) != Runner::Ended::done) return runner_.ended();
  return Runner::Ended::done;
}

Runner::Ended Approach::cut_piece(Pass piece) {
  if (runner_.at()) start_near(piece, *runner_.at());
  ++runner_.summary().passes;
  if (runner_.at() && stays_down(piece.points.front())) {
    if (cut({piece.points.front()}, false) != Runner::Ended::done) return runner_.ended();
  } else if (enter(piece) != Runner::Ended::done) {
    return runner_.ended();
  }
  return cut(piece.points, piece.closed);
}

bool Approach::stays_down(const Vec3& to) const {
  const Vec3& from = *runner_.at();
  const double way = (to - from).norm();
  if (way <= 0) return true;
  const bool same_height = std::abs(to.z() - from.z()) < 1e-3;
  if (!free_way(from, to)) return false;
  if (way <= options_.link_mm && same_height) return true;
  return way <= 20 * cut_.shape.radius_mm && in_air(from, to);
}

bool Approach::free_way(const Vec3& from, const Vec3& to) const {
  const int n = std::max(1, static_cast<int>(std::ceil((to - from).norm() / kStep_mm)));
  for (int k = 0; k <= n; ++k) {
    const Vec3 p = from + static_cast<double>(k) / n * (to - from);
    constexpr double kRounding_mm = 0.001;  // ends are rounded places of exact passes
    if (!field_.free(p.head<2>(), p.z() + (k == 0 || k == n ? kRounding_mm : 0))) {
      if ((k > 0 && k < n) || field_.lowest_mm(p.head<2>()) > p.z() + 1) return false;
    }
  }
  return true;
}

bool Approach::in_air(const Vec3& from, const Vec3& to) const {
  const int n = std::max(1, static_cast<int>(std::ceil((to - from).norm() / kStep_mm)));
  for (int k = 0; k <= n; ++k)
    if (standing_.meets(cut_.shape, from + static_cast<double>(k) / n * (to - from), options_.more_than_mm))
      return false;
  return true;
}

/// The least height above a place at which the tool meets nothing.
double Approach::lift_into_air(const Vec3& tip) const {
  const double step = 0.25,
               most = std::max(0.0, standing_.highest_under_mm(tip.head<2>(), cut_.shape.radius_mm) - tip.z());
  for (double lift = 0; lift < most; lift += step)
    if (!standing_.meets(cut_.shape, tip + Vec3(0, 0, lift), options_.more_than_mm)) return lift;
  return most;
}

Runner::Ended Approach::lift_over(const Vec3& to) {
  if (!runner_.at()) return runner_.rapid({to.x(), to.y(), runner_.safe_z_mm()});
  const Vec3 from = *runner_.at();
  const Vec2 reach = Vec2::Constant(cut_.tool.diameter_mm / 2 + options_.clearance_mm);
  const Vec2 lo = from.head<2>().cwiseMin(to.head<2>()) - reach, hi = from.head<2>().cwiseMax(to.head<2>()) + reach;
  const double highest = std::max(standing_.highest_mm(lo, hi), runner_.clear_height().over_mm(lo, hi));
  const double z = std::min(runner_.safe_z_mm(), std::max({highest + options_.clearance_mm, from.z(), to.z()}));
  ++runner_.summary().retracts;
  if (runner_.rapid({from.x(), from.y(), z}) != Runner::Ended::done) return runner_.ended();
  return runner_.rapid({to.x(), to.y(), z});
}

Runner::Ended Approach::lower_to(const Vec3& to) {
  const double above = std::max(to.z(), to.z() + lift_into_air(to)) + options_.clearance_mm;
  if (rapid_down({to.x(), to.y(), above}) != Runner::Ended::done) return runner_.ended();
  return cut({to}, false);
}

/// Straight down to a place, or to the clearance above what can stand there.
Runner::Ended Approach::rapid_down(const Vec3& to) {
  const double clear = runner_.clear_height().lowest_clear_tip_mm(cut_.shape, to.head<2>());
  const double z = clear <= to.z() ? to.z() : clear + options_.clearance_mm;
  return z < runner_.at()->z() ? runner_.rapid({to.x(), to.y(), z}) : Runner::Ended::done;
}

bool Approach::nothing_can_stand(const Vec3& tip) const {
  return runner_.clear_height().lowest_clear_tip_mm(cut_.shape, tip.head<2>()) <= tip.z() + options_.clearance_mm;
}

removal::CutterShape Approach::wide() const {
  removal::CutterShape out = cut_.shape;
  constexpr double kCells = 2;
  out.radius_mm += kCells * standing_.cell_mm();
  return out;
}

/// Returns a place at which this cutter is in air and from which the straight way to `to` is free of the part; with
/// `surely`, one at which the tool can come down in rapid.
std::optional<Vec3> Approach::side_entry(const Vec3& to, const removal::CutterShape& shape, bool surely) const {
  for (const double reach : {0.5, 1.0, 1.5, 2.2}) {
    for (int k = 0; k < kDirections; ++k) {
      const double a = 2 * kPi * k / kDirections, far = reach * (cut_.shape.radius_mm + options_.clearance_mm);
      const Vec3 from = to + far * Vec3(std::cos(a), std::sin(a), 0);
      if (!standing_.meets(shape, from, options_.more_than_mm) && (!surely || nothing_can_stand(from)) &&
          free_way(from, to))
        return from;
    }
  }
  return std::nullopt;
}

Runner::Ended Approach::enter(Pass& piece) {
  const Vec3 start = piece.points.front();
  const double lift = lift_into_air(start);
  const bool in_air = lift <= 0,
             clear = in_air && !standing_.meets(wide(), start, options_.more_than_mm) && nothing_can_stand(start);
  std::optional<Vec3> side = clear ? std::nullopt : side_entry(start, wide(), true);
  if (in_air && !side) {
    if (lift_over(start) != Runner::Ended::done) return runner_.ended();
    return lower_to(start);
  }
  if (!side) side = side_entry(start, cut_.shape, false);
  if (side) {
    if (lift_over(*side) != Runner::Ended::done || lower_to(*side) != Runner::Ended::done) return runner_.ended();
    return cut({start}, false);
  }
  if (lift_over(start) != Runner::Ended::done) return runner_.ended();
  if (cut_.operation.plunge) {
    ++runner_.summary().plunges;
    if (rapid_down(start + Vec3(0, 0, lift + options_.clearance_mm)) != Runner::Ended::done) return runner_.ended();
    constexpr double kPlungeShare = 1.0 / 3;
    return cut({start}, false, kPlungeShare);
  }
  return ramp(piece, lift + 0.1);
}

Runner::Ended Approach::enter_ring(Pass& ring) {
  const Vec3 start = ring.points.front();
  double lift = 0;
  for (const Vec3& p : ring.points) lift = std::max(lift, lift_into_air(p));
  if (lift <= 0 && runner_.at() && (start - *runner_.at()).norm() <= 20 * cut_.shape.radius_mm &&
      free_way(*runner_.at(), start) && in_air(*runner_.at(), start))
    return cut({start}, false);
  if (lift_over(start) != Runner::Ended::done) return runner_.ended();
  return lift <= 0 ? lower_to(start) : ramp(ring, lift + 0.1);
}

/// Down along the piece; a closed one begins where the ramp ended then.
Runner::Ended Approach::ramp(Pass& piece, double lift) {
  ++runner_.summary().ramps;
  const double slope = std::tan(cut_.operation.ramp_rad), longest = std::max(6 * cut_.shape.radius_mm, 5.0);
  std::vector<Vec3> way = dense(piece, 0.5);
  if (piece.closed) way.push_back(way.front());
  if (!piece.closed) {
    double gone = 0;
    std::size_t n = 1;
    while (n < way.size() && gone < longest) gone += (way[n] - way[n - 1]).norm(), ++n;
    way.resize(n);
  }
  std::vector<Vec3> points{way.front() + Vec3(0, 0, lift)};
  std::size_t at = 0;
  bool back = false;
  while (lift > 0) {
    if (piece.closed && at + 1 == way.size()) at = 0;
    if (!piece.closed && (back ? at == 0 : at + 1 == way.size())) back = !back;
    const std::size_t next = back ? at - 1 : at + 1;
    const double run = std::max(1e-3, (way[next] - way[at]).norm()), fall = slope * run;
    const double share = std::min(1.0, lift / fall);
    lift -= share * fall;
    if (lift < 1e-9) lift = 0;
    points.push_back(way[at] + share * (way[next] - way[at]) + Vec3(0, 0, lift));
    at = next;
  }
  if (rapid_down(points.front()) != Runner::Ended::done) return runner_.ended();
  if (cut(points, false) != Runner::Ended::done) return runner_.ended();
  if (piece.closed) {
    const Vec3 end = points.back();
    start_near(piece, end);
    return Runner::Ended::done;
  }
  // Back along the piece, level, to where it begins.
  std::vector<Vec3> home;
  for (std::size_t k = back ? at + 1 : at; k-- > 0;) home.push_back(way[k]);
  return cut(home, false);
}

}  // namespace camber::copymill
