#include "dynamics/stability_table.h"

#include <random>

#include <gtest/gtest.h>

#include "dynamics/tool_lobes.h"
#include "dynamics/tool_modes.h"
#include "tests/support/cutting.h"

namespace camber::dynamics {
namespace {

constexpr double kBetweenNodes = 0.05;  // of the depth, by drawing straight between nodes

Cut four_teeth() {
  Cut cut;
  cut.pitch_rad = equal_pitches(4);
  cut.radius_mm = 6;
  return cut;
}

std::vector<Mode> alike(double hz) { return {{Vec2::UnitX(), hz, 0.03, 8000}, {Vec2::UnitY(), hz, 0.03, 8000}}; }

/// Nine of ten cuts; cusps between two lobes are drawn rounder.
int far_ones(StabilityTable& table, std::mt19937& random, int cuts) {
  const auto between = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  int far = 0;
  for (int i = 0; i < cuts; ++i) {
    const ArcCut cut{between(0.3, kPi), between(0, 7), 900, between(100, 500)};
    const double exact = table.exactly_at(cut).depth_mm, found = table.at(cut).depth_mm;
    far += std::abs(found - exact) > kBetweenNodes * exact;
  }
  return far;
}

TEST(StabilityTable, IsNearTheExactDepthBetweenItsNodes) {
  std::mt19937 random(3);
  StabilityTable same(alike(900), four_teeth(), 9000, kBeamModeErrors);
  EXPECT_LE(far_ones(same, random, 60), 6);
  StabilityTable other({{Vec2::UnitX(), 900, 0.03, 8000}, {Vec2::UnitY(), 1100, 0.02, 6000}}, four_teeth(), 5200,
                       kMeasuredModeErrors);
  EXPECT_LE(far_ones(other, random, 60), 6);
}

TEST(StabilityTable, IsExactForTheForcesOfItsNodes) {
  StabilityTable table(alike(900), four_teeth(), 9000, kBeamModeErrors);
  const ArcCut node{2 * kPi * 36 * 36 / 3600, 0.3, 700, 210};
  EXPECT_NEAR(table.at(node).depth_mm, table.exactly_at(node).depth_mm, 1e-6 * table.exactly_at(node).depth_mm);
  // Twice the force, half the depth.
  const ArcCut twice{node.arc_rad, node.centre_rad, 1400, 420};
  EXPECT_NEAR(table.at(twice).depth_mm, table.at(node).depth_mm / 2, 1e-6);
}

TEST(StabilityTable, OfOtherSpeedsIsTheirTables) {
  const StabilityTable table(alike(900), four_teeth(), 9000, kBeamModeErrors);
  const ArcCut wide{2, 1, 900, 300}, narrow{0.4, 1, 900, 300};
  for (const ArcCut& cut : {wide, narrow})
    for (const double rpm : {5000.0, 12000.0})
      EXPECT_EQ(table.at_speeds(cut, {rpm})[0].depth_mm,
                StabilityTable(alike(900), four_teeth(), rpm, kBeamModeErrors).exactly_at(cut).depth_mm);
}

/// At low speed and high frequency process damping keeps stable what a margin alone calls unstable.
TEST(StabilityTable, ProbabilityCountsProcessDamping) {
  const ArcCut slot{kPi, 1, 2000, 600};
  StabilityTable slow(alike(6000), four_teeth(), 3000, kBeamModeErrors),
      fast(alike(600), four_teeth(), 12000, kBeamModeErrors);
  EXPECT_LT(slow.probability(slot, 2 * slow.at(slot).depth_mm), 0.3);
  EXPECT_GT(fast.probability(slot, 2 * fast.at(slot).depth_mm), 0.6);
}

TEST(StabilityTable, ProbabilityGrowsWithTheDepth) {
  StabilityTable table(alike(900), four_teeth(), 9000, kBeamModeErrors);
  const ArcCut cut{2, 1, 900, 300};
  const double critical = table.at(cut).depth_mm;
  double before = 0;
  for (const double share : {0.01, 0.3, 0.7, 1.0, 1.5, 3.0, 100.0}) {
    const double p = table.probability(cut, share * critical);
    EXPECT_GE(p, before);
    before = p;
  }
  EXPECT_EQ(table.probability(cut, 0.01 * critical), 0);
  EXPECT_GT(before, 0.95);  // in a few draws process damping keeps any depth stable
  EXPECT_NEAR(table.probability(cut, table.depth_of_probability(cut, 0.9)), 0.9, 0.08);
  // Modes that are known leave less room.
  StabilityTable known(alike(900), four_teeth(), 9000, kMeasuredModeErrors);
  EXPECT_LT(known.depth_of_probability(cut, 0.9) - known.depth_of_probability(cut, 0.1),
            table.depth_of_probability(cut, 0.9) - table.depth_of_probability(cut, 0.1));
}

LobeRequest request(machine::ToolType type) {
  LobeRequest r;
  r.tool = testing::make_tool(type, 10, 3, 0);
  r.tool.youngs_modulus_MPa = 210e3;
  r.modes = modes_of(r.tool);
  r.material = machine::Material(900, 300, 0);
  r.radial_mm = 4;
  return r;
}

TEST(ToolLobes, OfASmallCornerAreThoseOfASharpOne) {
  LobeRequest flat = request(machine::ToolType::flat), bull = request(machine::ToolType::bull);
  bull.tool.corner_radius_mm = 1e-3;
  for (const auto method : {LobeMethod::zero_order, LobeMethod::semi_discretisation}) {
    flat.method = bull.method = method;
    const auto a = tool_lobes(flat, {6000, 9000}), b = tool_lobes(bull, {6000, 9000});
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_TRUE(std::isfinite(a[i].critical.depth_mm));
      EXPECT_NEAR(b[i].critical.depth_mm, a[i].critical.depth_mm, 0.02 * a[i].critical.depth_mm);
    }
  }
}

/// In a slot the ball's slices are in the cut as wide as a cylinder's, and its chip pushes the less outwards, the
/// nearer to the tip: less radial force, and with krc = 0 the same border.
TEST(ToolLobes, OfABallInASlotWithoutRadialForceAreACylinders) {
  LobeRequest flat = request(machine::ToolType::flat), ball = request(machine::ToolType::ball);
  for (LobeRequest* r : {&flat, &ball}) {
    r->radial_mm = 10, r->material = machine::Material(900, 0, 0), r->method = LobeMethod::zero_order;
    r->modes = {{Vec2::UnitX(), 600, 0.03, 8000}, {Vec2::UnitY(), 800, 0.03, 6000}};
  }
  const auto a = tool_lobes(flat, {5000, 7000}), b = tool_lobes(ball, {5000, 7000});
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_TRUE(std::isfinite(a[i].critical.depth_mm));
    EXPECT_NEAR(b[i].critical.depth_mm, a[i].critical.depth_mm, 0.01 * a[i].critical.depth_mm);
  }
}

TEST(ToolLobes, OfABallThatDoesNotReachTheMaterialHaveNoBorder) {
  LobeRequest ball = request(machine::ToolType::ball);
  ball.tool.flute_length_mm = 0.5;  // of this depth the ball is 4.4 mm wide
  ball.radial_mm = 1;
  EXPECT_EQ(tool_lobes(ball, {8000}).front().border, StabilityBorder::none);
}

TEST(ToolModes, AreGivenOrTheBeams) {
  machine::Tool tool = testing::make_tool(machine::ToolType::flat, 10, 3, 30);
  const auto beam = modes_of(tool);
  ASSERT_EQ(beam.size(), 2u);  // the second mode of a clamped rod is 38 times as stiff as the first
  EXPECT_EQ(beam[0].damping_ratio, kUsualDamping);
  tool.density_kg_per_m3 = 4 * 14500;
  EXPECT_NEAR(modes_of(tool)[0].frequency_hz, beam[0].frequency_hz / 2, 1e-6 * beam[0].frequency_hz);
  tool.modes = {{Vec2::UnitX(), 500, 0.01, 1000}};
  EXPECT_EQ(modes_of(tool).size(), 1u);
}

}  // namespace
}  // namespace camber::dynamics
