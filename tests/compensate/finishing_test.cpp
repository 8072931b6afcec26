#include "compensate/finishing.h"

#include <gtest/gtest.h>

#include "nc/interpreter.h"
#include "removal/tool_path.h"

namespace camber::compensate {
namespace {

const char* const kTwoTools =
    "G21 G90\nG0 X0. Y0. Z5.\n(ROUGHING)\nT1 M6\nS1000 M3\nG1 X10. F100\nX20.\n(FINISH WALLS)\nT2 M6\nG1 "
    "X30.\nX40.\n(CHAMFER)\nX50.\nM30\n";

simulate::SimulatedProgram machined(const std::string& text) {
  Diagnostics diagnostics;
  simulate::SimulatedProgram p{kinematics::open_program(SourceText("two.nc", text), {}, {}, diagnostics)};
  p.selected = removal::selected_moves(p.moves_in_part(), {});
  for (std::uint32_t m = 0; m < p.moves_in_part().moves.size(); ++m) {
    removal::Stamp stamp;
    stamp.move = m;
    p.path.stamps.push_back(stamp);
  }
  return p;
}

std::vector<removal::SurfacePoint> surface_of(std::initializer_list<int> stamps) {
  std::vector<removal::SurfacePoint> out;
  for (const int s : stamps) {
    removal::SurfacePoint p;
    p.area_mm2 = 1;
    p.machined_stamp = s;
    out.push_back(p);
  }
  return out;
}

TEST(Finishing, IsWhatMakesTheSurface) {
  const auto program = machined(kTwoTools);
  const auto f = find_finishing({}, program, surface_of({3, 3, 4, 5}));
  ASSERT_EQ(f.operations.size(), 2u);
  EXPECT_EQ(f.operations[0].tool, 1);
  EXPECT_EQ(f.operations[0].compensated_moves, 0u);
  EXPECT_EQ(f.operations[1].compensated_moves, 3u);
  EXPECT_DOUBLE_EQ(f.operations[1].surface_fraction, 1);
  EXPECT_EQ(f.moves, (std::vector<bool>{false, false, false, true, true, true}));
}

TEST(Finishing, ALongCommentIsReadByItsFirstWords) {
  const std::string long_text(420'000, 'x');
  const auto program = machined("G21 G90\nG0 X0. Y0. Z5.\n(FINISH " + long_text + ")\nG1 X10. F100\n(" + long_text +
                                " FINISH)\nG1 X20.\n");
  machine::Job job;
  job.compensation.operations.comments = "(finish|a)+.*";
  EXPECT_EQ(find_finishing(job, program, {}).moves, (std::vector<bool>{false, true, false}));
}

TEST(Finishing, GoesByToolLinesAndComments) {
  const auto program = machined(kTwoTools);
  machine::Job job;
  job.compensation.operations.tools = {1};
  EXPECT_EQ(find_finishing(job, program, {}).moves, (std::vector<bool>{false, true, true, false, false, false}));
  job.compensation.operations = {};
  job.compensation.operations.blocks = {{7, 10}};
  EXPECT_EQ(find_finishing(job, program, {}).moves, (std::vector<bool>{false, false, true, true, false, false}));
  job.compensation.operations = {};
  job.compensation.operations.comments = "finish";
  EXPECT_EQ(find_finishing(job, program, {}).moves, (std::vector<bool>{false, false, false, true, true, false}));
}

TEST(Finishing, RefusesCutterRadiusCompensation) {
  const auto program = machined("G21 G90\nG0 X0. Y0.\nG41 D1 X5.\nG1 Y10. F100\nG40 X0.\nM30\n");
  nc::Interpretation moves = program.commanded();
  for (auto& s : moves.states) s.cutter_radius = true;
  const simulate::SimulatedProgram moved{kinematics::MachineProgram(program.text(), std::move(moves))};
  Diagnostics diagnostics;
  check_compensated(moved, {false, false, true, false}, diagnostics);
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(to_string(diagnostics.all()[0]),
            "two.nc:4:1: error: 1 move to compensate runs under cutter radius compensation (G41, G42), from here on: "
            "the control computes their path, and the text has no words for it; a program of the cutter centre, or "
            "[compensation] operations without these blocks, was expected [cutter-radius]\n"
            "    G1 Y10. F100\n"
            "    ^");
}

TEST(Finishing, SaysWhereNoMoveHasWordsOfItsOwn) {
  const auto program = machined(
      "G21 G90 G17 G54\nT1 M6\nS3000 M3\nG0 X0. Y0.\n#1=0\nWHILE [#1 LT 3] DO1\nG1 X[#1+1] F300\n#1=#1+1\nEND1\nM30\n");
  std::vector<bool> lines(program.moves_in_part().moves.size());
  for (std::size_t m = 0; m < lines.size(); ++m)
    lines[m] = program.moves_in_part().moves[m].kind == nc::MoveKind::linear;
  Diagnostics diagnostics;
  check_compensated(program, lines, diagnostics);
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(diagnostics.all()[0].severity, Severity::error);
  EXPECT_EQ(diagnostics.all()[0].location.line, 7u);
  EXPECT_EQ(diagnostics.all()[0].check, "nothing-to-compensate");
}

TEST(Finishing, SaysWhereNothingIsLeftToCompensate) {
  const auto program = machined(kTwoTools);
  Diagnostics diagnostics;
  check_compensated(program, std::vector<bool>(6, false), diagnostics);
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(diagnostics.all()[0].check, "nothing-to-compensate");
}

}  // namespace
}  // namespace camber::compensate
