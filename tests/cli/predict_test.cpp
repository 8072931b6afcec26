// predict as a user runs it: its files, and the same bytes whatever the number of threads.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <regex>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/geometry.h"
#include "base/triangle_mesh.h"
#include "base/units.h"
#include "tests/support/csv_columns.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::columns_of;
using tests::run_camber;
using tests::TempFolder;

void write_job(const TempFolder& folder) {
  std::string program = "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\n";
  for (const char* y : {"0.5", "0.8", "1.1"})
    program += std::string("G0 X4. Y") + y + " Z3.\nG1 Z-0.3 F300\nX-1. F900\nG0 Z3.\n";
  folder.write("p.nc", program + "M30\n");
  folder.write("machine.toml", "[axis.x]\nacceleration_mm_per_s2 = 500\n[axis.y]\n[axis.z]\n");
  folder.write("job.toml", R"(program = "p.nc"
machine = "machine.toml"
[tool.1]
type = "ball"
diameter_mm = 6.0
flutes = 2
overhang_mm = 30.0
[material]
ktc_MPa = 2000.0
krc_MPa = 700.0
[stock]
box_mm = [[0, 0, -1], [3, 2, 0]]
[simulation]
voxel_mm = 0.2
)");
}

TEST(Predict, WritesEveryFileThatIsPromised) {
  const TempFolder folder;
  write_job(folder);
  const auto run = run_camber(folder, "predict job.toml -o result --json figures.json --meshes");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  for (const char* name :
       {"feed.csv", "forces.csv", "machined.stl", "machined.ply", "form_error_mesh.ply", "form_error.csv",
        "form_error.vtp", "form_error.ply", "stock.vdb", "report.html", "summary.json"})
    EXPECT_GT(std::filesystem::file_size(folder / ("result/" + std::string(name))), 0u) << name;
  EXPECT_EQ(tests::file_text(folder / "figures.json"), tests::file_text(folder / "result/summary.json"));
  const auto figures = nlohmann::json::parse(tests::file_text(folder / "figures.json"));
  for (const char* key : {"machine_time_s", "compute_s"}) EXPECT_TRUE(figures[key].is_number()) << key;
  EXPECT_TRUE(figures["force_N"]["max"].is_number());
  for (const char* key : {"path", "stock"}) EXPECT_TRUE(figures["removed_mm3"][key].is_number()) << key;
  for (const char* key : {"min", "max", "mean", "rms", "p95"})
    EXPECT_TRUE(figures["form_error_um"][key].is_number()) << key;
}

/// A wall along X at y = 0, one millimetre of it cut by a slender end mill; the floor at z = -1.
void write_wall_job(const TempFolder& folder, const std::string& axis_y, const std::string& more = "") {
  folder.write("p.nc",
               "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\nG0 X-4. Y-2.\nG0 Z-1.\nG1 X12. F600\nG0 Z5.\nM30\n");
  folder.write("machine.toml", "[axis.x]\n[axis.y]\n" + axis_y + "[axis.z]\n");
  folder.write("job.toml",
               "program = \"p.nc\"\nmachine = \"machine.toml\"\n[tool.1]\ntype = \"flat\"\ndiameter_mm = 4.0\nflutes = "
               "2\noverhang_mm = 20.0\n[material]\nktc_MPa = 400.0\nkrc_MPa = 140.0\nkre_N_per_mm = "
               "10.0\n[stock]\nbox_mm = [[0, -0.5, "
               "-2], [8, 2, 0]]\n[simulation]\nvoxel_mm = 0.1\ncoupling = \"rigid\"\n" +
                   more);
}

