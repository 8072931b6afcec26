#include "plan/stock_solid.h"

#include <algorithm>
#include <cmath>

namespace camber::plan {
namespace {

void add_level(TriangleSolid& out, double x0, double x1, double y0, double y1, double z, bool up) {
  const auto first = static_cast<std::uint32_t>(out.points.size());
  out.points.insert(out.points.end(), {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}});
  if (up) {
    out.triangles.push_back({first, first + 1, first + 2});
    out.triangles.push_back({first, first + 2, first + 3});
  } else {
    out.triangles.push_back({first, first + 2, first + 1});
    out.triangles.push_back({first, first + 3, first + 2});
  }
}

bool alike(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double kSame_mm = 1e-4;
  return std::ranges::equal(a, b, [&](double u, double v) { return std::abs(u - v) < kSame_mm; });
}

/// Coordinates at which many small areas gather.
std::vector<AxisPlane> gathered(std::vector<AxisPlane> all, double tolerance_mm, double least_mm2) {
  std::vector<AxisPlane> planes = joined(std::move(all), tolerance_mm);
  std::erase_if(planes, [&](const AxisPlane& p) { return p.area_mm2 < least_mm2; });
  return planes;
}

}  // namespace

std::vector<double> material_along_z(const removal::Stock::Probe& probe, const removal::Stock& stock, double x,
                                     double y) {
  const double step = stock.voxel_mm();
  std::vector<double> out;
  double before = stock.voxel_mm();  // air below
  const int count = static_cast<int>(std::ceil((stock.max_mm().z() - stock.min_mm().z()) / step)) + 3;
  for (int i = -1; i < count; ++i) {
    const double z = stock.min_mm().z() + i * step, value = probe.distance_mm({x, y, z});
    if ((before < 0) != (value < 0)) out.push_back(z - step * value / (value - before));
    before = value;
  }
  if (out.size() % 2 != 0) out.pop_back();
  return out;
}

StockBlank blank_of(const removal::Stock& stock, const FaceOptions& options) {
  StockBlank out;
  out.solid.heights_only = true;
  const removal::Stock::Probe probe(stock);
  const double step = stock.voxel_mm();
  const Vec3 low = stock.min_mm(), size = stock.max_mm() - stock.min_mm();
  const int nx = static_cast<int>(std::ceil(size.x() / step)), ny = static_cast<int>(std::ceil(size.y() / step));
  std::vector<AxisPlane> levels;
  for (int i = 0; i < nx; ++i) {
    const double x0 = low.x() + size.x() * i / nx, x1 = low.x() + size.x() * (i + 1) / nx;
    const auto y_of = [&](int j) { return low.y() + size.y() * j / ny; };
    for (int j = 0; j < ny;) {
      const auto column = [&](int k) {
        return material_along_z(probe, stock, 0.5 * (x0 + x1), 0.5 * (y_of(k) + y_of(k + 1)));
      };
      const std::vector<double> heights = column(j);
      int end = j + 1;
      while (end < ny && alike(column(end), heights)) ++end;
      for (std::size_t k = 0; k < heights.size(); ++k) {
        add_level(out.solid, x0, x1, y_of(j), y_of(end), heights[k], k % 2 != 0);
        levels.push_back({heights[k], (x1 - x0) * (y_of(end) - y_of(j)), true});
      }
      j = end;
    }
  }
  constexpr double kShare = 0.01;
  const double least = std::max(options.min_face_mm2, kShare * size.x() * size.y());
  out.planes[2] = gathered(std::move(levels), options.plane_tolerance_mm, least);
  constexpr std::size_t kCrossings = 300000;
  const removal::StockShape shape = removal::stock_shape(stock, kCrossings);
  std::array<std::vector<AxisPlane>, 2> walls;
  for (const removal::StockCrossing& c : shape.crossings)
    for (int a = 0; a < 2; ++a)
      if (std::abs(c.outward[a]) > 0.5)
        walls[static_cast<std::size_t>(a)].push_back({c.place_mm[a], shape.cell_mm * shape.cell_mm, true});
  for (std::size_t a = 0; a < 2; ++a)
    out.planes[a] = gathered(std::move(walls[a]), std::max(options.plane_tolerance_mm, 0.05 * step),
                             std::max(options.min_face_mm2, kShare * size.z() * size[static_cast<int>(1 - a)]));
  return out;
}

}  // namespace camber::plan
