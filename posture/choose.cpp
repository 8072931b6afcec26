// Choice of the tool's direction along a path, as a shortest path through (point, direction).
//
// Overview
//
// 1. Directions      a grid of directions that the rotary axes reach, with the turn and the time from each to its
//                    neighbours.
// 2. knots_of        thins the points: every few millimetres, and where contact or rapid begin and end.
// 3. ClearDirections marks for every knot the directions in which tool and holder keep their clearance, for several
//                    overhangs at once.
// 4. Chooser         finds the path of least cost, in mm: posture_cost (the way times the share of the error that the
//                    direction lets through), the turn of the rotary axes times degree_cost_mm, the additional time's
//                    way times kTimeShare, and the way times the error that late axes leave (LagError). Directions
//                    between knots are interpolated and smoothed. Where the tool is not clear on the way between two
//                    knots, the step or the direction is barred and the path is found anew.
// 5. take_cheaper    where axes follow late, compares with the choice that ignores them and with one direction for all.
//
// BySurface takes the direction from the surface alone instead: normal, lead and tilt, or Shirase's seed.
#include "posture/choose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

#include "base/stage.h"
#include "base/units.h"
#include "posture/path_cost.h"
#include "posture/rotary_path.h"

namespace camber::posture {
namespace {

constexpr double kKnot_mm = 3;                ///< between the points at which the path through directions is looked for
constexpr double kFarthest = 55 * kPi / 180;  ///< largest angle of tool and normal that is tried
constexpr double kFarthestLate = 75 * kPi / 180;  ///< the same where the axes follow late, since turns cost more
constexpr double kRapidMmPerS = 200;
constexpr double kSpeedCost = 0.5;  ///< cost of a tip that cuts, per mm of path
constexpr int kRounds = 12, kSmoothings = 15, kSwingRounds = 6;
constexpr float kNever = std::numeric_limits<float>::infinity();

bool clear(const Surroundings& surroundings, const ToolShape& tool, const PathPoint& p, const Vec3& axis) {
  return surroundings.room_mm(tool, p.tip_mm(axis), axis, 0) >= 0;
}

/// Half way between two points the tool goes straight, and the axis about evenly.
bool clear_between(const Surroundings& surroundings, const ToolShape& tool, const PathPoint& p, const Vec3& a,
                   const PathPoint& q, const Vec3& b) {
  const Vec3 axis = (a + b).normalized();
  return surroundings.room_mm(tool, (p.tip_mm(a) + q.tip_mm(b)) / 2, axis, 0) >= 0;
}

/// Returns whether the tool is clear on the way between two points, with the rotary axes turning evenly.
bool clear_on_the_way(const Surroundings& surroundings, const ToolShape& tool, const kinematics::Chain& chain,
                      const Vec3& from_mm, const Vec3& to_mm, const Vec3& from_rad, const Vec3& to_rad) {
  return each_between(chain, from_rad, to_rad, [&](double share, const Vec3& axis) {
    return surroundings.room_mm(tool, from_mm + share * (to_mm - from_mm), axis, 0) >= 0;
  });
}

/// The points at which the direction is chosen: a few millimetres apart, and where contact begins and ends.
struct Knots {
  std::vector<std::size_t> of;    ///< indices among all points
  std::vector<PathPoint> points;  ///< points with way and time from the one before
};

Knots knots_of(std::span<const PathPoint> points) {
  Knots out;
  double way = 0, time = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    way += points[i].way_mm;
    time += points[i].time_s;
    const bool ends = i == 0 || i + 1 == points.size() || points[i + 1].contact != points[i].contact ||
                      points[i + 1].rapid != points[i].rapid;
    if (!ends && way < kKnot_mm) continue;
    out.of.push_back(i);
    out.points.push_back(points[i]);
    out.points.back().way_mm = way;
    out.points.back().time_s = time;
    way = time = 0;
  }
  return out;
}

/// The chosen directions: a shortest path through (point, direction).
class Chooser {
 public:
  /// What is the same for all tools.
  struct Choice {
    std::span<const PathPoint> points;
    const Knots& knots;
    const Directions& directions;
    const ClearDirections& clear;
    const Surroundings& surroundings;
    const machine::Machine& machine;
    const LagError& lag;
    const PostureOptions& options;
  };
  Chooser(const Choice& of, std::size_t tool_index, const ToolShape& tool)
      : all_(of.points),
        surroundings_(of.surroundings),
        tool_(tool),
        machine_(of.machine),
        lag_(of.lag),
        options_(of.options),
        directions_(of.directions),
        clear_(of.clear),
        tool_index_(tool_index),
        knots_(of.knots.of),
        points_(of.knots.points) {}