TEST(Predict, TellsTheLoadOfTheSpindleByToolAndLine) {
  // Of each line the heaviest turn: as forces.csv has it. Power is torque times speed.
  const TempFolder folder;
  write_wall_job(folder, "");
  ASSERT_EQ(run_camber(folder, "-q predict job.toml -o r").status, 0);
  const std::string text = tests::file_text(folder / "r/spindle_load.csv");
  EXPECT_EQ(text.substr(0, text.find('\n')), "tool,line,power_W,torque_Nm");
  const auto load = columns_of(text), forces = columns_of(tests::file_text(folder / "r/forces.csv"));
  ASSERT_EQ(load.at("tool"), (std::vector<double>{1}));
  ASSERT_EQ(load.at("line"), (std::vector<double>{6}));
  const auto& power = forces.at("power_W");
  EXPECT_EQ(load.at("power_W")[0], *std::ranges::max_element(power));
  EXPECT_GT(load.at("power_W")[0], 1);
  EXPECT_NEAR(load.at("power_W")[0], load.at("torque_Nm")[0] * 3000 * 2 * kPi / 60, 2e-3);
}

/// Volume that a binary STL encloses, and its triangles with their points.
double volume_of_stl(const std::string& bytes, std::size_t& triangles) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  triangles = count;
  double six = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::array<float, 12> v{};
    std::memcpy(v.data(), bytes.data() + 84 + 50 * i, sizeof v);
    const auto point = [&](std::size_t k) { return Vec3(v[k], v[k + 1], v[k + 2]); };
    six += point(3).dot(point(6).cross(point(9)));
  }
  return six / 6;
}

TEST(Predict, WritesTheMachinedPartAsAClosedMesh) {
  const TempFolder folder;
  write_wall_job(folder, "");
  ASSERT_EQ(run_camber(folder, "-q predict job.toml -o r --meshes").status, 0);
  const TriangleMesh part = read_stl(folder / "r/machined.stl");
  EXPECT_EQ(part.open_edges(), 0u);
  std::size_t triangles = 0;
  const double volume = volume_of_stl(tests::file_text(folder / "r/machined.stl"), triangles);
  // The blank less the corner that was cut; edges of the mesh are rounded by a part of a voxel.
  const auto figures = nlohmann::json::parse(tests::file_text(folder / "r/summary.json"));
  constexpr double kRounded_mm3 = 0.5;  // 60 mm of edges and corners, each cut by up to 0.1 mm squared
  EXPECT_NEAR(volume, 8 * 2.5 * 2 - figures["removed_mm3"]["stock"].get<double>(), kRounded_mm3);
  // It can be the blank of the next job, which cuts half a millimetre deeper.
  folder.write("p.nc", tests::replaced(tests::file_text(folder / "p.nc"), "Z-1.", "Z-1.5"));
  folder.write("next.toml", tests::replaced(tests::file_text(folder / "job.toml"),
                                            "box_mm = [[0, -0.5, -2], [8, 2, 0]]", "mesh = \"r/machined.stl\""));
  const auto next = run_camber(folder, "predict next.toml -o n --meshes");
  EXPECT_EQ(next.status, 0) << next.err;
  const std::string ply = tests::file_text(folder / "r/form_error_mesh.ply"),
                    head = ply.substr(0, ply.find("end_header\n"));
  for (const char* word : {"element vertex ", "property float error_um\n", "property int block\n", "element face "})
    EXPECT_NE(head.find(word), std::string::npos) << word;
}

TEST(Predict, GivesTheSameBytesOnOneAndTwoThreads) {
  const TempFolder folder;
  write_job(folder);
  ASSERT_EQ(run_camber(folder, "--threads 1 predict job.toml -o one").status, 0);
  ASSERT_EQ(run_camber(folder, "--threads 2 predict job.toml -o two").status, 0);
  for (const std::string name :
       {"feed.csv", "forces.csv", "form_error.csv", "form_error.vtp", "form_error.ply", "stock.vdb", "report.html"})
    EXPECT_EQ(tests::file_text(folder / ("one/" + name)), tests::file_text(folder / ("two/" + name))) << name;
}

