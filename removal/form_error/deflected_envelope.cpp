#include "removal/form_error/deflected_envelope.h"

#include <algorithm>
#include <cmath>

#include "removal/field/rounded_cutter.h"
#include "removal/form_error/settling.h"

namespace camber::removal {

double DeflectedEnvelope::height_mm(const Vec3& q, const Vec3& n, double highest) const {
  const Vec3 above = point_in_tool(pose_, q + highest * n);
  const double outside = e_.shape.distance_mm(above);
  if (outside > deflection_.largest_mm || (outside > 0 && outside > outward_mm(above))) return highest;
  // Where the deflection jumps along with the edge, two points of the envelope may lie on one line: the lower counts.
  return std::min(settled_mm(q, n, highest, Vec3::Zero()),
                  settled_mm(q, n, highest, deflection_at(above - deflection_at(above))));
}

/// From a guess of the deflection to the height at which place and deflection agree.
double DeflectedEnvelope::settled_mm(const Vec3& q, const Vec3& n, double highest, Vec3 deflection) const {
  constexpr auto close = static_cast<double>(Settling::kClose_mm);
  const Vec3 normal = direction_in_tool(pose_, n);
  double h = highest;
  for (int step = 0; step < Settling::kSteps; ++step) {
    const Vec3 x = point_in_tool(pose_, q + h * n);
    const double s = e_.shape.distance_mm(x - deflection);
    if (step == 0 && s >= 0) return highest;
    const double change =
        s / std::clamp(-e_.shape.gradient(x - deflection).dot(normal), static_cast<double>(Settling::kFlattest), 1.0);
    h += change;
    const Vec3 turned = deflection_at(point_in_tool(pose_, q + h * n) - deflection) - deflection;
    if (std::abs(change) < close && turned.squaredNorm() < close * close) break;
    deflection += static_cast<double>(Settling::share_of(step)) * turned;
  }
  return std::min(h, highest);
}

double DeflectedEnvelope::outward_mm(const Vec3& in_tool) const {
  const double rho = in_tool.head<2>().norm();
  // Near the axis a deflection turns a place to another side.
  if (rho <= 5 * deflection_.largest_mm) return deflection_.largest_mm;
  const double sector = (std::atan2(in_tool.y(), in_tool.x()) + kPi) * StampDeflection::kSectors / (2 * kPi);
  const int i = std::clamp(static_cast<int>(sector), 0, StampDeflection::kSectors - 1);
  return std::min(deflection_.largest_mm, static_cast<double>(deflection_.outward_mm[static_cast<std::size_t>(i)]));
}

/// Height of the envelope's point nearest to a place.
double DeflectedEnvelope::envelope_height_mm(const Vec3& p) const {
  const CutterShape& shape = e_.shape;
  const double rho = std::sqrt(p.x() * p.x() + p.y() * p.y());
  if (shape.general) return shape.profile.nearest({rho, p.z()}).place.y();
  const RoundedCutter<double> cutter{shape.bottom_length_mm(), shape.corner_radius_mm};
  return cutter.nearest_height(cutter.place(rho, p.z()), p.z());
}

Vec3 DeflectedEnvelope::deflection_at(const Vec3& in_tool) const {
  const double height = envelope_height_mm(in_tool);
  const double step = deflections_.step_at(std::atan2(in_tool.y(), in_tool.x()), height, e_.lag_per_mm, e_.flutes);
  const Vec2 lateral = deflections_.at(deflection_.row, height, step);
  return {lateral.x(), lateral.y(), 0};
}

}  // namespace camber::removal
