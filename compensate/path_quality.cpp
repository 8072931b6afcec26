#include "compensate/path_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace camber::compensate {
namespace {

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

bool cuts(const nc::Move& m) { return m.kind == nc::MoveKind::linear || m.kind == nc::MoveKind::arc; }

/// Turn between the ends of two moves of the given program; nothing where one is too short to have a direction.
std::optional<double> given_turn(const nc::Interpretation& given, std::uint32_t a, std::uint32_t b) {
  if (a == b) return 0;
  const nc::Move &from = given.moves[a], &to = given.moves[b];
  if (nc::length_mm(given, from) < kShort_mm || nc::length_mm(given, to) < kShort_mm) return std::nullopt;
  return angle_between(nc::direction_at(given, from, 1), nc::direction_at(given, to, 0));
}

/// Corners of the given program, along its path.
class Corners {
 public:
  explicit Corners(const nc::Interpretation& given) {
    double along_mm = 0;
    for (std::uint32_t m = 0; m < given.moves.size(); ++m) {
      starts_mm_.push_back(along_mm);
      lengths_mm_.push_back(cuts(given.moves[m]) ? nc::length_mm(given, given.moves[m]) : 0);
      along_mm += lengths_mm_.back();
      if (m + 1 == given.moves.size() || !cuts(given.moves[m]) || !cuts(given.moves[m + 1])) continue;
      if (const auto turn = given_turn(given, m, m + 1); turn && *turn > 0) corners_.emplace_back(along_mm, *turn);
    }
  }

  /// The sharpest within kCorner_mm of a place; 0: there is none.
  double turn_rad_near(const nc::MoveMap::MovePlace& place) const {
    const double at_mm = starts_mm_[place.move] + place.fraction * lengths_mm_[place.move];
    auto corner = std::ranges::lower_bound(corners_, at_mm - kCorner_mm, {}, &std::pair<double, double>::first);
    double out = 0;
    for (; corner != corners_.end() && corner->first <= at_mm + kCorner_mm; ++corner)
      out = std::max(out, corner->second);
    return out;
  }

