// Jobs of a part of a program: which surface is theirs, and operations by comment.
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/units.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using nlohmann::json;
using tests::file_text;
using tests::run_camber;
using tests::TempFolder;

/// Two slots of 4 mm along X through a block of 8 mm, the second (T2) 3 mm beside the first; 1 mm deep, unless said.
std::string two_slots(const std::string& second_z = "-1") {
  return "G21 G90 G17 G40 G49 G80 G54\n(FIRST SLOT)\nT1 M6\nS3000 M3\nG0 X-4 Y0 Z5\nG0 Z-1\nG1 X12 F900\nG0 Z5\n"
         "(SECOND SLOT)\nT2 M6\nS3000 M3\nG0 X-4 Y3 Z5\nG0 Z" +
         second_z + "\nG1 X12 F900\nG0 Z5\nM30\n";
}

std::string tool(int number) {
  return "[tool." + std::to_string(number) + "]\ntype = \"flat\"\ndiameter_mm = 4.0\nflutes = 2\noverhang_mm = 30.0\n";
}

json predicted(const std::string& program, const std::string& operations, const std::string& tools,
               const std::string& part = "") {
  const TempFolder folder;
  folder.write("p.nc", program);
  folder.write("machine.toml", "[axis.x]\nacceleration_mm_per_s2 = 500\n[axis.y]\n[axis.z]\n");
  folder.write("job.toml",
               "program = \"p.nc\"\nmachine = \"machine.toml\"\n" + operations + tools +
                   "[material]\nktc_MPa = 20.0\nkrc_MPa = 7.0\n[stock]\nbox_mm = [[0, -8, -5], [8, 8, 0]]\n" + part +
                   "[simulation]\nvoxel_mm = 0.1\ncoupling = \"rigid\"\n");
  const auto run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 0) << run.err;
  json out = json::parse(file_text(folder / "r/summary.json"));
  out["printed"] = run.out;
  out["points"] = file_text(folder / "r/form_error.csv");
  return out;
}

constexpr double kWall_mm2 = 8 * 1, kFloor_mm2 = 8 * 4;

/// A map leaves 0.15 mm along the blank's faces out.
void expect_area(double area_mm2, double whole_mm2) {
  EXPECT_LE(area_mm2, 1.02 * whole_mm2);
  EXPECT_GE(area_mm2, 0.75 * whole_mm2);
}

/// Rows of form_error.csv for which `wanted` is true of y and ny.
template <class Wanted>
std::vector<std::string> rows_of(const json& predicted, Wanted wanted) {
  std::vector<std::string> out;
  std::istringstream lines(predicted["points"].get<std::string>());
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    double x = 0, y = 0, z = 0, nx = 0, ny = 0;
    char comma = 0;
    std::istringstream(line) >> x >> comma >> y >> comma >> z >> comma >> nx >> comma >> ny;
    if (wanted(y, ny)) out.push_back(line);
  }
  return out;
}

bool any(double, double) { return true; }
bool is_far_wall(double y, double ny) { return y > 1.9 && ny < -0.9; }

TEST(Region, TheWallThatAnotherOperationTakesAwayIsNotOfIt) {
  // Both slots have their floor at one height: what of it lies in both sweeps is still this region's.
  const json alone = predicted(two_slots(), "operations = { tools = [1] }\n", tool(1));
  EXPECT_EQ(alone["border_mm2"], 0) << "nothing is known of T2";
  expect_area(alone["form_error_um"]["area_mm2"], kFloor_mm2 + 2 * kWall_mm2);
  const json known = predicted(two_slots(), "operations = { tools = [1] }\n", tool(1) + tool(2));
  expect_area(known["border_mm2"], kWall_mm2);
  EXPECT_NEAR(known["form_error_um"]["area_mm2"].get<double>() + known["border_mm2"].get<double>(),
              alone["form_error_um"]["area_mm2"].get<double>(), 1e-6);
  // Just that wall is gone, and nothing else has changed.
  EXPECT_GT(rows_of(alone, is_far_wall).size(), 100u);
  EXPECT_EQ(rows_of(known, any), rows_of(alone, [](double y, double ny) { return !is_far_wall(y, ny); }));
  EXPECT_NE(known["printed"].get<std::string>().find("not judged, other operations cut deeper there: "),
            std::string::npos);
  EXPECT_EQ(known["stage_between"], false);
}

