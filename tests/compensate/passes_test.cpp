// Which runs are cut twice, and the program that does.
#include "compensate/passes.h"

#include <gtest/gtest.h>

#include "nc/interpreter.h"

namespace camber::compensate {
namespace {

simulate::SimulatedProgram read(const std::string& text) {
  Diagnostics diagnostics;
  simulate::SimulatedProgram out{
      kinematics::open_program(SourceText("p.nc", text), {}, {.given = {.inch = false}}, diagnostics)};
  EXPECT_FALSE(diagnostics.has_errors());
  return out;
}

std::vector<bool> cuts_of(const simulate::SimulatedProgram& p) {
  std::vector<bool> out;
  for (const nc::Move& m : p.moves_in_part().moves)
    out.push_back(m.kind == nc::MoveKind::linear || m.kind == nc::MoveKind::arc);
  return out;
}

std::string messages(const Diagnostics& diagnostics) {
  std::string out;
  for (Diagnostic d : diagnostics.all()) {
    d.source_line.clear();
    out += to_string(d) + "\n";
  }
  return out;
}

constexpr const char* kRows =
    "G21 G90 G17\nT1 M6\nG54 S3000 M3\nG0 X0 Y0 Z5.\nZ-1.\nG1 X9. F300\nG0 Z5.\nX0 Y1.\nZ-1.\nG1 X9.\nG0 Z5.\n"
    "X0 Y2.\nZ-1.\nG1 X9.\nG0 Z5.\nM30\n";

TEST(Passes, CutTwiceTheRunsOfTheGreatestErrorThatFit) {
  const std::vector<PassRun> runs{{{}, 10, 0.004}, {{}, 10, 0.012}, {{}, 25, 0.020}, {{}, 10, 0.008}};
  using Chosen = std::vector<std::size_t>;
  EXPECT_EQ(choose_passes(runs, 100, 0.005), (Chosen{1, 2, 3}));
  EXPECT_EQ(choose_passes(runs, 35, 0.005), (Chosen{1, 2})) << "the worst one first";
  EXPECT_EQ(choose_passes(runs, 20, 0), (Chosen{1, 3})) << "the worst one does not fit";
  EXPECT_EQ(choose_passes(runs, 5, 0), Chosen{});
}

TEST(Passes, CutAgainWhatIsExpectedToBeLeftOver) {
  const std::vector<PassRun> runs{{{}, 10, 0.030}, {{}, 10, 0.012}, {{}, 10, 0.004}};
  using Chosen = std::vector<std::size_t>;
  EXPECT_EQ(choose_passes(runs, 100, 0.005, 3), (Chosen{0, 0, 1})) << "30, 7.5 and then 1.9 um; 12 and then 3 um";
  EXPECT_EQ(choose_passes(runs, 20, 0.005, 3), (Chosen{0, 1})) << "the worst one first";
  EXPECT_EQ(choose_passes(runs, 100, 0, 2), (Chosen{0, 0, 1, 1, 2, 2}));
}

TEST(Passes, LeaveTheDepthOfTheSingleCutAndHalfATolerance) {
  EXPECT_DOUBLE_EQ(pass_allowance_mm(0.040, 0.010), 0.045);
  EXPECT_DOUBLE_EQ(pass_allowance_mm(0.002, 0.005), 0.020) << "an edge must cut";
}

TEST(Passes, ErrorsAreThoseOfTheRunThatMakesTheSurface) {
  const simulate::SimulatedProgram given = read(kRows);
  const std::vector<bool> cuts = cuts_of(given);
  const ShiftPath path(given.moves_in_part(), cuts, 3);
  std::vector<Observation> observations;
  std::vector<double> left;
  for (std::uint32_t m = 0; m < cuts.size(); ++m) {
    if (!cuts[m]) continue;
    for (int i = 0; i < 100; ++i) {
      Observation o;
      o.place = path.find(m, i / 100.0);
      o.area_mm2 = 1;
      observations.push_back(o);
      left.push_back((observations.size() > 100 && i < 10 ? -0.010 : 0.001));
    }
  }
  const auto runs = pass_runs(given, cuts, path, observations, left);
  ASSERT_EQ(runs.size(), 3u);
  EXPECT_DOUBLE_EQ(runs[0].left_mm, 0.001);
  EXPECT_DOUBLE_EQ(runs[1].left_mm, 0.010) << "a tenth of it";
  EXPECT_DOUBLE_EQ(runs[2].left_mm, 0.010);
}

TEST(Passes, TheGivenMovesStandInTheRepeatedProgramAsTheyWere) {
  const simulate::SimulatedProgram given = read(kRows);
  const std::vector<bool> cuts = cuts_of(given);
  const auto found = pass_runs(given, cuts, ShiftPath(given.moves_in_part(), cuts, 3), {}, {});
  const nc::Emission same = nc::emit_edits(given.text(), given.moves_in_part(), {}, {});
  const std::vector<std::size_t> chosen{1};
  const nc::RepeatedText text = with_first_cuts(given, found, chosen, same);
  const simulate::SimulatedProgram twice = read(text.text);
  std::uint32_t wrong = 0;
  const auto moves = moves_in_repeated(given.moves_in_part(), twice.moves_in_part(), text, wrong);
  ASSERT_TRUE(moves.has_value()) << text.text;
  ASSERT_EQ(moves->size(), given.moves_in_part().moves.size());
  EXPECT_EQ(moves->back(), twice.moves_in_part().moves.size() - 1);
  EXPECT_EQ(twice.moves_in_part().moves.size(), given.moves_in_part().moves.size() + 4) << "a cut and three rapids\n"
                                                                                        << text.text;
}

TEST(Passes, RunsStandAsOftenAsTheyAreChosen) {
  const simulate::SimulatedProgram given = read(kRows);
  const std::vector<bool> cuts = cuts_of(given);
  const ShiftPath path(given.moves_in_part(), cuts, 3);
  const auto found = pass_runs(given, cuts, path, {}, {});
  const std::vector<std::size_t> chosen{1, 1, 2};
  const nc::RepeatedText text =
      with_first_cuts(given, found, chosen, nc::emit_edits(given.text(), given.moves_in_part(), {}, {}));
  const simulate::SimulatedProgram again = read(text.text);
  std::uint32_t wrong = 0;
  EXPECT_TRUE(moves_in_repeated(given.moves_in_part(), again.moves_in_part(), text, wrong).has_value()) << text.text;
  EXPECT_EQ(again.moves_in_part().moves.size(), given.moves_in_part().moves.size() + 3 * 4) << text.text;

  std::vector<Observation> observations(3);
  for (std::size_t i = 0; i < 3; ++i) observations[i].place = path.find(found[i].run.first_move, 0.5);
  const std::vector<double> left =
      left_after_passes_mm(found, chosen, path, observations, std::vector{0.01, 0.01, 0.01});
  EXPECT_DOUBLE_EQ(left[0], 0.01);
  EXPECT_DOUBLE_EQ(left[1], 0.01 / 16);  // a cut leaves a quarter
  EXPECT_DOUBLE_EQ(left[2], 0.01 / 4);
}

TEST(Passes, RunsThatLeaveAnotherModalStateBehindAreFound) {
  // The arcs' centre is absolute from the second line of the run on; cut again, the first arc would be another one.
  const simulate::SimulatedProgram given = read(
      "G21 G90 G17 G91.1\nT1 M6\nG54 S3000 M3\nG0 X0 Y0 Z5.\nZ-1.\nG3 X10. Y0 I5. J0 F300\n"
      "G90.1 G3 X20. Y0 I15. J0\nG0 Z5.\nM30\n");
  const std::vector<bool> cuts = cuts_of(given);
  const auto found = pass_runs(given, cuts, ShiftPath(given.moves_in_part(), cuts, 3), {}, {});
  ASSERT_EQ(found.size(), 1u);
  const nc::RepeatedText text = with_first_cuts(given, found, std::vector<std::size_t>{0},
                                                nc::emit_edits(given.text(), given.moves_in_part(), {}, {}));
  Diagnostics diagnostics;
  const simulate::SimulatedProgram twice{
      kinematics::open_program(SourceText("p.nc", text.text), {}, {.given = {.inch = false}}, diagnostics)};
  std::uint32_t wrong = 0;
  EXPECT_FALSE(moves_in_repeated(given.moves_in_part(), twice.moves_in_part(), text, wrong).has_value());
  EXPECT_EQ(given.moves_in_part().moves[wrong].block, 5u);
}

TEST(Passes, SayWhatCannotBeCutTwice) {
  Diagnostics none, some;
  const simulate::SimulatedProgram incremental =
      read("G21 G90 G17\nT1 M6\nG54 S3000 M3\nG0 X0 Y0 Z5.\nZ-1.\nG91\nG1 X9. F300\nG90\nG0 Z5.\nM30\n");
  check_passes(incremental, cuts_of(incremental), none);
  EXPECT_EQ(messages(none),
            "p.nc:7:1: error: levers names \"passes\", but none of the cuts to compensate can be made twice: those "
            "from here on are incremental (G91); levers without \"passes\" were expected [lever-unusable]\n");
  const simulate::SimulatedProgram mixed = read(
      "G21 G90 G17\nT1 M6\nG54 S3000 M3\nG0 X0 Y0 Z5.\nZ-1.\nG1 X9. F300\nM8\nX12.\nG0 Z5.\nX0 Y2.\nZ-1.\n"
      "G1 X9.\nG0 Z5.\nM30\n");
  check_passes(mixed, cuts_of(mixed), some);
  EXPECT_EQ(messages(some),
            "p.nc:6:1: warning: 1 of 2 runs of cuts between rapids cannot be made twice; the moves of the first, from "
            "here on, have M, S, T or H words among them [not-repeatable]\n");
}

}  // namespace
}  // namespace camber::compensate
