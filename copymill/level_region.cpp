#include "copymill/levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <tbb/parallel_for.h>

#include "copymill/grid.h"

namespace camber::copymill {
namespace {

using Segment = std::array<Vec2, 2>;

double distance_mm(const Segment& segment, const Vec2& p) {
  const Vec2 along = segment[1] - segment[0];
  const double t =
      along.squaredNorm() > 0 ? std::clamp((p - segment[0]).dot(along) / along.squaredNorm(), 0.0, 1.0) : 0;
  return (p - segment[0] - t * along).norm();
}

/// Nearest segment and its distance, for each point of a grid.
class Sweeper {
 public:
  Sweeper(const Grid& grid, const std::vector<Segment>& segments)
      : grid_(grid), segments_(segments), nearest_(grid.size(), -1), distance_(grid.size(), kFar) {}

  std::vector<float> run() {
    for (std::size_t s = 0; s < segments_.size(); ++s) seed(static_cast<int>(s));
    for (int round = 0; round < 2; ++round) sweep(false), sweep(true);
    return std::move(distance_);
  }

 private:
  static constexpr float kFar = std::numeric_limits<float>::infinity();

  void seed(int s) {
    const Segment& segment = segments_[static_cast<std::size_t>(s)];
    const Vec2 lo = grid_.cells(segment[0].cwiseMin(segment[1])), hi = grid_.cells(segment[0].cwiseMax(segment[1]));
    for (int j = static_cast<int>(std::floor(lo.y())) - 1; j <= static_cast<int>(std::ceil(hi.y())) + 1; ++j)
      for (int i = static_cast<int>(std::floor(lo.x())) - 1; i <= static_cast<int>(std::ceil(hi.x())) + 1; ++i)
        if (grid_.holds(i, j)) offer(i, j, s);
  }

  void offer(int i, int j, int s) {
    const std::size_t k = grid_.index(i, j);
    if (s < 0 || s == nearest_[k]) return;
    const auto d = static_cast<float>(distance_mm(segments_[static_cast<std::size_t>(s)], grid_.at(i, j)));
    if (d < distance_[k]) distance_[k] = d, nearest_[k] = s;
  }

  void sweep(bool back) {
    const int sign = back ? -1 : 1;
    for (int a = 0; a < grid_.ny; ++a) {
      const int j = back ? grid_.ny - 1 - a : a;
      for (int b = 0; b < grid_.nx; ++b) {
        const int i = back ? grid_.nx - 1 - b : b;
        for (const auto& [di, dj] : {std::array{-sign, 0}, {0, -sign}, {-sign, -sign}, {sign, -sign}})
          if (grid_.holds(i + di, j + dj)) offer(i, j, nearest_[grid_.index(i + di, j + dj)]);
      }
      for (int b = grid_.nx - 2; b >= 0; --b) {  // against the row's direction
        const int i = back ? grid_.nx - 1 - b : b, from = i + sign;
        if (grid_.holds(from, j)) offer(i, j, nearest_[grid_.index(from, j)]);
      }
    }
  }

  const Grid& grid_;
  const std::vector<Segment>& segments_;
  std::vector<int> nearest_;
  std::vector<float> distance_;
};

/// Each point tries the segments that its neighbours have found nearest, in four sweeps to and fro; beside the
/// segments the distance is exact, farther away the nearest segment may be missed by another that is as near but for
/// a small part of a step. Infinite without segments.
std::vector<float> distances_mm(const Grid& grid, const std::vector<Segment>& segments) {
  return Sweeper(grid, segments).run();
}

constexpr double kBisection_mm = 0.0002;

}  // namespace

SampledTips::SampledTips(const TipField& f, const AxisRegion& r, double step_mm)
    // Not on the grid's own lines: borders of regions are round numbers.
    : field(f), region(r), grid(Grid::over(r.min_mm(), r.max_mm(), 2.37 * step_mm, step_mm)) {
  lowest_mm.resize(grid.size());
  in_region.resize(grid.size());
  tbb::parallel_for(0, grid.ny, [&](int j) {
    for (int i = 0; i < grid.nx; ++i) {
      lowest_mm[grid.index(i, j)] = field.lowest_mm(grid.at(i, j));
      in_region[grid.index(i, j)] = region.contains(grid.at(i, j)) ? 1 : 0;
    }
  });
}

bool SampledTips::holds(std::size_t point, double z_mm) const {
  if (!region.depends_on_level()) return in_region[point] != 0;
  return in_region[point] != 0 && region.contains(grid.at(static_cast<int>(point % static_cast<std::size_t>(grid.nx)),
                                                          static_cast<int>(point / static_cast<std::size_t>(grid.nx))),
                                                  z_mm);
}

LevelRegion::LevelRegion(const SampledTips& tips, double z_mm)
    : tips_(tips),
      z_(z_mm),
      inside_([&tips, z_mm](const Vec2& p) { return tips.region.contains(p, z_mm) && tips.field.free(p, z_mm); }) {
  const Grid& grid = tips.grid;
  state_.resize(grid.size());
  mask_.resize(grid.size());
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const bool free = tips.lowest_mm[k] <= z_mm + 1e-7;
    state_[k] = !free ? State::wall : tips.holds(k, z_mm) ? State::inside : State::border;
    mask_[k] = state_[k] == State::inside ? 1 : 0;
  }
  find_outline();
  measure();
  label_components();
}

