#include "removal/surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

namespace camber::removal {
namespace {

constexpr int kMargin = 2;         // voxels around a tile for gradients and edges
constexpr double kGrazing = 0.05;  // grid lines that meet the surface at a flatter angle tell nothing
constexpr int kPad = Tile::kCore + 2 * kMargin;

/// Distance, machined distance and stamps of a tile with a margin on all sides.
struct Block {
  std::vector<float> target, machined;
  std::vector<std::int32_t> target_stamp, machined_stamp;
  static std::size_t at(int i, int j, int k) {
    return (static_cast<std::size_t>(i + kMargin) * kPad + static_cast<std::size_t>(j + kMargin)) * kPad +
           static_cast<std::size_t>(k + kMargin);
  }
};

void fill(const Stock& stock, const Index3& tile, std::vector<float>& distance, std::vector<std::int32_t>& stamp) {
  distance.resize(static_cast<std::size_t>(kPad) * kPad * kPad);
  stamp.resize(distance.size());
  stock.read({tile[0] * Tile::kCore - kMargin, tile[1] * Tile::kCore - kMargin, tile[2] * Tile::kCore - kMargin}, kPad,
             distance.data(), stamp.data());
}

Vec3 gradient(const std::vector<float>& d, int i, int j, int k) {
  return {d[Block::at(i + 1, j, k)] - d[Block::at(i - 1, j, k)], d[Block::at(i, j + 1, k)] - d[Block::at(i, j - 1, k)],
          d[Block::at(i, j, k + 1)] - d[Block::at(i, j, k - 1)]};
}

/// No voxel near the surface around here was left by the blank.
bool inside_cut(const Block& b, int i, int j, int k, float voxel) {
  for (int di = -1; di <= 1; ++di)
    for (int dj = -1; dj <= 1; ++dj)
      for (int dk = -1; dk <= 1; ++dk) {
        const std::size_t at = Block::at(i + di, j + dj, k + dk);
        if (b.target_stamp[at] == Stock::kUncut && std::abs(b.target[at]) < voxel) return false;
      }
  return true;
}

/// Two even numbers in -0.5 ... 0.5 that belong to a grid edge.
Vec2 scatter_of(const Index3& voxel, int axis) {
  // Source: splitmix64 (Steele, Lea, Flood 2014), as a hash.
  std::uint64_t h = static_cast<std::uint64_t>(axis);
  for (const int v : voxel) {
    h += 0x9e3779b97f4a7c15u + static_cast<std::uint64_t>(static_cast<std::int64_t>(v));
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    h ^= h >> 31;
  }
  constexpr double kPerStep = 1.0 / 4294967296.0;
  return {static_cast<double>(h >> 32) * kPerStep - 0.5, static_cast<double>(h & 0xffffffffu) * kPerStep - 0.5};
}

/// The cutters that the voxels around a grid edge name, and those before and after them that lie deeper between the
/// voxels (a feed below the voxel's size leaves stamps that no voxel names): the target is the largest of their fields.
class NamedCutters {
 public:
  NamedCutters(const Block& b, const Index3& from, int axis, const CutterPlaces& places) : places_(places) {
    Index3 lo{-1, -1, -1};
    lo[axis] = 0;
    for (int di = lo[0]; di <= 1; ++di)
      for (int dj = lo[1]; dj <= 1; ++dj)
        for (int dk = lo[2]; dk <= 1; ++dk) {
          const std::int32_t id = b.target_stamp[Block::at(from[0] + di, from[1] + dj, from[2] + dk)];
          if (std::find(ids_.begin(), ids_.begin() + count_, id) == ids_.begin() + count_ && places.knows(id))
            ids_[count_++] = id;
        }
  }

  /// Moves p along a direction onto the surface, and gives the surface's own normal there; nothing where there is none
  /// within `reach`.
  std::optional<Vec3> settle(Vec3& p, const Vec3& direction, double reach) const {
    // The field is the largest of convex ones: Newton's steps on the governing one settle at once.
    constexpr int kSteps = 6;
    constexpr double kClose_mm = 1e-5;
    const Vec3 from = p;
    for (int step = 0; step < kSteps && count_ > 0; ++step) {
      double value = -std::numeric_limits<double>::infinity();
      std::int32_t governing = 0;
      for (std::size_t n = 0; n < count_; ++n) {
        const auto [id, v] = places_.deepest_from(ids_[n], p);
        if (v > value) value = v, governing = id;
      }
      const Vec3 normal = -places_.gradient(governing, p);
      if (std::abs(value) < kClose_mm) return normal;
      const double slope = normal.dot(direction);
      if (std::abs(slope) < kGrazing) return std::nullopt;
      p -= value / slope * direction;
      if ((p - from).squaredNorm() > reach * reach) return std::nullopt;
    }
    return std::nullopt;
  }

