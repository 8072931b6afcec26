// predict, compensate and adapt on programs with rotary motion, as a user runs them.
#include <cmath>
#include <regex>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "base/geometry.h"
#include "base/units.h"
#include "tests/support/csv_columns.h"
#include "tests/support/open_page.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::columns_of;
using tests::run_camber;
using tests::TempFolder;

const std::string kStart = "G21 G90 G94\nG10 L2 P1 X0 Y0 Z-300.\nG10 L1 P1 R120.\nT1 M6\nS6000 M3\nG54\n";

/// The machine of sample 13, with the program's tool on a plate; `bodies`: of the machine file.
void write_job(const TempFolder& folder, const std::string& program, const std::string& bodies = {}) {
  std::string machine = tests::file_text(CAMBER_SOURCE_DIR "/samples/13-dome/machine.toml");
  machine.erase(machine.find("[[body]]"));
  folder.write("machine.toml", machine + bodies);
  folder.write("p.nc", program);
  folder.write("job.toml", R"(program = "p.nc"
machine = "machine.toml"
[tool.1]
type = "ball"
diameter_mm = 6.0
flutes = 2
overhang_mm = 30.0
root_stiffness_N_per_um = inf
holder_mm = [[32, 32, 60]]
[material]
ktc_MPa = 2000.0
krc_MPa = 700.0
[stock]
box_mm = [[0, 0, -1], [3, 2, 0]]
[simulation]
voxel_mm = 0.2
coupling = "rigid"
)");
}

/// Three rows along X by a ball that leans ahead (C90 puts the tilt of A into X), its lowest point at `z`.
std::string rows(double z = -0.2, int lead_deg = 20) {
  const double lead = rad_from_deg(lead_deg);
  const Vec3 axis(std::sin(lead), 0, std::cos(lead)), tip = Vec3(0, 0, 3 + z) - 3 * axis;
  const std::string angles = fmt::format("A{}. C{}.", std::abs(lead_deg), lead_deg < 0 ? -90 : 90);
  std::string text = kStart + "G0 X0 Y0 Z150.\n" + angles + "\n";
  bool first = true;
  for (const double y : {0.5, 1.0, 1.5}) {
    text += fmt::format("G0 {}X{:.4f} Y{:.4f} Z{:.4f}\n", first ? "G43.4 H1 " : "", tip.x() - 5, y, tip.z() + 5);
    text += fmt::format("G1 Z{:.4f} F300\nX{:.4f} {} F1200\nG0 Z{:.4f}\n", tip.z(), tip.x() + 7, angles, tip.z() + 5);
    first = false;
  }
  return text + "G0 Z100.\nM30\n";
}

TEST(PredictFiveAxes, WritesJointsPosesAndAxialForces) {
  const TempFolder folder;
  write_job(folder, rows());
  const auto run = run_camber(folder, "predict job.toml -o result");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const std::string forces = tests::file_text(folder / "result/forces.csv");
  EXPECT_NE(forces.find(",specific_energy_MPa,valid,chatter_margin,chatter_Hz,f_axial_max_N"), std::string::npos);
  const auto feed = columns_of(tests::file_text(folder / "result/feed.csv"));
  const auto &a = feed.at("a_deg"), &c = feed.at("c_deg"), &x = feed.at("axis_x"), &tip = feed.at("tip_z_mm");
  EXPECT_NEAR(a.back(), 20, 1e-3);
  EXPECT_NEAR(c.back(), 90, 1e-3);
  EXPECT_NEAR(x.back(), std::sin(rad_from_deg(20)), 1e-4);
  EXPECT_NEAR(*std::ranges::min_element(tip), 3 - 0.2 - 3 * std::cos(rad_from_deg(20)), 1e-3);
  // Forces in the part's axes: the tool leans back along X, so that its axial force shows there.
  const auto loads = columns_of(forces);
  double axial = 0;
  for (const double n : loads.at("f_axial_max_N")) axial = std::max(axial, std::abs(n));
  EXPECT_GT(axial, 1);
  const std::string page = tests::file_text(folder / "result/report.html");
  EXPECT_NE(page.find("\"chain\""), std::string::npos);
}