TEST(Predict, TheAxisGivesWayByForceOverStiffness) {
  // In rigid coupling the forces stay the same, and what the axis gives way by is theirs over the stiffness.
  const auto deflections = [](const std::string& axis) {
    const TempFolder folder;
    write_wall_job(folder, axis);
    const auto run = run_camber(folder, "-q predict job.toml -o r");
    EXPECT_EQ(run.status, 0) << run.err;
    return columns_of(tests::file_text(folder / "r/forces.csv"));
  };
  const auto stiff = deflections(""), soft = deflections("stiffness_N_per_um = 10\n"),
             softer = deflections("stiffness_N_per_um = 5\n");
  ASSERT_EQ(stiff.at("dy_um").size(), soft.at("dy_um").size());
  std::size_t compared = 0;
  for (std::size_t i = 0; i < stiff.at("dy_um").size(); ++i) {
    EXPECT_EQ(stiff.at("fy_max_N")[i], soft.at("fy_max_N")[i]);
    EXPECT_EQ(stiff.at("dx_um")[i], soft.at("dx_um")[i]);  // of the other axis
    if (stiff.at("x_mm")[i] < 2 || stiff.at("x_mm")[i] > 6) continue;
    // Where the edge passes the wall the chip is nothing, and a straight edge of 1 mm is pushed away by kre b = 10 N.
    EXPECT_NEAR(soft.at("dy_um")[i] - stiff.at("dy_um")[i], -1.0, 0.05) << i;
    EXPECT_NEAR(softer.at("dy_um")[i] - stiff.at("dy_um")[i], -2.0, 0.1) << i;
    ++compared;
  }
  EXPECT_GT(compared, 10u);
}

/// What the job leaves if nothing bends: an L of 8 mm length.
std::string wall_stl() {
  constexpr std::array<std::array<double, 2>, 6> kOutline{{{-0.5, -2}, {2, -2}, {2, 0}, {0, 0}, {0, -1}, {-0.5, -1}}};
  std::string out = "solid wall\n";
  const auto facet = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (const Vec3& p : {a, b, c})
      out += "vertex " + std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) + "\n";
    out += "endloop\nendfacet\n";
  };
  const auto at = [&](std::size_t i, double x) { return Vec3(x, kOutline[i % 6][0], kOutline[i % 6][1]); };
  for (std::size_t i = 0; i < 6; ++i) {
    facet(at(i, 0), at(i, 8), at(i + 1, 8));
    facet(at(i, 0), at(i + 1, 8), at(i + 1, 0));
  }
  constexpr std::size_t kCap[4][3] = {{0, 1, 4}, {1, 2, 3}, {1, 3, 4}, {0, 4, 5}};
  for (const auto& t : kCap) {
    facet(at(t[0], 0), at(t[1], 0), at(t[2], 0));
    facet(at(t[2], 8), at(t[1], 8), at(t[0], 8));
  }
  return out + "endsolid wall\n";
}

TEST(Predict, TotalErrorHoldsTheBending) {
  const TempFolder folder;
  write_wall_job(folder, "", "[part]\nmesh = \"part.stl\"\n");
  folder.write("part.stl", wall_stl());
  const auto run = run_camber(folder, "-q predict job.toml -o r");
  ASSERT_EQ(run.status, 0) << run.err;
  const auto points = columns_of(tests::file_text(folder / "r/form_error.csv"));
  double sum_um = 0;
  int count = 0;
  for (std::size_t i = 0; i < points.at("x_mm").size(); ++i) {
    const double x = points.at("x_mm")[i], z = points.at("z_mm")[i];
    if (points.at("ny")[i] > -0.99 || x < 2 || x > 6 || z < -0.8 || z > -0.3) continue;
    // The undeflected wall is the mesh's but for the feed marks, f^2 / (8 R) = 0.63 um: the rest of its error is
    // bending.
    EXPECT_NEAR(points.at("total_error_um")[i], points.at("error_um")[i], 0.7);
    sum_um += std::abs(points.at("error_um")[i]);
    ++count;
  }
  ASSERT_GT(count, 50);
  EXPECT_GT(sum_um / count, 2);
}

