// Runs of cuts that stand in a program twice: the second time the same moves, the given lines byte for byte.
#include "nc/repeat.h"

#include <gtest/gtest.h>

#include "nc/emit.h"
#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

constexpr const char* kTwoRuns =
    "%\n"
    "N10 G21 G90 G17 F500\n"
    "N20 T1 M6\n"
    "N30 G54 S3000 M3\n"
    "N40 G0 X-2. Y-7. Z10.\n"
    "N50 G0 Z-6.\n"
    "(UP)\n"
    "N60 G1 X1.\n"
    "N70 G2 X4. Y-4. I3. J0. F640 (ROUND)\n"
    "N80 G1 X14.\n"
    "N90 G0 Z10.\n"
    "N100 X0 Y5.\n"
    "N110 Z2.\n"
    "N120 G1 Z-1. F300\n"
    "N130 X9. F640\n"
    "N140 G0 Z20.\n"
    "N150 M30\n"
    "%\n";

std::vector<bool> all_cuts(const Interpretation& moves) {
  std::vector<bool> out;
  for (const Move& m : moves.moves) out.push_back(m.kind == MoveKind::linear || m.kind == MoveKind::arc);
  return out;
}

std::vector<CutRun> runs_of(const Read& r) { return cut_runs(r.program, r.moves, all_cuts(r.moves)); }

/// Its own lines, as a first cut.
EarlierCut same_lines(const Read& r, const CutRun& run) {
  EarlierCut out{.run = run};
  for (std::uint32_t b = run.first_block; b <= run.last_block; ++b) {
    out.lines.emplace_back(r.program.source.line(b + 1));
    out.block_of_lines.push_back(b);
  }
  return out;
}

RunGap gap_of(const std::string& text) {
  const Read r = read_text(text);
  const auto runs = runs_of(r);
  EXPECT_FALSE(runs.empty()) << text;
  return runs.empty() ? RunGap::none : runs.front().why_not;
}

TEST(Repeat, FindsRunsBetweenRapidsAndTheWayBackToTheirStarts) {
  const Read r = read_clean(kTwoRuns);
  const auto runs = runs_of(r);
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].first_block, 7u);
  EXPECT_EQ(runs[0].last_block, 9u);
  EXPECT_EQ(runs[0].why_not, RunGap::none);
  ASSERT_EQ(runs[0].way_back.size(), 3u);
  expect_near_mm(runs[0].way_back[0], {14, -4, 10});
  expect_near_mm(runs[0].way_back[1], {-2, -7, 10});
  expect_near_mm(runs[0].way_back[2], {-2, -7, -6});
  EXPECT_NEAR(runs[0].way_back_mm, 16 + std::hypot(16, 3) + 16, 1e-9);
  // The rapid behind the run is higher than the program's own way down.
  ASSERT_EQ(runs[1].way_back.size(), 3u);
  expect_near_mm(runs[1].way_back[0], {9, 5, 20});
  expect_near_mm(runs[1].way_back[1], {0, 5, 20});
  expect_near_mm(runs[1].way_back[2], {0, 5, 2});
}

TEST(Repeat, PutsTheFirstCutAndRapidsBackBeforeTheRun) {
  const Read r = read_clean(kTwoRuns);
  const auto runs = runs_of(r);
  EarlierCut first = same_lines(r, runs[0]);
  first.lines[2] = "N80 G1 X14. Y-3.95";
  const std::array cuts{first, same_lines(r, runs[1])};
  const RepeatedText out = repeat_runs(r.program, r.moves, cuts);
  EXPECT_EQ(out.text,
            "%\n"
            "N10 G21 G90 G17 F500\n"
            "N20 T1 M6\n"
            "N30 G54 S3000 M3\n"
            "N40 G0 X-2. Y-7. Z10.\n"
            "N50 G0 Z-6.\n"
            "(UP)\n"
            "G1 X1.\n"
            "G2 X4. Y-4. I3. J0. F640 (ROUND)\n"
            "G1 X14. Y-3.95\n"
            "G0 Z10.\n"
            "G0 X-2. Y-7. Z10.\n"
            "G0 Z-6. F500\n"
            "N60 G1 X1.\n"
            "N70 G2 X4. Y-4. I3. J0. F640 (ROUND)\n"
            "N80 G1 X14.\n"
            "N90 G0 Z10.\n"
            "N100 X0 Y5.\n"
            "N110 Z2.\n"
            "G1 Z-1. F300\n"
            "X9. F640\n"
            "G0 Z20.\n"
            "G0 X0. Y5. Z20.\n"
            "G0 Z2.\n"
            "N120 G1 Z-1. F300\n"
            "N130 X9. F640\n"
            "N140 G0 Z20.\n"
            "N150 M30\n"
            "%\n");
  ASSERT_EQ(out.added.size(), out.block_of_line.size());
  EXPECT_EQ(out.block_of_line[7], 7u);
  EXPECT_TRUE(out.added[7]);
  EXPECT_EQ(out.block_of_line[10], Emission::kNoBlock);
  EXPECT_EQ(out.block_of_line[13], 7u);
  EXPECT_FALSE(out.added[13]);

  const Read twice = read_clean(out.text);
  double cut_mm = 0, given_mm = 0;
  for (const Move& m : r.moves.moves) given_mm += m.kind == MoveKind::rapid ? 0 : length_mm(r.moves, m);
  for (const Move& m : twice.moves.moves) cut_mm += m.kind == MoveKind::rapid ? 0 : length_mm(twice.moves, m);
  EXPECT_NEAR(cut_mm, 2 * given_mm, 0.1) << "the first cut lies 0.05 mm beside";
}