TEST(PredictFiveAxes, SaysWhatIsMissing) {
  const TempFolder folder;
  const auto error_of = [&](const std::string& program, const std::string& command = "predict job.toml -o result") {
    write_job(folder, program);
    const auto run = run_camber(folder, command);
    EXPECT_EQ(run.status, 1) << run.err;
    return run.err;
  };
  std::string text = rows();
  text.erase(text.find("G10 L2"), text.find("G10 L1") - text.find("G10 L2"));
  EXPECT_EQ(error_of(text),
            "p.nc:7:1: error: where the tool is on the part depends on the work offset, which is not known; G10 L2 in "
            "the program or [compensation] work_offset_mm (of G54) in the job was expected [work-offset]\n"
            "    A20. C90.\n    ^\n");
  text = rows();
  text.erase(text.find("G10 L1"), text.find("T1 M6") - text.find("G10 L1"));
  EXPECT_EQ(error_of(text),
            "p.nc:8:1: error: where the tool is on the part depends on the length of tool T1, which is not known; its "
            "value (G10 L1) in the program was expected [tool-length]\n"
            "    G0 G43.4 H1 X-6.0261 Y0.5000 Z4.9809\n    ^\n");
  EXPECT_EQ(error_of(kStart + "G0 X0 Y0 Z150.\nA20. C90.\nG43 H1\nG0 X0 Y0 Z50.\nG2 X4. Y4. I4. J0 C100. F100\nM30\n"),
            "p.nc:11:1: error: this arc is none on the part, as rotary axes turn it; lines, or tool-centre-point "
            "control, were expected [not-read]\n    G2 X4. Y4. I4. J0 C100. F100\n    ^\n");
  write_job(folder, rows());
  folder.write("adapt.toml", tests::file_text(folder / "job.toml") +
                                 "[adapt]\nfeed_mm_per_min = [300, 3000]\nlevers = [\"feed\", \"speed\"]\n"
                                 "limits = { force_N = 50.0, chatter_margin = 0.8 }\n");
  EXPECT_NE(error_of(rows(), "adapt adapt.toml -o out.nc")
                .find("p.nc:8:1: error: chatter_margin in [adapt] limits changes spindle speeds, but rotary axes turn "
                      "here; a program of X, Y and Z alone was expected [rotary-motion]\n    A20. C90.\n    ^\n"),
            std::string::npos);
}

/// The tip of a ball that leans back by 35 degrees stays above the plate, which its side cuts.
TEST(PredictFiveAxes, ATiltedBallReachesDownPastItsTip) {
  const TempFolder folder;
  write_job(folder, rows(-0.2, -35));
  const auto run = run_camber(folder, "predict job.toml -o result --json r.json");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_GT(nlohmann::json::parse(tests::file_text(folder / "r.json"))["removed_mm3"]["stock"], 0.3);
}

/// Under tool-centre-point control and with words A0 C0, against the same program on three axes: the same bytes.
TEST(PredictFiveAxes, WithoutTiltTheBytesAreThoseOfThreeAxes) {
  const TempFolder folder;
  const auto program = [](const std::string& on, const std::string& angles) {
    std::string text = kStart + "G0 X-6 Y0.5 Z30\n" + on + " H1 Z5" + angles + "\n";
    for (const double y : {0.5, 1.0, 1.5})
      text += fmt::format("G0 X-6 Y{:.4f}\nG1 Z-0.2 F300\nX7 Z-0.15{} F1200\nG0 Z5\n", y, angles);
    return text + "G49\nM30\n";
  };
  const auto outputs_of = [&](const std::string& text) {
    write_job(folder, text);
    const auto run = run_camber(folder, "predict job.toml -o result");
    EXPECT_EQ(run.status, 0) << run.err;
    std::string out;
    for (const char* name : {"feed.csv", "forces.csv", "form_error.csv", "form_error.vtp", "stock.vdb"})
      out += tests::file_text(folder / ("result/" + std::string(name)));
    auto summary = nlohmann::json::parse(tests::file_text(folder / "result/summary.json"));
    summary.erase("compute_s");
    return out + summary.dump();
  };
  EXPECT_EQ(outputs_of(program("G43.4", " A0 C0")), outputs_of(program("G43", "")));
}

