// Tools that are kept once: `tools` and `from` in a job.
#include <gtest/gtest.h>

#include "machine/job_file.h"
#include "tests/support/temp_folder.h"

namespace camber::machine {
namespace {

using tests::replaced;

constexpr const char* kShop = R"([tool.17]
name = "wall finisher"
type = "flat"
diameter_mm = 8.0
flutes = 3
helix_deg = 30.0
overhang_mm = 40.0
root_stiffness_N_per_um = 20.0
[tool.18]
type = "ball"
diameter_mm = 6.0
flutes = 2
overhang_mm = 30.0
[tool.slotter]
type = "flat"
diameter_mm = 3.0
flutes = 2
overhang_mm = 12.0
)";

constexpr const char* kLibrary = R"({"data": [
  {"type": "bull nose end mill", "description": "Bull 10 R1", "unit": "millimeters", "BMC": "hss",
   "geometry": {"DC": 10, "RE": 1, "LCF": 22, "LB": 35, "NOF": 4, "SFDM": 10, "shoulder-diameter": 9.5,
                "shoulder-length": 30},
   "holder": {"unit": "millimeters", "segments": [{"height": 20, "lower-diameter": 28, "upper-diameter": 40}]},
   "post-process": {"number": 3}},
  {"type": "ball end mill", "description": "Ball 6", "unit": "millimeters", "geometry": {"DC": 6, "NOF": 2},
   "post-process": {"number": 4}},
  {"type": "ball end mill", "description": "Ball 4", "unit": "millimeters", "geometry": {"DC": 4, "NOF": 2},
   "post-process": {"number": 4}},
  {"type": "thread mill", "description": "M6", "unit": "millimeters", "geometry": {"DC": 4, "NOF": 3},
   "post-process": {"number": 5}}]})";

struct Result {
  Job job;
  std::string messages;
};

/// A job with these lines between its machine and its material.
Result read(const std::string& tools) {
  const tests::TempFolder folder;
  folder.write("p.nc", "G21\nM30\n");
  folder.write("machine.toml", "[spindle]\nmax_rpm = 12000\n");
  folder.write("shop.toml", kShop);
  folder.write("broken.toml", "[tool.1]\ntype = \"flat\"\ndiametre_mm = 3\nflutes = 0\noverhang_mm = 9\n");
  folder.write("lib.json", kLibrary);
  folder.write("bad.json", "{");
  const auto path = folder.write("job.toml", "program = \"p.nc\"\nmachine = \"machine.toml\"\n" + tools +
                                                 "[material]\nktc_MPa = 2000.0\nkrc_MPa = 700.0\n[stock]\nbox_mm = "
                                                 "[[0, 0, -20], [50, 40, 5]]\n");
  Result result;
  Diagnostics diagnostics;
  try {
    result.job = read_job(path, diagnostics);
    for (const auto& d : diagnostics.all()) result.messages += to_string(d) + "\n";
  } catch (const InputError& problem) {
    result.messages = problem.what();
  }
  result.messages = replaced(result.messages, folder.path() + "/", "");
  return result;
}

TEST(ToolShelf, GivesAToolByItsNumberOrName) {
  const auto [job, messages] = read(
      "tools = \"shop.toml\"\n[tool.1]\nfrom = 17\noverhang_mm = 36.0\n[tool.2]\nfrom = \"wall finisher\"\n"
      "[tool.3]\nfrom = \"slotter\"\n[tool.4]\ntype = \"ball\"\ndiameter_mm = 2.0\nflutes = 2\noverhang_mm = 9.0\n");
  EXPECT_EQ(messages, "");
  ASSERT_EQ(job.tools.size(), 4u);
  EXPECT_EQ(job.tools.at(1).number, 1);
  EXPECT_EQ(job.tools.at(1).type, ToolType::flat);
  EXPECT_EQ(job.tools.at(1).diameter_mm, 8);
  EXPECT_EQ(job.tools.at(1).flutes, 3);
  EXPECT_EQ(job.tools.at(1).root_stiffness_N_per_mm, 20000);
  EXPECT_EQ(job.tools.at(1).overhang_mm, 36) << "the job's own keys count";
  EXPECT_EQ(job.tools.at(2).overhang_mm, 40);
  EXPECT_EQ(job.tools.at(3).diameter_mm, 3);
  EXPECT_EQ(job.tools.at(4).diameter_mm, 2) << "a job may have tools of its own beside";
}

