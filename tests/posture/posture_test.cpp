#include "posture/posture_program.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "base/units.h"
#include "checks/tool_surface.h"
#include "kinematics/control_options.h"
#include "kinematics/machine_program.h"
#include "kinematics/program_joints.h"
#include "nc/interpreter.h"
#include "removal/cutter.h"
#include "repath/raster/drop_cutter.h"
#include "test_paths.h"
#include "tests/support/temp_folder.h"

namespace camber::posture {
namespace {

machine::Tool ball_in_holder(double overhang_mm) {
  machine::Tool tool;
  tool.number = 1;
  tool.type = machine::ToolType::ball;
  tool.diameter_mm = 6;
  tool.overhang_mm = overhang_mm;
  tool.flute_length_mm = 10;
  tool.shank_diameter_mm = 6;
  tool.holder = {{20, 24, 20}, {40, 40, 30}};
  return tool;
}

machine::Machine table() {
  Diagnostics diagnostics;
  return machine::read_machine(CAMBER_SOURCE_DIR "/samples/machines/linuxcnc_five_axis.toml", diagnostics);
}

/// A point against a cylinder.
double cylinder_room_mm(const Vec3& tip, const Vec3& axis, const Vec3& p, double radius, double from, double to) {
  const double up = (p - tip).dot(axis), out = (p - tip).cross(axis).norm();
  return std::hypot(std::max(out - radius, 0.0), std::max({from - up, up - to, 0.0}));
}

/// A point against the cylinders and cones of shank and holder: the other way to see whether there is room.
double room_behind_mm(const machine::Tool& tool, double clearance_mm, const Vec3& tip, const Vec3& axis,
                      const Vec3& p) {
  const auto cylinder = [&](double radius, double from, double to) {
    return cylinder_room_mm(tip, axis, p, radius, from, to) - clearance_mm;
  };
  const double l = tool.overhang_mm;
  return std::min({cylinder(3, 10, l), cylinder(10, l, l + 20), cylinder(20, l + 20, l + 50)});  // inside the cone
}

/// And of the flutes, which must not cut.
double point_room_mm(const machine::Tool& tool, double clearance_mm, const Vec3& tip, const Vec3& axis, const Vec3& p) {
  const bool cuts = cylinder_room_mm(tip, axis, p, 3 - kCutterSlack_mm, 3, 10) <= 0;
  return cuts ? -1 : room_behind_mm(tool, clearance_mm, tip, axis, p);
}

/// A wavy floor between steep walls, 1 mm triangles.
TriangleMesh trough(std::mt19937& random) {
  std::uniform_real_distribution<double> one(-1, 1);
  const double a = 2 * one(random), b = 3 + 2 * one(random), slope = 1.8 + 0.5 * one(random), w = 9 + 3 * one(random);
  TriangleMesh mesh;
  constexpr int kX = 41, kY = 81;
  const auto height = [&](double x, double y) {
    const double wall = std::max(0.0, std::abs(y) - w) * slope;
    return std::min(wall, 45.0) + a * std::sin(x / b);
  };
  for (int i = 0; i < kX; ++i)
    for (int k = 0; k < kY; ++k)
      mesh.points.emplace_back(static_cast<float>(i - 20), static_cast<float>(k - 40),
                               static_cast<float>(height(i - 20, k - 40)));
  for (int i = 0; i + 1 < kX; ++i)
    for (int k = 0; k + 1 < kY; ++k) {
      const auto at = [&](int x, int y) { return static_cast<std::uint32_t>(x * kY + y); };
      mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  return mesh;
}

TEST(Surroundings, RoomIsThatOfPointsAgainstCylinders) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> one(-1, 1);
  const machine::Tool tool = ball_in_holder(35);
  const ToolShape shape = tool_shape(tool, table(), 1);
  int blocked = 0, free = 0;
  for (int surface = 0; surface < 4; ++surface) {
    const TriangleMesh mesh = trough(random);
    Surroundings around;
    around.add(mesh);
    around.finish();
    for (int i = 0; i < 40; ++i) {
      const Vec3 axis = Vec3(0.5 * one(random), 0.8 * one(random), 1).normalized();
      const Vec3 tip(15 * one(random), 8 * one(random), 4 + 2 * one(random));
      double room = 10;
      for (const Eigen::Vector3f& p : mesh.points)
        room = std::min(room, point_room_mm(tool, 1, tip, axis, p.cast<double>()));
      const double ours = around.room_mm(shape, tip, axis, 10);
      ASSERT_LE(ours, std::max(room, 0.0) + 0.02 + 0.02) << i;  // pieces are smaller by 0.01 mm all round
      // A point is blocked: so are we, but for what the smaller pieces leave.
      if (room < -0.05) {
        ASSERT_LT(ours, 0) << i;
        ++blocked;
      }
      free += ours >= 0;
    }
  }
  EXPECT_GT(blocked, 10);
  EXPECT_GT(free, 10);
}

TEST(Surroundings, FlutesMayBeInStockAndNothingElse) {
  const ToolShape shape = tool_shape(ball_in_holder(35), table(), 1);
  const auto room = [&](Obstacle what, double top_mm) {
    Surroundings around;
    around.add_box({4.9, -50, -50}, {50, 50, top_mm}, what);
    around.finish();
    return around.room_mm(shape, {1.95, 0, 0}, Vec3::UnitZ(), 5);
  };
  EXPECT_LT(room(Obstacle::solid, 8), 0);  // beside the flutes, which end at 10
  EXPECT_GE(room(Obstacle::stock, 8), 0);
  EXPECT_LT(room(Obstacle::stock, 11), 0);  // the shank begins at 10, and keeps 1 mm
}

TEST(PathPoint, KeepsTheContactOfBallAndBullNose) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> one(-1, 1);
  for (const double corner : {4.0, 1.0}) {
    removal::CutterShape shape;
    shape.radius_mm = 4;
    shape.corner_radius_mm = corner;
    for (int i = 0; i < 200; ++i) {
      PathPoint p;
      p.normal = Vec3(0.5 * one(random), 0.5 * one(random), 1).normalized();
      p.corner_mm = corner;
      p.flat_mm = 4 - corner;
      const Vec3 contact(10 * one(random), 10 * one(random), one(random));
      p.centre_mm = contact + corner * p.normal;
      Vec3 axis = p.normal + 0.6 * Vec3(one(random), one(random), one(random));
      axis.normalize();
      if (axis.cross(p.normal).norm() < 0.05) continue;
      const Mat3 frame = checks::outline_frame({p.tip_mm(axis), axis, 0});
      const Vec3 there = frame.transpose() * (contact - p.tip_mm(axis));
      EXPECT_NEAR(shape.distance_mm(there), 0, 1e-9) << corner;
      EXPECT_GT((frame * shape.gradient(there)).dot(-p.normal), 1 - 1e-9) << corner;
    }
  }
}

class PostureInATrough : public ::testing::Test {
 protected:
  static std::string rows(const TriangleMesh& mesh) {
    std::string text =
        "G21 G17 G90 G94\nG10 L2 P1 X25. Y-15. Z5.\nG10 L1 P1 Z120.\nT1 M6\nG54\nS9000 M3\nG43 H1\nG0 X0. Y0. Z60.\n";
    for (const int y : {-8, 0, 8}) {
      text += "G0 X-14. Y" + std::to_string(y) + ".\nG0 Z8.\nG1 Z4. F600\n";
      for (int x = -13; x <= 14; ++x) text += "X" + std::to_string(x) + ". Z" + std::to_string(tip(mesh, x, y)) + "\n";
      text += "G0 Z60.\n";
    }
    return text + "M5\nM2\n";
  }

