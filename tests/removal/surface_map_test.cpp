// The map of the machined surface: what marks say, and the blank where none is deeper.
#include "removal/form_error.h"

#include <gtest/gtest.h>

#include "removal/engagement.h"
#include "tests/support/cutting.h"

namespace camber::removal {
namespace {

using testing::add_row;
using testing::make_box;
using testing::make_tool;

TEST(SurfaceMap, WhereNoMarkIsDeeperTheBlankIsTheSurface) {
  constexpr double kFloor_mm = -1.5, kLeft_mm = 0.1;
  const auto tool = make_tool(machine::ToolType::flat, 6, 3, 30);
  const EnvelopeGrid envelope = make_envelope(tool, 3, 0.1, kPi / 90);
  std::vector<Stamp> stamps;
  add_row(stamps, {-9, 0, kFloor_mm}, {9, 0, kFloor_mm}, 0.02);
  Stock target = make_box({-4, -5, -3}, {4, 5, 0}, 0.1);
  sweep(target, envelope.shape, stamps, {});
  CutterPlaces places;
  places.add(0, envelope.shape, stamps);
  const Stock blank = make_box({-4, -5, -3}, {4, 5, kFloor_mm + kLeft_mm}, 0.1);
  SurfaceMap map(target, places, blank);
  // The straight cutter passes over the first half of the floor only.
  const std::span<const Stamp> half(stamps.data(), stamps.size() / 2);
  map.mark(envelope, half, DeflectionTable(half.size(), envelope.steps_per_pitch, {0, 3}), 0);
  std::size_t cut = 0, uncut = 0;
  for (const SurfacePoint& p : map.take()) {
    if (p.normal.z() < 0.9 || std::abs(p.place_mm.y()) > 0.5) continue;
    if (p.place_mm.x() < -0.5) {
      EXPECT_NEAR(p.error_mm, 0, 1e-4);
      EXPECT_GE(p.machined_stamp, 0);
      ++cut;
    } else if (p.place_mm.x() > 3.5) {  // a radius beyond the last of them
      EXPECT_NEAR(p.error_mm, kLeft_mm, 1e-4);
      EXPECT_EQ(p.machined_stamp, Stock::kUncut);
      ++uncut;
    }
  }
  EXPECT_GT(cut, 100u);
  EXPECT_GT(uncut, 20u);
}

}  // namespace
}  // namespace camber::removal