/// The work offset of the job is that of G54.
TEST(PredictFiveAxes, TakesTheWorkOffsetOfTheJob) {
  const TempFolder folder;
  write_job(folder, rows());
  ASSERT_EQ(run_camber(folder, "predict job.toml -o one").status, 0);
  std::string text = rows();
  text.replace(text.find("G10 L2 P1 X0 Y0 Z-300."), 22, "(IN THE JOB)");
  write_job(folder, text);
  folder.write("job.toml", tests::file_text(folder / "job.toml") + "[compensation]\nwork_offset_mm = [0, 0, -300]\n");
  const auto run = run_camber(folder, "predict job.toml -o two");
  ASSERT_EQ(run.status, 0) << run.err;
  for (const char* name : {"forces.csv", "feed.csv", "form_error.csv"})
    EXPECT_EQ(tests::file_text(folder / ("one/" + std::string(name))),
              tests::file_text(folder / ("two/" + std::string(name))));
}

/// The holder's rim, 30 mm up the tool and 16 mm wide, comes down to z = tip + 30 cos A - 16 sin A.
std::string over_the_stock(double clearance) {
  const double tilt = rad_from_deg(70), rim = 30 * std::cos(tilt) - 16 * std::sin(tilt);
  // The rim's lowest point is 30 sin A + 16 cos A towards the spindle; C90 leans the tool along X.
  const double x = 1.5 - 30 * std::sin(tilt) - 16 * std::cos(tilt), z = clearance - rim;
  return fmt::format("G0 Z100.\nG0 A70. C90.\nG0 X{0:.4f} Y-20. Z{1:.4f}\nG1 Y20. F3000\nG0 Z100.\nM30\n", x, z);
}

TEST(PredictFiveAxes, NamesTheLineOfACollision) {
  const TempFolder folder;
  const std::string program = rows().substr(0, rows().find("G0 Z100.\nM30"));
  const auto line = 1 + std::ranges::count(program, '\n') + 3;
  write_job(folder, program + over_the_stock(0.1));
  const auto misses = run_camber(folder, "predict job.toml -o result");
  EXPECT_EQ(misses.status, 0) << misses.err;
  EXPECT_EQ(misses.err, "");
  write_job(folder, program + over_the_stock(-0.5));
  const auto hits = run_camber(folder, "predict job.toml -o result");
  EXPECT_EQ(hits.status, 1);
  EXPECT_EQ(hits.err.find(fmt::format("p.nc:{}:1: error: the holder of T1 in stock at X", line)), 0u) << hits.err;
  EXPECT_NE(hits.err.find("a longer overhang or less depth was expected [collision-holder]"), std::string::npos);
}

/// A clamp on the table whose top is the stock's: exact to a tenth of the clearance.
TEST(PredictFiveAxes, NamesTheLineThatMeetsABodyOfTheMachine) {
  const TempFolder folder;
  const std::string program = rows().substr(0, rows().find("G0 Z100.\nM30")),
                    clamp = "[[body]]\nname = \"clamp\"\non = \"c\"\nbox_mm = [[0, 5, -310], [3, 9, -300]]\n";
  const auto line = 1 + std::ranges::count(program, '\n') + 3;
  write_job(folder, program + over_the_stock(0.1), clamp);
  EXPECT_EQ(run_camber(folder, "predict job.toml -o result").err, "");
  write_job(folder, program + over_the_stock(-0.05), clamp);
  const auto hits = run_camber(folder, "predict job.toml -o result");
  EXPECT_EQ(hits.status, 1);
  EXPECT_EQ(hits.err.find(fmt::format("p.nc:{}:1: error: the holder of T1 meets the body \"clamp\"", line)), 0u)
      << hits.err;
}

