#include "copymill/loop_order.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>

namespace camber::copymill {
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