  Postures run() {
    Postures out, best;
    std::size_t least = std::numeric_limits<std::size_t>::max();
    barred_.assign(points_.size(), {});
    restricted_.assign(points_.size(), 0);
    for (int round = 0; round < kRounds; ++round) {
      const auto path = shortest(out);
      if (out.blocked && restricts_) {
        stop_restricting();
        out.blocked.reset();
        continue;
      }
      if (out.blocked) break;
      out.axes = between_knots(path);
      if (bar_blocked_steps(path, out.axes)) continue;
      smooth(out.axes);
      const std::vector<std::size_t> unclear = unclear_knots(out.axes);
      if (unclear.size() < least) {
        least = unclear.size();
        best = out;
      }
      if (unclear.empty() || ++swings_ > kSwingRounds) return best;
      avoid(path, unclear);
    }
    if (!best.axes.empty()) return best;  // the figures say where it is not clear
    out.blocked = knots_[out.blocked.value_or(first_barred_)];
    out.axes.clear();
    return out;
  }

 private:
  float step_cost(const PathPoint& p, const Directions::Step& step) const {
    const double time = p.time_s > 0 ? p.time_s : p.way_mm / kRapidMmPerS;
    const double speed = p.time_s > 0 ? p.way_mm / p.time_s : kRapidMmPerS;
    return static_cast<float>(options_.degree_cost_mm * step.turn_deg +
                              kTimeShare * speed * std::max(0.0, step.time_s - time));
  }

  /// The machine at a point: for each direction that is clear, its solutions.
  using Places = std::vector<std::array<LagError::Place, 2>>;
  void place(std::size_t i, Places& out) const {
    out.resize(directions_.size());
    for (std::size_t d = 0; d < directions_.size(); ++d)
      if (clear_.clear(i, d, tool_index_))
        for (std::size_t k = 0; k < directions_.angles(d).size(); ++k)
          out[d][k] = lag_.place(points_[i], directions_.axis(d), directions_.angles(d)[k]);
  }
  /// Returns the error that the axes leave on the surface on the way from one direction to another, at the programmed
  /// feed: that turns slow the axes down is no merit.
  float lag_cost(const PathPoint& p, const Directions::Step& step, std::size_t from, const Places& before,
                 const Places& here) const {
    const double error = LagError::error_mm(before[from][step.from_branch], here[step.to][step.to_branch], p.time_s);
    return static_cast<float>(p.way_mm * lag_share(error, tool_));
  }

