#include "inspect/surface_chart.h"

#include <algorithm>
#include <cmath>

namespace camber::inspect {
namespace {

constexpr std::int64_t kRow = std::int64_t{1} << 32;

/// `d` brought into -period / 2 ... period / 2.
double wrapped(double d, double period) { return period > 0 ? d - period * std::round(d / period) : d; }

}  // namespace

SurfaceChart::SurfaceChart(double reach_mm, double period_mm) : reach_mm_(reach_mm), period_mm_(period_mm) {}

std::int64_t SurfaceChart::cell(double u, double v) const {
  const double w = period_mm_ > 0 ? u - period_mm_ * std::floor(u / period_mm_) : u;
  return static_cast<std::int64_t>(std::floor(w / reach_mm_)) * kRow +
         static_cast<std::int64_t>(std::floor(v / reach_mm_));
}

void SurfaceChart::add(const ChartPoint& point) {
  cells_[cell(point.u_mm, point.v_mm)].push_back(static_cast<std::uint32_t>(points_.size()));
  points_.push_back(point);
}

std::optional<Reading> SurfaceChart::within(double u, double v, double reach) const {
  const int cells = static_cast<int>(std::ceil(reach / reach_mm_));
  Reading sum;
  double weight = 0, invalid = 0;
  std::vector<std::int64_t> seen;  // a small circle meets a cell twice
  for (int i = -cells; i <= cells; ++i)
    for (int j = -cells; j <= cells; ++j) seen.push_back(cell(u + i * reach_mm_, v + j * reach_mm_));
  std::ranges::sort(seen);
  seen.erase(std::ranges::unique(seen).begin(), seen.end());
  for (const std::int64_t key : seen) {
    const auto at = cells_.find(key);
    if (at == cells_.end()) continue;
    for (const std::uint32_t k : at->second) {
      const ChartPoint& p = points_[k];
      const double du = std::abs(wrapped(p.u_mm - u, period_mm_)), dv = std::abs(p.v_mm - v);
      if (du >= reach || dv >= reach) continue;
      const double w = p.area_mm2 * (1 - du / reach) * (1 - dv / reach);
      if (!p.valid) {
        invalid += w;
        continue;
      }
      weight += w;
      sum.nominal_mm += w * p.nominal_mm;
      sum.contour_mm += w * p.contour_mm;
      sum.deflection_mm += w * p.deflection_mm;
    }
  }
  if (weight <= invalid || weight <= 0) return std::nullopt;
  return Reading{sum.nominal_mm / weight, sum.contour_mm / weight, sum.deflection_mm / weight};
}

std::optional<Reading> SurfaceChart::at(double u_mm, double v_mm) const {
  if (auto near = within(u_mm, v_mm, reach_mm_)) return near;
  return within(u_mm, v_mm, 2 * reach_mm_);
}

}  // namespace camber::inspect
