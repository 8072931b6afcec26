// A trace on its program's moves: matched by line and by place, and what is no trace of it is refused.
#include "calib/traced_motion.h"

#include <gtest/gtest.h>

#include "nc/interpreter.h"
#include "nc/program_text.h"
#include "tests/support/temp_folder.h"

namespace camber::calib {
namespace {

constexpr double kPeriod_s = 0.001;

/// A square of 10 mm at F600 after a rapid; lines 3 to 6 cut.
constexpr const char* kProgram = "G21 G90 G17 G94\nG0 X0 Y0 Z0\nG1 X10 F600\nG1 Y10\nG1 X0\nG1 Y0\nM2\n";

struct Square {
  nc::Program text;
  nc::Interpretation moves;
  std::vector<bool> cut;

  Square() {
    Diagnostics none;
    text = nc::read_program(SourceText("square.nc", kProgram), none);
    moves = nc::interpret(text, {}, none);
    for (const auto& m : moves.moves) cut.push_back(m.kind == nc::MoveKind::linear);
  }
};

/// A tool that follows the square at 10 mm/s, `lag_mm` behind on the path, so that it cuts no corner.
ServoTrace trace_of_square(bool with_line, double lag_mm = 0.3, double to_mm = 41) {
  ServoTrace t;
  t.path = "trace.csv";
  t.has_command = t.has_actual = {true, true, true};
  const auto on_square = [](double s) {
    s = std::clamp(s, 0.0, 40.0);
    const int side = std::min(static_cast<int>(s / 10), 3);
    const double u = s - 10 * side;
    constexpr double kStart[4][2] = {{0, 0}, {10, 0}, {10, 10}, {0, 10}},
                     kWay[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    return Vec3(kStart[side][0] + u * kWay[side][0], kStart[side][1] + u * kWay[side][1], 0);
  };
  for (int i = 0; 0.01 * i < to_mm; ++i) {
    const double s = 0.01 * i;
    t.t_s.push_back(kPeriod_s * i);
    t.row.push_back(static_cast<std::size_t>(i) + 2);
    t.command_mm.push_back(on_square(s));
    t.actual_mm.push_back(on_square(s - lag_mm));
    if (with_line) t.line.push_back(s >= 40 ? 0 : static_cast<std::uint32_t>(3 + s / 10));
  }
  set_stretches(t);
  return t;
}

/// The message where it is refused; empty: it is not.
std::string refusal(const ServoTrace& trace) {
  const Square square;
  Diagnostics diagnostics;
  try {
    traced_motion(trace, square.text, square.moves, square.cut, diagnostics);
  } catch (const InputError& e) {
    std::string text = e.what();
    while (!text.empty() && text.back() == '\n') text.pop_back();
    return text;
  }
  return {};
}

TEST(TracedMotion, FollowsTheProgramByLineAndByPlaceAlike) {
  const Square square;
  Diagnostics none;
  const TracedMotion by_line = traced_motion(trace_of_square(true), square.text, square.moves, square.cut, none);
  const TracedMotion by_place = traced_motion(trace_of_square(false), square.text, square.moves, square.cut, none);
  EXPECT_TRUE(by_line.by_line);
  EXPECT_FALSE(by_place.by_line);
  EXPECT_TRUE(none.all().empty());
  EXPECT_LT(by_line.off_path_max_mm, 1e-9);
  EXPECT_NEAR(by_line.time_s, 4.0, 0.002);  // of the axes
  EXPECT_NEAR(by_line.cutting_time_s, 4.0, 0.002);
  ASSERT_EQ(by_line.samples.size(), by_place.samples.size());
  std::size_t apart = 0;
  for (std::size_t i = 0; i < by_line.samples.size(); ++i) {
    EXPECT_EQ(by_line.samples[i].position_mm, by_place.samples[i].position_mm);
    apart += by_line.samples[i].move != by_place.samples[i].move;
  }
  EXPECT_LE(apart, 4u);  // a sample at each corner
  EXPECT_NEAR(by_line.samples[500].velocity_mm_per_s.norm(), 10, 1e-9);
  EXPECT_EQ(square.moves.moves[by_line.samples[1500].move].block + 1, 4u);
}

TEST(TracedMotion, TakesLinesThatTheControlMerges) {
  for (const std::uint32_t first : {3u, 5u}) {
    ServoTrace t = trace_of_square(true);
    // Two sides under the number of the first, or of the second of them.
    for (auto& line : t.line) line = line == first + 1 ? first : line;
    EXPECT_EQ(refusal(t), "");
    t = trace_of_square(true);
    for (auto& line : t.line) line = line == first ? first + 1 : line;
    EXPECT_EQ(refusal(t), "");
  }
}

TEST(TracedMotion, RefusesMissingAxes) {
  ServoTrace t = trace_of_square(true);
  t.has_actual = {true, false, false};
  EXPECT_EQ(refusal(t),
            "trace.csv: error: the trace has no y_act_mm and no z_act_mm; x_act_mm, y_act_mm and z_act_mm, where the "
            "axes were, are expected [trace-column]");
}

TEST(TracedMotion, RefusesAnotherProgram) {
  ServoTrace t = trace_of_square(true);
  t.line[20] = 12;
  EXPECT_EQ(refusal(t),
            "trace.csv:22:1: error: line 12 is commanded, but square.nc has 7 lines; a trace of this program was "
            "expected [trace-program]");
  t = trace_of_square(true);
  for (std::size_t i = 3000; i < 3500; ++i) t.line[i] = 3;
  EXPECT_EQ(refusal(t),
            "trace.csv:3002:1: error: line 3 is commanded after line 5, but square.nc does not run in this order; a "
            "trace of this program was expected [trace-program]");
  for (const bool with_line : {true, false}) {
    t = trace_of_square(with_line);
    for (auto* places : {&t.command_mm, &t.actual_mm})
      for (Vec3& p : *places) p.z() += 2;
    EXPECT_EQ(refusal(t),
              with_line
                  ? "trace.csv:2:1: error: the axes are 2 mm off line 3 of square.nc (at X0.000 Y0.000 Z2.000); a "
                    "trace of this program, in the same work offset, was expected [trace-program]"
                  : "trace.csv:4101:1: error: the axes never come to line 3 of square.nc, the first that is cut; a "
                    "trace of this program, in the same work offset, was expected [trace-program]");
  }
  t = trace_of_square(true);
  for (Vec3& p : t.actual_mm) p.z() += 0.6;
  EXPECT_EQ(refusal(t),
            "trace.csv: error: in the cut, a twentieth of the samples is 0.6 mm or more off the path of square.nc; a "
            "trace of this program, in the same work offset, was expected [trace-program]");
}

/// Without the samples from ... end - 1.
ServoTrace without(ServoTrace t, std::size_t from, std::size_t end) {
  const auto erase = [&](auto& values) {
    if (!values.empty())
      values.erase(values.begin() + static_cast<std::ptrdiff_t>(from),
                   values.begin() + static_cast<std::ptrdiff_t>(end));
  };
  erase(t.t_s), erase(t.command_mm), erase(t.actual_mm), erase(t.line), erase(t.row);
  set_stretches(t);
  return t;
}

TEST(TracedMotion, RefusesAGapInTheCutAlone) {
  EXPECT_EQ(refusal(without(trace_of_square(true), 1500, 1520)),
            "trace.csv:1522:1: error: 0.02 s are missing before 1.52 s, in the cut of line 4 of square.nc; a trace "
            "without gaps in the cut was expected [trace-gap]");
  EXPECT_EQ(refusal(without(trace_of_square(true), 4050, 4080)), "");  // at rest after the cut
}

TEST(TracedMotion, RefusesATraceThatEndsOrBeginsInTheCut) {
  EXPECT_EQ(refusal(trace_of_square(true, 0.3, 25)),
            "trace.csv:2501:1: error: the trace ends in line 5 of square.nc; it was expected to go on to line 6, the "
            "last that is cut [trace-end]");
  EXPECT_EQ(
      refusal(trace_of_square(true, 0.3, 35)),
      "trace.csv:3501:1: error: the trace ends in the middle of line 6 of square.nc, the last that is cut; a trace "
      "of all of it was expected [trace-end]");
  EXPECT_EQ(refusal(without(trace_of_square(true), 0, 1800)),
            "trace.csv:1802:1: error: the axes go from line 2 to line 4 of square.nc without 17.7 mm of the cut "
            "between them; a trace of the whole cut was expected [trace-program]");
}

}  // namespace
}  // namespace camber::calib