  std::vector<std::uint16_t> shortest(Postures& out) const {
    const std::size_t n = directions_.size();
    const bool lags = tool_.error_mm > 0 && lag_.any();
    Places before, here;
    std::vector<float> cost(n), next(n);
    std::vector<std::uint16_t> from(points_.size() * n, 0);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      std::fill(next.begin(), next.end(), kNever);
      std::uint16_t* parents = from.data() + i * n;
      before.swap(here);
      if (lags) place(i, here);
      const bool left = lags && i > 0 && points_[i].contact && points_[i].time_s > 0;
      for (std::size_t a = 0; a < n; ++a) {
        if (i == 0) {
          next[a] = 0;
          continue;
        }
        if (cost[a] == kNever) continue;
        for (const Directions::Step& step : directions_.steps(a)) {
          float sum = cost[a] + step_cost(points_[i], step);
          if (sum >= next[step.to] || !open(i, step.to)) continue;
          if (left) sum += lag_cost(points_[i], step, a, before, here);
          if (sum >= next[step.to] || barred(i, a, step.to)) continue;
          next[step.to] = sum;
          parents[step.to] = static_cast<std::uint16_t>(a);
        }
      }
      bool any = false;
      for (std::size_t d = 0; d < n; ++d) {
        if (i == 0 && !open(i, d)) next[d] = kNever;
        if (next[d] == kNever) continue;
        next[d] += static_cast<float>(posture_cost(points_[i], directions_.axis(d), options_));
        any = true;
      }
      if (!any) {
        out.blocked = i;
        return {};
      }
      cost.swap(next);
    }
    std::vector<std::uint16_t> path(points_.size());
    std::size_t d = static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
    for (std::size_t i = points_.size(); i-- > 0;) {
      path[i] = static_cast<std::uint16_t>(d);
      d = from[i * n + d];
    }
    return path;
  }

  bool open(std::size_t i, std::size_t d) const {
    return clear_.clear(i, d, tool_index_) && (restricted_[i] == 0 || directions_.whole(d));
  }

  /// Knots on the way to which the axes, as they turn, take the tool too near, or swing it.
  std::vector<std::size_t> unclear_knots(const std::vector<Vec3>& axes) const {
    std::vector<std::size_t> out;
    const std::vector<Vec3> rotary_rad = rotary_path(machine_, all_, axes);
    for (const std::size_t i : unclear_points(all_, axes, rotary_rad, surroundings_, tool_, machine_)) {
      const auto k = static_cast<std::size_t>(std::ranges::lower_bound(knots_, i) - knots_.begin());
      if (out.empty() || out.back() != k) out.push_back(k);
    }
    return out;
  }

  /// These steps are not taken again; and the cuts about them, between rapids, keep to directions that do not end the
  /// travel of any solution.
  void avoid(const std::vector<std::uint16_t>& path, const std::vector<std::size_t>& unclear) {
    for (const std::size_t k : unclear) {
      if (k == 0) continue;
      barred_[k].emplace_back(path[k - 1], path[k]);
      if (!may_restrict_ || points_[k].rapid) continue;
      std::size_t first = k, end = k;
      while (first > 0 && !points_[first].rapid) --first;
      while (end < points_.size() && !points_[end].rapid) ++end;
      std::fill(restricted_.begin() + static_cast<std::ptrdiff_t>(first),
                restricted_.begin() + static_cast<std::ptrdiff_t>(end), std::uint8_t{1});
      restricts_ = true;
    }
  }

  /// Lifts the restriction, where nothing else is clear.
  void stop_restricting() {
    std::fill(restricted_.begin(), restricted_.end(), std::uint8_t{0});
    restricts_ = may_restrict_ = false;
  }

  bool barred(std::size_t i, std::size_t from, std::size_t to) const {
    const auto& pairs = barred_[i];
    return !pairs.empty() && std::find(pairs.begin(), pairs.end(), std::pair(from, to)) != pairs.end();
  }

  std::vector<Vec3> between_knots(const std::vector<std::uint16_t>& path) const {
    std::vector<Vec3> out(all_.size(), directions_.axis(path[0]));
    for (std::size_t k = 1; k < knots_.size(); ++k) {
      const Vec3 &from = directions_.axis(path[k - 1]), &to = directions_.axis(path[k]);
      double way = 0;
      for (std::size_t i = knots_[k - 1] + 1; i <= knots_[k]; ++i) {
        way += all_[i].way_mm;
        const double u = i == knots_[k] || points_[k].way_mm <= 0 ? 1 : way / points_[k].way_mm;
        out[i] = ((1 - u) * from + u * to).normalized();
      }
    }
    return out;
  }

