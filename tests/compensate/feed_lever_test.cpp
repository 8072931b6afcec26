// How far the feed lever may lower the feed: at corners that the control passes more slowly, further.
#include "compensate/feed_lever.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "nc/interpreter.h"

namespace camber::compensate {
namespace {

constexpr double kLeast = 0.2;

/// 15 mm/s along X, then along Y.
constexpr const char* kCorner =
    "G21 G90 G17\nT1 M6\nG54 S3000 M3\nG0 X0 Y0 Z5.\nG0 Z-1.\nG1 X20. F900\nG1 Y20.\n"
    "G0 Z5.\nM30\n";

machine::Machine machine_with(machine::CornerLaw law, double speed_difference_mm_per_s = 0) {
  machine::Machine out;
  for (auto& axis : out.axis) axis.acceleration_mm_per_s2 = 400;
  out.control.corner = {.law = law, .speed_difference_mm_per_s = speed_difference_mm_per_s};
  return out;
}

struct Pieces {
  std::vector<double> from_corner_mm, least;
};

Pieces pieces_of(const machine::Machine& machine) {
  Diagnostics diagnostics;
  const nc::Program text = nc::read_program(SourceText("p.nc", kCorner), diagnostics);
  const nc::Interpretation moves = nc::interpret(text, {.inch = false}, diagnostics);
  EXPECT_FALSE(diagnostics.has_errors());
  std::vector<bool> cuts;
  for (const nc::Move& m : moves.moves) cuts.push_back(m.kind == nc::MoveKind::linear);
  const ShiftPath path(moves, cuts, 0.5);
  const std::vector<double> least = least_feeds(path, moves, machine, kLeast);
  EXPECT_EQ(least.size(), path.points().size());
  Pieces out;
  for (std::size_t i = 1; i < least.size(); ++i) {
    out.from_corner_mm.push_back(path.points()[i].along_mm - 20);
    out.least.push_back(least[i]);
  }
  return out;
}

TEST(LeastFeed, IsTheSpeedOfTheCornerWithinTwoMillimetresOfIt) {
  // 2 mm/s through the corner, 0.133 of the feed.
  const Pieces pieces = pieces_of(machine_with(machine::CornerLaw::speed_difference, 2));
  for (std::size_t i = 0; i < pieces.least.size(); ++i) {
    const double at = pieces.from_corner_mm[i];  // of the end of a piece of 0.5 mm
    const bool near = at > -2 + 1e-6 && at < 2.5 - 1e-6;
    EXPECT_NEAR(pieces.least[i], near ? 2.0 / 15 : kLeast, 1e-9) << at;
  }
}

TEST(LeastFeed, IsAtLeastHalfOfTheOneElsewhere) {
  const Pieces pieces = pieces_of(machine_with(machine::CornerLaw::speed_difference, 0.5));
  EXPECT_DOUBLE_EQ(*std::min_element(pieces.least.begin(), pieces.least.end()), kLeast / 2);
}

TEST(LeastFeed, IsThatOfEverywhereAtFastCornersAndStops) {
  for (const auto& machine :
       {machine_with(machine::CornerLaw::speed_difference, 12), machine_with(machine::CornerLaw::exact_stop)})
    for (const double least : pieces_of(machine).least) EXPECT_DOUBLE_EQ(least, kLeast);
}

}  // namespace
}  // namespace camber::compensate