 private:
  std::vector<double> starts_mm_, lengths_mm_;        ///< one per move
  std::vector<std::pair<double, double>> corners_{};  ///< place along the path, and turn
};

std::vector<std::optional<double>> mean_errors_mm(const ShiftPath& path, const Observed& observed) {
  struct Sums {
    double error = 0, area = 0;
  };
  std::vector<Sums> sums(path.points().size());
  for (std::size_t i = 0; i < observed.points.size(); ++i) {
    if (!observed.compensated[i]) continue;
    const Observation& o = observed.points[i];
    const auto add = [&](std::size_t at, double fraction) {
      sums[at].error += fraction * o.area_mm2 * o.error_mm;
      sums[at].area += fraction * o.area_mm2;
    };
    add(o.place.lower, 1 - o.place.upper_fraction);
    add(o.place.lower + 1, o.place.upper_fraction);
  }
  std::vector<std::optional<double>> out(sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i)
    if (sums[i].area > 0) out[i] = sums[i].error / sums[i].area;
  return out;
}

double p95(std::vector<double> values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

PathQuality path_quality(const nc::Interpretation& given, const std::vector<bool>& selected,
                         const nc::Interpretation& emitted, const nc::MoveMap& map, double block_time_s,
                         double angle_bound_rad) {
  PathQuality out;
  const Corners corners(given);
  out.shortest_mm = std::numeric_limits<double>::infinity();
  const auto split = [&](std::size_t m) {
    const nc::MoveMap::MovePlace first = map.given(static_cast<std::uint32_t>(m), 0),
                                 last = map.given(static_cast<std::uint32_t>(m), 1);
    return last.fraction - first.fraction < 1 - 1e-9;
  };
  for (std::size_t m = 0; m < emitted.moves.size(); ++m) {
    const nc::Move& move = emitted.moves[m];
    const nc::MoveMap::MovePlace end = map.given(static_cast<std::uint32_t>(m), 1);
    if (!cuts(move) || !selected[end.move]) continue;
    const double length = nc::length_mm(emitted, move);
    if (split(m)) {
      out.shortest_mm = std::min(out.shortest_mm, length);
      if (length < move.feed_mm_per_s * block_time_s * (1 - 1e-6)) ++out.too_short;
    }
    std::size_t next = m + 1;
    while (next < emitted.moves.size() && cuts(emitted.moves[next]) && nc::length_mm(emitted, emitted.moves[next]) <= 0)
      ++next;
    if (length <= 0 || next >= emitted.moves.size() || !cuts(emitted.moves[next])) continue;
    const nc::MoveMap::MovePlace start = map.given(static_cast<std::uint32_t>(next), 0);
    if (!selected[start.move]) continue;
    const auto before = given_turn(given, end.move, start.move);
    if (!before) continue;
    const double growth =
        angle_between(nc::direction_at(emitted, move, 1), nc::direction_at(emitted, emitted.moves[next], 0)) - *before;
    if (growth > out.angle_growth_rad) {
      out.angle_growth_rad = growth;
      out.angle_line = emitted.moves[next].block + 1;
    }
    if (growth > std::max(angle_bound_rad, kOfCorner * corners.turn_rad_near(end))) out.over.push_back(end);
  }
  if (!std::isfinite(out.shortest_mm)) out.shortest_mm = 0;
  return out;
}

RowSteps row_steps(const ShiftPath& path, double reach_mm) {
  using Cell = std::array<long, 3>;
  const auto cell_of = [&](const Vec3& p) {
    return Cell{std::lround(p.x() / reach_mm), std::lround(p.y() / reach_mm), std::lround(p.z() / reach_mm)};
  };
  struct Entry {
    std::size_t point, chain;
  };
  std::map<Cell, std::vector<Entry>> cells;
  const auto& points = path.points();
  for (std::size_t c = 0; c < path.chains().size(); ++c)
    for (std::size_t i = path.chains()[c].from; i < path.chains()[c].from + path.chains()[c].count; ++i)
      cells[cell_of(points[i].place_mm)].push_back({i, c});
  constexpr double kDetour = 4;  // another row is much farther along the path than across
  std::vector<double> steps;
  for (const auto& [cell, members] : cells)
    for (const Entry& a : members) {
      if (points[a.point].fixed) continue;
      double nearest = reach_mm;
      std::size_t other = a.point;
      for (long i = -1; i <= 1; ++i)
        for (long j = -1; j <= 1; ++j)
          for (long k = -1; k <= 1; ++k) {
            const auto near = cells.find({cell[0] + i, cell[1] + j, cell[2] + k});
            if (near == cells.end()) continue;
            for (const Entry& b : near->second) {
              if (points[b.point].fixed) continue;
              const double distance = (points[a.point].place_mm - points[b.point].place_mm).norm();
              const double along = std::abs(points[a.point].along_mm - points[b.point].along_mm);
              if (distance >= nearest || (a.chain == b.chain && along < kDetour * distance + 2 * reach_mm)) continue;
              nearest = distance;
              other = b.point;
            }
          }
      if (other != a.point) steps.push_back((points[a.point].shift_mm - points[other].shift_mm).norm());
    }
  if (steps.empty()) return {};
  std::sort(steps.begin(), steps.end());
  return {steps[static_cast<std::size_t>(0.95 * static_cast<double>(steps.size() - 1))], steps.back(), steps.size()};
}

SurfaceSteps surface_steps(const ShiftPath& path, std::span<const RowLink> pairs, const Observed& before,
                           const Observed& after) {
  const auto was = mean_errors_mm(path, before), is = mean_errors_mm(path, after);
  SurfaceSteps out;
  std::vector<double> steps_before, steps_after;
  for (const RowLink& l : pairs) {
    if (!was[l.a] || !was[l.b] || !is[l.a] || !is[l.b]) continue;
    steps_before.push_back(std::abs(*was[l.a] - *was[l.b]));
    steps_after.push_back(std::abs(*is[l.a] - *is[l.b]));
    out.growth_rad = std::max(
        out.growth_rad, std::atan2(steps_after.back(), l.distance_mm) - std::atan2(steps_before.back(), l.distance_mm));
  }
  out.pairs = steps_before.size();
  if (out.pairs == 0) return out;
  out.before_max_mm = *std::max_element(steps_before.begin(), steps_before.end());
  out.after_max_mm = *std::max_element(steps_after.begin(), steps_after.end());
  out.before_p95_mm = p95(std::move(steps_before));
  out.after_p95_mm = p95(std::move(steps_after));
  return out;
}

}  // namespace camber::compensate