  /// The same in Klartext or for a Sinumerik: lines, and the head in words of the language.
  static std::string rows_in(const std::string& language, const TriangleMesh& mesh) {
    const bool klartext = language == "heidenhain";
    std::istringstream lines(rows(mesh));
    std::string out = klartext ? "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S9000\n2 M3\n"
                               : "%_N_A_MPF\nN1 G17 G71 G90 G94\nN2 T1\nN3 M6 D1\nN4 G54 S9000 M3\n";
    int number = klartext ? 3 : 5;
    bool rapid = true;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("G0 ") || line.starts_with("G1 ")) rapid = line[1] == '0';
      const std::string words = line.starts_with("G") ? line.substr(3) : line;
      if (words.empty() || words[0] < 'X' || words[0] > 'Z') continue;
      out += klartext ? fmt::format("{} L {}{}\n", number++, words, rapid ? " R0 FMAX" : "")
                      : fmt::format("N{} {} {}\n", number++, rapid ? "G0" : "G1", words);
    }
    return out + (klartext ? fmt::format("{} M30\n{} END PGM A MM\n", number, number + 1) : "N9000 M30\n");
  }

  /// Lowered onto the corners of the mesh: near enough to touch.
  static double tip(const TriangleMesh& mesh, double x, double y) {
    double z = -1e9;
    for (const auto& p : mesh.points) {
      const double d2 = (p.x() - x) * (p.x() - x) + (p.y() - y) * (p.y() - y);
      if (d2 < 9) z = std::max(z, p.z() + std::sqrt(9 - d2) - 3);
    }
    return z + 0.05;
  }

  std::string write_mesh(const TriangleMesh& mesh, const std::string& name) const {
    const std::string stl = folder_ / name;
    std::ofstream out(stl, std::ios::binary);
    const std::string head(80, ' ');
    out.write(head.data(), 80);
    const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
    out.write(reinterpret_cast<const char*>(&count), 4);
    for (const auto& t : mesh.triangles) {
      float row[12] = {0, 0, 0};
      for (std::size_t i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) row[3 + 3 * i + static_cast<std::size_t>(k)] = mesh.points[t[i]][k];
      out.write(reinterpret_cast<const char*>(row), 48);
      out.write("\0\0", 2);
    }
    return stl;
  }

  void SetUp() override {
    std::mt19937 random(11);
    mesh_ = trough(random);
    job_.path = "job.toml";
    job_.machine = table();
    job_.part.mesh = write_mesh(mesh_, "part.stl");
    job_.tools[1] = ball_in_holder(35);
  }

  void read(const std::string& text) {
    Diagnostics diagnostics;
    nc::InterpreterOptions options;
    options.inch = false;
    options.rotary_axes = kinematics::rotary_options(job_.machine);
    options.work_offsets_mm[54] = Vec3(25, -15, 5);
    options.tool_offsets[1].length_mm = 120;
    options = kinematics::interpreter_options(job_.machine, options);
    program_ = nc::read_program(SourceText("p.nc", text), diagnostics);
    moves_ = nc::interpret(program_, options, diagnostics);
    diagnostics.throw_if_errors();
  }

  /// Poses at the ends of the feed moves, as the machine of the job runs them.
  std::vector<ToolPose> cut_ends(const std::string& text) const {
    Diagnostics diagnostics;
    nc::InterpreterOptions options;
    options.inch = false;
    options.rotary_axes = kinematics::rotary_options(job_.machine);
    options.work_offsets_mm[54] = Vec3(25, -15, 5);
    options.tool_offsets[1].length_mm = 120;
    options = kinematics::interpreter_options(job_.machine, options);
    const nc::Program program = nc::read_program(SourceText("out.nc", text), diagnostics);
    nc::Interpretation moves = nc::interpret(program, options, diagnostics);
    diagnostics.throw_if_errors();
    moves = kinematics::MachineProgram({}, moves, job_.machine).moves_in_program();
    kinematics::ProgramJoints joints(job_.machine, moves);
    std::vector<ToolPose> out;
    while (!joints.done()) {
      joints.next();
      const auto pose = joints.pose_at(1);
      if (pose && moves.moves[joints.index()].kind == nc::MoveKind::linear) out.push_back(*pose);
    }
    return out;
  }

  Postured made(Mode mode, Diagnostics& diagnostics) const {
    return make_postures({.job = &job_, .program = &program_, .moves = &moves_, .tool = 1, .options = {.mode = mode}},
                         diagnostics)
        .at(0);
  }

  /// The control of the machine becomes another.
  void speak(const char* control) { job_.machine.control.kind = *machine::control_kind_named(control); }

  std::string said(const machine::Job& job, std::optional<nc::OneDirection> indexed = {}) const {
    Diagnostics diagnostics;
    PostureRequest request{.job = &job, .program = &program_, .moves = &moves_, .tool = 1, .options = {}};
    request.options.indexed = indexed.has_value();
    if (indexed) request.written = *indexed;
    make_postures(request, diagnostics);
    std::string out;
    for (Diagnostic d : diagnostics.all()) {
      d.source_line.clear();
      out += to_string(d) + "\n";
    }
    return out;
  }

  tests::TempFolder folder_;
  TriangleMesh mesh_;
  machine::Job job_;
  nc::Program program_;
  nc::Interpretation moves_;
};

