#include "copymill/clear_height.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <tbb/parallel_for.h>

namespace camber::copymill {
namespace {

constexpr double kMaxCells = 2e6;
/// The tip as simulated against the lines and arcs that are written, and their rounding.
constexpr double kPathDeviation_mm = 0.005;

double cell_size_mm(const removal::Stock& stock, double smallest_mm) {
  const Vec3 size = stock.max_mm() - stock.min_mm();
  constexpr double kPerDiameter = 20, kLeast_mm = 0.1, kMost_mm = 0.5, kVoxels = 4;
  const double fine = std::min(std::clamp(smallest_mm / kPerDiameter, kLeast_mm, kMost_mm), kVoxels * stock.voxel_mm());
  return std::max(fine, std::sqrt(size.x() * size.y() / kMaxCells));
}

/// The highest place of a column that is nearer to material than `near_mm`.
double bound_of_column(const removal::Stock::Probe& probe, const Vec2& p, double top, double bottom, double near_mm,
                       double voxel) {
  for (double z = top; z > bottom;) {
    const double d = probe.distance_mm({p.x(), p.y(), z});
    if (d <= near_mm) return z;
    z -= std::max(d - near_mm, 0.25 * voxel);
  }
  return probe.distance_mm({p.x(), p.y(), bottom}) <= near_mm ? bottom : ClearHeight::kAir;
}

}  // namespace

ClearHeight::ClearHeight(const removal::Stock& stock, double smallest_mm) {
  const double cell = cell_size_mm(stock, smallest_mm), voxel = stock.voxel_mm();
  const Vec3 &lo = stock.min_mm(), &hi = stock.max_mm();
  grid_ = Grid::over(lo.head<2>() + Vec2::Constant(0.5 * cell), hi.head<2>() - Vec2::Constant(0.5 * cell), 0, cell);
  half_diagonal_mm_ = cell / std::numbers::sqrt2;
  constexpr double kOfBand_voxels = 3;  // distances are clipped at four voxels
  const double near = std::min(half_diagonal_mm_, kOfBand_voxels * voxel);
  height_.resize(grid_.size());
  tbb::parallel_for(0, grid_.ny, [&](int j) {
    const removal::Stock::Probe probe(stock);
    for (int i = 0; i < grid_.nx; ++i)
      height_[grid_.index(i, j)] =
          static_cast<float>(bound_of_column(probe, grid_.at(i, j), hi.z(), lo.z(), near, voxel));
  });
}

template <class Visit>
void ClearHeight::rows(const Vec2& axis, double radius, Visit visit) const {
  const Vec2 c = grid_.cells(axis);
  const double r = radius / grid_.step_mm;
  const int j0 = std::max(0, static_cast<int>(std::ceil(c.y() - r))),
            j1 = std::min(grid_.ny - 1, static_cast<int>(std::floor(c.y() + r)));
  for (int j = j0; j <= j1; ++j) {
    const double w = std::sqrt(std::max(0.0, r * r - (j - c.y()) * (j - c.y())));
    const int first = std::max(0, static_cast<int>(std::ceil(c.x() - w))),
              last = std::min(grid_.nx - 1, static_cast<int>(std::floor(c.x() + w)));
    if (first <= last) visit(Row{j, first, last});
  }
}

void ClearHeight::lower(const removal::CutterShape& shape, const Vec3& tip) {
  const double radius = shape.radius_mm - half_diagonal_mm_ - kPathDeviation_mm;
  if (radius <= 0) return;
  const bool level_bottom = !shape.general && shape.corner_radius_mm <= 0;
  rows(tip.head<2>(), radius, [&](const Row& row) {
    float* heights = &height_[grid_.index(0, row.j)];
    const auto z = static_cast<float>(tip.z());
    if (level_bottom) {
      for (int i = row.first; i <= row.last; ++i) heights[i] = std::min(heights[i], z);
      return;
    }
    for (int i = row.first; i <= row.last; ++i) {
      if (heights[i] <= z) continue;
      const double farthest = (grid_.at(i, row.j) - tip.head<2>()).norm() + half_diagonal_mm_ + kPathDeviation_mm;
      heights[i] = std::min(heights[i], static_cast<float>(tip.z() + underside_mm(shape, farthest)));
    }
  });
}

double ClearHeight::lowest_clear_tip_mm(const removal::CutterShape& shape, const Vec2& axis) const {
  const bool level_bottom = !shape.general && shape.corner_radius_mm <= 0;
  double out = kAir;
  rows(axis, shape.radius_mm + half_diagonal_mm_, [&](const Row& row) {
    for (int i = row.first; i <= row.last; ++i) {
      const double height = height_[grid_.index(i, row.j)];
      if (height <= out) continue;
      const double nearest = (grid_.at(i, row.j) - axis).norm() - half_diagonal_mm_;
      out = std::max(out, level_bottom
                              ? height
                              : height - underside_mm(shape, std::clamp(nearest, 0.0, shape.radius_mm * (1 - 1e-9))));
    }
  });
  return out;
}

double ClearHeight::over_mm(const Vec2& min, const Vec2& max) const {
  const Vec2 lo = grid_.cells(min), hi = grid_.cells(max);
  double out = kAir;
  for (int j = std::max(0, static_cast<int>(std::floor(lo.y()))); j <= std::min(grid_.ny - 1.0, std::ceil(hi.y())); ++j)
    for (int i = std::max(0, static_cast<int>(std::floor(lo.x()))); i <= std::min(grid_.nx - 1.0, std::ceil(hi.x()));
         ++i)
      out = std::max(out, static_cast<double>(height_[grid_.index(i, j)]));
  return out;
}

}  // namespace camber::copymill