TEST(Region, AnEarlierOperationCountsAsWell) {
  const json second = predicted(two_slots(), "operations = { blocks = [[10, 15]] }\n", tool(1) + tool(2));
  expect_area(second["border_mm2"], kWall_mm2);
}

TEST(Region, WhatLiesDeeperIsNotOfIt) {
  // The second slot goes 2 mm deep: it takes a quarter of the first one's floor, and the wall.
  const json deeper = predicted(two_slots("-2"), "operations = { tools = [1] }\n", tool(1) + tool(2));
  expect_area(deeper["border_mm2"], kWall_mm2 + kFloor_mm2 / 4);
  EXPECT_TRUE(rows_of(deeper, [](double y, double) { return y > 1.01; }).empty());
}

TEST(Region, AStageBetweenIsJudgedAsAWhole) {
  const std::string again =
      "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\nG0 X-4 Y0 Z5\nG0 Z-1\nG1 X12 F900\nG0 Z5\nT2 M6\nS3000 M3\n"
      "G0 X-4 Y0 Z5\nG0 Z-2\nG1 X12 F900\nG0 Z5\nM30\n";
  const std::string wide = "[tool.2]\ntype = \"flat\"\ndiameter_mm = 5.0\nflutes = 2\noverhang_mm = 30.0\n";
  const json rough = predicted(again, "operations = { tools = [1] }\n", tool(1) + wide);
  EXPECT_EQ(rough["stage_between"], true);
  EXPECT_EQ(rough["border_mm2"], 0);
  expect_area(rough["form_error_um"]["area_mm2"], kFloor_mm2 + 2 * kWall_mm2);
  // The same passes over the same place are no border of each other.
  const json twice = predicted(std::string(again).replace(again.find("Z-2"), 3, "Z-1"),
                               "operations = { tools = [1] }\n", tool(1) + tool(2));
  EXPECT_EQ(twice["border_mm2"], 0);
  EXPECT_EQ(twice["stage_between"], false);
}

TEST(Region, JudgedNamesMovesOfTheTarget) {
  const json all = predicted(two_slots(), "", tool(1) + tool(2));
  const json second = predicted(two_slots(), "", tool(1) + tool(2), "[part]\njudged = { comments = \"second\" }\n");
  EXPECT_NEAR(second["form_error_um"]["area_mm2"].get<double>() + second["not_judged_mm2"].get<double>(),
              all["form_error_um"]["area_mm2"].get<double>(), 1e-6);
  // Of the floor between the slots, at y from 1 to 2, either one may have the points.
  for (const std::string& row : rows_of(all, [](double y, double) { return y > 2.1; }))
    EXPECT_NE(second["points"].get<std::string>().find(row), std::string::npos) << row;
  EXPECT_TRUE(rows_of(second, [](double y, double) { return y < 0.99; }).empty());
}

