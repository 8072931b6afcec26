// Parts with one feature each, planned with the tools of the published experiment (table 2), which sample 15 has; and
// the demonstration part.
#include <gtest/gtest.h>

#include "plan/setup_plan.h"
#include "test_paths.h"
#include "tests/support/block_part.h"

namespace camber::plan {
namespace {

using tests::BlockPart;
using tests::box;

const PlanInput& table_2() {
  static const PlanInput input = [] {
    Diagnostics diagnostics;
    return read_plan_input(CAMBER_SOURCE_DIR "/samples/15-plan/demonstration.toml", diagnostics);
  }();
  return input;
}

struct Planned {
  Feature feature = Feature::face;
  std::vector<int> tools{};
  std::vector<Pattern> patterns{};
  bool by_the_rules = true;
};

/// Of a removal volume with one primitive; all three plans come to the same.
Planned planned(const RemovalVolume& removal) {
  Planned out;
  for (const DivisionPlan division : kDivisionPlans) {
    const PlannedDivision plan = plan_division(table_2(), removal, division);
    EXPECT_TRUE(plan.complete());
    EXPECT_EQ(plan.order.steps.size(), 1U);
    Planned now{.feature = plan.order.steps.at(0).feature};
    for (const PlanOperation& o : plan.operations) {
      now.tools.push_back(o.tool);
      now.patterns.push_back(o.pattern);
      for (const std::string& note : o.notes)
        now.by_the_rules = now.by_the_rules && note.find("rule") == std::string::npos;
    }
    if (division != kDivisionPlans[0]) {
      EXPECT_EQ(now.tools, out.tools);
    }
    out = std::move(now);
  }
  return out;
}

/// Cut from a block of 200 x 150 x 20.
Planned planned(const machine::Box& cut) {
  const BlockPart part{box(0, 0, 0, 200, 150, 20), {cut}, {}};
  return planned(removal_volume({.blank = solid_of(part.block), .part = solid_of(part.mesh())}));
}

Planned planned(const tests::BlockHole& hole) {
  const BlockPart part{box(0, 0, 0, 200, 150, 20), {}, {hole}};
  return planned(removal_volume({.blank = solid_of(part.block), .part = solid_of(part.mesh())}));
}

void expect(const Planned& is, Feature feature, std::vector<int> tools, Pattern pattern) {
  EXPECT_EQ(to_string(is.feature), to_string(feature));
  EXPECT_EQ(is.tools, tools);
  for (const Pattern p : is.patterns) EXPECT_EQ(p, pattern);
  EXPECT_TRUE(is.by_the_rules);
}

TEST(OneFeature, ClosedPocketHasAFifthOfItsShorterSide) {
  expect(planned(box(30, 30, 12, 130, 80, 20)), Feature::closed_pocket, {2}, Pattern::contour_line);
  expect(planned(box(30, 30, 12, 130, 109.9, 20)), Feature::closed_pocket, {2}, Pattern::contour_line);
  expect(planned(box(30, 30, 12, 130, 110, 20)), Feature::closed_pocket, {3}, Pattern::contour_line);
  expect(planned(box(30, 30, 12, 130, 79.9, 20)), Feature::closed_pocket, {1}, Pattern::contour_line);
}
TEST(OneFeature, OpenPocketHasTheLargestEndMill) {
  expect(planned(box(150, 100, 12, 201, 151, 20)), Feature::open_pocket, {3}, Pattern::scanning_line);
}
TEST(OneFeature, ClosedSlotHasAThirdOfItsWidth) {
  expect(planned(box(100, 60, 12, 201, 90, 20)), Feature::closed_slot, {2}, Pattern::scanning_line);
  expect(planned(box(100, 60, 12, 201, 107.9, 20)), Feature::closed_slot, {2}, Pattern::scanning_line);
  expect(planned(box(100, 60, 12, 201, 108, 20)), Feature::closed_slot, {3}, Pattern::scanning_line);
}
TEST(OneFeature, OpenSlotHasAThirdOfItsWidth) {
  expect(planned(box(-1, 60, 12, 201, 78, 20)), Feature::open_slot, {1}, Pattern::scanning_line);
  expect(planned(box(-1, 60, 12, 201, 89.9, 20)), Feature::open_slot, {1}, Pattern::scanning_line);
  expect(planned(box(-1, 60, 12, 201, 90, 20)), Feature::open_slot, {2}, Pattern::scanning_line);
}
TEST(OneFeature, FaceAndStepHaveTheLargestFaceMill) {
  expect(planned(box(-1, -1, 15, 201, 151, 21)), Feature::face, {6}, Pattern::scanning_line);
  expect(planned(box(-1, -1, 15, 201, 60, 21)), Feature::step, {6}, Pattern::scanning_line);
}
TEST(OneFeature, HolesHaveCentreDrillAndDrill) {
  expect(planned(tests::BlockHole{100, 75, 10, 0}), Feature::through_hole, {7, 8}, Pattern::drilling);
  expect(planned(tests::BlockHole{100, 75, 10, 6}), Feature::blind_hole, {7, 8}, Pattern::drilling);
}
TEST(OneFeature, FreeFormHasTheLargestBallEndMill) {
  TriangleSolid part = solid_of(box(0, 0, 0, 60, 40, 20));  // a wedge
  for (Vec3& p : part.points)
    if (p.z() > 10 && p.x() > 30) p.z() = 17;
  const Planned is = planned(removal_volume({.blank = solid_of(box(0, 0, 0, 60, 40, 20)), .part = part}));
  expect(is, Feature::free_form, {5, 5}, Pattern::scanning_line);
}

/// Features and tools in the order of table 4: face, closed pocket, open pocket, closed slots of two widths, free form,
/// hole. The free-form face is a pocket's floor here, and that pocket comes before it.
TEST(DemonstrationPart, HasThePublishedFeaturesToolsAndOrder) {
  Diagnostics diagnostics;
  const PlanResult result = make_plan(table_2(), diagnostics);
  const SetupPlan& setup = result.setups.at(0);
  EXPECT_NEAR(setup.removal.balance(), 0, 1e-3);
  for (const PlannedDivision& plan : setup.plans) {
    EXPECT_TRUE(plan.complete());
    std::vector<std::pair<std::string_view, int>> is;
    for (const PlanOperation& o : plan.operations) is.emplace_back(to_string(o.feature), o.tool);
    const std::vector<std::pair<std::string_view, int>> wanted{
        {"face", 6},        {"closed pocket", 2}, {"open pocket", 3},  {"closed pocket", 1},
        {"closed slot", 2}, {"closed slot", 2},   {"closed slot", 1},  {"closed slot", 1},
        {"free form", 5},   {"free form", 5},     {"through hole", 7}, {"through hole", 8}};
    EXPECT_EQ(is, wanted);
  }
}

}  // namespace
}  // namespace camber::plan