void LevelRegion::find_outline() {
  const double step = tips_.grid.step_mm;
  const auto crossing = [&](const Vec2& in, const Vec2& out) { return last_inside(inside_, in, out, kBisection_mm); };
  for (const Outline& coarse : outlines(tips_.grid, mask_, crossing))
    outlines_.push_back(refined(coarse, inside_, kOutline_mm, step));
}

/// Distances from the walls; from the border where there are none.
void LevelRegion::measure() {
  std::vector<Segment> walls, all;
  constexpr double kBeyond_mm = 0.002;
  for (const Outline& loop : outlines_)
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec2 &a = loop[k], &b = loop[(k + 1) % loop.size()];
      if ((b - a).norm() <= 0) continue;
      const Vec2 outward = Vec2((b - a).y(), -(b - a).x()) / (b - a).norm();
      if (!tips_.field.free(0.5 * (a + b) + kBeyond_mm * outward, z_)) walls.push_back({a, b});
      all.push_back({a, b});
    }
  walled_ = !walls.empty();
  distance_ = distances_mm(tips_.grid, walled_ ? walls : all);
  for (std::size_t k = 0; k < distance_.size(); ++k)
    if (state_[k] == State::wall || (!walled_ && state_[k] != State::inside)) distance_[k] = -distance_[k];
}