TEST_F(PostureInATrough, ChosenDirectionsAreClearByASecondMethodAndTurnLess) {
  read(rows(mesh_));
  Diagnostics diagnostics;
  const Postured chosen = made(Mode::chosen, diagnostics), seed = made(Mode::seed, diagnostics);
  diagnostics.throw_if_errors();
  ASSERT_FALSE(chosen.blocked_move);
  EXPECT_EQ(chosen.figures.unclear, 0U);
  EXPECT_GT(chosen.figures.contacts, 70U);
  for (std::size_t i = 0; i < chosen.points.size(); ++i) {
    const Vec3 axis = chosen.axes[i], tip = chosen.points[i].tip_mm(axis);
    for (const Eigen::Vector3f& p : mesh_.points)
      ASSERT_GE(point_room_mm(job_.tools.at(1), 1, tip, axis, p.cast<double>()), -0.02) << i;
  }
  EXPECT_LT(chosen.figures.rotary_motion_deg, seed.figures.rotary_motion_deg);
  EXPECT_NE(chosen.text.find("\nM428\n"), std::string::npos);
  EXPECT_EQ(chosen.text.substr(0, 15), program_.source.text().substr(0, 15));
}

TEST_F(PostureInATrough, ShankAndHolderAreClearOfTheStockByASecondMethod) {
  read(rows(mesh_));
  Diagnostics diagnostics;
  const Postured without = made(Mode::chosen, diagnostics);
  // Something stands where the shank was in the middle of the path.
  const std::size_t middle = without.points.size() / 2;
  const Vec3 there = without.points[middle].tip_mm(without.axes[middle]) + 25 * without.axes[middle];
  job_.stock.box = machine::Box{there - Vec3::Constant(2), there + Vec3::Constant(2)};
  const Postured with = made(Mode::chosen, diagnostics);
  diagnostics.throw_if_errors();
  ASSERT_FALSE(with.blocked_move);
  const auto least_room = [&](const Postured& made) {
    double least = 1e9;
    for (std::size_t i = 0; i < made.points.size(); ++i)
      for (int k = 0; k < 125; ++k)
        least = std::min(least, room_behind_mm(job_.tools.at(1), 1, made.points[i].tip_mm(made.axes[i]), made.axes[i],
                                               there + Vec3(k % 5 - 2, k / 5 % 5 - 2, k / 25 - 2)));
    return least;
  };
  EXPECT_GT(least_room(with), -0.02);
  EXPECT_LT(least_room(without), -0.9);
}