TEST(Region, ThatBeginsInTheMiddleOfACutIsWarnedOf) {
  const TempFolder folder;
  folder.write("p.nc",
               "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\nG0 X-4 Y0 Z5\nG0 Z-1\nG1 X-3 F900\nG1 X4\nG1 X12\n"
               "G0 Z5\nM30\n");
  folder.write("machine.toml", "[axis.x]\n[axis.y]\n[axis.z]\n");
  const auto said_of = [&](const std::string& blocks) {
    folder.write("job.toml",
                 "program = \"p.nc\"\nmachine = \"machine.toml\"\noperations = { blocks = " + blocks + " }\n" +
                     tool(1) +
                     "[material]\nktc_MPa = 20.0\nkrc_MPa = 7.0\n[stock]\nbox_mm = [[0, -8, -5], [8, 8, 0]]\n"
                     "[simulation]\nvoxel_mm = 0.2\ncoupling = \"rigid\"\n");
    return run_camber(folder, "predict job.toml -o r").err;
  };
  const std::string in_a_cut = said_of("[[8, 8]]");
  EXPECT_NE(in_a_cut.find(
                "p.nc:8:1: warning: the job's operations begin here, in the middle of a cut: T1 stands in material, "
                "which is removed without chips; a range that begins at a rapid was expected [starts-in-material]"),
            std::string::npos)
      << in_a_cut;
  // The chips of what the cutter stood in are missing, as the error behind says.
  EXPECT_NE(in_a_cut.find("camber: error: the chips add up to"), std::string::npos) << in_a_cut;
  EXPECT_EQ(said_of("[[7, 8]]"), "") << "the feed move before it ends beside the block";
  EXPECT_EQ(said_of("[[5, 8]]"), "");
}

TEST(Region, TheAllowanceInWhichARapidEndsIsNoChip) {
  const TempFolder folder;
  folder.write("p.nc", "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\nG0 X4 Y0 Z5\nG0 Z-1\nG1 X12 F900\nG0 Z5\nM30\n");
  folder.write("machine.toml", "[axis.x]\n[axis.y]\n[axis.z]\n");
  folder.write("job.toml",
               "program = \"p.nc\"\nmachine = \"machine.toml\"\n" + tool(1) +
                   "[material]\nktc_MPa = 20.0\nkrc_MPa = 7.0\n[stock]\nbox_mm = [[0, -8, -5], [8, 8, 0]]\n"
                   "allowance_mm = 0.3\n[simulation]\nvoxel_mm = 0.1\ncoupling = \"rigid\"\ncollisions = \"off\"\n");
  const auto run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err.find("the chips add up to"), std::string::npos) << run.err;
  // A cylinder of radius 2 and 1 mm deep, less what lies 0.3 mm inside of it or of the slot ahead, and the first chip.
  const double ahead = 1.7 * std::sqrt(4 - 1.7 * 1.7) + 4 * std::asin(0.85);
  const json removed = json::parse(file_text(folder / "r/summary.json"))["removed_mm3"];
  EXPECT_NEAR(removed["rapid"].get<double>(), kPi * 4 - 0.7 * (kPi * 1.7 * 1.7 / 2 + ahead), 0.3);
  EXPECT_NE(run.out.find(" mm3 of the allowance that rapids end in)"), std::string::npos) << run.out;
}

TEST(Region, NothingOfTheAllowanceIsLeftWhereATipEndsAtTheUnderside) {
  // A slot of 4 mm through a plate of 2 mm: a skin of 0.3 mm lies on its two walls, and there is no floor.
  const TempFolder folder;
  folder.write("machine.toml", "[axis.x]\n[axis.y]\n[axis.z]\n");
  folder.write("job.toml",
               "program = \"p.nc\"\nmachine = \"machine.toml\"\n" + tool(1) +
                   "[material]\nktc_MPa = 20.0\nkrc_MPa = 7.0\n[stock]\nbox_mm = [[0, -8, -2], [8, 8, 0]]\n"
                   "allowance_mm = 0.3\n[simulation]\nvoxel_mm = 0.1\ncoupling = \"rigid\"\ncollisions = \"off\"\n");
  for (const char* z : {"-2", "-2.4"}) {
    folder.write("p.nc", std::string("G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\nG0 X-4 Y0 Z5\nG0 Z") + z +
                             "\nG1 X12 F900\nG0 Z5\nM30\n");
    for (const char* in : {"", " --sections 2"}) {
      const auto run = run_camber(folder, std::string("predict job.toml -o r") + in);
      EXPECT_EQ(run.status, 0) << run.err;
      const json removed = json::parse(file_text(folder / "r/summary.json"))["removed_mm3"];
      EXPECT_NEAR(removed["path"].get<double>(), 2 * 0.3 * 2 * 8, 0.2) << z << in;
      // Half a voxel at the underside is lost where the tip ends in the same plane.
      EXPECT_NEAR(removed["stock"].get<double>(), 2 * 0.3 * 2 * 8, 0.3) << z << in;
    }
  }
}

