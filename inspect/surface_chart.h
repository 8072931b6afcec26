#pragma once
// A patch of the predicted surface laid flat: what an instrument reads where its ball touches.
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

namespace camber::inspect {

/// A point of the surface beside a feature's nominal shape.
struct ChartPoint {
  double u_mm = 0, v_mm = 0;  ///< along the nominal shape
  double nominal_mm = 0;      ///< height of the programmed surface above the shape, along the chart's outward direction
  double contour_mm = 0, deflection_mm = 0;  ///< what lag and corners, and bending, add to it
  double area_mm2 = 0;
  bool valid = true;  ///< the model holds here
};

/// Heights at a place; their sum is that of the machined surface.
struct Reading {
  double nominal_mm = 0, contour_mm = 0, deflection_mm = 0;
  double machined_mm() const { return nominal_mm + contour_mm + deflection_mm; }
};

class SurfaceChart {
 public:
  /// `reach_mm`: half the width of what a reading averages over, about one and a half voxels. `period_mm` > 0: u goes
  /// round (a cylinder's circumference).
  SurfaceChart(double reach_mm, double period_mm = 0);
  void add(const ChartPoint& point);
  bool empty() const { return points_.empty(); }
  const std::vector<ChartPoint>& points() const { return points_; }
  /// Mean of the points nearby, weighted by area and falling off linearly to zero at the reach (twice that where there
  /// are none). Nothing where the surface has no point, or more than half of it is beyond the model.
  std::optional<Reading> at(double u_mm, double v_mm) const;

 private:
  std::int64_t cell(double u, double v) const;
  std::optional<Reading> within(double u, double v, double reach) const;

  double reach_mm_, period_mm_;
  std::vector<ChartPoint> points_;
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> cells_;
};

}  // namespace camber::inspect
