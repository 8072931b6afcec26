// camber study from the command line: what it refuses, word for word, and what it writes and does not write again.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/run_camber.h"

namespace camber {
namespace {

namespace fs = std::filesystem;
using tests::CamberRun;
using tests::replaced;
using tests::run_camber;
using tests::TempFolder;

const std::string kMachine =
    "[axis.x]\nacceleration_mm_per_s2 = 3000\n[axis.y]\nacceleration_mm_per_s2 = 3000\n[axis.z]\n"
    "acceleration_mm_per_s2 = 3000\n[spindle]\nmax_rpm = 12000\n";
const std::string kSlot =
    "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\nG0 X-6 Y0 Z5\nG0 Z-2\nG1 X4 F300 (slot)\nG0 Z5\nM30\n";
const std::string kJob =
    "program = \"p.nc\"\nmachine = \"machine.toml\"\n[tool.1]\ntype = \"flat\"\ndiameter_mm = 4.0\nflutes = 2\n"
    "overhang_mm = 15.0\n[material]\nktc_MPa = 800.0\nkrc_MPa "
    "= 250.0\nkte_N_per_mm = 5.0\nkre_N_per_mm = 5.0\n"
    "[stock]\nbox_mm = [[0, -3, -3], [4, 3, 0]]\n[simulation]\nvoxel_mm = 0.4\ncoupling = \"rigid\"\n";
const std::string kStudy = "job = \"../job.toml\"\n[grid]\ntool.1.overhang_mm = [15, 25]\nfeed_percent = [100, 200]\n";

void write_all(const TempFolder& folder, const std::string& study = kStudy) {
  folder.write("p.nc", kSlot);
  folder.write("job.toml", kJob);
  folder.write("machine.toml", kMachine);
  fs::create_directories(folder / "s");
  folder.write("s/study.toml", study);
}

/// Nothing is computed.
void expect_refused(const std::string& study, const std::string& message) {
  const TempFolder folder;
  write_all(folder, study);
  const CamberRun run = run_camber(folder, "study s/study.toml -o out");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err, message);
  EXPECT_EQ(run.out, "");
  EXPECT_FALSE(fs::exists(folder / "out/study.json"));
}

nlohmann::json table_in(const TempFolder& folder) {
  return nlohmann::json::parse(tests::file_text(folder / "out/study.json"));
}

TEST(StudyCommand, ComputesEveryCaseOnce) {
  const TempFolder folder;
  write_all(folder);
  std::string clamped = kJob;
  clamped.insert(clamped.find("[material]"), "root_stiffness_N_per_um = inf\n");
  folder.write("job.toml", clamped);
  const CamberRun run = run_camber(folder, "study s/study.toml -o out --json copy.json");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_NE(run.out.find("4 cases: 4 done, 0 doubtful, 0 open\n"), std::string::npos) << run.out;
  const auto table = table_in(folder);
  EXPECT_EQ(tests::file_text(folder / "copy.json"), tests::file_text(folder / "out/study.json"));
  ASSERT_EQ(table.at("cases").size(), 4u);
  const auto figure = [&](std::size_t i, const char* name) {
    return table.at("cases").at(i).at("results").at(name).get<double>();
  };
  EXPECT_EQ(table.at("cases").at(1).at("values"),
            nlohmann::json({{"tool.1.overhang_mm", 15.0}, {"feed_percent", 200.0}}));
  // Force does not know the overhang in rigid coupling, a cantilever from the holder to the load, about 2 mm above the
  // tip, does, and feed goes into force and time.
  EXPECT_DOUBLE_EQ(figure(0, "force_N.max"), figure(2, "force_N.max"));
  const auto bent = [](double overhang_mm) {  // fluted along 12 mm
    const double load = 2, in_flutes = std::pow(12 - load, 3);
    return in_flutes / std::pow(0.8, 4) + std::pow(overhang_mm - load, 3) - in_flutes;
  };
  EXPECT_NEAR(figure(2, "deflection_um.p95") / figure(0, "deflection_um.p95"), bent(25) / bent(15), 0.3);
  EXPECT_GT(figure(1, "force_N.max"), 1.2 * figure(0, "force_N.max"));
  EXPECT_LT(figure(1, "machine_time_s"), figure(0, "machine_time_s"));
  const std::string csv = tests::file_text(folder / "out/study.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')),
            "case,hash,state,tool.1.overhang_mm,feed_percent,machine_time_s,force_N.max,form_error_um.p95,"
            "form_error_um.min,form_error_um.max,deflection_um.p95");
  const std::string page = tests::file_text(folder / "out/study.html");
  for (const auto& one : table.at("cases"))
    EXPECT_NE(page.find("href=\"" + one.at("folder").get<std::string>() + "/report.html\""), std::string::npos);
  const std::string scaled =
      tests::file_text(folder / ("out/" + table.at("cases").at(1).at("folder").get<std::string>() + "/program.nc"));
  EXPECT_EQ(scaled, replaced(kSlot, "F300", "F600"));

  // Again: nothing is computed, and one more value computes its own cases alone.
  const auto written = [&] {
    std::map<std::string, fs::file_time_type> out;
    for (const auto& f : fs::recursive_directory_iterator(folder / "out/cases"))
      if (f.is_regular_file()) out[f.path().string()] = fs::last_write_time(f.path());
    return out;
  };
  const auto before = written();
  ASSERT_EQ(run_camber(folder, "study s/study.toml -o out").status, 0);
  EXPECT_EQ(written(), before);
  folder.write("s/study.toml", replaced(kStudy, "[15, 25]", "[15, 20, 25]"));
  const CamberRun list = run_camber(folder, "study s/study.toml -o out --list");
  EXPECT_EQ(std::ranges::count(list.out, '\n'), 2) << list.out;
  // The commands do the same as the study.
  const std::string commands = "cd '" + folder.path() + "' && PATH=\"$(dirname '" CAMBER_EXECUTABLE "'):$PATH\" sh -e";
  folder.write("commands.sh", list.out);
  ASSERT_EQ(std::system((commands + " commands.sh").c_str()), 0) << list.out;
  const CamberRun gathered = run_camber(folder, "study s/study.toml -o out --list");
  EXPECT_EQ(gathered.out, "");
  EXPECT_EQ(table_in(folder).at("open"), 0);
  for (const auto& [path, time] : before) EXPECT_EQ(fs::last_write_time(path), time) << path;
}

TEST(StudyCommand, SetsSeveralKeysTogether) {
  const TempFolder folder;
  write_all(
      folder,
      "job = \"../job.toml\"\ncommand = \"adapt\"\n[grid]\n\"tool.1\" = [{ diameter_mm = 4.0, flutes = 2 }, { "
      "diameter_mm = 3.0, flutes = 3 }]\nadapt = [{ limits = { force_N = 60.0 }, feed_mm_per_min = [50, 2000] }]\n");
  const CamberRun run = run_camber(folder, "study s/study.toml -o out --list");
  ASSERT_EQ(run.status, 0) << run.err;
  const auto table = table_in(folder);
  ASSERT_EQ(table.at("cases").size(), 2u);
  EXPECT_EQ(table.at("open"), 2);
  const std::string place = "out/" + table.at("cases").at(1).at("folder").get<std::string>();
  EXPECT_EQ(tests::file_text(folder / (place + "/job.toml")),
            "# A case of study.toml, made by camber study:\n# tool.1 = { diameter_mm = 3, flutes = 3 }\n"
            "# adapt = { limits = { force_N = 60 }, feed_mm_per_min = [50, 2000] }\n"
            "program = \"../../../p.nc\"\nmachine = \"../../../machine.toml\"\n\n[tool.1]\ntype = \"flat\"\n"
            "diameter_mm = 3\nflutes = 3\noverhang_mm = 15\n\n[material]\nktc_MPa = 800\nkrc_MPa = 250\n"
            "kte_N_per_mm = 5\nkre_N_per_mm = 5\n\n[stock]\nbox_mm = [[0, -3, -3], [4, 3, 0]]\n\n[simulation]\n"
            "voxel_mm = 0.4\ncoupling = \"rigid\"\n\n[adapt]\nfeed_mm_per_min = [50, 2000]\n\n[adapt.limits]\n"
            "force_N = 60\n");
  EXPECT_NE(run.out.find("camber -q adapt " + place + "/job.toml -o " + place + "/new.nc --report " + place +
                         "/report.html --json " + place + "/summary.json\n"),
            std::string::npos)
      << run.out;
}

TEST(StudyCommand, HashesFollowContentsNotPlaces) {
  const TempFolder folder;
  write_all(folder);
  ASSERT_EQ(run_camber(folder, "study s/study.toml -o out --list").status, 0);
  const auto first = table_in(folder).at("cases").at(0).at("hash");
  ASSERT_EQ(run_camber(folder, "study s/study.toml -o a/b/other --list").status, 0);
  EXPECT_EQ(nlohmann::json::parse(tests::file_text(folder / "a/b/other/study.json")).at("cases").at(0).at("hash"),
            first);
  folder.write("p.nc", replaced(kSlot, "(slot)", "(SLOT)"));
  ASSERT_EQ(run_camber(folder, "study s/study.toml -o out --list").status, 0);
  EXPECT_NE(table_in(folder).at("cases").at(0).at("hash"), first);
}

/// Feeds of lines that turn, of rotary axes alone and in inverse time; but turns in inverse time have no feed.
TEST(StudyCommand, ScalesFeedsOfProgramsWithRotaryAxes) {
  const std::string program =
      "G21 G90 G94 G17\nG10 L2 P1 X0 Y0 Z-300\nG10 L1 P1 R120\nT1 M6\nS3000 M3\nG54\nG0 X0 Y0 Z150\nA20 C0\n"
      "G0 G43.4 H1 X-6 Y0 Z5\nG1 Z-2 F300\nX4 A30 F500\nA20 F900\nG93 X-6 C30 F20\nC0 F30\nG94 G0 Z5\nM30\n";
  const TempFolder folder;
  write_all(folder, "job = \"../job.toml\"\n[grid]\nfeed_percent = [200]\n");
  folder.write("p.nc", program);
  std::string machine = tests::file_text(CAMBER_SOURCE_DIR "/samples/13-dome/machine.toml");
  machine.erase(machine.find("[[body]]"));
  folder.write("machine.toml", machine);
  const CamberRun run = run_camber(folder, "study s/study.toml -o out --list");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(
      run.err,
      "p.nc:14:0: warning: feed_percent = 200: the times (G93) of 1 moves of rotary axes alone stay as programmed "
      "[study-feed]\n");
  std::string scaled = program;
  for (const auto& [from, to] : {std::pair{"F300", "F600"}, {"F500", "F1000"}, {"F900", "F1800"}, {"F20", "F40"}})
    scaled = replaced(scaled, from, to);
  EXPECT_EQ(tests::file_text(
                folder / ("out/" + table_in(folder).at("cases").at(0).at("folder").get<std::string>() + "/program.nc")),
            scaled);
}

TEST(StudyCommand, OtherCasesGoOnWhenOneFails) {
  const TempFolder folder;
  write_all(folder, "job = \"../job.toml\"\n[grid]\nprogram = [\"../p.nc\", \"air.nc\"]\n");
  folder.write("s/air.nc", replaced(kSlot, "Z-2", "Z3"));
  const CamberRun run = run_camber(folder, "study s/study.toml -o out");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("air.nc"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("camber: error: 1 of 2 cases could not be computed; the same command tries them again\n"),
            std::string::npos);
  EXPECT_EQ(table_in(folder).at("cases").at(0).at("state"), "done");
  EXPECT_EQ(table_in(folder).at("cases").at(1).at("state"), "open");
}

TEST(StudyCommand, RefusesAStudyWithoutAGrid) {
  expect_refused("job = \"../job.toml\"\n",
                 "s/study.toml: error: grid is missing; a table of keys of the job, each with a list of values was "
                 "expected [key-missing]\n");
}

TEST(StudyCommand, RefusesAValueWithoutAList) {
  expect_refused("job = \"../job.toml\"\n[grid]\ntool.1.overhang_mm = 15\n",
                 "s/study.toml:3:22: error: tool.1.overhang_mm = 15: a list of one or more values was expected "
                 "[study-values]\n    tool.1.overhang_mm = 15\n                         ^\n");
}

TEST(StudyCommand, RefusesAJobThatIsNotThere) {
  expect_refused("job = \"none.toml\"\n[grid]\ntool.1.overhang_mm = [15]\n",
                 "s/study.toml:1:7: error: job: no such file: s/none.toml (paths are relative to the study's folder) "
                 "[file-missing]\n    job = \"none.toml\"\n          ^\n");
}

TEST(StudyCommand, RefusesACommandThatIsNone) {
  expect_refused(
      "job = \"../job.toml\"\ncommand = \"predikt\"\n[grid]\ntool.1.overhang_mm = [15]\n",
      "s/study.toml:2:11: error: command is \"predikt\"; \"predict\", \"compensate\" or \"adapt\" was expected "
      "[value-choice]\n    command = \"predikt\"\n              ^\n");
}

TEST(StudyCommand, RefusesFeedsThatAreNone) {
  expect_refused("job = \"../job.toml\"\n[grid]\nfeed_percent = [100, -5]\n",
                 "s/study.toml:3:16: error: feed_percent = -5: a number from 1 to 1000 was expected [value-range]\n"
                 "    feed_percent = [100, -5]\n                   ^\n");
}

TEST(StudyCommand, RefusesEqualCases) {
  expect_refused("job = \"../job.toml\"\n[grid]\ntool.1.overhang_mm = [15, 20, 15]\n",
                 "s/study.toml: error: cases 1 and 3 are the same; different values were expected [study-twice]\n");
}

TEST(StudyCommand, RefusesAKeyBelowOneThatIsNoTable) {
  expect_refused(
      "job = \"../job.toml\"\n[grid]\nprogram.name = [\"a\"]\n",
      "s/study.toml:3:16: error: program.name: the job has no table for this key; a dotted key of job.toml was "
      "expected [study-key]\n    program.name = [\"a\"]\n                   ^\n");
}

TEST(StudyCommand, FindsAWrongValueBeforeTheFirstCase) {
  const TempFolder folder;
  write_all(folder, "job = \"../job.toml\"\n[grid]\ntool.1.flutes = [2, 2.5]\n");
  const CamberRun run = run_camber(folder, "study s/study.toml -o out");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("/job.toml:9:10: error: flutes is 2.5; a whole number from 1 to 100 was expected"),
            std::string::npos)
      << run.err;
  EXPECT_FALSE(fs::exists(folder / "out/study.json"));
}

}  // namespace
}  // namespace camber