void LevelRegion::label_components() {
  const Grid& grid = tips_.grid;
  component_.assign(grid.size(), -1);
  std::vector<std::array<int, 2>> open;
  for (int j0 = 0; j0 < grid.ny; ++j0)
    for (int i0 = 0; i0 < grid.nx; ++i0) {
      if (!mask_[grid.index(i0, j0)] || component_[grid.index(i0, j0)] >= 0) continue;
      depth_.push_back(0);
      open.push_back({i0, j0});
      component_[grid.index(i0, j0)] = components_;
      while (!open.empty()) {
        const auto [i, j] = open.back();
        open.pop_back();
        depth_.back() = std::max(depth_.back(), static_cast<double>(distance_[grid.index(i, j)]));
        for (const auto& [di, dj] : {std::array{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
          if (!grid.holds(i + di, j + dj)) continue;
          const std::size_t k = grid.index(i + di, j + dj);
          if (!mask_[k] || component_[k] >= 0) continue;
          component_[k] = components_;
          open.push_back({i + di, j + dj});
        }
      }
      ++components_;
    }
}

int LevelRegion::component_of(const Vec2& p) const {
  const Grid& grid = tips_.grid;
  const Vec2 c = grid.cells(p);
  const int i0 = static_cast<int>(std::floor(c.x())), j0 = static_cast<int>(std::floor(c.y()));
  int best = 0;
  double nearest = 1e300;
  for (int j = j0 - 1; j <= j0 + 2; ++j)
    for (int i = i0 - 1; i <= i0 + 2; ++i) {
      if (!grid.holds(i, j) || component_[grid.index(i, j)] < 0) continue;
      const double d = (c - Vec2(i, j)).squaredNorm();
      if (d < nearest) nearest = d, best = component_[grid.index(i, j)];
    }
  return best;
}

double LevelRegion::distance_mm(const Vec2& p) const {
  const Grid& grid = tips_.grid;
  const Vec2 c = grid.cells(p);
  const int i = std::clamp(static_cast<int>(std::floor(c.x())), 0, grid.nx - 2);
  const int j = std::clamp(static_cast<int>(std::floor(c.y())), 0, grid.ny - 2);
  const double u = c.x() - i, v = c.y() - j;
  const auto at = [&](int di, int dj) { return static_cast<double>(distance_[grid.index(i + di, j + dj)]); };
  return (1 - v) * ((1 - u) * at(0, 0) + u * at(1, 0)) + v * ((1 - u) * at(0, 1) + u * at(1, 1));
}

bool LevelRegion::holds_line(const Vec2& a, const Vec2& b) const {
  const int n = std::max(1, static_cast<int>(std::ceil((b - a).norm() / (0.5 * tips_.grid.step_mm))));
  for (int k = 0; k <= n; ++k)
    if (!inside_(a + static_cast<double>(k) / n * (b - a))) return false;
  return true;
}

/// Cuts a loop where it leaves the wall that it follows.
std::vector<FlatPass> LevelRegion::follow(const Outline& loop, double distance) const {
  const std::size_t n = loop.size();
  if (!walled_) return {{loop, true}};
  const double near = 0.4 * tips_.grid.step_mm;
  std::vector<char> on(n);
  for (std::size_t k = 0; k < n; ++k) on[k] = std::abs(distance_mm(loop[k]) - distance) < near ? 1 : 0;
  const auto off = std::ranges::find(on, 0);
  if (off == on.end()) return {{loop, true}};
  const auto first = static_cast<std::size_t>(off - on.begin());
  std::vector<FlatPass> out;
  bool going = false;
  for (std::size_t i = 1; i <= n; ++i) {
    const std::size_t k = (first + i) % n;
    if (on[k] && !going) out.emplace_back();
    going = on[k] != 0;
    if (going) out.back().points.push_back(loop[k]);
  }
  std::erase_if(out, [](const FlatPass& p) { return p.points.size() < 2; });
  return out;
}

std::vector<FlatPass> LevelRegion::loops(double distance) const {
  std::vector<Outline> at;
  if (distance <= 0) {
    at = outlines_;
  } else {
    const Grid& grid = tips_.grid;
    std::vector<char> farther(grid.size());
    for (std::size_t k = 0; k < grid.size(); ++k) farther[k] = mask_[k] && distance_[k] >= distance ? 1 : 0;
    const auto crossing = [&](const Vec2& in, const Vec2& out) -> Vec2 {
      const double a = distance_mm(in), b = distance_mm(out);
      if (a > b && b < distance) return in + std::max(0.0, (a - distance) / (a - b)) * (out - in);
      return last_inside(inside_, in, out, kBisection_mm);
    };
    at = outlines(grid, farther, crossing);
  }
  std::vector<FlatPass> out;
  for (const Outline& loop : at)
    for (FlatPass& pass : follow(loop, distance)) out.push_back(std::move(pass));
  return out;
}

std::vector<FlatPass> LevelRegion::stretches(const Vec2& from, const Vec2& to) const {
  const double step = 0.5 * tips_.grid.step_mm, length = (to - from).norm();
  const int n = std::max(1, static_cast<int>(std::ceil(length / step)));
  std::vector<FlatPass> out;
  Vec2 before = from;
  bool in_before = false;
  for (int k = 0; k <= n; ++k) {
    const Vec2 p = from + static_cast<double>(k) / n * (to - from);
    const bool in = inside_(p);
    if (in && !in_before)
      out.push_back({{k == 0 ? p : last_inside(inside_, p, before, kBisection_mm)}, false}),
          out.back().points.push_back(p);
    else if (in)
      out.back().points.back() = p;
    else if (in_before)
      out.back().points.back() = last_inside(inside_, before, p, kBisection_mm);
    before = p, in_before = in;
  }
  std::erase_if(out, [](const FlatPass& s) { return (s.points[1] - s.points[0]).norm() < 1e-3; });
  return out;
}

}  // namespace camber::copymill
