#include "machine/job_file.h"

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace camber::machine {
namespace {

using tests::replaced;
using tests::TempFolder;

constexpr std::string_view kJob = R"(program = "finish.nc"
machine = "machine.toml"
[tool.1]
type = "ball"
diameter_mm = 6.0
flutes = 2
overhang_mm = 40.0
[material]
ktc_MPa = 2000.0
krc_MPa = 700.0
[stock]
box_mm = [[0, 0, -20], [50, 40, 5]]
)";

struct Result {
  Job job;
  std::string messages;
};

/// Reads job.toml with `text` beside a program and a machine; messages name files without their folder.
Result read(std::string_view text) {
  const TempFolder folder;
  folder.write("finish.nc", "G21\nM30\n");
  folder.write("part.stl", "solid\n");
  folder.write("machine.toml", "[spindle]\nmax_rpm = 12000\n");
  const std::string path = folder.write("job.toml", text);
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

std::string with(std::string_view from, std::string_view to) {
  EXPECT_NE(kJob.find(from), std::string_view::npos) << from;
  return replaced(std::string(kJob), from, to);
}

std::string with_more(std::string_view lines) {
  std::string out(kJob);
  out.append(lines);
  return out;
}

TEST(JobReader, WhatIsWrittenIsNoTypicalValue) {
  const auto [job, messages] =
      read(with("overhang_mm = 40.0\n", "overhang_mm = 40.0\nroot_stiffness_N_per_um = inf\nflute_length_mm = 40\n"));
  EXPECT_EQ(messages, "");
  EXPECT_TRUE(job.tools.at(1).typical.empty());
  EXPECT_EQ(job.tools.at(1).root_stiffness_N_per_mm, kNoLimit);
  EXPECT_EQ(job.tools.at(1).typical_flute_mm, 0);
}

TEST(JobReader, ReadsTheSmallestJobWithDefaults) {
  const auto [job, messages] = read(kJob);
  EXPECT_EQ(messages, "");
  ASSERT_EQ(job.tools.count(1), 1u);
  EXPECT_EQ(job.tools.at(1).type, ToolType::ball);
  EXPECT_EQ(job.tools.at(1).number, 1);
  EXPECT_EQ(job.tools.at(1).flutes, 2);
  EXPECT_FALSE(job.tools.at(1).flute_length_mm);
  EXPECT_EQ(job.tools.at(1).root_stiffness_N_per_mm, 20000);
  EXPECT_EQ(job.tools.at(1).typical_flute_mm, 18);
  EXPECT_EQ(job.tools.at(1).typical,
            (std::vector<std::string>{"root_stiffness_N_per_um = 20", "flute_length_mm = 18"}));
  EXPECT_EQ(job.machine.spindle.max_rpm, 12000);
  EXPECT_EQ(job.material.ktc_MPa, 2000);
  EXPECT_EQ(job.stock.box->min_mm.z(), -20);
  EXPECT_EQ(job.stock.box->max_mm.x(), 50);
  EXPECT_EQ(job.stock.allowance_mm, 0);
  EXPECT_EQ(job.simulation.voxel_mm, 0.1);
  EXPECT_EQ(job.simulation.coupling, Coupling::static_);
  EXPECT_EQ(job.compensation.max_rounds, 8);
  EXPECT_FALSE(job.inch);
  EXPECT_NE(job.program.find("/finish.nc"), std::string::npos);
}

TEST(JobReader, ReadsEveryKeyInItsUnit) {
  const auto [job, messages] = read(R"(program = "finish.nc"
machine = "machine.toml"
units = "inch"
operations = { tools = [1, 2], blocks = [[120, 900], [1000, 1000]] }
[tool.1]
type = "ball"
diameter_mm = 6.0
flutes = 2
helix_deg = 30.0
overhang_mm = 40.0
flute_length_mm = 12
shank_diameter_mm = 8
effective_diameter_ratio = 0.75
youngs_modulus_GPa = 210.0
root_stiffness_N_per_um = 25
[tool.2]
type = "bull"
diameter_mm = 10
corner_radius_mm = 2
flutes = 4
overhang_mm = 50
[material]
ktc_MPa = 1
krc_MPa = 2
kac_MPa = -3
kte_N_per_mm = 4
kre_N_per_mm = 5
kae_N_per_mm = 6
[stock]
mesh = "part.stl"
allowance_mm = 0.2
[part]
mesh = "part.stl"
program = "finish.nc"
[simulation]
voxel_mm = 0.05
coupling = "rigid"
rotation_step_deg = 0.5
envelope_step_mm = 0.02
[compensation]
tolerance_um = 2
max_shift_mm = 0.05
max_rounds = 3
)");
  EXPECT_EQ(messages, "");
  EXPECT_EQ(job.inch, std::optional(true));
  EXPECT_EQ(job.operations.tools, (std::vector<int>{1, 2}));
  ASSERT_EQ(job.operations.blocks.size(), 2u);
  EXPECT_EQ(job.operations.blocks[0], (std::array<int, 2>{120, 900}));
  const Tool& ball = job.tools.at(1);
  EXPECT_DOUBLE_EQ(ball.helix_rad, kPi / 6);
  EXPECT_EQ(ball.flute_length_mm, std::optional(12.0));
  EXPECT_EQ(ball.shank_diameter_mm, 8);
  EXPECT_EQ(ball.effective_diameter_ratio, 0.75);
  EXPECT_EQ(ball.youngs_modulus_MPa, 210000);
  EXPECT_EQ(ball.root_stiffness_N_per_mm, 25000);
  EXPECT_EQ(job.tools.at(2).corner_radius_mm, 2);
  EXPECT_EQ(job.material.kac_MPa, -3);
  EXPECT_EQ(job.material.kae_N_per_mm, 6);
  EXPECT_FALSE(job.stock.box);
  EXPECT_EQ(job.stock.allowance_mm, 0.2);
  EXPECT_EQ(job.simulation.coupling, Coupling::rigid);
  EXPECT_DOUBLE_EQ(job.simulation.rotation_step_rad, kPi / 360);
  EXPECT_EQ(job.simulation.envelope_step_mm, 0.02);
  EXPECT_EQ(job.compensation.tolerance_um, 2);
  EXPECT_EQ(job.compensation.max_shift_mm, 0.05);
  EXPECT_EQ(job.compensation.max_rounds, 3);
}

TEST(JobReader, WritesTextThatReadsBack) {
  const TempFolder folder;
  folder.write("finish.nc", "M30\n");
  folder.write("machine.toml", "[spindle]\nmax_rpm = 12000\n");
  Diagnostics diagnostics;
  const Job job = read_job(folder.write("job.toml", with("flutes = 2", "flutes = 2\nhelix_deg = 30")), diagnostics);
  const std::string text = to_toml(job);
  const Job back = read_job(folder.write("again.toml", text), diagnostics);
  EXPECT_EQ(to_toml(back), text);
  EXPECT_EQ(back.tools.at(1).helix_rad, job.tools.at(1).helix_rad);
}

TEST(JobReader, ReadsOperationsOfTheTargetAndWhatIsJudged) {
  const TempFolder folder;
  folder.write("finish.nc", "M30\n");
  folder.write("machine.toml", "[spindle]\nmax_rpm = 12000\n");
  Diagnostics diagnostics;
  const std::string more =
      "[part]\nprogram = \"finish.nc\"\noperations = { comments = \"wall|floor\" }\n"
      "judged = { tools = [1], blocks = [[3, 9]] }\n[compensation]\noperations = { comments = \"wall\" }\n";
  const Job job = read_job(folder.write("job.toml", with_more(more)), diagnostics);
  ASSERT_TRUE(job.part.operations && job.part.judged);
  EXPECT_EQ(job.part.operations->comments, "wall|floor");
  EXPECT_EQ(job.part.judged->tools, std::vector<int>{1});
  EXPECT_EQ(job.part.judged->blocks, (std::vector<std::array<int, 2>>{{3, 9}}));
  EXPECT_EQ(job.compensation.operations.comments, "wall");
  EXPECT_FALSE(job.operations.given());
  const std::string text = to_toml(job);
  EXPECT_EQ(to_toml(read_job(folder.write("again.toml", text), diagnostics)), text);
  EXPECT_NE(read(with_more("[part]\njudged = { tools = [7] }\n")).messages.find("there is no [tool.7]"),
            std::string::npos);
}

TEST(JobReader, ReadsReferenceAndBand) {
  const Result result = read(with_more("[compensation]\nreference = \"machine\"\nprofile_um = [-5, 10]\n"));
  EXPECT_EQ(result.messages, "");
  const CompensationSettings& c = result.job.compensation;
  EXPECT_EQ(c.reference, Reference::machine);
  EXPECT_EQ(c.profile_um, (std::array<double, 2>{-5, 10}));
  EXPECT_EQ(c.depth_limit_um(), std::optional(5.0));
  EXPECT_EQ(c.half_width_um(), 7.5);
  const Result plain = read(with_more("[compensation]\nmax_overcut_um = 4\n"));
  EXPECT_EQ(plain.job.compensation.reference, Reference::commanded);
  EXPECT_EQ(plain.job.compensation.depth_limit_um(), std::optional(4.0)) << "the lower end of a band";
  EXPECT_FALSE(read(kJob).job.compensation.depth_limit_um());
  const Result back = read(replaced(replaced(to_toml(result.job), result.job.program, "finish.nc"),
                                    result.job.machine_path, "machine.toml"));
  EXPECT_EQ(back.messages, "") << "--effective-config reads back";
  EXPECT_EQ(back.job.compensation.profile_um, c.profile_um);
}

TEST(JobReader, ReadsLevers) {
  const Result result =
      read(with_more("[compensation]\nlevers = [\"feed\", \"shift\", \"passes\"]\nmin_feed_percent = 30\n"
                     "pass_allowance_mm = 0.03\n"));
  EXPECT_EQ(result.messages, "");
  EXPECT_TRUE(result.job.compensation.has(Lever::feed));
  EXPECT_TRUE(result.job.compensation.has(Lever::passes));
  EXPECT_EQ(result.job.compensation.min_feed_percent, 30);
  EXPECT_EQ(result.job.compensation.pass_allowance_mm, 0.03);
  EXPECT_TRUE(read(kJob).job.compensation.has(Lever::feed)) << "by default";
  EXPECT_FALSE(read(kJob).job.compensation.has(Lever::passes));
  EXPECT_FALSE(read(with_more("[compensation]\nlevers = [\"shift\"]\n")).job.compensation.has(Lever::feed));
  const Result back = read(replaced(replaced(to_toml(result.job), result.job.program, "finish.nc"),
                                    result.job.machine_path, "machine.toml"));
  EXPECT_EQ(back.messages, "");
  EXPECT_EQ(back.job.compensation.levers, result.job.compensation.levers);
  EXPECT_EQ(back.job.compensation.pass_allowance_mm, 0.03);
}

TEST(JobReader, ReadsGoalAndTimeBudget) {
  const CompensationSettings plain = read(kJob).job.compensation;
  EXPECT_EQ(plain.goal, Goal::best);
  EXPECT_FALSE(plain.time_budget_percent);
  const Result result = read(with_more("[compensation]\ngoal = \"tolerance\"\ntime_budget_percent = 0\n"));
  EXPECT_EQ(result.messages, "");
  EXPECT_EQ(result.job.compensation.goal, Goal::tolerance);
  EXPECT_EQ(result.job.compensation.time_budget_percent, std::optional(0.0));
  const Result back = read(replaced(replaced(to_toml(result.job), result.job.program, "finish.nc"),
                                    result.job.machine_path, "machine.toml"));
  EXPECT_EQ(back.messages, "");
  EXPECT_EQ(back.job.compensation.goal, Goal::tolerance);
  EXPECT_EQ(back.job.compensation.time_budget_percent, std::optional(0.0));
  EXPECT_TRUE(back.job.compensation.levers.empty()) << "levers by default stay so";
  EXPECT_EQ(read(with_more("[compensation]\ngoal = \"least\"\ntime_budget_percent = -1\n")).messages,
            "job.toml:14:8: error: goal is \"least\"; \"best\" or \"tolerance\" was expected [value-choice]\n"
            "    goal = \"least\"\n"
            "           ^\n"
            "job.toml:15:23: error: time_budget_percent is -1; a number from 0 to 1000 was expected [value-range]\n"
            "    time_budget_percent = -1\n"
            "                          ^");
}

TEST(JobReader, RefusesLeversThatAreNone) {
  EXPECT_EQ(read(with_more("[compensation]\nlevers = [\"shift\", \"speed\"]\n")).messages,
            "job.toml:14:10: error: levers names \"speed\"; a list of \"shift\", \"feed\", \"passes\" and "
            "\"allowance\" was expected "
            "[value-choice]\n"
            "    levers = [\"shift\", \"speed\"]\n"
            "             ^");
  EXPECT_EQ(read(with_more("[compensation]\nlevers = [\"feed\"]\n")).messages,
            "job.toml:14:10: error: levers does not name \"shift\", which every compensation needs; [\"shift\", "
            "\"feed\"] was expected [value-choice]\n"
            "    levers = [\"feed\"]\n"
            "             ^");
}

TEST(JobReader, RefusesBandsThatAreNone) {
  EXPECT_EQ(
      read(with_more("[compensation]\nprofile_um = [2, 10]\n")).messages,
      "job.toml:14:14: error: profile_um = [2, 10]; a lower end below zero (into the part) and an upper end above "
      "it were expected [value-range]\n"
      "    profile_um = [2, 10]\n"
      "                 ^");
  EXPECT_EQ(read(with_more("[compensation]\nmax_overcut_um = 3\nprofile_um = [-5, 10]\n")).messages,
            "job.toml:14:1: error: [compensation] has profile_um and max_overcut_um, which is its lower end; one of "
            "them was expected [profile]\n"
            "    max_overcut_um = 3\n"
            "    ^");
  EXPECT_NE(read(with_more("[compensation]\nreference = \"cam\"\n")).messages.find("commanded"), std::string::npos);
}

TEST(JobReader, NamesMissingFilesAtTheirKey) {
  EXPECT_EQ(
      read(with("finish.nc", "sub/../finsh.nc")).messages,
      "job.toml:1:11: error: program: no such file: finsh.nc (paths are relative to the job's folder) [file-missing]\n"
      "    program = \"sub/../finsh.nc\"\n"
      "              ^");
  EXPECT_EQ(
      read(with("\"machine.toml\"", "\"mill.toml\"")).messages,
      "job.toml:2:11: error: machine: no such file: mill.toml (paths are relative to the job's folder) [file-missing]\n"
      "    machine = \"mill.toml\"\n"
      "              ^");
  EXPECT_EQ(
      read(with("box_mm = [[0, 0, -20], [50, 40, 5]]", "mesh = \"blank.stl\"")).messages,
      "job.toml:12:8: error: mesh: no such file: blank.stl (paths are relative to the job's folder) [file-missing]\n"
      "    mesh = \"blank.stl\"\n"
      "           ^");
}

TEST(JobReader, ShowsTheMachinesErrorsInTheMachinesFile) {
  const TempFolder folder;
  folder.write("finish.nc", "M30\n");
  folder.write("machine.toml", "[spindle]\nmax_rpm = -1\n");
  Diagnostics diagnostics;
  try {
    read_job(folder.write("job.toml", kJob), diagnostics);
    FAIL();
  } catch (const InputError& problem) {
    EXPECT_EQ(replaced(problem.what(), folder.path() + "/", ""),
              "machine.toml:2:11: error: max_rpm is -1; a number greater than zero or inf was expected [value-range]\n"
              "    max_rpm = -1\n"
              "              ^");
  }
}

TEST(JobReader, AsksForWhatIsMissing) {
  EXPECT_EQ(
      read("units = \"mm\"\n").messages,
      "job.toml: error: program is missing; the path of a file, in quotes was expected [key-missing]\n"
      "job.toml: error: machine is missing; the path of a file, in quotes was expected [key-missing]\n"
      "job.toml: error: [tool.1] is missing; a table for each tool of the program was expected [key-missing]\n"
      "job.toml: error: [material] is missing; a table with the specific cutting forces ktc_MPa, krc_MPa ... "
      "was expected [key-missing]\n"
      "job.toml: error: [stock] is missing; a table with box_mm, cylinder, mesh or vdb was expected [key-missing]");
  EXPECT_EQ(read(with("diameter_mm = 6.0\n", "")).messages,
            "job.toml:3:1: error: diameter_mm is missing in [tool.1]; a number greater than zero was expected "
            "[key-missing]\n"
            "    [tool.1]\n"
            "    ^");
  EXPECT_EQ(read(with("krc_MPa = 700.0\n", "")).messages,
            "job.toml:8:1: error: krc_MPa is missing in [material]; a number of zero or more was expected "
            "[key-missing]\n"
            "    [material]\n"
            "    ^");
}

TEST(JobReader, RefusesToolsThatCannotBe) {
  EXPECT_EQ(read(with("diameter_mm = 6.0", "diameter_mm = 0")).messages,
            "job.toml:5:15: error: diameter_mm is 0; a number greater than zero was expected [value-range]\n"
            "    diameter_mm = 0\n"
            "                  ^");
  EXPECT_EQ(read(with("flutes = 2", "flutes = 2.5")).messages,
            "job.toml:6:10: error: flutes is 2.5; a whole number from 1 to 100 was expected [value-range]\n"
            "    flutes = 2.5\n"
            "             ^");
  EXPECT_EQ(read(with("flutes = 2", "flutes = 2\nflute_length_mm = 41")).messages,
            "job.toml:7:19: error: flute_length_mm is 41; at most the overhang, 40, was expected [tool-shape]\n"
            "    flute_length_mm = 41\n"
            "                      ^");
  EXPECT_EQ(read(with("flutes = 2", "flutes = 2\ncorner_radius_mm = 1")).messages,
            "job.toml:7:1: error: corner_radius_mm does not belong to type \"ball\"; it is for \"bull\" or \"general\" "
            "[key-unused]\n"
            "    corner_radius_mm = 1\n"
            "    ^");
  EXPECT_EQ(read(with("\"ball\"", "\"bull\"")).messages,
            "job.toml:3:1: error: corner_radius_mm is missing in [tool.1]; a number greater than zero was expected "
            "[key-missing]\n"
            "    [tool.1]\n"
            "    ^");
  EXPECT_EQ(read(with("\"ball\"", "\"bull\"\ncorner_radius_mm = 4")).messages,
            "job.toml:5:20: error: corner_radius_mm is 4; at most half the diameter, 3, was expected [tool-shape]\n"
            "    corner_radius_mm = 4\n"
            "                       ^");
  EXPECT_EQ(read(with("\"ball\"", "\"tapered\"")).messages,
            "job.toml:4:8: error: type is \"tapered\"; \"ball\", \"flat\", \"bull\", \"drill\", \"tapered_ball\", "
            "\"chamfer\" or \"general\" was expected "
            "[value-choice]\n"
            "    type = \"tapered\"\n"
            "           ^");
  EXPECT_EQ(read(with("overhang_mm = 40.0", "overhang_mm = 3")).messages,
            "job.toml:7:15: error: overhang_mm is 3; more than the rounded end, 3, was expected [tool-shape]\n"
            "    overhang_mm = 3\n"
            "                  ^");
  EXPECT_EQ(read(with("[tool.1]", "[tool.ball]")).messages,
            "job.toml:3:7: error: [tool.ball]: a tool number was expected, as in [tool.1] for T1 [tool-number]\n"
            "    [tool.ball]\n"
            "          ^");
}

TEST(JobReader, RefusesABoxInsideOut) {
  EXPECT_EQ(read(with("[50, 40, 5]", "[50, 0, 5]")).messages,
            "job.toml:12:10: error: box_mm goes from y = 0 to y = 0; the second must be greater than the first "
            "[stock-box]\n"
            "    box_mm = [[0, 0, -20], [50, 0, 5]]\n"
            "             ^");
  EXPECT_EQ(read(with("[50, 40, 5]", "[50, 40]")).messages,
            "job.toml:12:10: error: box_mm: [[x, y, z], [x, y, z]], two opposite corners, was expected "
            "[value-count]\n"
            "    box_mm = [[0, 0, -20], [50, 40]]\n"
            "             ^");
  EXPECT_EQ(read(with("[50, 40, 5]", "[50, nan, 5]")).messages,
            "job.toml:12:29: error: box_mm[1][1] is nan; a number was expected [value-range]\n"
            "    box_mm = [[0, 0, -20], [50, nan, 5]]\n"
            "                                ^");
  EXPECT_EQ(read(with("box_mm = [[0, 0, -20], [50, 40, 5]]", "allowance_mm = 0.2")).messages,
            "job.toml:11:1: error: box_mm is missing in [stock]; box_mm = [[x, y, z], [x, y, z]], cylinder, mesh or "
            "vdb was expected [key-missing]\n"
            "    [stock]\n"
            "    ^");
}

TEST(JobReader, RefusesOperationsOfToolsThatTheJobDoesNotHave) {
  EXPECT_EQ(
      read(with("machine = \"machine.toml\"", "machine = \"machine.toml\"\noperations = { tools = [9] }")).messages,
      "job.toml:3:24: error: operations name T9, but there is no [tool.9] [tool-missing]\n"
      "    operations = { tools = [9] }\n"
      "                           ^");
  EXPECT_EQ(read(with("machine = \"machine.toml\"", "machine = \"machine.toml\"\noperations = { blocks = [[9, 2]] }"))
                .messages,
            "job.toml:3:25: error: blocks go from line 9 to line 2; the first must not be greater [value-range]\n"
            "    operations = { blocks = [[9, 2]] }\n"
            "                            ^");
}

TEST(JobReader, RefusesUnknownAndWrongSimulationKeys) {
  EXPECT_EQ(read(with_more("[simulation]\nvoxel_mm = -0.1\nvoxels = 3\n")).messages,
            "job.toml:14:12: error: voxel_mm is -0.1; a number greater than zero was expected [value-range]\n"
            "    voxel_mm = -0.1\n"
            "               ^\n"
            "job.toml:15:1: error: unknown key voxels in [simulation]; did you mean voxel_mm? [key-unknown]\n"
            "    voxels = 3\n"
            "    ^");
  EXPECT_EQ(read(with_more("[compensation]\nmax_rounds = 0\n")).messages,
            "job.toml:14:14: error: max_rounds is 0; a whole number from 1 to 1000 was expected [value-range]\n"
            "    max_rounds = 0\n"
            "                 ^");
  EXPECT_EQ(read(with_more("[simulation]\ncoupling = \"loose\"\n")).messages,
            "job.toml:14:12: error: coupling is \"loose\"; \"rigid\" or \"static\" was expected [value-choice]\n"
            "    coupling = \"loose\"\n"
            "               ^");
}

TEST(JobReader, AShankStandsAboveTypicalFlutes) {
  const auto [job, messages] = read(with("flutes = 2", "flutes = 2\nshank_diameter_mm = 8"));
  EXPECT_EQ(messages, "");
  EXPECT_EQ(job.tools.at(1).typical_flute_mm, 18);
  EXPECT_EQ(job.tools.at(1).shank_diameter_mm, 8);
}

TEST(JobReader, WarnsOfAShankThatHasNoEffect) {
  const std::string tapered = with("flutes = 2", "flutes = 2\ntaper_deg = 3\nshank_diameter_mm = 6");
  EXPECT_EQ(read(replaced(tapered, "\"ball\"", "\"tapered_ball\"")).messages,
            "job.toml:8:21: warning: shank_diameter_mm has no effect: without flute_length_mm the whole overhang is "
            "fluted [tool-shape]\n"
            "    shank_diameter_mm = 6\n"
            "                        ^\n");
}

TEST(JobReader, RefusesAnEmptyJob) {
  EXPECT_EQ(read("").messages,
            "job.toml: error: the file is empty; a job description (program, machine, [tool.1], [material], [stock] "
            "...) was expected [file-empty]");
}

}  // namespace
}  // namespace camber::machine
