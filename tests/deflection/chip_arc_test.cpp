#include "deflection/tooth_pass.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/cutting.h"

namespace camber::deflection {
namespace {

/// Chips on the whole height from one angle to another, counter-clockwise from x.
std::vector<removal::ChipSample> chips_on_arc(const removal::EnvelopeGrid& e, double from, double to, float thickness) {
  std::vector<removal::ChipSample> chips;
  for (std::size_t p = 0; p < e.size(); ++p) {
    const double phi = std::atan2(e.sin_phi[p], e.cos_phi[p]);
    const double turned = phi < 0 ? phi + 2 * kPi : phi;
    if (turned >= from && turned < to)
      chips.push_back({.point = static_cast<std::uint32_t>(p), .thickness_mm = thickness});
  }
  return chips;
}

TEST(ChipArc, OfAWallIsItsDepthAndItsArc) {
  const auto e = removal::make_envelope(testing::make_tool(machine::ToolType::flat, 10, 4, 0), 3, 0.1, kPi / 360);
  const double from = 0.5, to = 1.9, arc = to - from, centre = (from + to) / 2;
  const ChipArc a = chip_arc(e, chips_on_arc(e, from, to, 0.05f));
  EXPECT_NEAR(a.area_mm_rad, 3 * arc, 0.01 * 3 * arc);
  EXPECT_NEAR(a.wall_mm_rad, a.area_mm_rad, 1e-4 * a.area_mm_rad);
  EXPECT_NEAR(std::hypot(a.cosine_mm_rad, a.sine_mm_rad) / a.area_mm_rad, std::sin(arc) / arc, 0.01);
  EXPECT_NEAR(std::atan2(a.sine_mm_rad, a.cosine_mm_rad) / 2, centre, 0.01);
  EXPECT_EQ(chip_arc(e, chips_on_arc(e, from, to, 1e-4f)).area_mm_rad, 0);
}

TEST(ChipArc, OfABallLeansTowardsItsTip) {
  const auto e = removal::make_envelope(testing::make_tool(machine::ToolType::ball, 10, 2, 0), 1, 0.02, kPi / 180);
  const ChipArc a = chip_arc(e, chips_on_arc(e, 0, 2 * kPi, 0.05f));
  EXPECT_NEAR(a.area_mm_rad, 2 * kPi, 0.03 * 2 * kPi);
  // Mean of sqrt(2 R z - z^2) / R over z from 0 to 1, R = 5.
  EXPECT_NEAR(a.wall_mm_rad / a.area_mm_rad, 0.4088, 0.01);
}

}  // namespace
}  // namespace camber::deflection