  bool bar_blocked_steps(const std::vector<std::uint16_t>& path, const std::vector<Vec3>& axes) {
    std::vector<std::uint8_t> bad(path.size(), 0);
    tbb::parallel_for(std::size_t{1}, path.size(), [&](std::size_t k) {
      for (std::size_t i = knots_[k - 1] + 1; i <= knots_[k] && bad[k] == 0; ++i)
        bad[k] = !clear(surroundings_, tool_, all_[i], axes[i]) ||
                 !clear_between(surroundings_, tool_, all_[i - 1], axes[i - 1], all_[i], axes[i]);
    });
    bool any = false;
    for (std::size_t k = 1; k < path.size(); ++k) {
      if (bad[k] == 0) continue;
      barred_[k].emplace_back(path[k - 1], path[k]);
      if (!any) first_barred_ = k;
      any = true;
    }
    return any;
  }

  /// Steps of the grid become even turns, as far as that stays clear.
  void smooth(std::vector<Vec3>& axes) const {
    const auto holds = [&](std::size_t i, const Vec3& axis) {
      const PathPoint& p = all_[i];
      if (p.contact &&
          angle_between(axis, p.normal) < std::min(options_.least_angle_rad, angle_between(axes[i], p.normal)) - 1e-6)
        return false;
      return clear(surroundings_, tool_, p, axis) &&
             clear_between(surroundings_, tool_, all_[i - 1], axes[i - 1], p, axis) &&
             clear_between(surroundings_, tool_, p, axis, all_[i + 1], axes[i + 1]);
    };
    std::vector<int> changed(axes.size(), 0), refused(axes.size(), -1);  // in which pass, last
    for (int pass = 0; pass < kSmoothings; ++pass)
      for (std::size_t i = 1; i + 1 < axes.size(); ++i) {
        // Nothing near has changed since.
        if (refused[i] > std::max({changed[i - 1], changed[i], changed[i + 1]})) continue;
        const Vec3 middle = (axes[i - 1] + 2 * axes[i] + axes[i + 1]).normalized();
        if ((middle - axes[i]).norm() <= 1e-5) continue;
        if (holds(i, middle)) {
          axes[i] = middle;
          changed[i] = pass;
        } else {
          refused[i] = pass;
        }
      }
  }

  std::span<const PathPoint> all_;
  const Surroundings& surroundings_;
  const ToolShape& tool_;
  const machine::Machine& machine_;
  const LagError& lag_;
  const PostureOptions& options_;
  const Directions& directions_;
  const ClearDirections& clear_;
  std::size_t tool_index_;
  const std::vector<std::size_t>& knots_;  ///< indices into all_
  const std::vector<PathPoint>& points_;   ///< the knots
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> barred_;
  std::size_t first_barred_ = 0;
  std::vector<std::uint8_t> restricted_;  ///< knots
  bool may_restrict_ = true, restricts_ = false;
  int swings_ = 0;
};

void take_cheaper(std::span<const PathPoint> points, const ToolShape& tool, const LagError& lag,
                  const machine::Machine& machine, const PostureOptions& options, Postures other, Postures& best) {
  if (other.blocked) return;
  const auto cost = [&](const Postures& p) { return path_cost(points, p.axes, tool, lag, machine, options); };
  if (best.blocked || cost(other) < cost(best)) best = std::move(other);
}

/// Postures from the surface alone.
class BySurface {
 public:
  BySurface(std::span<const PathPoint> points, const Surroundings& surroundings, const ToolShape& tool,
            const machine::Machine& machine, const PostureOptions& options)
      : points_(points), surroundings_(surroundings), tool_(tool), chain_(machine), options_(options) {}

  Postures run() {
    Postures out;
    std::vector<std::optional<Vec3>> wanted;
    for (std::size_t i = 0; i < points_.size(); ++i) wanted.push_back(wanted_at(i));
    out.axes = filled(wanted);
    return out;
  }

