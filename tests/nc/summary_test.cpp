#include "nc/summary.h"

#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

TEST(NcSummary, CountsMovesToolsAndLengths) {
  const Read r = read_clean(
      "G0 X0 Y0 Z0\nT1 M6\nS1000 M3\nG1 X10 F100\nG1 X20 F200\nG0 Y5\nT2 M6\nS500\nG3 X20 Y15 J5 F300\nG4 P2\nT1 "
      "M6\nG1 X0 "
      "F50\nG28 Z0\n");
  const Summary s = summarize(r.program, r.moves);
  EXPECT_EQ(s.blocks, 13u);
  EXPECT_EQ(s.rapids, 3u);
  EXPECT_EQ(s.lines, 3u);
  EXPECT_EQ(s.arcs, 1u);
  EXPECT_EQ(s.dwells, 1u);
  EXPECT_EQ(s.reference, 2u);
  EXPECT_EQ(s.dwell_s, 2);
  ASSERT_EQ(s.tools.size(), 2u);
  EXPECT_EQ(s.tools[0].tool, 1);
  EXPECT_EQ(s.tools[0].line, 2u);
  EXPECT_EQ(s.tools[0].calls, 2u);
  EXPECT_EQ(s.tools[0].cutting_moves, 3u);
  EXPECT_NEAR(s.tools[0].cutting_length_mm, 40, 1e-9);
  EXPECT_NEAR(s.tools[0].feed_mm_per_min.min, 50, 1e-9);
  EXPECT_NEAR(s.tools[0].feed_mm_per_min.max, 200, 1e-9);
  EXPECT_EQ(s.tools[1].line, 7u);
  EXPECT_EQ(s.tools[1].spindle_speed_rpm.max, 500);
  EXPECT_NEAR(s.cutting_length_mm, 40 + 5 * kPi, 1e-9);
  EXPECT_NEAR(s.rapid_length_mm, 5, 1e-9);
  expect_near_mm(s.cutting.max_mm, {25, 15, 0});
}

TEST(NcSummary, ExtentsHoldTheWholeArc) {
  for (const char* text : {"G0 X10 Y0 Z0\nG3 X0 Y10 I-10 J-3 F9 (refused)\n", "G0 X10 Y0 Z0\nG3 I-10 Z5 F9\n",
                           "G0 X0 Y6 Z8\nG19 G2 Y-8 Z6 J-6 K-8 F9\n", "G0 X6 Y0 Z8\nG18 G3 X-8 Z-6 I-6 K-8 Y3 F9\n",
                           "G0 X6 Y8 Z0\nG2 X8 Y6 I-6 J-8 F9\n"}) {
    const Read r = read_text(text);
    if (r.moves.moves.size() < 2) continue;
    const Move& m = r.moves.moves[1];
    const Extents box = extents_of(r.moves, m);
    Extents sampled;
    for (int i = 0; i <= 20000; ++i) sampled.add(point_at(r.moves, m, i / 20000.0));
    expect_near_mm(box.min_mm, sampled.min_mm, 1e-6);
    expect_near_mm(box.max_mm, sampled.max_mm, 1e-6);
  }
}

}  // namespace
}  // namespace camber::nc