/// A tool that leans by 60 degrees over the edge of the plate at X3: on the way down at X-7.6 that edge is
/// (10.6 sin 60 - 1.3 cos 60) = 8.53 mm up the tool, and the holder begins at its overhang.
TEST(CheckFiveAxes, AHolderThatMeetsTheStockIsNamedAndOneThatMissesIsNot) {
  const TempFolder folder;
  const auto check = [&](double overhang_mm) {
    write_job(folder, rows(-0.2, 60));
    std::string job = tests::file_text(folder / "job.toml");
    job.replace(job.find("overhang_mm = 30.0"), 18, fmt::format("overhang_mm = {}", overhang_mm));
    job.replace(job.find("voxel_mm = 0.2"), 14, "voxel_mm = 0.1");
    folder.write("job.toml", job);
    return run_camber(folder, "check p.nc --job job.toml");
  };
  const auto meets = check(8.2), misses = check(8.63);
  EXPECT_EQ(meets.status, 1);
  EXPECT_NE(meets.err.find("p.nc:11:1: error: the holder of T1 in stock at X2."), std::string::npos) << meets.err;
  EXPECT_NE(meets.err.find("[collision-holder]"), std::string::npos);
  EXPECT_EQ(misses.status, 0) << misses.err;
  EXPECT_EQ(misses.err.find("[collision"), std::string::npos) << misses.err;
}

/// The first turns of the dome of sample 13, in voxels of 0.2 mm.
void write_top_of_the_dome(const TempFolder& folder) {
  const std::string sample = CAMBER_SOURCE_DIR "/samples/13-dome/";
  std::string program = tests::file_text(sample + "dome.nc"), job = tests::file_text(sample + "job.toml");
  std::size_t from = 0;
  constexpr int kLines = 430;
  for (int line = 0; line < kLines; ++line) from = program.find('\n', from) + 1;
  program.replace(from, program.find("G49\n") - from, "G0 Z20.\n");
  job.replace(job.find("voxel_mm = 0.1"), 14, "voxel_mm = 0.2");
  folder.write("dome.nc", program);
  folder.write("job.toml", job);
  folder.write("machine.toml", tests::file_text(sample + "machine.toml"));
}

/// At a clicked place the page shows the tool there and turns the part as the table does.
TEST(PredictFiveAxes, ThePageOfTheDomeTurnsThePart) {
  CAMBER_NEEDS_BROWSER();
  const TempFolder folder;
  write_top_of_the_dome(folder);
  const auto run = run_camber(folder, "predict job.toml -o result");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(tests::open_page("dome", folder / "result/report.html"), "");
}

/// X Y Z of the axes without tool-centre-point control that take the tip there; the tables of sample 13.
Vec3 linear_axes_mm(const Vec3& tip, double a_deg, double c_deg) {
  const Vec3 zero(0, 0, -300), pivot(0, 0, -360);
  const Vec3 turned = Eigen::AngleAxisd(-rad_from_deg(c_deg), Vec3::UnitZ()) * (tip + zero);
  return pivot + Eigen::AngleAxisd(-rad_from_deg(a_deg), Vec3::UnitX()) * Vec3(turned - pivot) - zero;
}

/// Rows in which the table turns from block to block.
std::string turning_rows(bool tip_control) {
  std::string text = kStart + "G0 X0 Y0 Z150.\nA30 C80\n" + (tip_control ? "G43.4 H1\n" : "G43 H1\n");
  const auto block = [&](double x, double y, double up, double c_deg) {
    const double a = rad_from_deg(30), c = rad_from_deg(c_deg);
    const Vec3 axis(std::sin(a) * std::sin(c), -std::sin(a) * std::cos(c), std::cos(a));
    const Vec3 tip = Vec3(x, y, 2.8 + up) - 3 * axis, at = tip_control ? tip : linear_axes_mm(tip, 30, c_deg);
    return fmt::format("X{:.4f} Y{:.4f} Z{:.4f} A30 C{:g}", at.x(), at.y(), at.z(), c_deg);
  };
  for (const double y : {-0.4, 0.0, 0.4, 0.8, 1.2, 1.6, 2.0, 2.4}) {
    text += "G0 " + block(-2, y, 9, 80) + "\nG1 " + block(-2, y, 0, 80) + " F500\n";
    for (int i = 1; i <= 14; ++i) text += block(-2 + 0.5 * i, y, 0, 80 + 1.5 * i) + (i == 1 ? " F1200\n" : "\n");
    text += "G0 " + block(5, y, 9, 101) + "\n";
  }
  return text + "M30\n";
}

