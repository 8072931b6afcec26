#include "removal/bent_envelope.h"

#include <algorithm>
#include <cmath>

#include "removal/settling.h"

namespace camber::removal {

double BentEnvelope::height_mm(const Vec3& q, const Vec3& n, double highest) const {
  const Vec3 above = q + highest * n - tip_;
  const double outside = e_.shape.distance_mm(above);
  if (outside > bend_.largest_mm || (outside > 0 && outside > outward_mm(above))) return highest;
  // Where the deflection jumps along with the edge, two points of the envelope may lie on one line: the lower counts.
  return std::min(settled_mm(q, n, highest, Vec3::Zero()), settled_mm(q, n, highest, shift(above - shift(above))));
}

/// From a guess of the deflection to the height at which place and deflection agree.
double BentEnvelope::settled_mm(const Vec3& q, const Vec3& n, double highest, Vec3 bend) const {
  constexpr auto close = static_cast<double>(Settling::kClose_mm);
  double h = highest;
  for (int step = 0; step < Settling::kSteps; ++step) {
    const Vec3 x = q + h * n - tip_;
    const double s = e_.shape.distance_mm(x - bend);
    if (step == 0 && s >= 0) return highest;
    const double change =
        s / std::clamp(-e_.shape.gradient(x - bend).dot(n), static_cast<double>(Settling::kFlattest), 1.0);
    h += change;
    const Vec3 turned = shift(q + h * n - tip_ - bend) - bend;
    if (std::abs(change) < close && turned.squaredNorm() < close * close) break;
    bend += static_cast<double>(Settling::share_of(step)) * turned;
  }
  return std::min(h, highest);
}

double BentEnvelope::outward_mm(const Vec3& from_tip) const {
  const double rho = from_tip.head<2>().norm();
  if (rho <= 5 * bend_.largest_mm) return bend_.largest_mm;  // near the axis a shift turns a place to another side
  const double sector = (std::atan2(from_tip.y(), from_tip.x()) + kPi) * CarveBend::kSectors / (2 * kPi);
  const int i = std::clamp(static_cast<int>(sector), 0, CarveBend::kSectors - 1);
  return std::min(bend_.largest_mm, static_cast<double>(bend_.outward_mm[static_cast<std::size_t>(i)]));
}

/// Height of the envelope's point nearest to a place.
double BentEnvelope::envelope_height_mm(const Vec3& p) const {
  const CutterShape& shape = e_.shape;
  const double rho = std::sqrt(p.x() * p.x() + p.y() * p.y());
  if (shape.general) return shape.profile.nearest({rho, p.z()}).place.y();
  const double qx = rho - shape.bottom_length_mm(), qz = shape.corner_radius_mm - p.z();
  if (qx > 0 && qz > 0) return shape.corner_radius_mm * (1 - qz / std::sqrt(qx * qx + qz * qz));
  return qx > qz ? std::max(p.z(), 0.0) : 0.0;
}

Vec3 BentEnvelope::shift(const Vec3& from_tip) const {
  const double height = envelope_height_mm(from_tip);
  double step =
      (std::atan2(from_tip.y(), from_tip.x()) - height * e_.lag_per_mm) * shifts_.steps * e_.flutes / (2 * kPi);
  step -= shifts_.steps * std::floor(step / shifts_.steps);
  const int m0 = static_cast<int>(step) % shifts_.steps, m1 = m0 + 1 == shifts_.steps ? 0 : m0 + 1;
  const double f = step - std::floor(step);
  const NodeWeight w = node_weight(shifts_.node_height_mm, height);
  Vec3 sum = Vec3::Zero();
  const auto add = [&](int node, int m, double weight) {
    const float* v = bend_.row + 2 * (node * shifts_.steps + m);
    sum.x() += weight * v[0];
    sum.y() += weight * v[1];
  };
  add(w.lower, m0, (1 - w.upper_share) * (1 - f));
  add(w.lower, m1, (1 - w.upper_share) * f);
  add(w.upper, m0, w.upper_share * (1 - f));
  add(w.upper, m1, w.upper_share * f);
  return sum;
}

}  // namespace camber::removal
