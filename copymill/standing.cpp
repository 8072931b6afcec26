#include "copymill/standing.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "copymill/clear_height.h"

namespace camber::copymill {
namespace {

/// Highest place of a column that is not above `top` and is material; `floor` where there is none.
double top_of_column(const removal::Stock::Probe& probe, const Vec2& p, double top, double floor, double voxel) {
  double z = top, before = 0;
  while (z > floor) {
    const double d = probe.distance_mm({p.x(), p.y(), z});
    if (d <= 0) return before > 0 ? std::min(top, z - d * std::min(1.0, (top - z) / std::max(1e-9, before - d))) : z;
    before = d;
    z -= std::max(d, 0.25 * voxel);
  }
  return floor;
}

}  // namespace

Standing::Standing(const removal::Stock& stock, double cell_mm, double floor_mm) {
  const Vec3 &lo = stock.min_mm(), &hi = stock.max_mm();
  grid_ = Grid::over(lo.head<2>() + Vec2::Constant(0.5 * cell_mm), hi.head<2>() - Vec2::Constant(0.5 * cell_mm), 0,
                     cell_mm);
  top_of_cell_.resize(grid_.size());
  const double voxel = stock.voxel_mm();
  tbb::parallel_for(0, grid_.ny, [&](int j) {
    const removal::Stock::Probe probe(stock);
    for (int i = 0; i < grid_.nx; ++i) {
      const double z = top_of_column(probe, grid_.at(i, j), hi.z() + voxel, floor_mm, voxel);
      top_of_cell_[grid_.index(i, j)] = static_cast<float>(
          z > floor_mm || probe.distance_mm({grid_.at(i, j).x(), grid_.at(i, j).y(), floor_mm}) < 0 ? z : kAir);
    }
  });
  for (const float z : top_of_cell_) top_ = std::max(top_, static_cast<double>(z));
}

template <class Visit>
void Standing::visit(const Vec2& axis, double radius, Visit visit) const {
  const Vec2 lo = grid_.cells(axis - Vec2::Constant(radius)), hi = grid_.cells(axis + Vec2::Constant(radius));
  const int j0 = std::max(0, static_cast<int>(std::ceil(lo.y()))),
            j1 = std::min(grid_.ny - 1, static_cast<int>(std::floor(hi.y())));
  for (int j = j0; j <= j1; ++j) {
    const double dy = grid_.at(0, j).y() - axis.y(), half = radius * radius - dy * dy;
    if (half <= 0) continue;
    const double w = std::sqrt(half) / grid_.step_mm, c = (axis.x() - grid_.origin.x()) / grid_.step_mm;
    const int i0 = std::max(0, static_cast<int>(std::ceil(c - w))),
              i1 = std::min(grid_.nx - 1, static_cast<int>(std::floor(c + w)));
    for (int i = i0; i <= i1; ++i) {
      const double dx = grid_.origin.x() + i * grid_.step_mm - axis.x();
      if (!visit(grid_.index(i, j), dx * dx + dy * dy)) return;
    }
  }
}

void Standing::cut(const removal::CutterShape& shape, const Vec3& from, const Vec3& to) {
  const bool level_bottom = !shape.general && shape.corner_radius_mm <= 0;
  const double step = std::max(0.5 * grid_.step_mm, shape.radius_mm / 16);
  const int n = std::max(1, static_cast<int>(std::ceil((to - from).norm() / step)));
  for (int k = 1; k <= n; ++k) {
    const Vec3 tip = from + static_cast<double>(k) / n * (to - from);
    visit(tip.head<2>(), shape.radius_mm, [&](std::size_t cell, double r2) {
      if (top_of_cell_[cell] > tip.z()) {
        const auto z = static_cast<float>(level_bottom ? tip.z() : tip.z() + underside_mm(shape, std::sqrt(r2)));
        top_of_cell_[cell] = std::min(top_of_cell_[cell], z);
      }
      return true;
    });
  }
}

bool Standing::meets(const removal::CutterShape& shape, const Vec3& tip, double more_than) const {
  const bool level_bottom = !shape.general && shape.corner_radius_mm <= 0;
  bool out = false;
  visit(tip.head<2>(), shape.radius_mm * (1 - 1e-9), [&](std::size_t cell, double r2) {
    const double above = top_of_cell_[cell] - tip.z() - more_than;
    out = above > 0 && (level_bottom || above > underside_mm(shape, std::sqrt(r2)));
    return !out;
  });
  return out;
}

double Standing::engaged_rad(const removal::CutterShape& shape, const Vec3& tip, const Vec2& direction,
                             double more_than) const {
  constexpr int kSteps = 24;  // of half a turn
  int engaged = 0;
  for (int k = 0; k < kSteps; ++k) {
    const double a = ((k + 0.5) / kSteps - 0.5) * kPi, c = std::cos(a), s = std::sin(a);
    const Vec2 spoke(c * direction.x() - s * direction.y(), s * direction.x() + c * direction.y());
    for (const double share : {0.97, 0.8, 0.6}) {
      const double r = share * shape.radius_mm;
      if (at(tip.head<2>() + r * spoke) <= tip.z() + more_than + underside_mm(shape, r)) continue;
      ++engaged;
      break;
    }
  }
  return engaged * kPi / kSteps;
}

double Standing::highest_mm(const Vec2& min, const Vec2& max) const {
  const Vec2 lo = grid_.cells(min), hi = grid_.cells(max);
  double out = kAir;
  for (int j = std::max(0, static_cast<int>(std::floor(lo.y()))); j <= std::min(grid_.ny - 1.0, std::ceil(hi.y())); ++j)
    for (int i = std::max(0, static_cast<int>(std::floor(lo.x()))); i <= std::min(grid_.nx - 1.0, std::ceil(hi.x()));
         ++i)
      out = std::max(out, static_cast<double>(top_of_cell_[grid_.index(i, j)]));
  return out;
}

double Standing::highest_under_mm(const Vec2& axis, double radius) const {
  double out = kAir;
  visit(axis, radius, [&](std::size_t cell, double) {
    out = std::max(out, static_cast<double>(top_of_cell_[cell]));
    return true;
  });
  return out;
}

double Standing::at(const Vec2& p) const {
  const Vec2 c = grid_.cells(p);
  const int i = static_cast<int>(std::lround(c.x())), j = static_cast<int>(std::lround(c.y()));
  return grid_.holds(i, j) ? top_of_cell_[grid_.index(i, j)] : kAir;
}

std::vector<Pass> stretches_in_material(const Standing& standing, const removal::CutterShape& shape, const Pass& pass,
                                        double more_than, double lead, double join) {
  return stretches(
      pass, std::min(standing.cell_mm(), 0.25 * shape.radius_mm),
      [&](const Vec3& p) { return standing.meets(shape, p, more_than); }, lead, join);
}

}  // namespace camber::copymill