/// The program without the values of its words X, Y and Z.
std::string without_coordinates(const std::string& program) {
  return std::regex_replace(program, std::regex("([XYZ])[-0-9.]+"), "$1");
}

/// The tip is moved and the axis kept: in both kinds of program coordinates change, and nothing else.
TEST(CompensateFiveAxes, ChangesCoordinatesAndNothingElse) {
  for (const bool tip_control : {true, false}) {
    SCOPED_TRACE(tip_control);
    const TempFolder folder;
    const std::string program = turning_rows(tip_control);
    write_job(folder, program);
    std::string job = tests::file_text(folder / "job.toml");
    job.replace(job.find("overhang_mm = 30.0"), 18, "overhang_mm = 40.0\nflute_length_mm = 40.0\nhelix_deg = 30.0");
    job.replace(job.find("coupling = \"rigid\""), 18, "[compensation]\nlevers = [\"shift\"]\ntolerance_um = 0.5");
    folder.write("job.toml", job);
    const auto run = run_camber(folder, "compensate job.toml -o out.nc --json c.json");
    const std::string out = tests::file_text(folder / "out.nc");
    EXPECT_EQ(without_coordinates(out), without_coordinates(program));
    const auto figures = nlohmann::json::parse(tests::file_text(folder / "c.json"));
    EXPECT_GT(figures["blocks"]["changed"], 60);
    EXPECT_EQ(figures["blocks"]["before"], figures["blocks"]["after"]);
    const double before = figures["before_um"]["p95"], after = figures["after_um"]["p95"];
    EXPECT_LT(after, 0.6 * before) << run.err;
    // What the loop says of its result is what verify finds.
    const auto verify = run_camber(folder, "compensate --verify out.nc --json v.json");
    EXPECT_NEAR(nlohmann::json::parse(tests::file_text(folder / "v.json"))["emitted"]["error_um"]["p95"], after,
                0.05 * after)
        << verify.err;
  }
}

/// Rows by a ball that leans 30 degrees, in X Y Z of the part, of the axes, or of a frame along the tool. The frame's
/// Euler angles are those of the axes, so that under G254 the words are those of the tilted frame.
enum class Frame { tip, axes, tilted, dynamic };

const Eigen::Matrix3d& leaning_plane() {
  static const Eigen::Matrix3d plane =
      (Eigen::AngleAxisd(rad_from_deg(80), Vec3::UnitZ()) * Eigen::AngleAxisd(rad_from_deg(30), Vec3::UnitX()))
          .toRotationMatrix();
  return plane;
}

std::string leaning_rows(Frame frame) {
  std::string text = kStart + "G0 X0 Y0 Z150.\nA30 C80\n";
  if (frame == Frame::tilted) text += "G68.2 X0 Y0 Z0 I80 J30 K0\nG53.1\n";
  if (frame == Frame::dynamic) text += "G254\n";
  text += frame == Frame::tip ? "G43.4 H1\n" : "G43 H1\n";
  const auto block = [&](double x, double y, double up) {
    const Vec3 tip = Vec3(x, y, 2.8 + up) - 3 * leaning_plane().col(2);
    const Vec3 at = frame == Frame::tip    ? tip
                    : frame == Frame::axes ? linear_axes_mm(tip, 30, 80)
                                           : Vec3(leaning_plane().transpose() * tip);
    return fmt::format("X{:.5f} Y{:.5f} Z{:.5f}", at.x(), at.y(), at.z());
  };
  for (const double y : {0.0, 0.4, 0.8, 1.2, 1.6, 2.0}) {
    text += "G0 " + block(-2, y, 9) + "\nG1 " + block(-2, y, 0) + " F500\n";
    for (int i = 1; i <= 14; ++i) text += block(-2 + 0.5 * i, y, 0) + (i == 1 ? " F1200\n" : "\n");
    text += "G0 " + block(5, y, 9) + "\n";
  }
  return text + "M30\n";
}