TEST_F(PostureInATrough, WhatEarlierToolsCutIsNoObstacle) {
  const std::string head = "G21 G17 G90 G94\nT2 M6\nS3000 M3\nG0 X-20. Y0. Z60.\nG0 Z20.\n";
  const std::string slot = "G1 Z6. F600\nX20.\nG0 Z60.\n", tail = "T1 M6\nG0 X0. Y0. Z60.\nG1 Z7. F600\nG0 Z60.\nM2\n";
  job_.tools[1].flutes = 2;
  job_.tools[2] = job_.tools[1];
  job_.tools[2].number = 2;
  job_.tools[2].type = machine::ToolType::flat;
  job_.tools[2].diameter_mm = 16;
  job_.simulation.voxel_mm = 0.5;
  job_.stock.box = machine::Box{{-24, -12, -2}, {24, 12, 20}};
  const auto room = [&](const std::string& text, const Vec3& tip, double allowance) {
    read(text);
    job_.stock.allowance_mm = allowance;
    Diagnostics diagnostics;
    Surroundings around;
    const auto first = std::find_if(moves_.moves.begin(), moves_.moves.end(),
                                    [&](const nc::Move& m) { return moves_.state_of(m).tool == 1; });
    add_stock(job_, program_, moves_, static_cast<std::size_t>(first - moves_.moves.begin()), around, diagnostics);
    diagnostics.throw_if_errors();
    around.finish();
    // A pin of 2 mm that goes up from the tip.
    checks::TurnedSolid pin(checks::OutlineRing::Part::holder);
    pin.add(1, 0);
    pin.add(1, 50);
    ToolShape shape;
    shape.add(std::move(pin), 0.01);
    return around.room_mm(shape, tip, Vec3::UnitZ(), 20);
  };
  EXPECT_NEAR(room(head + slot + tail, {0, 0, 8}, 0), 2, 0.55);   // over the floor of the slot
  EXPECT_NEAR(room(head + slot + tail, {0, 3, 15}, 0), 4, 0.55);  // from its wall
  EXPECT_LT(room(head + slot + tail, {0, 8.5, 15}, 0), 0);
  EXPECT_LT(room(tail, {0, 3, 15}, 0), 0);                               // the whole block
  EXPECT_NEAR(room(head + slot + tail, {0, 0, 9}, 1), 2, 0.55);          // the slot is cut after the allowance
  EXPECT_NEAR(room(head + "G0 Z60.\n" + tail, {0, 0, 22}, 1), 2, 0.55);  // of the last tool alone a dimple
}

