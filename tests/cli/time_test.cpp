// camber time as a user runs it.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/run_camber.h"

namespace camber {
namespace {

using nlohmann::json;
using tests::file_text;
using tests::run_camber;
using tests::TempFolder;

constexpr const char* kMachine = R"([control]
corner = { law = "exact_stop" }
[axis.x]
max_velocity_mm_per_min = 30000
acceleration_mm_per_s2 = 1000
[axis.y]
max_velocity_mm_per_min = 30000
acceleration_mm_per_s2 = 1000
[axis.z]
max_velocity_mm_per_min = 30000
acceleration_mm_per_s2 = 1000
[cycle]
m_code_s = 0.5
[tool_change]
chip_to_chip_s = 4
)";
constexpr const char* kProgram = "G21 G90\nT1 M6\nS1000 M3\nG0 X0 Y0 Z50\nG1 X100 F6000\nM8\nG4 P2000\nG1 Y100\nM30\n";

struct Files {
  TempFolder folder;
  Files() {
    folder.write("m.toml", kMachine);
    folder.write("p.nc", kProgram);
  }
};

TEST(Time, PrintsAndWritesTheSameFigures) {
  const Files f;
  const auto run = run_camber(f.folder, "time p.nc --machine m.toml --json r.json --report r.html");
  ASSERT_EQ(run.status, 0) << run.err;
  const json r = json::parse(file_text(f.folder / "r.json"));
  EXPECT_NEAR(r["cutting_s"], 2 * (1 + 0.1), 0.01);  // 100 mm at 100 mm/s, 1000 mm/s2; and the control's periods
  EXPECT_EQ(r["tool_change_s"], 4.0);
  EXPECT_EQ(r["m_code_s"], 1.5);
  EXPECT_EQ(r["dwell_s"], 2.0);
  double sum = 0;
  for (const char* key : {"cutting_s", "positioning_s", "spindle_s", "tool_change_s", "m_code_s", "dwell_s"})
    sum += r[key].get<double>();
  EXPECT_NEAR(r["total_s"], sum, 1e-9);
  EXPECT_EQ(r["dominant"], "tool_change_s");
  EXPECT_NEAR(r["commanded_feed_mm_per_min"], 6000, 1e-6);
  EXPECT_NEAR(r["k"], 0.1, 1e-9);
  EXPECT_NEAR(r["e"], 1 / 1.1, 0.005);
  EXPECT_EQ(r["distances"]["g01"]["moves"], 2);
  EXPECT_EQ(r["tools"].back()["tool"], 1);
  EXPECT_NE(run.out.find("tool change           4.0 s"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("tool change takes"), std::string::npos) << run.out;
  const std::string page = file_text(f.folder / "r.html");
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_EQ(page.find("http:"), std::string::npos);  // opens without a network
  EXPECT_EQ(page.find("https:"), std::string::npos);
}

TEST(Time, SweepsTheGrid) {
  const Files f;
  const auto run = run_camber(f.folder,
                              "time p.nc --machine m.toml --sweep axis.all.acceleration_mm_per_s2=500:2000:4 "
                              "--sweep cycle.feed_override_percent=50:150:3 --json r.json --report r.html");
  ASSERT_EQ(run.status, 0) << run.err;
  const json r = json::parse(file_text(f.folder / "r.json"));
  ASSERT_EQ(r["sweep"].size(), 12u);
  EXPECT_EQ(r["sweep"][1]["values"]["axis.all.acceleration_mm_per_s2"], 500);
  EXPECT_EQ(r["sweep"][1]["values"]["cycle.feed_override_percent"], 100);
  for (std::size_t i = 3; i < 12; ++i) EXPECT_LT(r["sweep"][i]["cutting_s"], r["sweep"][i - 3]["cutting_s"]);
  EXPECT_NE(file_text(f.folder / "r.html").find("<polyline"), std::string::npos);
}

TEST(Time, SetsCasesSideBySide) {
  const Files f;
  f.folder.write("cases.toml",
                 "[case.1]\nmachine = \"m.toml\"\n[case.2]\ntitle = \"fast change\"\nmachine = \"m.toml\"\n"
                 "set = { \"tool_change.chip_to_chip_s\" = 1.5 }\n");
  const auto run = run_camber(f.folder, "time p.nc --case cases.toml --json r.json");
  ASSERT_EQ(run.status, 0) << run.err;
  const json r = json::parse(file_text(f.folder / "r.json"));
  EXPECT_EQ(r["cases"][1]["name"], "2: fast change");
  EXPECT_NEAR(r["cases"][0]["total_s"].get<double>() - r["cases"][1]["total_s"].get<double>(), 2.5, 1e-9);
}

TEST(Time, AgreesWithFeedWhereOnlyTheAxesCount) {
  const Files f;
  f.folder.write("l.toml", std::string("control.dialect = \"linuxcnc\"\n") +
                               "[axis.x]\nmax_velocity_mm_per_min = 9000\nacceleration_mm_per_s2 = 600\n");
  f.folder.write("q.nc", "G21\nG0 X0 Y0 Z0\nG0 X30\nG64 P0.01\nG1 X60 F3000\nX90 F1000\nG4 P1\nX0\nM2\n");
  ASSERT_EQ(run_camber(f.folder, "time q.nc --machine l.toml --json t.json").status, 0);
  ASSERT_EQ(run_camber(f.folder, "feed q.nc --machine l.toml --json f.json").status, 0);
  const json t = json::parse(file_text(f.folder / "t.json")), feed = json::parse(file_text(f.folder / "f.json"));
  EXPECT_NEAR(t["total_s"], feed["time_s"], 1e-9);
}

TEST(Time, TellsWhatIsWrong) {
  const Files f;
  EXPECT_EQ(run_camber(f.folder, "time p.nc").err,
            "time: --machine M.toml or --case cases.toml was expected\nRun with --help for more information.\n");
  EXPECT_EQ(run_camber(f.folder, "time p.nc").status, 2);
  auto run = run_camber(f.folder, "time p.nc --machine m.toml --sweep axis.x.wheel=1:2:3");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err.substr(0, 70), "m.toml: error: --sweep: axis.x.wheel is not a machine parameter; a key");
  run = run_camber(f.folder, "time p.nc --machine m.toml --sweep axis.x.acceleration_mm_per_s2=1:2");
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.err,
            "--sweep: axis.x.acceleration_mm_per_s2=1:2: KEY=FROM:TO:N was expected, as in "
            "axis.x.acceleration_mm_per_s2=3500:15000:4\nRun with --help for more information.\n");
}

TEST(Time, SaysThatTheReferencePointIsNotKnown) {
  const Files f;
  f.folder.write("q.nc", "G21 G90\nG0 X0 Y0 Z50\nG91 G28 Z0\nG90 G0 Z50\nM30\n");
  const auto run = run_camber(f.folder, "time q.nc --machine m.toml");
  EXPECT_EQ(run.status, 0);
  EXPECT_NE(run.out.find("moves to or from the reference point: its position is not known (x_mm, y_mm, z_mm of "
                         "[tool_change] in the machine file)"),
            std::string::npos)
      << run.out;
}

}  // namespace
}  // namespace camber
