// The map of the machined surface: what marks say, and the blank where none is deeper.
#include "removal/form_error.h"

#include <utility>

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

TEST(SurfaceMap, GivesTheMarksOfOnePieceAfterTheOther) {
  const auto tool = make_tool(machine::ToolType::ball, 6, 2, 30);
  const EnvelopeGrid envelope = make_envelope(tool, 3, 0.1, kPi / 90);
  std::vector<Stamp> stamps;
  for (const double y : {-1.5, 0.0, 1.5}) add_row(stamps, {-9, y, -1}, {9, y, -1}, 0.1);
  Stock target = make_box({-6, -4, -3}, {6, 4, 0}, 0.1);
  const Stock blank(target);
  sweep(target, envelope.shape, stamps, {});
  CutterPlaces places;
  places.add(0, envelope.shape, stamps);
  const SurfaceMap fresh(target, places, blank);
  SurfaceMap map(fresh);
  EXPECT_TRUE(map.take_marks().empty());
  std::size_t marked = 0;
  // Pieces that overlap, the second one far from the first.
  const std::size_t n = stamps.size();
  for (const auto& [from, count] :
       {std::pair(std::size_t{0}, n / 6), std::pair(2 * n / 3, n / 4), std::pair(n / 8, n / 3)}) {
    const std::span<const Stamp> piece(stamps.data() + from, count);
    const DeflectionTable straight(count, envelope.steps_per_pitch, {0, 3});
    SurfaceMap alone(fresh);
    for (SurfaceMap* of : {&map, &alone}) of->mark(envelope, piece, straight, static_cast<std::int32_t>(from));
    const std::vector<PointMark> marks = map.take_marks();
    std::size_t next = 0;
    for (std::size_t i = 0; i < alone.points().size(); ++i) {
      const SurfacePoint& p = alone.points()[i];
      if (p.machined_stamp == Stock::kUncut) continue;
      ASSERT_LT(next, marks.size());
      EXPECT_EQ(marks[next].point, i);
      EXPECT_EQ(marks[next].error_mm, p.error_mm);
      EXPECT_EQ(marks[next].stamp, p.machined_stamp);
      ++next;
    }
    EXPECT_EQ(next, marks.size());
    marked += marks.size();
  }
  EXPECT_GT(marked, 1000u);
  EXPECT_TRUE(map.take_marks().empty());
}

}  // namespace
}  // namespace camber::removal