TEST_F(PostureInATrough, ATableOfOverhangsHasWhatEachOfThemGivesAlone) {
  read(rows(mesh_));
  job_.tools[1].holder = {{44, 44, 40}};
  Diagnostics diagnostics;
  PostureRequest request{.job = &job_, .program = &program_, .moves = &moves_, .tool = 1, .options = {}};
  request.overhangs_mm = {45, 27, 20, 15, 10};
  const std::vector<Postured> table = make_postures(request, diagnostics);
  ASSERT_EQ(table.size(), 5U);
  std::size_t blocked = 0, different = 0;
  for (std::size_t i = 0; i < table.size(); ++i) {
    PostureRequest one = request;
    one.overhangs_mm = {request.overhangs_mm[i]};
    const std::vector<Postured> alone = make_postures(one, diagnostics);
    EXPECT_EQ(table[i].text, alone.at(0).text) << i;
    EXPECT_EQ(table[i].blocked_move, alone[0].blocked_move) << i;
    blocked += table[i].blocked_move.has_value();
    different += i > 0 && !table[i].blocked_move && table[i].text != table[0].text;
  }
  diagnostics.throw_if_errors();
  EXPECT_GT(blocked, 0U);  // the wide holder does not follow everywhere
  EXPECT_LT(blocked, table.size());
  EXPECT_GT(different, 0U);
}

/// A flank, ever steeper towards +X or -X: from 10 to 50 degrees.
TriangleMesh flank(double side) {
  TriangleMesh mesh;
  constexpr int kCount = 41;
  std::vector<double> height{0};
  for (int i = 1; i < kCount; ++i) height.push_back(height.back() - std::tan(rad_from_deg(10 + i - 0.5)));
  for (int i = 0; i < kCount; ++i)
    for (const int y : {-20, 20})
      mesh.points.emplace_back(static_cast<float>(side * (i - 20)), static_cast<float>(y),
                               static_cast<float>(height[static_cast<std::size_t>(i)]));
  for (std::uint32_t i = 0; i + 1 < kCount; ++i) {
    mesh.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 3});
    mesh.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 1});
    if (side > 0) continue;
    for (std::size_t t = mesh.triangles.size() - 2; t < mesh.triangles.size(); ++t)
      std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  }
  return mesh;
}

TEST_F(PostureInATrough, RotaryAxesKeepTheirSolutionInACutThoughTheOtherOneIsNearer) {
  Diagnostics diagnostics;
  job_.machine = machine::read_machine(CAMBER_SOURCE_DIR "/samples/kinematics/table_bc.toml", diagnostics);
  job_.tools[1].holder = {{20, 24, 20}};
  for (const double side : {-1.0, 1.0}) {
    const TriangleMesh mesh = flank(side);
    job_.part.mesh = write_mesh(mesh, "flank.stl");
    removal::CutterShape ball;
    ball.radius_mm = ball.corner_radius_mm = 3;
    repath::DropCutter drop(mesh, ball);
    std::string text = "G21 G17 G90 G94\nG10 L2 P1 X0. Y0. Z0.\nG10 L1 P1 Z120.\nT1 M6\nG54\nS9000 M3\nG43 H1\n";
    text += "G0 X" + std::to_string(-14 * side) + " Y0. Z40.\n";
    for (int x = -14; x <= 14; ++x)
      text += "G1 X" + std::to_string(side * x) + " Z" +
              std::to_string(drop.at(Eigen::Vector2d(side * x, 0), std::nullopt)->tip_mm) + " F600.\n";
    read(text + "G0 Z40.\nM5\nM2\n");
    const Postured made_now = made(Mode::normal, diagnostics);
    diagnostics.throw_if_errors();
    EXPECT_EQ(made_now.figures.unclear, 0U);
    std::vector<double> b;
    std::istringstream lines(made_now.text);
    for (std::string line; std::getline(lines, line);)
      if (const auto at = line.find('B'); at != std::string::npos) b.push_back(std::stod(line.substr(at + 1)));
    ASSERT_GT(b.size(), 25U);
    EXPECT_GT(*std::ranges::max_element(b), 40) << side;  // beyond what B-35 reaches
    EXPECT_GT(*std::ranges::min_element(b), -1e-9) << side;
  }
}