/// Area-weighted rms of a column.
double rms_of(const std::map<std::string, std::vector<double>>& points, const std::string& name) {
  double squares = 0, area = 0;
  for (std::size_t i = 0; i < points.at(name).size(); ++i) {
    squares += points.at("area_mm2")[i] * std::pow(points.at(name)[i], 2);
    area += points.at("area_mm2")[i];
  }
  return std::sqrt(squares / area);
}

TEST(Predict, EveryRowOfTheFormErrorAddsUpAndTheFiguresFollowFromTheColumns) {
  const TempFolder folder;
  write_wall_job(folder, "");
  // A corner that lagging axes cut short: contour error and deflection on the same surface.
  folder.write("p.nc",
               "G21 G90 G17 G40 G49 G80 G54 G64\nT1 M6\nS3000 M3\nG0 X-4. Y1.\nG0 Z-1.\nG1 X5. F600\nY6.\nG0 "
               "Z5.\nM30\n");
  folder.write("machine.toml",
               "[control]\ncorner = { law = \"blend\", tolerance_mm = 0.1 }\n[axis.x]\nposition_gain_per_s = "
               "30\n[axis.y]\nposition_gain_per_s = 20\n[axis.z]\n");
  const auto run = run_camber(folder, "-q predict job.toml -o r");
  ASSERT_EQ(run.status, 0) << run.err;
  const auto points = columns_of(tests::file_text(folder / "r/form_error.csv"));
  const auto json = nlohmann::json::parse(tests::file_text(folder / "r/summary.json"));
  EXPECT_EQ(json["schema_version"], 2);
  constexpr double kRounded = 0.0016;  // three columns of three decimals
  double area = 0;
  for (std::size_t i = 0; i < points.at("error_um").size(); ++i) {
    EXPECT_NEAR(points.at("error_um")[i], points.at("deflection_um")[i] + points.at("contour_um")[i], kRounded) << i;
    area += points.at("area_mm2")[i];
  }
  const std::pair<const char*, const char*> kGroups[] = {
      {"error_um", "form_error_um"}, {"deflection_um", "deflection_um"}, {"contour_um", "contour_um"}};
  for (const auto& [column, group] : kGroups) {
    EXPECT_NEAR(rms_of(points, column), json[group]["rms"].get<double>(), kRounded) << column;
    EXPECT_NEAR(*std::max_element(points.at(column).begin(), points.at(column).end()), json[group]["max"].get<double>(),
                kRounded)
        << column;
    EXPECT_NEAR(area, json[group]["area_mm2"].get<double>(), 1e-3);
    EXPECT_GT(json[group]["rms"], 1) << column;
  }
}

TEST(Predict, IsSilentWithQuiet) {
  const TempFolder folder;
  write_job(folder);
  const auto run = run_camber(folder, "-q predict job.toml -o result");
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.out + run.err, "");
}

/// A slot of 4 x 1 mm at 600 mm/min: Q = 40 mm3/s, and with K_tc = 2000 MPa alone P = K_tc Q = 80 W.
void write_slot_job(const TempFolder& folder, const std::string& spindle, const std::string& more = "") {
  folder.write("p.nc", "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\nG0 X-4. Y0.\nG0 Z-1.\nG1 X5. F600\n" + more +
                           "G0 Z5.\nM30\n");
  folder.write("machine.toml", "[axis.x]\n[axis.y]\n[axis.z]\n[spindle]\n" + spindle);
  folder.write("job.toml", R"(program = "p.nc"
machine = "machine.toml"
[tool.1]
type = "flat"
diameter_mm = 4.0
flutes = 2
overhang_mm = 20.0
[material]
ktc_MPa = 2000.0
krc_MPa = 700.0
kte_N_per_mm = 0.0
kre_N_per_mm = 0.0
[stock]
box_mm = [[0, -4, -2], [12, 4, 0]]
[simulation]
voxel_mm = 0.2
coupling = "rigid"
)");
}