 private:
  std::optional<Vec3> wanted_at(std::size_t i) const {
    const PathPoint& p = points_[i];
    if (!p.contact) return std::nullopt;
    Vec3 axis = p.normal;
    if (options_.mode == Mode::lead_tilt) {
      const std::size_t a = i > 0 ? i - 1 : i, b = i > 0 ? i : std::min(i + 1, points_.size() - 1);
      Vec3 forward = points_[b].centre_mm - points_[a].centre_mm;
      forward -= forward.dot(axis) * axis;
      if (forward.norm() > 1e-9) {
        forward.normalize();
        axis += std::tan(options_.lead_rad) * forward + std::tan(options_.tilt_rad) * axis.cross(forward);
        axis.normalize();
      }
    }
    if (options_.mode == Mode::seed) axis = away(p, axis);
    return reached(axis);
  }

  /// The nearest direction towards +Z that the machine reaches.
  Vec3 reached(const Vec3& axis) const {
    const auto holds = [&](const Vec3& a) {
      return angle_between(a, Vec3::UnitZ()) <= options_.max_tilt_rad &&
             chain_.solve_tool_axis(a, {}).reach == kinematics::Reach::reached;
    };
    if (holds(axis)) return axis;
    double good = 1, bad = 0;
    for (int i = 0; i < 30; ++i) {
      const double u = (good + bad) / 2;
      (holds(((1 - u) * axis + u * Vec3::UnitZ()).normalized()) ? good : bad) = u;
    }
    return ((1 - good) * axis + good * Vec3::UnitZ()).normalized();
  }

  /// The seed's rule: from the point that is deepest in the virtual cylinder about shank and holder, in the plane of it
  /// and the axis, by asin(R/L) - asin(e/L); again for what then is deepest.
  Vec3 away(const PathPoint& p, Vec3 axis) const {
    constexpr int kTurns = 40;
    double radius = 0, from = std::numeric_limits<double>::infinity();
    for (const ToolShape::Piece& piece : tool_.pieces)
      if (piece.solid.part() != checks::OutlineRing::Part::cutter) {
        radius = std::max(radius, piece.radius_mm + piece.need_mm);
        from = std::min(from, piece.bottom_mm);
      }
    for (int i = 0; i < kTurns; ++i) {
      Surroundings::Inside inside;
      if (!surroundings_.deepest_point(p.tip_mm(axis), axis, radius, from, inside)) break;
      const Vec3 q = inside.point_mm - p.centre_mm;
      const double length = q.norm();
      const Vec3 about = q.cross(axis);
      if (length <= radius || about.norm() < 1e-9) break;
      const double turn = std::asin(radius / length) - std::asin(std::min(1.0, inside.from_axis_mm / length));
      axis = (Eigen::AngleAxisd(turn + 1e-6, about.normalized()) * axis).normalized();
    }
    return axis;
  }

  /// Between contacts the direction goes over from the last to the next one.
  std::vector<Vec3> filled(const std::vector<std::optional<Vec3>>& wanted) const {
    std::vector<Vec3> out(wanted.size(), Vec3::UnitZ());
    std::optional<std::size_t> last;
    for (std::size_t i = 0; i <= wanted.size(); ++i) {
      if (i < wanted.size() && !wanted[i]) continue;
      const Vec3 to = i < wanted.size() ? *wanted[i] : last ? out[*last] : Vec3::UnitZ();
      const Vec3 from = last ? out[*last] : to;
      double way = 0, whole = 0;
      const std::size_t first = last ? *last + 1 : 0;
      for (std::size_t k = first; k <= std::min(i, wanted.size() - 1); ++k) whole += points_[k].way_mm;
      for (std::size_t k = first; k < i; ++k) {
        way += points_[k].way_mm;
        const double u = whole > 0 ? way / whole : 1;
        out[k] = ((1 - u) * from + u * to).normalized();
      }
      if (i < wanted.size()) out[i] = to;
      last = i;
    }
    return out;
  }

