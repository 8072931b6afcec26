#include "checks/material_distance.h"

#include <algorithm>
#include <cmath>

#include "removal/stock.h"

namespace camber::checks {
namespace {

constexpr std::uint16_t kNone = 60000;       ///< tiles away: there is no material
constexpr std::size_t kReadingsPerTile = 8;  ///< of points, that cost as much as a tile of the transform

}  // namespace

MaterialDistance::MaterialDistance(const removal::Stock& stock)
    : stock_(stock), tile_mm_(removal::kTileVoxels * stock.voxel_mm()) {
  std::size_t count = 1;
  for (Eigen::Index a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    first_[axis] = static_cast<int>(std::floor(stock.min_mm()[a] / tile_mm_)) - 1;
    extent_[axis] = static_cast<int>(std::floor(stock.max_mm()[a] / tile_mm_)) + 2 - first_[axis];
    lo_mm_[a] = first_[axis] * tile_mm_;
    hi_mm_[a] = (first_[axis] + extent_[axis]) * tile_mm_;
    count *= static_cast<std::size_t>(extent_[axis]);
  }
  tiles_away_.resize(count);
  transform();
}

/// Two passes over the 26 neighbours, half of them each; exact for the largest of three differences.
void MaterialDistance::transform() {
  readings_ = 0;
  const auto [nx, ny, nz] = extent_;
  const auto place = [ny = ny, nz = nz](int x, int y, int z) {
    return (static_cast<std::size_t>(x) * static_cast<std::size_t>(ny) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(nz) +
           static_cast<std::size_t>(z);
  };
  const auto at = [&](int x, int y, int z) -> std::uint16_t& { return tiles_away_[place(x, y, z)]; };
  const auto inside = [nx = nx, ny = ny, nz = nz](int x, int y, int z) {
    return x >= 0 && y >= 0 && z >= 0 && x < nx && y < ny && z < nz;
  };
  const auto relax = [&](int x, int y, int z, int sign) {
    int least = at(x, y, z);
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j)
        for (int k = -1; k <= 1; ++k) {
          if (9 * i + 3 * j + k >= 0) continue;  // the other half comes in the other pass
          const int u = x + sign * i, v = y + sign * j, w = z + sign * k;
          if (inside(u, v, w)) least = std::min(least, at(u, v, w) + 1);
        }
    at(x, y, z) = static_cast<std::uint16_t>(std::min<int>(least, kNone));
  };
  for (int x = 0; x < nx; ++x)
    for (int y = 0; y < ny; ++y)
      for (int z = 0; z < nz; ++z) {
        at(x, y, z) = stock_.is_air({first_[0] + x, first_[1] + y, first_[2] + z}) ? kNone : 0;
        if (at(x, y, z) > 0) relax(x, y, z, 1);
      }
  for (int x = nx - 1; x >= 0; --x)
    for (int y = ny - 1; y >= 0; --y)
      for (int z = nz - 1; z >= 0; --z)
        if (at(x, y, z) > 0) relax(x, y, z, -1);
}

double MaterialDistance::at_least_mm(const Vec3& point) const {
  const Vec3 inside = point.cwiseMax(lo_mm_).cwiseMin(hi_mm_);
  const double beyond = (point - inside).norm();
  std::size_t place = 0;
  for (Eigen::Index a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const int i = static_cast<int>((inside[a] - lo_mm_[a]) / tile_mm_);
    place =
        place * static_cast<std::size_t>(extent_[axis]) + static_cast<std::size_t>(std::clamp(i, 0, extent_[axis] - 1));
  }
  const double tiles = std::max(0, tiles_away_[place] - 1) * tile_mm_;
  return std::max(beyond, tiles - beyond);
}

void MaterialDistance::count_readings(std::size_t points) {
  readings_ += points;
  if (readings_ > kReadingsPerTile * tiles_away_.size()) transform();
}

}  // namespace camber::checks
