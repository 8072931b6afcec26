#include "plan/case_base.h"

#include <gtest/gtest.h>

#include "test_paths.h"
#include "tests/support/temp_folder.h"

namespace camber::plan {
namespace {

CaseBase sample_base() {
  Diagnostics diagnostics;
  return read_case_base(CAMBER_SOURCE_DIR "/samples/case_base.toml", diagnostics);
}

/// The content of the published experiment: FC250, carbide, coated, rough.
CaseContent fc250(const std::string& tool, double diameter_mm) {
  return {.material = "FC250", .tool = tool, .tool_material = "carbide", .coated = true, .diameter_mm = diameter_mm};
}

TEST(CaseBase, HoldsAboutAHundredCases) {
  const CaseBase base = sample_base();
  EXPECT_EQ(base.cases.size(), 104U);
  ASSERT_NE(base.group_of("S45C"), nullptr);
  EXPECT_EQ(base.group_of("S45C")->name, "steel");
  EXPECT_EQ(base.group_of("unobtainium"), nullptr);
}

TEST(Similarity, CountsEqualAttributesByWeight) {
  const CaseBase base = sample_base();
  const CaseContent a = fc250("end mill", 10);
  EXPECT_DOUBLE_EQ(similarity(base, a, a), 1);
  CaseContent b = a;
  b.material = "grey-iron";  // the same group
  EXPECT_DOUBLE_EQ(similarity(base, a, b), 0.8);
  b.material = "S45C";
  EXPECT_DOUBLE_EQ(similarity(base, a, b), 0.6);
  b.coated = false;
  EXPECT_DOUBLE_EQ(similarity(base, a, b), 0.5);
  b.tool = "face mill";
  EXPECT_EQ(similarity(base, a, b), 0);
  b = a;
  b.fast = true;
  EXPECT_EQ(similarity(base, a, b), 0);
}

TEST(ConditionsByCases, AreWithinTheSpreadOfTheNeighbours) {
  const CaseBase base = sample_base();
  const auto answer = conditions_by_cases(base, fc250("end mill", 10));
  ASSERT_TRUE(answer.has_value());
  EXPECT_TRUE(answer->similar);
  EXPECT_LE(answer->neighbours.size(), 5U);
  double low = 1e9, high = 0;
  for (const Neighbour& n : answer->neighbours) {
    low = std::min(low, n.speed_m_per_min);
    high = std::max(high, n.speed_m_per_min);
    EXPECT_GE(n.similarity, 0.7 - 1e-9);
  }
  EXPECT_GE(answer->speed_m_per_min, low);
  EXPECT_LE(answer->speed_m_per_min, high);
}

TEST(ConditionsByCases, TurnSpeedByTheGroupsAndFeedByTheDiameter) {
  CaseBase base;
  base.groups = {{"iron", {"FC250"}, 200, 870}, {"steel", {"S45C"}, 150, 400}};
  base.feed_exponent["end mill"] = 0.5;
  base.least_similarity = 0.5;
  base.cases.push_back({.content = {"S45C", "end mill", "carbide", true, false, false, 10},
                        .speed_m_per_min = 90,
                        .feed_mm_per_min = 300,
                        .axial_depth_mm = 4,
                        .radial_depth_mm = 2});
  const double per_turn = *base.cases[0].feed_per_turn_mm();
  const auto answer = conditions_by_cases(base, fc250("end mill", 40));
  ASSERT_TRUE(answer.has_value());
  EXPECT_NEAR(answer->speed_m_per_min, 90 * 200 / 150.0, 1e-9);
  EXPECT_NEAR(answer->feed_per_turn_mm, 2 * per_turn, 1e-9);
  EXPECT_NEAR(answer->axial_depth_mm, 16, 1e-9);
  EXPECT_NEAR(answer->radial_depth_mm, 8, 1e-9);
}

TEST(ConditionsByCases, ChangeWithANewCase) {
  CaseBase base = sample_base();
  const CaseContent query = fc250("end mill", 10);
  const double before = conditions_by_cases(base, query)->speed_m_per_min;
  Case job{.content = query, .speed_m_per_min = 1.5 * before, .feed_mm_per_min = 500};
  base.cases.push_back(job);
  const double after = conditions_by_cases(base, query)->speed_m_per_min;
  EXPECT_GT(after, before * 1.01);
}

TEST(ConditionsByCases, HaveNoneForAToolThatNoCaseKnows) {
  EXPECT_FALSE(conditions_by_cases(sample_base(), fc250("broach", 10)).has_value());
}

TEST(LeaveOneOut, AsksEachCaseOfTheOthers) {
  const CaseBase base = sample_base();
  const auto rows = leave_one_out(base);
  EXPECT_GT(rows.size(), 90U);
  CaseBase twice = base;  // with a twin of each case, of the best neighbours at least one is exact
  twice.most_cases = 1;
  twice.cases.insert(twice.cases.end(), base.cases.begin(), base.cases.end());
  std::size_t exact = 0;
  for (const LeftOut& row : leave_one_out(twice))
    if (std::abs(row.speed_ratio - 1) < 1e-9) ++exact;
  EXPECT_GT(exact, 150U);
}

TEST(CaseReader, ReadsBackWhatItWrites) {
  const tests::TempFolder folder;
  const Case c{.content = {"FC250", "end mill", "carbide", true, true, false, 12.5},
               .speed_m_per_min = 80,
               .feed_mm_per_min = 321.5,
               .axial_depth_mm = 3};
  folder.write("cases.toml", to_toml(c));
  Diagnostics diagnostics;
  const CaseBase base = read_case_base(folder / "cases.toml", diagnostics);
  ASSERT_EQ(base.cases.size(), 1U);
  EXPECT_EQ(to_toml(base.cases[0]), to_toml(c));
}

TEST(CaseReader, TellsWhatIsWrong) {
  const tests::TempFolder folder;
  folder.write("cases.toml",
               "[[case]]\nmaterial = \"FC250\"\ntool = \"end mill\"\ntool_material = \"carbide\"\n"
               "diameter_mm = 10\nspeed_m_per_min = 0\nfinish = \"smooth\"\n");
  Diagnostics diagnostics;
  read_case_base(folder / "cases.toml", diagnostics);
  ASSERT_EQ(diagnostics.all().size(), 2U);
  const std::string path = folder / "cases.toml";
  EXPECT_EQ(to_string(diagnostics.all()[0]).substr(0, to_string(diagnostics.all()[0]).find('\n')),
            path + ":7:10: error: finish is \"smooth\"; \"rough\" or \"fine\" was expected [value-choice]");
  EXPECT_EQ(to_string(diagnostics.all()[1]).substr(0, to_string(diagnostics.all()[1]).find('\n')),
            path + ":6:19: error: speed_m_per_min is 0; a number greater than zero was expected [value-range]");
}

}  // namespace
}  // namespace camber::plan
