// Which moves make holes, and the stamps along them.
#include "removal/tool_path.h"

#include <gtest/gtest.h>

#include "nc/interpreter.h"

namespace camber::removal {
namespace {

struct Holes {
  nc::Interpretation moves;
  std::vector<HoleMove> holes;
  StampPath path;

  std::size_t count(HoleMove kind) const { return static_cast<std::size_t>(std::ranges::count(holes, kind)); }
  /// Lowest tip of the path.
  double lowest() const {
    double z = 1e9;
    for (const auto& s : path.stamps) z = std::min(z, s.pose.tip_mm.z());
    return z;
  }
};

/// T1 is a flat end mill, T2 a drill; 2 flutes.
Holes holes_of(const std::string& text, const machine::Operations& operations = {},
               const machine::Machine& machine = {}) {
  Diagnostics diagnostics;
  const auto program = nc::read_program(SourceText("p.nc", text), diagnostics);
  Holes out{nc::interpret(program, {}, diagnostics), {}, {}};
  diagnostics.throw_if_errors();
  std::map<int, machine::Tool> tools;
  tools[1].type = machine::ToolType::flat;
  tools[2].type = machine::ToolType::drill;
  out.holes = hole_moves(out.moves, operations, tools);
  auto selected = selected_moves(out.moves, operations);
  for (std::size_t i = 0; i < selected.size(); ++i)
    if (out.holes[i] != HoleMove::none) selected[i] = false;
  StampBuilder builder(out.moves, tools, selected, out.holes);
  feedmodel::predict_feed(out.moves, machine, [&](auto samples) { builder.add(samples); });
  out.path = builder.take();
  return out;
}

const std::string kHead = "G21 G90 G17 G54\nT1 M6\nS3000 M3\nG0 X0 Y0 Z5\n";

TEST(HoleMoves, EveryPeckOfACycleIsDrilled) {
  const Holes h = holes_of(kHead + "G99 G83 X1 Y2 Z-7 R1 Q2 F300\nX4\nG80\nM30\n");
  EXPECT_EQ(h.count(HoleMove::drilled), 8u);  // 2 2 2 2 from R1 down to -7
  const HoleCount count = count_holes(h.moves, h.holes);
  EXPECT_EQ(count.drilled, 2u);
  EXPECT_EQ(count.tapped, 0u);
}

TEST(HoleMoves, TappingIsTappedAndFeedsOutOfTheHole) {
  const Holes h = holes_of(kHead + "G98 G84 X1 Y2 Z-7 R1 F300\nG85 X3 R1 Z-4\nG80\nM30\n");
  EXPECT_EQ(h.count(HoleMove::tapped), 1u);
  EXPECT_EQ(h.count(HoleMove::drilled), 1u);
  EXPECT_EQ(h.count(HoleMove::way_out), 2u);
  ASSERT_EQ(h.path.runs.size(), 2u);
  EXPECT_EQ(h.path.runs[0].kind, RunKind::tapping);
  EXPECT_EQ(h.path.runs[1].kind, RunKind::drilling);
}

/// A pocket and a bore that cycles mill (252, 208) are cut like lines and arcs of the program.
TEST(HoleMoves, PocketsOfCyclesAreMilled) {
  for (const char* cycle : {"CYCL DEF 252 Q215=0 Q223=30 Q368=0 Q207=500 Q351=1 Q201=-2 Q202=2 Q369=0 Q206=150 Q338=0 "
                            "Q200=2 Q203=0 Q204=20 Q370=1 Q366=0 Q385=400",
                            "CYCL DEF 208 Q200=2 Q201=-2 Q206=200 Q334=1 Q203=0 Q204=20 Q335=30 Q342=0"}) {
    const Holes h = holes_of(std::string("BEGIN PGM A MM\nTOOL DEF 1 L+0 R+4\nTOOL CALL 1 Z S3000\n"
                                         "L X+20 Y+30 Z+50 R0 FMAX M3\n") +
                             cycle + "\nCYCL CALL\nM30\nEND PGM A MM\n");
    EXPECT_EQ(h.count(HoleMove::none), h.holes.size()) << cycle;
    ASSERT_FALSE(h.path.runs.empty()) << cycle;
    EXPECT_EQ(h.path.runs[0].kind, RunKind::milling) << cycle;
    EXPECT_NEAR(h.lowest(), -2, 1e-6) << cycle;
  }
}

TEST(HoleMoves, BackBoringIsNotCarved) {
  const Holes h = holes_of(kHead + "G98 G87 X1 Y2 Z-3 R-7 Q0.5 F300\nG80\nM30\n");
  EXPECT_EQ(h.count(HoleMove::not_carved), 1u);
  EXPECT_TRUE(h.path.stamps.empty());
}

TEST(HoleMoves, ACycleAcrossTheToolsAxisIsNotCarved) {
  const Holes h = holes_of(kHead + "G18 G98 G81 X1 Z-3 Y-7 R2 F300\nG80\nM30\n");
  EXPECT_EQ(h.count(HoleMove::not_carved), 1u);
}

TEST(HoleMoves, StraightFeedsOfADrillAreDrilledButThoseOfAMillAreMilled) {
  const std::string pecks = "G0 X1 Y1\nG1 Z-2 F300\nG0 Z1\nG0 Z-1.8\nG1 Z-4\nG1 Z2\nG1 X5\n";
  const Holes mill = holes_of(kHead + pecks + "M30\n");
  EXPECT_EQ(mill.count(HoleMove::none), mill.holes.size());
  const Holes drill = holes_of(kHead + "T2 M6\nS3000 M3\nG0 X0 Y0 Z5\n" + pecks + "M30\n");
  EXPECT_EQ(drill.count(HoleMove::drilled), 2u);
  EXPECT_EQ(drill.count(HoleMove::way_out), 1u);
  EXPECT_EQ(count_holes(drill.moves, drill.holes).drilled, 1u);
  ASSERT_EQ(drill.path.runs.size(), 2u);
  EXPECT_EQ(drill.path.runs[0].kind, RunKind::drilling);
  EXPECT_EQ(drill.path.runs[1].kind, RunKind::milling) << "X5: job_checks refuses it";
}

TEST(HoleMoves, OperationsLeaveCyclesOut) {
  const Holes h = holes_of(kHead + "G81 X1 Y2 Z-7 R1 F300\nG80\nT2 M6\nS3000 M3\nG81 X4 Y2 Z-7 R1 F300\nG80\nM30\n",
                           {.tools = {2}, .blocks = {}, .comments = {}});
  EXPECT_EQ(h.count(HoleMove::drilled), 1u);
  ASSERT_EQ(h.path.runs.size(), 1u);
  EXPECT_EQ(h.path.runs[0].tool, 2);
}

TEST(HoleStamps, EndAtTheProgrammedBottomHoweverFarTheAxisLags) {
  for (const double gain : {20.0, 60.0})
    for (const double feed : {100.0, 3000.0}) {
      machine::Machine machine;
      for (auto& axis : machine.axis) {
        axis.acceleration_mm_per_s2 = 500;
        axis.position_gain_per_s = gain;
      }
      const Holes h =
          holes_of(kHead + "G99 G83 X1 Y2 Z-7 R1 Q2.5 F" + std::to_string(feed) + "\nX8 Y9\nG80\nM30\n", {}, machine);
      EXPECT_DOUBLE_EQ(h.lowest(), -7);
      std::vector<double> bottoms;
      for (std::size_t k = 0; k < h.path.stamps.size(); ++k) {
        const auto& s = h.path.stamps[k];
        EXPECT_TRUE(s.pose.tip_mm.head<2>() == Vec2(1, 2) || s.pose.tip_mm.head<2>() == Vec2(8, 9));
        EXPECT_LE(s.feed_per_tooth_mm.norm(), (1 + 1e-9) * feed / 6000);
        EXPECT_GE(s.t_s, h.path.stamps[k > 0 ? k - 1 : 0].t_s);
        if (k + 1 == h.path.stamps.size() || h.path.stamps[k + 1].first) bottoms.push_back(s.pose.tip_mm.z());
        EXPECT_TRUE(s.first || s.pose.tip_mm.z() < h.path.stamps[k - 1].pose.tip_mm.z());
      }
      ASSERT_EQ(bottoms.size(), 8u);
      for (std::size_t i = 0; i < bottoms.size(); ++i)
        EXPECT_DOUBLE_EQ(bottoms[i], std::max(-7.0, 1 - 2.5 * static_cast<double>(i % 4 + 1)));
    }
}

}  // namespace
}  // namespace camber::removal
