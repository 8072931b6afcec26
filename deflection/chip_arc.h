#pragma once
// Where the chips of a tooth passing are around the tool: what a vibration of the tool meets.
#include <span>

#include "removal/engagement.h"

namespace camber::deflection {

/// Integrals over the envelope in the cut, of height dz and angle dphi: of 1, of cos 2 phi and sin 2 phi, and of the
/// sine of the profile's normal angle. phi counter-clockwise from x in the tool's frame (tool_frame.h). With them the
/// mean directional matrix of any engagement is known (dynamics/vibrating_cut.h).
struct ChipArc {
  float area_mm_rad = 0;  ///< area of the arc: for a single one its depth times its angle
  float cosine_mm_rad = 0, sine_mm_rad = 0;
  float wall_mm_rad = 0;  ///< as much as the first on an upright wall, less on a floor

  ChipArc operator+(const ChipArc& b) const {
    return {area_mm_rad + b.area_mm_rad, cosine_mm_rad + b.cosine_mm_rad, sine_mm_rad + b.sine_mm_rad,
            wall_mm_rad + b.wall_mm_rad};
  }
  friend ChipArc operator*(double f, const ChipArc& a) {
    const auto k = static_cast<float>(f);
    return {k * a.area_mm_rad, k * a.cosine_mm_rad, k * a.sine_mm_rad, k * a.wall_mm_rad};
  }
};

/// Chips thinner than this are no cut: a tool that vibrates swings out of them.
constexpr float kThinnestChip_mm = 5e-4f;

ChipArc chip_arc(const removal::EnvelopeGrid& envelope, std::span<const removal::ChipSample> chips);
ChipArc chip_arc(const removal::EnvelopeGrid& envelope, const removal::EnvelopeBlocks& blocks,
                 std::span<const removal::ChipBlock> chips);

}  // namespace camber::deflection
