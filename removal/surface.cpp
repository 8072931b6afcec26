#include "removal/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <tbb/parallel_for.h>

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

/// Share of the grid edge from voxel (i, j, k) along `axis` at which the cutters that the voxels around it name leave
/// the surface; `u` where the trilinear field has it.
double sharp_crossing(const Block& b, int i, int j, int k, int axis, double u, const Vec3& corner_mm, double voxel,
                      const CutterPlaces& places) {
  std::array<std::int32_t, 18> ids;
  std::size_t count = 0;
  std::array<int, 3> lo{-1, -1, -1};
  lo[axis] = 0;
  for (int di = lo[0]; di <= 1; ++di)
    for (int dj = lo[1]; dj <= 1; ++dj)
      for (int dk = lo[2]; dk <= 1; ++dk) {
        const std::int32_t id = b.target_stamp[Block::at(i + di, j + dj, k + dk)];
        if (std::find(ids.begin(), ids.begin() + count, id) == ids.begin() + count && places.knows(id))
          ids[count++] = id;
      }
  // The field is the largest of convex ones: Newton's steps on the governing one settle at once.
  constexpr int kSteps = 4;
  for (int step = 0; step < kSteps && count > 0; ++step) {
    Vec3 p = corner_mm;
    p[axis] += u * voxel;
    double value = -std::numeric_limits<double>::infinity();
    std::int32_t governing = 0;
    for (std::size_t n = 0; n < count; ++n)
      if (const double v = -places.distance_mm(ids[n], p); v > value) value = v, governing = ids[n];
    const double slope = -places.gradient(governing, p)[axis];
    if (std::abs(slope) < kGrazing) return u;
    u = std::clamp(u - value / (slope * voxel), 0.0, 1.0);
  }
  return u;
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
          double u = t0 / (static_cast<double>(t0) - t1);
          const Vec3 g = (1 - u) * gradient(b.target, i, j, k) + u * gradient(b.target, ni, nj, nk);
          if (std::abs(g[a]) <= kGrazing * g.norm()) continue;
          if (b.target_stamp[here] == Stock::kUncut || b.target_stamp[next] == Stock::kUncut) continue;
          if (!inside_cut(b, i, j, k, static_cast<float>(voxel)) ||
              !inside_cut(b, ni, nj, nk, static_cast<float>(voxel)))
            continue;
          SurfacePoint p;
          p.normal = g.normalized();
          p.place_mm =
              voxel * Vec3(tile[0] * Tile::kCore + i, tile[1] * Tile::kCore + j, tile[2] * Tile::kCore + k);
          if (places) u = sharp_crossing(b, i, j, k, a, u, p.place_mm, voxel, *places);
          p.place_mm[a] += voxel * u;
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