TEST(Region, ThatBeginsBehindARapidIntoTheStockIsWarnedOf) {
  const TempFolder folder;
  folder.write("p.nc",
               "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\nG0 X4 Y0 Z-1\nG4 P0.2\nG0 X4\nG1 X12 F900\nG0 Z5\nM30\n");
  folder.write("machine.toml", "[axis.x]\n[axis.y]\n[axis.z]\n");
  const auto said_of = [&](const std::string& box) {
    folder.write("job.toml", "program = \"p.nc\"\nmachine = \"machine.toml\"\noperations = { blocks = [[7, 7]] }\n" +
                                 tool(1) + "[material]\nktc_MPa = 20.0\nkrc_MPa = 7.0\n[stock]\nbox_mm = " + box +
                                 "\n[simulation]\nvoxel_mm = 0.2\ncoupling = \"rigid\"\ncollisions = \"off\"\n");
    return run_camber(folder, "predict job.toml -o r").err;
  };
  EXPECT_NE(said_of("[[0, -8, -5], [8, 8, 0]]")
                .find("p.nc:7:1: warning: the job's operations begin here, behind a rapid that ends in the stock: T1 "
                      "stands in material, which is removed without chips; a stock that leaves the start free was "
                      "expected [starts-in-material]"),
            std::string::npos);
  EXPECT_EQ(said_of("[[7, -8, -5], [15, 8, 0]]"), "");
}

TEST(OperationsByComment, AreTheLinesUnderTheComment) {
  for (const auto& [comments, blocks] :
       {std::pair("first", "[[2, 9]]"), std::pair("SECOND slot", "[[9, 16]]"), std::pair("slot", "[[1, 16]]")}) {
    json by_comment =
        predicted(two_slots(), "operations = { comments = \"" + std::string(comments) + "\" }\n", tool(1) + tool(2));
    json by_lines =
        predicted(two_slots(), "operations = { blocks = " + std::string(blocks) + " }\n", tool(1) + tool(2));
    for (json* j : {&by_comment, &by_lines})
      for (const char* key : {"compute_s", "printed"}) j->erase(key);
    EXPECT_EQ(by_comment, by_lines) << comments;
  }
}

TEST(OperationsByComment, SayWhereNothingMatches) {
  const TempFolder folder;
  folder.write("p.nc", two_slots());
  folder.write("machine.toml", "[axis.x]\n[axis.y]\n[axis.z]\n");
  const auto error_of = [&](const std::string& operations) {
    folder.write("job.toml",
                 "program = \"p.nc\"\nmachine = \"machine.toml\"\noperations = { " + operations + " }\n" + tool(1) +
                     tool(2) +
                     "[material]\nktc_MPa = 20.0\nkrc_MPa = 7.0\n[stock]\nbox_mm = [[0, -8, -5], [8, 8, 0]]\n");
    const auto run = run_camber(folder, "predict job.toml -o r");
    EXPECT_EQ(run.status, 1) << run.out;
    return run.err;
  };
  EXPECT_EQ(error_of("comments = \"third\""),
            "p.nc: error: no line, arc or hole belongs to the job's operations; a tool and a range that cut were "
            "expected [nothing-to-cut]\n");
  EXPECT_NE(error_of("comments = \"first(\"")
                .find("job.toml:3:27: error: comments = \"first(\" is not a regular expression; one such as "
                      "\"finish|contour\" was expected [regular-expression]"),
            std::string::npos);
}

}  // namespace
}  // namespace camber