 private:
  const CutterPlaces& places_;
  std::array<std::int32_t, 18> ids_{};
  std::size_t count_ = 0;
};

/// Puts a point of the trilinear surface, on a grid line along `axis`, onto the cutters that made it, and aside within
/// the square that the line stands for: those squares together cover the surface once, and rows and feed marks that are
/// in step with the grid are met at all their places.
void sharpen(SurfacePoint& p, const NamedCutters& cutters, int axis, const Vec2& scatter, double voxel) {
  constexpr double kFarthest = 0.9;  // voxels; where the line grazes the surface, its square is wider than that
  constexpr double kOneFace = 0.94;  // cosine; neighbouring cusps differ by less, a wall and a floor by more
  Vec3 place = p.place_mm;
  const auto normal = cutters.settle(place, p.normal, voxel);
  if (!normal) return;
  p.place_mm = place;
  const int b = (axis + 1) % 3, c = (axis + 2) % 3;
  Vec3 aside = Vec3::Zero();
  aside[b] = scatter.x();
  aside[c] = scatter.y();
  aside[axis] = -(aside[b] * p.normal[b] + aside[c] * p.normal[c]) / p.normal[axis];
  if (const double length = aside.norm(); length > kFarthest) aside *= kFarthest / length;
  place += voxel * aside;
  const auto normal_aside = cutters.settle(place, p.normal, 0.5 * voxel);
  if (normal_aside && normal_aside->dot(*normal) > kOneFace) p.place_mm = place;
}

/// `places`, `machined`: null where not wanted.
void collect(const Stock* machined, const Stock& target, const CutterPlaces* places, const Index3& tile,
             std::vector<SurfacePoint>& out) {
  if (!target.is_cut(tile)) return;
  Block b;
  fill(target, tile, b.target, b.target_stamp);
  if (machined) fill(*machined, tile, b.machined, b.machined_stamp);
  const double voxel = target.voxel_mm();
  for (int i = 0; i < Tile::kCore; ++i)
    for (int j = 0; j < Tile::kCore; ++j)
      for (int k = 0; k < Tile::kCore; ++k) {
        const std::size_t here = Block::at(i, j, k);
        const float t0 = b.target[here];
        if (std::abs(t0) > 2 * voxel) continue;
        for (int a = 0; a < 3; ++a) {
          const int ni = i + (a == 0), nj = j + (a == 1), nk = k + (a == 2);
          const std::size_t next = Block::at(ni, nj, nk);
          const float t1 = b.target[next];
          if ((t0 < 0) == (t1 < 0)) continue;
          const double u = t0 / (static_cast<double>(t0) - t1);
          const Vec3 g = (1 - u) * gradient(b.target, i, j, k) + u * gradient(b.target, ni, nj, nk);
          if (std::abs(g[a]) <= kGrazing * g.norm()) continue;
          if (b.target_stamp[here] == Stock::kUncut || b.target_stamp[next] == Stock::kUncut) continue;
          if (!inside_cut(b, i, j, k, static_cast<float>(voxel)) ||
              !inside_cut(b, ni, nj, nk, static_cast<float>(voxel)))
            continue;
          SurfacePoint p;
          p.normal = g.normalized();
          const Index3 at{tile[0] * Tile::kCore + i, tile[1] * Tile::kCore + j, tile[2] * Tile::kCore + k};
          p.place_mm = voxel * Vec3(at[0], at[1], at[2]);
          p.place_mm[a] += voxel * u;
          p.crossing_mm = p.place_mm;
          if (places) sharpen(p, NamedCutters(b, {i, j, k}, a, *places), a, scatter_of(at, a), voxel);
          if (machined) p.error_mm = -((1 - u) * b.machined[here] + u * b.machined[next]);
          p.area_mm2 = voxel * voxel * std::abs(p.normal[a]);
          p.target_stamp = b.target_stamp[u < 0.5 ? here : next];
          if (machined) p.machined_stamp = b.machined_stamp[u < 0.5 ? here : next];
          out.push_back(p);
        }
      }
}

}  // namespace

namespace {

std::vector<std::vector<SurfacePoint>> by_tile(const Stock* machined, const Stock& target, const CutterPlaces* places) {
  const std::vector<Index3> tiles = target.surface_tiles();
  std::vector<std::vector<SurfacePoint>> parts(tiles.size());
  tbb::parallel_for(std::size_t{0}, tiles.size(),
                    [&](std::size_t i) { collect(machined, target, places, tiles[i], parts[i]); });
  return parts;
}

}  // namespace

std::vector<SurfacePoint> compare_surfaces(const Stock& machined, const Stock& target) {
  std::vector<SurfacePoint> points;
  for (const auto& part : by_tile(&machined, target, nullptr)) points.insert(points.end(), part.begin(), part.end());
  return points;
}

std::vector<std::vector<SurfacePoint>> surface_points(const Stock& target, const CutterPlaces& places) {
  return by_tile(nullptr, target, &places);
}

ErrorFigures error_figures(const std::vector<double>& error, const std::vector<double>& area) {
  ErrorFigures f;
  if (error.empty()) return f;
  f.min = *std::min_element(error.begin(), error.end());
  f.max = *std::max_element(error.begin(), error.end());
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < error.size(); ++i) {
    f.area_mm2 += area[i];
    sum += area[i] * error[i];
    squares += area[i] * error[i] * error[i];
  }
  f.mean = sum / f.area_mm2;
  f.rms = std::sqrt(squares / f.area_mm2);
  std::vector<std::size_t> order(error.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return std::abs(error[a]) < std::abs(error[b]); });
  double below = 0;
  for (const std::size_t i : order) {
    below += area[i];
    f.p95 = std::abs(error[i]);
    if (below >= 0.95 * f.area_mm2) break;
  }
  return f;
}

}  // namespace camber::removal
