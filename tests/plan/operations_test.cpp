#include "plan/planned_operations.h"

#include <map>

#include <gtest/gtest.h>

#include "plan/programs.h"
#include "plan/setup_plan.h"
#include "test_paths.h"
#include "tests/support/temp_folder.h"

namespace camber::plan {
namespace {

machine::Tool tool_of(int number, machine::ToolType type, double diameter_mm) {
  machine::Tool t;
  t.number = number;
  t.type = type;
  t.diameter_mm = diameter_mm;
  t.flutes = 4;
  t.overhang_mm = 100;
  return t;
}

/// The tools of the published experiment (table 2).
PlanTools experiment_tools() {
  using machine::ToolType;
  PlanTools out;
  const auto add = [&](int number, ToolType type, double d, ToolUse use) {
    out[number] = {tool_of(number, type, d), use, "carbide", true};
  };
  add(1, ToolType::flat, 6, ToolUse::end_mill);
  add(2, ToolType::flat, 10, ToolUse::end_mill);
  add(3, ToolType::flat, 16, ToolUse::end_mill);
  add(4, ToolType::ball, 6, ToolUse::ball_end_mill);
  add(5, ToolType::ball, 10, ToolUse::ball_end_mill);
  add(6, ToolType::flat, 80, ToolUse::face_mill);
  add(7, ToolType::drill, 3, ToolUse::center_drill);
  add(8, ToolType::drill, 10, ToolUse::drill);
  return out;
}

int picked(Feature feature, double width_mm) {
  std::string wanted;
  const auto pick = pick_mill({.feature = feature, .width_mm = width_mm, .depth_mm = 10}, experiment_tools(), wanted);
  return pick && pick->note.empty() ? pick->tool : 0;
}

TEST(Tools, HaveTheDiametersOfTheRules) {
  EXPECT_EQ(picked(Feature::closed_pocket, 50), 2);
  EXPECT_EQ(picked(Feature::closed_pocket, 79.9), 2);
  EXPECT_EQ(picked(Feature::closed_pocket, 80), 3);
  EXPECT_EQ(picked(Feature::closed_slot, 30), 2);
  EXPECT_EQ(picked(Feature::closed_slot, 47.9), 2);
  EXPECT_EQ(picked(Feature::open_slot, 18), 1);
  EXPECT_EQ(picked(Feature::closed_slot, 29.9), 1);
  EXPECT_EQ(picked(Feature::open_pocket, 20), 3);
  EXPECT_EQ(picked(Feature::face, 150), 6);
  EXPECT_EQ(picked(Feature::step, 20), 6);
  EXPECT_EQ(picked(Feature::free_form, 40), 5);
}

TEST(Tools, BreakARuleWithANote) {
  std::string wanted;
  const auto pick =
      pick_mill({.feature = Feature::closed_slot, .width_mm = 12, .depth_mm = 10}, experiment_tools(), wanted);
  ASSERT_TRUE(pick.has_value());
  EXPECT_EQ(pick->tool, 2);
  EXPECT_EQ(pick->note, "the rule asks for 4 mm or less");
}

TEST(Tools, AreWantedWhereNoneWillDo) {
  std::string wanted;
  EXPECT_FALSE(pick_mill({.feature = Feature::closed_slot, .width_mm = 5, .depth_mm = 10}, experiment_tools(), wanted));
  EXPECT_EQ(wanted, "an end mill of at most 1.667 mm that reaches 10 mm deep");
}

TEST(Tools, ReachWithFlutesShankAndHolder) {
  machine::Tool t = tool_of(1, machine::ToolType::flat, 6);
  const ToolNeed need{
      .feature = Feature::closed_pocket, .width_mm = 40, .depth_mm = 25, .wall_mm = [](double) { return 25.0; }};
  EXPECT_EQ(reach_fault(t, need), "");
  t.overhang_mm = 25.5;
  EXPECT_EQ(reach_fault(t, need), "its overhang of 25.5 mm is too short for a depth of 25 mm");
  t.overhang_mm = 60;
  t.flute_length_mm = 20;
  t.shank_diameter_mm = 10;
  EXPECT_EQ(reach_fault(t, need), "its shank of 10 mm meets a wall 25 mm high");
  t.shank_diameter_mm = 6;
  EXPECT_EQ(reach_fault(t, need), "");
  t.overhang_mm = 40;
  t.holder = {{20, 30, 30}};
  const ToolNeed below_a_wall{
      .feature = Feature::closed_pocket, .width_mm = 40, .depth_mm = 25, .wall_mm = [](double radius) {
        return radius > 12 ? 45.0 : 25.0;
      }};
  EXPECT_EQ(reach_fault(t, below_a_wall), "its holder of 30 mm meets a wall 45 mm high");
}

TEST(Tools, OfHolesAreCentreDrillAndDrill) {
  std::string wanted;
  const auto tools =
      pick_hole_tools({.feature = Feature::through_hole, .width_mm = 10, .depth_mm = 40}, experiment_tools(), wanted);
  ASSERT_TRUE(tools.has_value());
  EXPECT_EQ(tools->center_drill, 7);
  EXPECT_EQ(tools->drill, 8);
  EXPECT_FALSE(tools->reamer.has_value());
  const auto milled =
      pick_hole_tools({.feature = Feature::blind_hole, .width_mm = 24, .depth_mm = 20}, experiment_tools(), wanted);
  ASSERT_TRUE(milled.has_value());
  EXPECT_EQ(milled->end_mill, 3);
  EXPECT_FALSE(
      pick_hole_tools({.feature = Feature::blind_hole, .width_mm = 5, .depth_mm = 20}, experiment_tools(), wanted));
  EXPECT_EQ(wanted, "a drill of 5 mm that reaches 20 mm deep");
}

TEST(Tools, ReamWhereReamerAndItsDrillAreThere) {
  PlanTools tools = experiment_tools();
  tools[9] = {tool_of(9, machine::ToolType::drill, 9.8), ToolUse::drill};
  tools[10] = {tool_of(10, machine::ToolType::drill, 10), ToolUse::reamer};
  std::string wanted;
  const auto pick = pick_hole_tools({.feature = Feature::through_hole, .width_mm = 10, .depth_mm = 40}, tools, wanted);
  ASSERT_TRUE(pick.has_value());
  EXPECT_EQ(pick->drill, 9);
  EXPECT_EQ(pick->reamer, 10);
}

/// Published operations (table 4) whose depths and feed are complete.
TEST(RemovalRate, OfThePublishedOperations) {
  const PlanTools tools = experiment_tools();
  const auto rate = [&](int tool, double f, double rd, double ad) {
    Conditions c;
    c.feed_mm_per_min = f, c.radial_mm = rd, c.axial_mm = ad;
    return removal_rate_mm3_per_s(tools.at(tool), c);
  };
  EXPECT_NEAR(rate(6, 230, 8.0, 5.0), 153.3, 0.05);
  EXPECT_NEAR(rate(2, 346, 1.6, 3.8), 35.06, 0.005);
  EXPECT_NEAR(rate(3, 241, 4.5, 2.1), 37.96, 0.005);
  EXPECT_NEAR(rate(8, 100, 0, 0), kPi * 100 * 100 / 240, 1e-9);
}

TEST(BestPlan, IsThePublishedChoice) {
  EXPECT_EQ(best_plan({{true, 1806, 8, 0}, {true, 1786, 6, 0}, {true, 1805, 8, 0}}), 1U);
  EXPECT_EQ(best_plan({{false, 1000, 1, 0}, {true, 1786, 6, 0}, {true, 1786, 5, 0}}), 2U);
  EXPECT_EQ(best_plan({{true, 1786, 6, 0.02}, {true, 1786, 6, 0.01}}), 1U);
}

TEST(TotalTime, IsTheSumAndTheToolChanges) {
  std::vector<PlanOperation> operations;
  for (const int tool : {6, 2, 3, 2, 2, 1, 1, 5, 7, 8}) {
    PlanOperation o;
    o.tool = tool;
    o.nominal_time_s = 100;
    operations.push_back(o);
  }
  EXPECT_EQ(tool_changes(operations), 7);  // the published sequence; its table says 6
  EXPECT_DOUBLE_EQ(total_time_s(operations, 10), 1070);
}

class SamplePlan : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    Diagnostics diagnostics;
    input = new PlanInput(read_plan_input(CAMBER_SOURCE_DIR "/samples/15-plan/plan.toml", diagnostics));
    result = new PlanResult(make_plan(*input, diagnostics));
    warnings = diagnostics.warnings();
  }
  static void TearDownTestSuite() {
    delete result;
    delete input;
  }
  static PlanInput* input;
  static PlanResult* result;
  static std::size_t warnings;
};
PlanInput* SamplePlan::input = nullptr;
PlanResult* SamplePlan::result = nullptr;
std::size_t SamplePlan::warnings = 0;

