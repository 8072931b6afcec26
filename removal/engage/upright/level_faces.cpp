#include "removal/engage/upright/level_faces.h"

#include <algorithm>
#include <cmath>

namespace camber::removal::upright {
namespace {

/// Rings whose normal leans by less than this count as upright, faces as level.
constexpr double kUpright = 0.1;

/// A face this near to the edge of a ring's width, as a share of half the width, is the edge: what an earlier pass at
/// the same height left below the lowest ring does not divide it.
constexpr double kWithin = 1 - 1e-6;

}  // namespace

std::vector<float> wall_half_widths_mm(const EnvelopeGrid& envelope) {
  std::vector<float> out;
  out.reserve(envelope.rings.size());
  for (const auto& ring : envelope.rings)
    out.push_back(std::abs(ring.cosine) < kUpright ? static_cast<float>(ring.width_mm / 2) : 0.0f);
  return out;
}

std::uint8_t RingPart::cut_255(double half_width_mm) const {
  return static_cast<std::uint8_t>(std::lround(255 * std::max(0.0, to_mm - from_mm) / (2 * half_width_mm)));
}

RingPart part_in_material(const RingPlace& ring, const TipView& tips, std::int32_t first_id, const CutterShape& shape) {
  RingPart part{-ring.half_width_mm, ring.half_width_mm};
  // A smooth field is looked up before its gradient.
  const auto is_far = [&](const BlankCell& b) {
    return b.faces.empty() &&
           std::abs(static_cast<double>(trilinear(b.lowest, b.share))) >= kWithin * ring.half_width_mm;
  };
  if (ring.blank && !is_far(*ring.blank))
    ring.blank->for_each_face([&](double above, const Vec3& up) {
      if (std::abs(above) < kWithin * ring.half_width_mm && std::abs(up.dot(ring.normal)) < kUpright * std::abs(up.z()))
        part.cut_by(-above / up.z(), up.z() > 0);
    });
  std::int32_t last = -1;
  for (int c = 0; c < 8; ++c) {
    const std::int32_t id = ring.ids[cell_corner(c)] - first_id;
    if (id < 0 || id == last) continue;
    last = id;
    Vec3 from_tip = ring.point_mm - tips[id];
    from_tip.z() -= ring.axial_mm;
    if (std::abs(from_tip.z()) >= kWithin * ring.half_width_mm || shape.gradient(from_tip).z() > -1 + kUpright)
      continue;
    part.to_mm = std::min(part.to_mm, -from_tip.z());
  }
  return part;
}

}  // namespace camber::removal::upright