/// Ends of the blocks on the part, of a program of leaning_rows.
std::vector<Vec3> places_of(const std::string& program, Frame frame) {
  static const std::regex kPlace("X([-0-9.]+) Y([-0-9.]+) Z([-0-9.]+)");
  std::vector<Vec3> out;
  const std::string rows = program.substr(program.find("H1\n"));
  for (auto it = std::sregex_iterator(rows.begin(), rows.end(), kPlace); it != std::sregex_iterator(); ++it) {
    const Vec3 at(std::stod((*it)[1]), std::stod((*it)[2]), std::stod((*it)[3]));
    if (frame == Frame::axes) {
      // linear_axes_mm is affine.
      const Vec3 zero = linear_axes_mm(Vec3::Zero(), 30, 80);
      Eigen::Matrix3d map;
      for (int i = 0; i < 3; ++i) map.col(i) = linear_axes_mm(Vec3::Unit(i), 30, 80) - zero;
      out.emplace_back(map.transpose() * (at - zero));
    } else {
      out.emplace_back(frame == Frame::tip ? at : Vec3(leaning_plane() * at));
    }
  }
  return out;
}

/// One cut in four writings: the same forces, and compensated the same places on the part, each in its own coordinates.
TEST(CompensateFiveAxes, TiltedFramesAreCompensatedInTheirOwnCoordinates) {
  std::vector<Vec3> given, expected;
  double force_N = 0, error_um = 0;
  for (const Frame frame : {Frame::axes, Frame::tilted, Frame::dynamic, Frame::tip}) {
    SCOPED_TRACE(static_cast<int>(frame));
    const TempFolder folder;
    const std::string program = leaning_rows(frame);
    write_job(folder, program);
    std::string job = tests::file_text(folder / "job.toml");
    job.replace(job.find("overhang_mm = 30.0"), 18, "overhang_mm = 40.0\nflute_length_mm = 40.0\nhelix_deg = 30.0");
    job.replace(job.find("coupling = \"rigid\""), 18,
                "[compensation]\nlevers = [\"shift\"]\ntolerance_um = 0.5\nmax_rounds = 1");
    folder.write("job.toml", job);
    const auto predicted = run_camber(folder, "predict job.toml -o result --json p.json");
    ASSERT_EQ(predicted.status, 0) << predicted.err;
    const auto p = nlohmann::json::parse(tests::file_text(folder / "p.json"));
    const auto run = run_camber(folder, "compensate job.toml -o out.nc --json c.json");
    ASSERT_NE(run.status, 1) << run.err;
    const std::string out = tests::file_text(folder / "out.nc");
    EXPECT_EQ(without_coordinates(out), without_coordinates(program));
    const std::vector<Vec3> places = places_of(out, frame);
    const auto c = nlohmann::json::parse(tests::file_text(folder / "c.json"));
    EXPECT_LT(c["after_um"]["p95"], c["before_um"]["p95"].get<double>());
    if (frame == Frame::axes) {
      given = places_of(program, frame), expected = places;
      force_N = p["force_N"]["max"], error_um = c["after_um"]["p95"];
      ASSERT_EQ(places.size(), given.size());
      double shifted = 0;
      for (std::size_t i = 0; i < places.size(); ++i) shifted = std::max(shifted, (places[i] - given[i]).norm());
      EXPECT_GT(shifted, 0.0009);
      continue;
    }
    EXPECT_NEAR(p["force_N"]["max"], force_N, (frame == Frame::tip ? 0.02 : 2e-3) * force_N);
    // The control plans the tip's corners under tool-centre-point control, and those of the axes else.
    EXPECT_NEAR(c["after_um"]["p95"], error_um, (frame == Frame::tip ? 0.06 : 0.02) * error_um);
    if (frame == Frame::tip) continue;
    ASSERT_EQ(places.size(), expected.size());
    for (std::size_t i = 0; i < places.size(); ++i) EXPECT_LT((places[i] - expected[i]).norm(), 4e-4) << i;
  }
}

}  // namespace
}  // namespace camber