TEST_F(SamplePlan, HasTheFeaturesAndToolsOfItsPart) {
  EXPECT_EQ(warnings, 0U);
  const SetupPlan& setup = result->setups.at(0);
  EXPECT_NEAR(setup.removal.balance(), 0, 1e-3);
  for (const PlannedDivision& p : setup.plans) {
    EXPECT_TRUE(p.complete());
    std::map<Feature, int> features;
    for (const Step& s : p.order.steps) ++features[s.feature];
    EXPECT_EQ(features[Feature::face], 1);
    EXPECT_EQ(features[Feature::closed_pocket], 1);
    EXPECT_EQ(features[Feature::free_form], 1);
    EXPECT_EQ(features[Feature::through_hole], 1);
    EXPECT_GE(features[Feature::closed_slot], 4);
    EXPECT_EQ(p.order.steps.front().feature, Feature::face);
    EXPECT_EQ(p.order.steps.back().feature, Feature::through_hole);
    for (const PlanOperation& o : p.operations) {
      const std::map<Feature, int> tools{
          {Feature::face, 6}, {Feature::closed_pocket, 2}, {Feature::open_pocket, 3}, {Feature::free_form, 5}};
      if (const auto rule = tools.find(o.feature); rule != tools.end()) {
        EXPECT_EQ(o.tool, rule->second);
      }
    }
    EXPECT_EQ(p.operations.back().tool, 8);
  }
}

