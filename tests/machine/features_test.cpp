#include "machine/features.h"

#include <gtest/gtest.h>

#include "machine/toml_table.h"
#include "tests/support/temp_folder.h"

namespace camber::machine {
namespace {

using tests::replaced;
using tests::TempFolder;

struct Result {
  std::vector<Feature> features;
  std::string messages;
};

/// Reads `text` as job.toml beside values.csv; messages name files without their folder.
Result read(const std::string& text, const std::string& csv = "feature,part,date,value_mm\nA,7,2026-11-03,4.01\n") {
  const TempFolder folder;
  folder.write("values.csv", csv);
  const std::string path = folder.write("job.toml", text);
  Result result;
  Diagnostics diagnostics;
  try {
    const auto file = read_toml(path, "a job", diagnostics);
    diagnostics.throw_if_errors();
    TomlTable top = TomlTable::top(*file, diagnostics);
    result.features = read_features(top, folder.path());
    top.finish();
    for (const auto& d : diagnostics.all()) result.messages += to_string(d) + "\n";
  } catch (const InputError& problem) {
    result.messages = problem.what();
  }
  result.messages = replaced(result.messages, folder.path() + "/", "");
  return result;
}

const std::string kBore = R"([[feature]]
name = "A"
kind = "bore"
axis_mm = [[1, 2, 0], [1, 2, -5]]
nominal_mm = 4.0
)";

TEST(Features, ReadsABoreWithEverything) {
  const auto [features, messages] = read(kBore + R"(tol_mm = [-0.01, 0.02]
depth_mm = 3
points = 8
filter = "max_inscribed"
tool = 5
arc_deg = [-90, 90]
align = true
measured_mm = [4.001, 4.003]
measured = "values.csv"
)");
  EXPECT_EQ(messages, "");
  ASSERT_EQ(features.size(), 1u);
  const Feature& f = features.front();
  EXPECT_EQ(f.name, "A");
  EXPECT_EQ(f.kind, FeatureKind::bore);
  EXPECT_EQ(f.axis_mm[1], Vec3(1, 2, -5));
  EXPECT_EQ(f.nominal_mm, 4);
  EXPECT_EQ((*f.tol_mm)[1], 0.02);
  EXPECT_EQ(f.depth_mm, 3);
  EXPECT_EQ(f.points, 8);
  EXPECT_EQ(f.filter, FeatureFilter::max_inscribed);
  EXPECT_EQ(f.tool, 5);
  EXPECT_NEAR((*f.arc_rad)[0], -kPi / 2, 1e-12);
  EXPECT_TRUE(f.align);
  ASSERT_EQ(f.measured.size(), 3u);
  EXPECT_EQ(f.measured[2].part, "7");
  EXPECT_EQ(f.measured[2].date, "2026-11-03");
  EXPECT_NEAR(*measured_mean_mm(f), (4.001 + 4.003 + 4.01) / 3, 1e-12);
  EXPECT_EQ(measured_mean_mm(f, "7"), 4.01);
  EXPECT_FALSE(measured_mean_mm(f, "8"));
}

TEST(Features, WrittenTextReadsTheSame) {
  const auto first = read(kBore + "tol_mm = [-0.01, 0.02]\narc_deg = [0, 180]\nmeasured_mm = [4.001]\n");
  const auto again = read(features_text(first.features, {}));
  EXPECT_EQ(again.messages, "");
  EXPECT_EQ(features_text(again.features, {}), features_text(first.features, {}));
}

/// A source line below a message, and the caret under its column.
std::string shown(const std::string& line, std::size_t column) {
  return "\n    " + line + "\n    " + std::string(column - 1, ' ') + "^\n";
}

TEST(Features, MissingKeysAreNamed) {
  const std::string line = shown("[[feature]]", 1);
  EXPECT_EQ(
      read("[[feature]]\nkind = \"bore\"\n").messages,
      "job.toml:1:1: error: name is missing in [[feature]]; a text in quotes was expected [key-missing]" + line +
          "job.toml:1:1: error: axis_mm is missing in [[feature]]; [[x, y, z], [x, y, z]], two points, was expected "
          "[key-missing]" +
          line +
          "job.toml:1:1: error: nominal_mm is missing in [[feature]]; a number greater than zero was expected "
          "[key-missing]" +
          line);
}

TEST(Features, EveryMistakeIsNamedAtItsPlace) {
  struct Case {
    std::string text, message;
  };
  const std::vector<Case> cases{
      {replaced(kBore, "[1, 2, -5]", "[1, 2, 0]"),
       "job.toml:4:11: error: the two points of axis_mm are the same; two different points were expected "
       "[feature-axis]" +
           shown("axis_mm = [[1, 2, 0], [1, 2, 0]]", 11)},
      {kBore + "tol_mm = [0.02, -0.01]\n",
       "job.toml:6:10: error: tol_mm = [0.02, -0.01]; the lower limit must be below the upper one [value-range]" +
           shown("tol_mm = [0.02, -0.01]", 10)},
      {kBore + "of = [\"A\", \"B\"]\n",
       "job.toml:6:1: error: of belongs to kind = \"distance\" alone [key-unused]" + shown("of = [\"A\", \"B\"]", 1)},
      {kBore + "measured = \"none.csv\"\n",
       "job.toml:6:12: error: measured: no such file: none.csv (paths are relative to the job's folder) "
       "[file-missing]" +
           shown("measured = \"none.csv\"", 12)},
      {kBore + kBore,
       "job.toml:7:8: error: two features are called \"A\"; different names were expected [feature-name]" +
           shown("name = \"A\"", 8)},
      {replaced(kBore, "\"bore\"", "\"wall\"") + "filter = \"max_inscribed\"\n",
       "job.toml:6:10: error: filter = \"max_inscribed\" is for kinds \"bore\" and \"boss\"; \"least_squares\" or "
       "\"min_zone\" was expected [feature-filter]" +
           shown("filter = \"max_inscribed\"", 10)},
  };
  for (const Case& c : cases) {
    EXPECT_EQ(read(c.text).messages, c.message);
  }
}

TEST(Features, ATableWithoutTheFeatureIsAWarning) {
  const auto [features, messages] = read(kBore + "measured = \"values.csv\"\n", "feature,value_mm\nB,4\n");
  EXPECT_EQ(messages, "job.toml:6:12: warning: values.csv has no value of \"A\" [feature-unmeasured]" +
                          shown("measured = \"values.csv\"", 12));
  EXPECT_TRUE(features.front().measured.empty());
}

TEST(Features, SizesFollowTheToolsDiameter) {
  Feature f;
  f.kind = FeatureKind::bore;
  EXPECT_EQ(f.size_per_diameter(), 1);
  f.kind = FeatureKind::wall;
  EXPECT_EQ(f.size_per_diameter(), -1);
  f.kind = FeatureKind::plane;
  f.axis_mm = {Vec3(0, 0, 0), Vec3(3, 0, 0)};
  EXPECT_EQ(f.size_per_diameter(), -0.5);
  f.axis_mm = {Vec3(0, 0, 0), Vec3(0, 0, 3)};
  EXPECT_EQ(f.size_per_diameter(), 0);
}

}  // namespace
}  // namespace camber::machine