TEST(Predict, WarnsWhereTheCutTakesMoreThanTheSpindleHas) {
  const TempFolder folder;
  write_slot_job(folder, "power_W = 70\n");
  const auto run = run_camber(folder, "predict job.toml -o result");
  ASSERT_EQ(run.status, 0) << run.err;
  std::smatch found;
  ASSERT_TRUE(std::regex_match(
      run.err, found,
      std::regex(
          R"(p\.nc:6:1: warning: T1 takes (\d+) W at 3000 rpm, where the spindle provides 70 W; at most power_W of the )"
          R"(machine file was expected \[spindle-power\]\n    G1 X5\. F600\n    \^\n)")))
      << run.err;
  EXPECT_NEAR(std::stod(found[1]), 80, 2.5);  // K_tc Q; the voxels' share
  EXPECT_NE(tests::file_text(folder / "result/report.html").find("[spindle-power]"), std::string::npos);
  EXPECT_EQ(run_camber(folder, "--strict predict job.toml -o result").status, 1);

  // Constant torque to 6000 rpm: at 3000 half of the power; both cutting lines take more.
  write_slot_job(folder, "power_W = 100\nconstant_torque_rpm = 6000\n", "X8. F450\n");
  const std::string err = run_camber(folder, "predict job.toml -o result").err;
  EXPECT_NE(err.find("where the spindle provides 50 W; 2 lines need more than that; at most"), std::string::npos)
      << err;

  write_slot_job(folder, "power_W = 90\n");
  EXPECT_EQ(run_camber(folder, "predict job.toml -o result").err, "");
}

TriangleMesh block(const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
  TriangleMesh out;
  for (int i = 0; i < 8; ++i)
    out.points.emplace_back((i & 1 ? high : low).x(), (i & 2 ? high : low).y(), (i & 4 ? high : low).z());
  out.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return out;
}

TEST(Predict, MovesThePartAsAFileThatWasMovedByHand) {
  const TempFolder folder;
  write_job(folder);
  const std::string job = tests::file_text(folder / "job.toml");
  // Sums of these have no rounding.
  TriangleMesh mesh = block({-7.5F, 4, 20}, {-4.5F, 6, 20.5F});
  folder.write("elsewhere.stl", stl_text(mesh));
  for (Eigen::Vector3f& p : mesh.points) p += Eigen::Vector3f(7.5F, -4, -21);
  folder.write("in_place.stl", stl_text(mesh));
  const auto predicted = [&](const std::string& part) {
    folder.write("job.toml", job + "[part]\n" + part);
    const auto run = run_camber(folder, "predict job.toml -o result");
    EXPECT_EQ(run.status, 0) << run.err;
    return tests::file_text(folder / "result/form_error.csv");
  };
  const std::string moved = predicted("mesh = \"elsewhere.stl\"\nmove_mm = [7.5, -4, -21]\n");
  EXPECT_EQ(moved, predicted("mesh = \"in_place.stl\"\n"));
  EXPECT_NE(moved, predicted("mesh = \"in_place.stl\"\nmove_mm = [0, 0, 0.125]\n"));
}

TEST(Predict, WritesOfThePartsMoveWhatItHasRead) {
  const TempFolder folder;
  write_job(folder);
  const std::string job = tests::file_text(folder / "job.toml");
  folder.write("part.stl", stl_text(block({0, 0, -1}, {3, 2, -0.5F})));
  folder.write("job.toml", job + "[part]\nmesh = \"part.stl\"\nmove_mm = [1, -2.5, 0]\n");
  const auto run = run_camber(folder, "predict job.toml -o result --effective-config");
  EXPECT_NE(run.out.find("\nmove_mm = [1, -2.5, 0]\n"), std::string::npos) << run.out << run.err;
  folder.write("job.toml", job + "[part]\nmesh = \"part.stl\"\nmove_mm = [1, -2.5]\n");
  EXPECT_EQ(run_camber(folder, "predict job.toml -o result").err,
            "job.toml:17:11: error: move_mm has 2 numbers; [x, y, z], by which the mesh is moved, was expected "
            "[value-count]\n    move_mm = [1, -2.5]\n              ^\n");
}

}  // namespace
}  // namespace camber