TEST_F(SamplePlan, KeepsItsLimits) {
  for (const PlannedDivision& p : result->setups.at(0).plans)
    for (const PlanOperation& o : p.operations) {
      EXPECT_LE(o.conditions.loads.form_error_mm, 0.060 * 1.001) << o.tool;
      EXPECT_LE(o.conditions.spindle_rpm, 8000);
      EXPECT_FALSE(o.conditions.limit.empty());
    }
}

TEST_F(SamplePlan, ReadsItsTableBackUnchanged) {
  const tests::TempFolder folder;
  SetupPlan setup = result->setups[0];
  const std::string text = operations_toml(*input, setup, setup.best);
  const std::string path = folder.write("operations.toml", text);
  Diagnostics diagnostics;
  read_operations(path, *input, setup, diagnostics);
  EXPECT_EQ(diagnostics.all().size(), 0U);
  EXPECT_EQ(operations_toml(*input, setup, 0), text);
}

TEST_F(SamplePlan, DecidesAnewWhatATableLeavesOut) {
  const tests::TempFolder folder;
  SetupPlan setup = result->setups[0];
  const std::string path =
      folder.write("operations.toml",
                   "division = \"largest\"\n[[operation]]\nprimitive = 1\nkind = \"rough\"\n[[operation]]\nprimitive = "
                   "2\nkind = \"rough\"\n"
                   "tool = 1\n[[operation]]\nprimitive = 2\nkind = \"rough\"\nfeed_mm_per_min = 100\n");
  Diagnostics diagnostics;
  read_operations(path, *input, setup, diagnostics);
  const auto& rows = setup.plans.at(0).operations;
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].tool, 6);
  EXPECT_EQ(rows[1].tool, 1);
  EXPECT_GT(rows[1].conditions.spindle_rpm, rows[2].conditions.spindle_rpm);  // a smaller tool at the same speed
  EXPECT_EQ(rows[2].conditions.feed_mm_per_min, 100);
  EXPECT_EQ(rows[2].conditions.limit, "given");
}

TEST_F(SamplePlan, TellsWhatIsWrongInATable) {
  const tests::TempFolder folder;
  SetupPlan setup = result->setups[0];
  const std::string path = folder.write(
      "operations.toml", "division = \"largest\"\n[[operation]]\nprimitive = 1\nkind = \"rough\"\ntool = 99\n");
  Diagnostics diagnostics;
  try {
    read_operations(path, *input, setup, diagnostics);
    FAIL();
  } catch (const InputError& error) {
    const std::string text = to_string(error.diagnostics().at(0));
    EXPECT_EQ(text.substr(0, text.find('\n')),
              path + ":5:8: error: tool = 99, but there is no [tool.99] in " + input->path + " [tool-missing]");
  }
}

}  // namespace
}  // namespace camber::plan