TEST_F(PostureInATrough, OneDirectionIsTheSameHoweverItIsWritten) {
  read(rows(mesh_));
  std::vector<std::vector<ToolPose>> all;
  for (const nc::OneDirection written : {nc::OneDirection::tip, nc::OneDirection::tilted, nc::OneDirection::dynamic}) {
    speak(written == nc::OneDirection::tip ? "linuxcnc" : written == nc::OneDirection::tilted ? "fanuc" : "haas");
    Diagnostics diagnostics;
    PostureRequest request{.job = &job_, .program = &program_, .moves = &moves_, .tool = 1, .options = {}};
    request.options.indexed = true;
    request.written = written;
    const std::vector<Postured> made = make_postures(request, diagnostics);
    diagnostics.throw_if_errors();
    ASSERT_FALSE(made.at(0).blocked_move);
    EXPECT_EQ(made[0].text.find("M428") != std::string::npos, written == nc::OneDirection::tip);
    EXPECT_EQ(made[0].text.find("G68.2 X0. Y0. Z0. I") != std::string::npos, written == nc::OneDirection::tilted);
    EXPECT_EQ(made[0].text.find("\nG254\n") != std::string::npos, written == nc::OneDirection::dynamic);
    for (std::size_t i = 0; i < made[0].points.size(); ++i) {
      const Vec3 axis = made[0].axes[i], tip = made[0].points[i].tip_mm(axis);
      for (const Eigen::Vector3f& p : mesh_.points)
        ASSERT_GE(point_room_mm(job_.tools.at(1), 1, tip, axis, p.cast<double>()), -0.02) << i;
    }
    all.push_back(cut_ends(made[0].text));
  }
  ASSERT_GT(all[0].size(), 80U);
  EXPECT_GT(angle_between(all[0][0].axis, Vec3::UnitZ()), rad_from_deg(4));
  for (std::size_t way = 1; way < all.size(); ++way) {
    ASSERT_EQ(all[way].size(), all[0].size());
    for (std::size_t i = 0; i < all[0].size(); ++i) {
      EXPECT_LT((all[way][i].tip_mm - all[0][i].tip_mm).norm(), 0.001) << way << " " << i;
      EXPECT_LT(angle_between(all[way][i].axis, all[0][i].axis), 1e-5) << way << " " << i;
    }
  }
}

TEST_F(PostureInATrough, IsTheSameInEveryLanguage) {
  constexpr double kSamePlace_mm = 1e-6, kSameDirection = 1e-9;
  using enum nc::OneDirection;
  for (const bool indexed : {false, true})
    for (const nc::OneDirection written : {tip, tilted}) {
      if (!indexed && written == tilted) continue;
      std::vector<std::vector<ToolPose>> all;
      for (const char* control : {"fanuc", "heidenhain", "siemens"}) {
        SCOPED_TRACE(fmt::format("{} {}", control, static_cast<int>(written)));
        speak(control);
        read(control == std::string("fanuc") ? rows(mesh_) : rows_in(control, mesh_));
        Diagnostics diagnostics;
        PostureRequest request{.job = &job_, .program = &program_, .moves = &moves_, .tool = 1, .options = {}};
        request.options.indexed = indexed;
        request.written = written;
        const std::vector<Postured> made = make_postures(request, diagnostics);
        diagnostics.throw_if_errors();
        ASSERT_FALSE(made.at(0).blocked_move);
        const std::string& text = made[0].text;
        const std::string on = written == tilted ? "\nCYCLE800(0,\"\",100000,57,0,0,0," : "\nTRAORI\n";
        EXPECT_EQ(text.find(on) != std::string::npos, control == std::string("siemens")) << text.substr(0, 600);
        EXPECT_EQ(text.find(written == tilted ? " PLANE SPATIAL SPA" : " M128\n") != std::string::npos,
                  control == std::string("heidenhain"))
            << text.substr(0, 600);
        all.push_back(cut_ends(text));
        // As it was chosen.
        std::size_t contact = 0;
        for (std::size_t i = 0; i < made[0].points.size(); ++i) contact += !made[0].points[i].rapid;
        ASSERT_EQ(all.back().size(), contact);
        if (indexed) {
          for (const ToolPose& pose : all.back())
            EXPECT_LT((pose.axis - made[0].axes.front()).norm(), written == tilted ? kSameDirection : 3e-6);
        }
      }
      ASSERT_GT(all[0].size(), 80U);
      for (std::size_t k = 1; k < all.size(); ++k) {
        ASSERT_EQ(all[k].size(), all[0].size());
        for (std::size_t i = 0; i < all[0].size(); ++i) {
          // The angles of a tilted plane differ from language to language, and so does what rounds them.
          EXPECT_LT((all[k][i].tip_mm - all[0][i].tip_mm).norm(), written == tilted ? 2e-4 : kSamePlace_mm) << k;
          EXPECT_LT((all[k][i].axis - all[0][i].axis).norm(), written == tilted ? 3e-6 : kSameDirection) << k;
        }
      }
    }
}

