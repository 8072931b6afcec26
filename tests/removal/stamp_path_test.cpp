#include "removal/tool_path.h"

#include <gtest/gtest.h>

#include "nc/interpreter.h"

namespace camber::removal {
namespace {

struct Timed {
  nc::Interpretation moves;
  StampPath path;
};

Timed stamps_of(const std::string& text, const machine::Operations& operations = {}) {
  Diagnostics diagnostics;
  const auto program = nc::read_program(SourceText("p.nc", text), diagnostics);
  Timed out{nc::interpret(program, {}, diagnostics), {}};
  std::map<int, machine::Tool> tools;
  for (const int number : {1, 2}) tools[number].flutes = 2;
  machine::Machine machine;  // no limits: the axes follow at once
  StampBuilder builder(out.moves, tools, selected_moves(out.moves, operations));
  feedmodel::predict_feed(out.moves, machine, [&](auto samples) { builder.add(samples); });
  out.path = builder.take();
  return out;
}

constexpr const char* kTwoTools =
    "G21 G90\nT1 M6\nS3000 M3\nG0 X0 Y0 Z1\nG1 X9 F900\nG0 Z5\nT2 M6\nS6000 M3\nG0 X0 Y0 Z1\nG1 X9 F900\nM30\n";

TEST(StampPath, SetsAStampEveryToothPassing) {
  const auto [moves, path] = stamps_of(kTwoTools);
  ASSERT_EQ(path.runs.size(), 2u);
  EXPECT_EQ(path.runs[0].tool, 1);
  // 9 mm at 15 mm/s; 3000 rpm with two flutes pass every 10 ms: 0.15 mm apart.
  EXPECT_NEAR(static_cast<double>(path.runs[0].count), 60, 2);
  EXPECT_NEAR(static_cast<double>(path.runs[1].count), 120, 2);
  for (std::size_t k = 5; k < 55; ++k) {
    EXPECT_FALSE(path.stamps[k].first);
    EXPECT_NEAR(path.stamps[k].feed_per_tooth_mm.x(), 0.15, 1e-6);
    EXPECT_NEAR(path.stamps[k].t_s - path.stamps[k - 1].t_s, 0.01, 1e-9);
  }
  EXPECT_TRUE(path.stamps[0].first);
  EXPECT_TRUE(path.stamps[path.runs[1].from].first);
}

TEST(StampPath, TakesOnlyTheOperationsThatTheJobNames) {
  const auto [moves, path] = stamps_of(kTwoTools, {.tools = {2}, .blocks = {}, .comments = {}});
  ASSERT_EQ(path.runs.size(), 1u);
  EXPECT_EQ(path.runs[0].tool, 2);
  const auto [moves2, path2] = stamps_of(kTwoTools, {.tools = {}, .blocks = {{1, 5}}, .comments = {}});
  ASSERT_EQ(path2.runs.size(), 1u);
  EXPECT_EQ(path2.runs[0].tool, 1);
}

TEST(StampPath, SetsNoStampsInRapidsAndDwells) {
  const auto [moves, path] = stamps_of("G21 G90\nT1 M6\nS3000 M3\nG0 X0 Y0 Z1\nG1 X3 F900\nG4 P1\nG0 X6\nG1 X9\nM30\n");
  for (const auto& s : path.stamps) {
    EXPECT_EQ(moves.moves[s.move].kind, nc::MoveKind::linear);
    EXPECT_TRUE(s.pose.tip_mm.x() < 3.2 || s.pose.tip_mm.x() > 5.8);
  }
  EXPECT_LT(path.stamps.size(), 50u);
}

}  // namespace
}  // namespace camber::removal