  std::span<const PathPoint> points_;
  const Surroundings& surroundings_;
  const ToolShape& tool_;
  kinematics::Chain chain_;
  const PostureOptions& options_;
};

}  // namespace

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

double error_share(double angle_rad) {
  const double s = std::sin(angle_rad);
  return s * s + kAlong * s * std::abs(std::cos(angle_rad));
}

double lag_share(double error_mm, const ToolShape& tool) {
  const double share = error_mm / tool.error_mm;
  return share * share;
}

double posture_cost(const PathPoint& point, const Vec3& axis, const PostureOptions& options) {
  if (!point.contact) return 0;
  const double angle = angle_between(axis, point.normal), least = std::sin(options.least_angle_rad);
  double cost = error_share(angle);
  if (angle < options.least_angle_rad) {
    const double missing = (least - std::sin(angle)) / least;
    cost += kSpeedCost * missing * missing;
  }
  return cost * point.way_mm;
}

std::vector<std::size_t> unclear_points(std::span<const PathPoint> points, std::span<const Vec3> axes,
                                        std::span<const Vec3> rotary_rad, const Surroundings& surroundings,
                                        const ToolShape& tool, const machine::Machine& machine) {
  const kinematics::Chain chain(machine);
  std::vector<std::uint8_t> bad(points.size(), 0);
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    bad[i] = !clear(surroundings, tool, points[i], axes[i]) ||
             (i > 0 && (swings(chain, points, axes, rotary_rad, i) ||
                        !clear_on_the_way(surroundings, tool, chain, points[i - 1].tip_mm(axes[i - 1]),
                                          points[i].tip_mm(axes[i]), rotary_rad[i - 1], rotary_rad[i])));
  });
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < bad.size(); ++i)
    if (bad[i] != 0) out.push_back(i);
  return out;
}

std::vector<Postures> choose_postures(std::span<const PathPoint> points, const Surroundings& surroundings,
                                      std::span<const ToolShape> tools, const machine::Machine& machine,
                                      const LagError& lag, const PostureOptions& options) {
  std::vector<Postures> out(tools.size());
  if (points.empty()) return out;
  if (options.indexed) {
    for (std::size_t i = 0; i < tools.size(); ++i)
      out[i] = one_direction(points, surroundings, tools[i], machine, lag, options);
    return out;
  }
  if (options.mode != Mode::chosen) {
    for (std::size_t i = 0; i < tools.size(); ++i)
      out[i] = BySurface(points, surroundings, tools[i], machine, options).run();
    return out;
  }
  const Knots knots = knots_of(points);
  const Directions directions(machine, options.grid_rad, options.max_tilt_rad);
  for (std::size_t first = 0; first < tools.size(); first += ClearDirections::kMaxTools) {
    const auto some = tools.subspan(first, std::min(tools.size() - first, ClearDirections::kMaxTools));
    const ClearDirections clear(knots.points, surroundings, some, directions, lag.any() ? kFarthestLate : kFarthest);
    const Chooser::Choice choice{points, knots, directions, clear, surroundings, machine, lag, options};
    Stage stage("choosing directions", some.size());
    tbb::parallel_for(std::size_t{0}, some.size(), [&](std::size_t i) {
      const auto chosen = [&](const ToolShape& tool) { return Chooser(choice, i, tool).run(); };
      out[first + i] = chosen(some[i]);
      if (lag.any()) {
        // The steps of the grid stand for even turns, and one direction for the whole path is not among them.
        ToolShape without = some[i];
        without.error_mm = 0;
        for (Postures other : {chosen(without), one_direction(points, surroundings, some[i], machine, lag, options)})
          take_cheaper(points, some[i], lag, machine, options, std::move(other), out[first + i]);
      }
      stage.advance();
    });
  }
  return out;
}

}  // namespace camber::posture
