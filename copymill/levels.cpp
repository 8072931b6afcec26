#include "copymill/levels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <unordered_map>

namespace camber::copymill {

std::vector<double> level_floors(const TriangleMesh& part, const AxisRegion& region, double least_mm2) {
  struct Floor {
    double area_mm2 = 0, highest_mm = -1e30;
  };
  std::map<long, Floor> floors;  // by micrometres
  for (const auto& t : part.triangles) {
    const Vec3 a = part.points[t[0]].cast<double>(), b = part.points[t[1]].cast<double>(),
               c = part.points[t[2]].cast<double>();
    constexpr double kLevel_mm = 1e-5;
    if (std::max({a.z(), b.z(), c.z()}) - std::min({a.z(), b.z(), c.z()}) > kLevel_mm) continue;
    const double area = 0.5 * ((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x());
    const Vec2 lo = a.cwiseMin(b).cwiseMin(c).head<2>(), hi = a.cwiseMax(b).cwiseMax(c).head<2>();
    const bool beside = (lo.array() > region.max_mm().array()).any() || (hi.array() < region.min_mm().array()).any();
    if (area <= 0 || beside) continue;
    Floor& floor = floors[std::lround(a.z() * 1000)];
    floor.area_mm2 += area, floor.highest_mm = std::max({floor.highest_mm, a.z(), b.z(), c.z()});
  }
  std::vector<double> out;
  for (const auto& [um, floor] : floors)
    if (floor.area_mm2 >= least_mm2) out.push_back(floor.highest_mm);
  std::ranges::reverse(out);
  return out;
}

std::vector<double> BoxLevels::floors_between(double above, double level) const {
  constexpr double kApart_mm = 1e-7;
  std::vector<double> out;
  for (const double f : floors_mm)
    if (f < above - kApart_mm && f > level + kApart_mm) out.push_back(f);
  return out;
}

BoxLevels box_levels(double top_mm, double bottom_mm, std::vector<double> floors_mm, const AxisRegion& region,
                     double allowance_mm) {
  for (const auto& b : region.boxes_mm()) floors_mm.push_back(b[0].z());
  std::vector<double> all;
  all.reserve(floors_mm.size() + region.boxes_mm().size());
  for (const double f : floors_mm) all.push_back(f + allowance_mm);
  if (allowance_mm > 0)
    for (const auto& b : region.boxes_mm()) all.push_back(b[0].z());
  std::ranges::sort(all, std::greater<>());
  // Of the mesh's and the table's numbers for one height the higher.
  constexpr double kSame_mm = 1e-5;
  BoxLevels out{Levels(top_mm, bottom_mm, {}), {}};
  for (const double f : all)
    if (out.floors_mm.empty() || f < out.floors_mm.back() - kSame_mm) out.floors_mm.push_back(f);
  return out;
}

Levels::Levels(double top_mm, double bottom_mm, std::vector<double> floors_mm) : top_(top_mm), bottom_(bottom_mm) {
  std::ranges::sort(floors_mm, std::greater<>());
  constexpr double kApart_mm = 1e-3;
  for (const double f : floors_mm)
    if (f < top_mm - kApart_mm && f > bottom_mm + kApart_mm && (stops_.empty() || f < stops_.back() - kApart_mm))
      stops_.push_back(f);
  if (bottom_mm < top_mm - kApart_mm) stops_.push_back(bottom_mm);
}

bool Levels::next(double above_mm, double axial_depth_mm, double& level_mm) const {
  constexpr double kApart_mm = 1e-6;
  const auto stop = std::ranges::find_if(stops_, [&](double s) { return s < above_mm - kApart_mm; });
  if (stop == stops_.end()) return false;
  const double steps = std::max(1.0, std::ceil((above_mm - *stop) / axial_depth_mm - 1e-6));
  level_mm = steps <= 1 ? *stop : above_mm - (above_mm - *stop) / steps;
  return true;
}

namespace {

/// Points of loops by square cells, to find those near a place.
class PointsByCell {
 public:
  explicit PointsByCell(double cell_mm) : cell_mm_(cell_mm) {}
  void add(std::size_t loop, const Vec3& p) { cells_[key(cell(p.x()), cell(p.y()))].push_back({loop, p.head<2>()}); }
  /// Adds the loops that have a point within a cell's width.
  void find(const Vec3& p, std::vector<std::size_t>& out) const {
    for (std::int64_t j = -1; j <= 1; ++j)
      for (std::int64_t i = -1; i <= 1; ++i) {
        const auto found = cells_.find(key(cell(p.x()) + i, cell(p.y()) + j));
        if (found == cells_.end()) continue;
        for (const auto& [loop, at] : found->second)
          if ((at - p.head<2>()).squaredNorm() <= cell_mm_ * cell_mm_ && std::ranges::find(out, loop) == out.end())
            out.push_back(loop);
      }
  }

 private:
  std::int64_t cell(double v) const { return static_cast<std::int64_t>(std::floor(v / cell_mm_)); }
  static std::int64_t key(std::int64_t i, std::int64_t j) { return i * 1'000'003 + j; }

  struct Point {
    std::size_t loop;
    Vec2 at;
  };
  double cell_mm_;
  std::unordered_map<std::int64_t, std::vector<Point>> cells_;
};

}  // namespace

void LoopOrder::add(std::vector<Pass> loops, double apart_mm, bool may_turn) {
  constexpr double kBeside = 1.3, kBetween = 0.25;  // times as far apart; of points that are looked at
  const std::size_t first = loops_.size();
  PointsByCell before(kBeside * std::max(apart_mm, 1e-3));
  for (std::size_t k = first_of_last_; k < first; ++k)
    for (const Vec3& p : dense(loops_[k].pass, kBetween * apart_mm)) before.add(k, p);
  for (Pass& pass : loops) {
    const bool turns = may_turn && !pass.closed;
    Loop& loop = loops_.emplace_back(Loop{std::move(pass), {}, turns});
    for (const Vec3& p : dense(loop.pass, kBetween * apart_mm)) before.find(p, loop.after);
  }
  first_of_last_ = first;
}

bool LoopOrder::may_be_next(const Loop& loop) const {
  return !loop.taken && std::ranges::all_of(loop.after, [&](std::size_t k) { return loops_[k].taken; });
}

std::optional<Pass> LoopOrder::next(const std::optional<Vec3>& tip) {
  Loop* best = nullptr;
  bool turned = false;
  double nearest = std::numeric_limits<double>::infinity();
  for (Loop& loop : loops_) {
    if (!may_be_next(loop)) continue;
    if (tip) start_near(loop.pass, *tip);
    const double far = tip ? (loop.pass.points.front() - *tip).norm() : 0;
    if (far < nearest) nearest = far, best = &loop, turned = false;
    const double back = loop.may_turn && tip ? (loop.pass.points.back() - *tip).norm() : far;
    if (back < nearest) nearest = back, best = &loop, turned = true;
  }
  if (best == nullptr) return std::nullopt;
  best->taken = true;
  return turned ? reversed(best->pass) : best->pass;
}

}  // namespace camber::copymill
