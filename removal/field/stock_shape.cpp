#include "removal/stock.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>

namespace camber::removal {
namespace {

constexpr double kInside = 1e-3;  // of a cell

/// Every `every`-th voxel of a stock, and a layer of air around.
class CoarseGrid {
 public:
  CoarseGrid(const Stock& stock, int every) : probe_(stock), voxel_mm_(stock.voxel_mm()), every_(every) {
    const double cell_mm = every * voxel_mm_;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<int>(a);
      low_[a] = static_cast<int>(std::floor(stock.min_mm()[axis] / cell_mm)) - 1;
      high_[a] = static_cast<int>(std::ceil(stock.max_mm()[axis] / cell_mm)) + 1;
    }
  }

  std::vector<StockCrossing> crossings() const {
    std::vector<StockCrossing> out;
    Index3 p{};
    for (p[0] = low_[0]; p[0] < high_[0]; ++p[0])
      for (p[1] = low_[1]; p[1] < high_[1]; ++p[1])
        for (p[2] = low_[2]; p[2] < high_[2]; ++p[2]) {
          const bool inside = distance(scaled(p)) < 0;
          for (int axis = 0; axis < 3; ++axis) {
            Index3 next = p;
            ++next[static_cast<std::size_t>(axis)];
            if (inside != (distance(scaled(next)) < 0)) out.push_back(crossing(scaled(p), axis, inside));
          }
        }
    return out;
  }

 private:
  Index3 scaled(const Index3& p) const { return {p[0] * every_, p[1] * every_, p[2] * every_}; }
  Vec3 place(const Index3& voxel) const { return voxel_mm_ * Vec3(voxel[0], voxel[1], voxel[2]); }
  double distance(const Index3& voxel) const { return probe_.nearest(place(voxel)); }

  /// The first change of sign among the voxels from `from` to the next point of the grid.
  StockCrossing crossing(const Index3& from, int axis, bool inside) const {
    Index3 voxel = from;
    int& at = voxel[static_cast<std::size_t>(axis)];
    double before = distance(from), after = before;
    do {
      before = after;
      ++at;
      after = distance(voxel);
    } while ((after < 0) == inside);
    Vec3 where = place(voxel);
    where[axis] -= voxel_mm_ * after / (after - before);
    // Not on the ends: there it could not be told which line it lies on.
    const double cell_mm = every_ * voxel_mm_, low = place(from)[axis];
    where[axis] = std::clamp(where[axis], low + kInside * cell_mm, low + (1 - kInside) * cell_mm);
    return {where, (inside ? 1.0 : -1.0) * Vec3::Unit(axis)};
  }

  Stock::Probe probe_;
  double voxel_mm_;
  int every_;
  Index3 low_{}, high_{};
};

}  // namespace

StockShape stock_shape(const Stock& stock, std::size_t max_crossings) {
  assert(max_crossings >= 1);
  const auto most = static_cast<double>(max_crossings);
  const Vec3 size = stock.max_mm() - stock.min_mm();
  const double area_mm2 = 2 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
  // A face that lies along the grid is crossed once a cell.
  int every = std::max(1, static_cast<int>(std::ceil(std::sqrt(area_mm2 / most) / stock.voxel_mm())));
  StockShape out;
  for (;;) {
    out = {every * stock.voxel_mm(), CoarseGrid(stock, every).crossings()};
    const double over = static_cast<double>(out.crossings.size()) / most;
    if (over <= 1) return out;
    every = std::max(every + 1, static_cast<int>(every * std::sqrt(over)));
  }
}

}  // namespace camber::removal