TEST(ToolShelf, TakesWhatALibraryTells) {
  const auto [job, messages] = read(
      "tools = \"lib.json\"\n[tool.1]\nfrom = 3\nhelix_deg = 40.0\n[tool.2]\nfrom = \"Ball 4\"\noverhang_mm = "
      "20.0\n");
  EXPECT_EQ(messages, "");
  const Tool& bull = job.tools.at(1);
  EXPECT_EQ(bull.type, ToolType::bull);
  EXPECT_EQ(bull.corner_radius_mm, 1);
  EXPECT_EQ(bull.flutes, 4);
  EXPECT_EQ(bull.overhang_mm, 35);
  EXPECT_EQ(bull.flute_length_mm, 22);
  EXPECT_EQ(bull.neck_diameter_mm, 9.5);
  EXPECT_EQ(bull.neck_length_mm, 8);
  EXPECT_EQ(bull.youngs_modulus_MPa, 210000);
  ASSERT_EQ(bull.holder.size(), 1u);
  EXPECT_EQ(bull.holder[0].upper_diameter_mm, 40);
  EXPECT_EQ(job.tools.at(2).diameter_mm, 4);
}

TEST(ToolShelf, AsksForWhatALibraryDoesNotTell) {
  EXPECT_EQ(read("tools = \"lib.json\"\n[tool.2]\nfrom = \"Ball 4\"\n").messages,
            "job.toml:4:1: error: overhang_mm is missing in [tool.2]; a number greater than zero was expected "
            "[key-missing]\n    [tool.2]\n    ^");
}

TEST(ToolShelf, NamesTheNearestToolsWhereOneIsMissing) {
  EXPECT_EQ(read("tools = \"shop.toml\"\n[tool.1]\nfrom = 16\n").messages,
            "job.toml:5:8: error: from = 16: shop.toml has no such tool; the nearest: 17 \"wall finisher\", 18 "
            "[tool-missing]\n    from = 16\n           ^");
  EXPECT_EQ(read("tools = \"shop.toml\"\n[tool.1]\nfrom = \"wall finishr\"\n").messages,
            "job.toml:5:8: error: from = \"wall finishr\": shop.toml has no such tool; the nearest: \"wall finisher\", "
            "\"slotter\" [tool-missing]\n    from = \"wall finishr\"\n           ^");
  EXPECT_EQ(
      read("tools = \"lib.json\"\n[tool.1]\nfrom = 4\n").messages,
      "job.toml:5:8: error: from = 4: lib.json has 2 different tools of this number (\"Ball 6\", \"Ball 4\"); one "
      "was expected [tool-missing]\n    from = 4\n           ^");
}

TEST(ToolShelf, SaysWhatIsWrongAtItsPlace) {
  EXPECT_EQ(read("[tool.1]\nfrom = 17\n").messages,
            "job.toml:4:1: error: from names a tool kept elsewhere, but no file: tools = \"shop.toml\" was expected at "
            "the top of the job [key-missing]\n    from = 17\n    ^");
  EXPECT_EQ(read("tools = \"none.toml\"\n[tool.1]\nfrom = 17\n").messages,
            "job.toml:3:9: error: tools: none.toml: no such file (paths are relative to the job's folder) "
            "[file-missing]\n    tools = \"none.toml\"\n            ^");
  EXPECT_EQ(read("tools = \"bad.json\"\n[tool.1]\nfrom = 17\n").messages.substr(0, 51),
            "bad.json:1:2: error: this is not JSON; a tool libra");
  // What stands in the shop's file is wrong there; what the job adds is wrong in the job.
  EXPECT_EQ(read("tools = \"broken.toml\"\n[tool.1]\nfrom = 1\noverhang_mm = -1\n").messages,
            "job.toml:4:1: error: diameter_mm is missing in [tool.1]; a number greater than zero was expected "
            "[key-missing]\n    [tool.1]\n    ^\n"
            "job.toml:6:15: error: overhang_mm is -1; a number greater than zero was expected [value-range]\n"
            "    overhang_mm = -1\n                  ^\n"
            "broken.toml:4:10: error: flutes is 0; a whole number from 1 to 100 was expected [value-range]\n"
            "    flutes = 0\n             ^\n"
            "broken.toml:3:1: error: unknown key diametre_mm in [tool.1]; did you mean diameter_mm? [key-unknown]\n"
            "    diametre_mm = 3\n    ^");
  EXPECT_EQ(read("tools = \"lib.json\"\n[tool.5]\nfrom = 5\noverhang_mm = 20.0\n").messages,
            "job.toml:4:1: error: type is missing in [tool.5]; \"ball\", \"flat\", \"bull\", \"drill\", "
            "\"tapered_ball\", \"chamfer\" or \"general\" was expected [key-missing]\n    [tool.5]\n    ^");
}

}  // namespace
}  // namespace camber::machine