TEST(Repeat, ClosedRunsAreCutAgainWithoutARetract) {
  const Read r = read_clean(
      "G21 G90 G17\nT1 M6\nG54 S3000 M3\nG0 X-5. Y0 Z10.\nZ-2.\nG1 X0 F300\nG2 I10. F640\nG1 X-5.\nG0 Z10.\nM30\n");
  const auto runs = runs_of(r);
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_EQ(runs[0].why_not, RunGap::none);
  EXPECT_TRUE(runs[0].closed);
  EXPECT_TRUE(runs[0].way_back.empty());
  EarlierCut first = same_lines(r, runs[0]);
  first.lines = {"G1 X0.05 Z-1.98 F300", "G2 X0.05 I9.95 F640", "G1 X-4.95"};
  const std::array cuts{first};
  const RepeatedText out = repeat_runs(r.program, r.moves, cuts);
  EXPECT_EQ(out.text,
            "G21 G90 G17\nT1 M6\nG54 S3000 M3\nG0 X-5. Y0 Z10.\nZ-2.\n"
            "G1 X0.05 Z-1.98 F300\nG2 X0.05 I9.95 F640\nG1 X-4.95\nG1 X-5. Y0. Z-2.\n"
            "G1 X0 F300\nG2 I10. F640\nG1 X-5.\nG0 Z10.\nM30\n");
  EXPECT_EQ(out.block_of_line[8], Emission::kNoBlock);
  EXPECT_TRUE(out.added[8]);
}

TEST(Repeat, WritesInchesAndShiftedFramesInTheProgramsOwnCoordinates) {
  const Read inches = read_clean("G20 G90 G17 F20.\nT1 M6\nS3000 M3\nG0 X0 Y0 Z.5\nG0 Z-.1\nG1 X1.5\nG0 Z.5\nM30\n");
  const auto runs = runs_of(inches);
  ASSERT_EQ(runs.size(), 1u);
  const std::array one{same_lines(inches, runs[0])};
  EXPECT_EQ(repeat_runs(inches.program, inches.moves, one).text,
            "G20 G90 G17 F20.\nT1 M6\nS3000 M3\nG0 X0 Y0 Z.5\nG0 Z-.1\n"
            "G1 X1.5\nG0 Z.5\nG0 X0. Y0. Z.5\nG0 Z-.1\nG1 X1.5\nG0 Z.5\nM30\n");
  const Read shifted =
      read_clean("G21 G90 G17 F200\nT1 M6\nS3000 M3\nG52 X100. Y50.\nG0 X0 Y0 Z5.\nG0 Z-1.\nG1 X15.\nG0 Z5.\nM30\n");
  const auto there = runs_of(shifted);
  ASSERT_EQ(there.size(), 1u);
  const std::array two{same_lines(shifted, there[0])};
  EXPECT_NE(repeat_runs(shifted.program, shifted.moves, two).text.find("\nG0 X0. Y0. Z5.\nG0 Z-1.\n"),
            std::string::npos);
}

TEST(Repeat, RefusesRunsThatCannotStandTwice) {
  const std::string head = "G21 G90 G17 F300\nT1 M6\nS3000 M3\n";
  EXPECT_EQ(gap_of(head + "G0 X0 Y0 Z5.\nZ-1.\nG1 X5.\nG0 Z5.\nM30\n"), RunGap::none);
  EXPECT_EQ(gap_of(head + "G0 X0 Y0 Z5.\nZ-1.\nG1 X5.\nG91 G28 Z0\nM30\n"), RunGap::none);
  EXPECT_EQ(gap_of(head + "G0 X0 Y0 Z5.\nZ-1.\nG1 X5.\nG81 X9. Z-2. R2.\nM30\n"), RunGap::no_rapid_behind);
  EXPECT_EQ(gap_of(head + "G0 X0 Y0 Z5.\nZ-1.\nG91\nG1 X5.\nG90\nG0 Z5.\nM30\n"), RunGap::incremental);
  EXPECT_EQ(gap_of(head + "G0 X0 Y0 Z5.\nZ-1.\nG1 X5.\nM8\nX9.\nG0 Z5.\nM30\n"), RunGap::other_codes);
  EXPECT_EQ(gap_of(head + "G0 X0 Y0 Z5.\nZ-1.\nG1 X5.\nS2000 X9.\nG0 Z5.\nM30\n"), RunGap::other_codes);
  EXPECT_EQ(gap_of(head + "G1 X5. Z-1.\nG0 Z5.\nM30\n"), RunGap::no_rapid_before);
  EXPECT_EQ(gap_of(head + "G0 X0 Y0 Z-1.\nX1.\nG1 X5.\nX9.\nG0 X20.\nM30\n"), RunGap::no_height);
  EXPECT_EQ(gap_of(head + "G0 X0 Y0 Z5.\nZ-1.\n/G1 X5.\nX9.\nG0 Z5.\nM30\n"), RunGap::not_in_text);
  EXPECT_EQ(gap_of(head + "#1=0\nWHILE[#1 LT 2] DO1\nG0 X0 Y0 Z5.\nZ-1.\nG1 X5.\nG0 Z5.\n#1=#1+1\nEND1\nM30\n"),
            RunGap::not_in_text);
  const Read part = read_clean(head + "G0 X0 Y0 Z5.\nZ-1.\nG1 X5.\nX9.\nG0 Z5.\nM30\n");
  std::vector<bool> wanted = all_cuts(part.moves);
  *std::find(wanted.rbegin(), wanted.rend(), true) = false;
  const auto runs = cut_runs(part.program, part.moves, wanted);
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_EQ(runs[0].why_not, RunGap::others);
}

}  // namespace
}  // namespace camber::nc