TEST_F(PostureInATrough, SaysWhichFramesItCannotWrite) {
  using enum nc::OneDirection;
  read(rows(mesh_));
  const std::string end = "; joints or tip was expected for one direction of the tool [no-frame]\n";
  EXPECT_EQ(said(job_, tilted), "job.toml: error: LinuxCNC has no tilted frames (G68.2)" + end);
  EXPECT_EQ(said(job_, dynamic), "job.toml: error: LinuxCNC has no dynamic work offset (G254)" + end);
  speak("fanuc");
  EXPECT_EQ(said(job_, dynamic), "job.toml: error: Fanuc has no dynamic work offset (G254); tilted, " + end.substr(2));
  for (const auto& [control, title] : {std::pair("heidenhain", "Heidenhain"), std::pair("siemens", "Siemens")}) {
    speak(control);
    read(rows_in(control, mesh_));
    EXPECT_EQ(said(job_, dynamic),
              fmt::format("job.toml: error: {} has no dynamic work offset (G254); tilted, {}", title, end.substr(2)));
  }
  read(rows(mesh_));
  Diagnostics diagnostics;
  job_.machine = machine::read_machine(CAMBER_SOURCE_DIR "/samples/kinematics/head_table.toml", diagnostics);
  speak("haas");
  EXPECT_EQ(said(job_, dynamic),
            "job.toml: error: the head of the machine turns; G254 turns with the table, and tilted, joints or tip was "
            "expected [no-frame]\n");
  job_.machine = table();
  speak("fanuc");
  read("G21 G17 G90 G94\nT1 M6\nG0 X0. Y0. Z60.\nG68 X0 Y0 R30\nG1 Z10. F600\nG69\nM30\n");
  EXPECT_EQ(
      said(job_, tilted),
      "p.nc:5:1: error: this move has turned, mirrored or scaled coordinates; a frame for one direction of the tool "
      "was expected to be the only one [no-frame]\n");
}

TEST_F(PostureInATrough, SaysWhatItCannotTilt) {
  read("G21 G17 G90 G94\nT1 M6\nG0 X0. Y0. Z60.\nG1 Z10. F600\nM2\n");
  machine::Job job = job_;
  job.part.mesh.clear();
  EXPECT_EQ(said(job), "job.toml: error: [part] has no mesh; the STL file of the part was expected [no-part]\n");
  job = job_;
  job.tools[1].type = machine::ToolType::flat;
  EXPECT_EQ(
      said(job),
      "job.toml: error: [tool.1] is neither a ball nor a bull-nose cutter; one of these was expected [not-ball]\n");
  job = job_;
  job.tools.clear();
  EXPECT_EQ(said(job),
            "job.toml: error: the job has no [tool.1]; the tool of the finishing moves was expected [no-tool]\n");
  job = job_;
  job.machine.kinematics = {};
  EXPECT_EQ(said(job), "job.toml: error: the machine has no [kinematics]; rotary axes were expected [kinematics]\n");
  read("G21 G17 G90 G94\nT1 M6\nG0 X0. Y0. Z60.\nG1 Z10. A5. F600\nM2\n");
  EXPECT_EQ(said(job_),
            "p.nc:4:1: error: this move has directions of its own; moves of three axes were expected [rotary-axis]\n");
  read("G21 G17 G90 G94\nG0 X0. Y0. Z60.\nM2\n");
  EXPECT_EQ(said(job_),
            "p.nc:1:1: error: tool T1 has no moves in this program; finishing moves were expected [no-moves]\n");
}

}  // namespace
}  // namespace camber::posture
