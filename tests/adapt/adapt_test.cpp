#include "adapt/adaptation.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "adapt/feed_cells.h"
#include "kinematics/control_options.h"
#include "nc/interpreter.h"
#include "tests/adapt/small_job.h"

namespace camber::adapt {
namespace {

using tests::adapted;
using tests::Adapted;
using tests::chip_of_force;
using tests::feed_of_chip;
using tests::SmallJob;
using tests::TempFolder;

constexpr double kAimed = 0.97;       // of the limit
constexpr double kVoxelError = 0.04;  // of the feed: the force of a voxel field differs by up to 2 %

/// Two passes along X: the second one meets a radial depth of 4 mm up to x = 35 and of 2 mm behind it.
const std::string kStep =
    "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS6000 M3\nG0 X80 Y-3 Z5\nG0 Z-2\nG1 X40 F600\nG0 Y-20\nG0 X-10\nG0 Y-1\n"
    "G1 X75 F600\nG0 Z5\nM30\n";

/// Feed after of the cell that ends nearest to `from_start` on the move of a line.
double feed_at(const AdaptResult& r, std::size_t line, double from_start_mm) {
  double start = 0, best = 1e9, feed = 0;
  bool met = false;
  for (std::size_t i = 0; i < r.trace.line.size(); ++i) {
    if (r.trace.line[i] != line) continue;
    if (!met) start = i > 0 ? r.trace.along_mm[i - 1] : 0;
    met = true;
    const double away = std::abs(r.trace.along_mm[i] - start - from_start_mm);
    if (away < best) best = away, feed = r.trace.feed_after_mm_per_s[i];
  }
  return feed;
}

TEST(Adapt, ShoulderWithAStepInItsRadialDepthGetsTheFeedsOfTheForceLaw) {
  const TempFolder folder;
  const Adapted a = adapted(folder, {.program = kStep});
  EXPECT_TRUE(a.result.good);
  const double h = chip_of_force(kAimed * 250, 2);
  const double wide = feed_of_chip(h, 4), narrow = feed_of_chip(h, 2);
  // From x = -10: the step lies at 45 mm and takes the shape of the cutter.
  EXPECT_NEAR(feed_at(a.result, 10, 30) / wide, 1, kVoxelError);
  EXPECT_NEAR(feed_at(a.result, 10, 65) / narrow, 1, kVoxelError);
  ASSERT_EQ(a.result.loads.size(), 1u);
  EXPECT_LT(a.result.loads[0].max_after, kOverLimit * 250);
  EXPECT_GT(a.result.loads[0].max_after, kUnderLimit * 250);
}

TEST(Adapt, AirIsCutAtTheHighestFeedAndTheCutterEntersAtThatOfTheCut) {
  const TempFolder folder;
  const Adapted a = adapted(folder, {.program = kStep});
  const double wide = feed_of_chip(chip_of_force(kAimed * 250, 2), 4);
  // Line 10 begins at x = -10; the cutter meets the block at about x = -4.9.
  EXPECT_NEAR(feed_at(a.result, 10, 1.5), 4000.0 / 60, 1e-6);
  for (double x = 5.0; x < 12; x += 0.5) EXPECT_LT(feed_at(a.result, 10, x), 1.05 * wide) << x;
}

TEST(Adapt, SlotOfGrowingDepthGetsAFallingFeed) {
  const TempFolder folder;
  // The first pass rises through the block and leaves a floor that the second one cuts to z = -3: at the front of the
  // cutter the depth is 3 mm + the height of the first pass at the cutter's centre, whatever the angle.
  const std::string program =
      "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS6000 M3\nG0 X-10 Y10 Z5\nG0 Z-2.5\nG1 X0 F500\nG1 X70 Z-0.5\nG1 X80\n"
      "G0 Z5\nG0 X-10\nG0 Z-3\nG1 X60 F500\nG0 Z5\nM30\n";
  const Adapted a =
      adapted(folder, {.program = program, .box_mm = "[[0, 0, -4], [70, 20, 0]]", .limits = "force_N = 300.0"});
  EXPECT_TRUE(a.result.good);
  const auto by_law = [](double x) {
    const double depth = 3 - 2.5 + 2.0 / 70 * x;
    return feed_of_chip(chip_of_force(kAimed * 300, depth), 5);
  };
  // A run has the feed of its deepest place; the next one is lower by up to a step or two.
  for (const double x : {15.0, 25.0, 35.0, 45.0, 55.0}) {
    const double feed = feed_at(a.result, 12, x + 10);
    EXPECT_LT(feed, (1 + kVoxelError) * by_law(x)) << x;
    EXPECT_GT(feed, by_law(x) / 1.16) << x;
  }
  EXPECT_GT(feed_at(a.result, 12, 20), 1.5 * feed_at(a.result, 12, 65));
}

TEST(Adapt, AskedFeedsAreReachedByTheControl) {
  // Lines of 6 mm with a stop at each corner: to and fro along a shoulder of 1 mm.
  std::string program = "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS6000 M3\nG0 X-6 Y-4 Z5\nG0 Z-2\nG1 X3 F300\n";
  for (int i = 0; i < 8; ++i) program += fmt::format("G1 X{}\nG1 Y{}\n", 9 + 6 * i, i % 2 == 0 ? -3.5 : -4.0);
  program += "G0 Z5\nM30\n";
  const TempFolder slow_folder, fast_folder;
  const Adapted slow = adapted(slow_folder, {.program = program, .acceleration_mm_per_s2 = 120});
  const Adapted fast = adapted(fast_folder, {.program = program, .acceleration_mm_per_s2 = 5000});
  EXPECT_LT(fast.result.time_after_s, 0.8 * slow.result.time_after_s);
  const PathTrace& t = slow.result.trace;
  for (std::size_t i = 0; i < t.line.size();) {
    std::size_t end = i;
    double reached = 0;
    for (; end < t.line.size() && t.feed_after_mm_per_s[end] == t.feed_after_mm_per_s[i]; ++end)
      reached = std::max(reached, t.speed_after_mm_per_s[end]);
    const bool raised = t.feed_after_mm_per_s[i] > t.feed_before_mm_per_s[i] * 1.001;
    if (raised) {
      EXPECT_GT(reached, 0.95 * t.feed_after_mm_per_s[i]) << "line " << t.line[i];
    }
    i = end;
  }
}

nc::Interpretation moves_of(const machine::Job& job, const std::string& text) {
  Diagnostics diagnostics;
  const auto program = nc::read_program(SourceText("p.nc", text), diagnostics);
  return nc::interpret(program, kinematics::interpreter_options(job.machine, job.inch), diagnostics);
}

TEST(Adapt, OnlyFeedsAndSplitsDiffer) {
  const TempFolder folder;
  const Adapted a = adapted(folder, {.program = kStep});
  const SourceText before("", kStep), after("", a.result.text);
  const auto without_feed = [](std::string_view line) {
    const std::size_t f = line.find(" F");
    return std::string(f == std::string_view::npos ? line : line.substr(0, f));
  };
  std::vector<std::size_t> lines(before.line_count(), 0);
  for (std::size_t i = 0; i < a.result.block_of_line.size(); ++i) {
    const std::uint32_t block = a.result.block_of_line[i];
    ASSERT_LT(block, before.line_count());
    ++lines[block];
  }
  for (std::size_t i = 0, line = 0; i < before.line_count(); line += lines[i], ++i) {
    ASSERT_GE(lines[i], 1u);
    if (lines[i] == 1) {
      EXPECT_EQ(without_feed(after.line(line + 1)), without_feed(before.line(i + 1)));
    }
  }
  const nc::Interpretation given = moves_of(a.job, kStep), emitted = moves_of(a.job, a.result.text);
  double length_before = 0, length_after = 0;
  for (const auto& m : given.moves) length_before += nc::length_mm(given, m);
  for (const auto& m : emitted.moves) length_after += nc::length_mm(emitted, m);
  EXPECT_NEAR(length_after, length_before, 1e-3);
  EXPECT_GT(a.result.blocks_after, a.result.blocks_before);
}

TEST(Adapt, FeedsAreTheSameForAnyNumberOfCallsAndDifferByMoreThanAStep) {
  const TempFolder folder;
  const Adapted a = adapted(folder, {.program = kStep}), b = adapted(folder, {.program = kStep});
  EXPECT_EQ(a.result.text, b.result.text);
  const PathTrace& t = a.result.trace;
  for (std::size_t i = 1; i < t.line.size(); ++i) {
    const double low = std::min(t.feed_after_mm_per_s[i - 1], t.feed_after_mm_per_s[i]);
    const double high = std::max(t.feed_after_mm_per_s[i - 1], t.feed_after_mm_per_s[i]);
    const bool programmed = t.feed_after_mm_per_s[i] == t.feed_before_mm_per_s[i] ||
                            t.feed_after_mm_per_s[i - 1] == t.feed_before_mm_per_s[i - 1];
    if (low == high || programmed || t.line[i] != t.line[i - 1]) continue;
    EXPECT_GT(high, 1.05 * low * (1 - 1e-9)) << i;
  }
}

TEST(Adapt, BlocksOverTheLimitAtTheLowestFeedAreNamed) {
  const TempFolder folder;
  // The wide part needs less than the lowest feed, the narrow one does not.
  const double wide = 60 * feed_of_chip(chip_of_force(250, 2), 4);
  const Adapted a = adapted(folder, {.program = kStep, .feeds = fmt::format("[{:.0f}, 4000]", 1.15 * wide)});
  EXPECT_TRUE(a.result.good);
  ASSERT_FALSE(a.result.over.empty());
  for (const OverLimit& o : a.result.over) {
    EXPECT_EQ(o.line, 10u);
    EXPECT_EQ(o.reason, OverReason::lowest_feed);
    EXPECT_GT(o.value, kOverLimit * 250);
  }
  EXPECT_LT(a.result.loads[0].max_elsewhere, kOverLimit * 250);
}

TEST(Adapt, OtherLoadsAreKeptAsWell) {
  const TempFolder folder;
  const Adapted torque = adapted(folder, {.program = kStep, .limits = "torque_Nm = 0.9"});
  EXPECT_TRUE(torque.result.good);
  // M = (Ktc h + Kte) a_p R of the thickest chip.
  const double h = (kAimed * 900 / 2 / 5 - tests::kKte) / tests::kKtc;
  EXPECT_NEAR(feed_at(torque.result, 10, 30) / feed_of_chip(h, 4), 1, kVoxelError);
  const Adapted chip = adapted(folder, {.program = kStep, .limits = "chip_mm = 0.05"});
  EXPECT_NEAR(feed_at(chip.result, 10, 30) / feed_of_chip(kAimed * 0.05, 4), 1, kVoxelError);
  EXPECT_NEAR(feed_at(chip.result, 10, 65) / feed_of_chip(kAimed * 0.05, 2), 1, kVoxelError);
  const Adapted both = adapted(folder, {.program = kStep, .limits = "chip_mm = 0.05, force_N = 250.0, power_W = 600"});
  EXPECT_TRUE(both.result.good);
  for (const LoadFigure& f : both.result.loads) EXPECT_LT(f.max_after, kOverLimit * f.limit.value);
}

TEST(Adapt, TimeLimitScalesTheLimitsAndTheSweepFallsWithThem) {
  const TempFolder folder;
  const Adapted free = adapted(folder, {.program = kStep}, {.time_limit_s = {}, .sweep = true, .progress = {}});
  ASSERT_GE(free.result.sweep.size(), 5u);
  for (std::size_t i = 1; i < free.result.sweep.size(); ++i)
    EXPECT_LE(free.result.sweep[i].time_s, 1.01 * free.result.sweep[i - 1].time_s);
  const double wanted = 0.85 * free.result.time_after_s;
  const Adapted hurried = adapted(folder, {.program = kStep}, {.time_limit_s = wanted, .sweep = false, .progress = {}});
  EXPECT_TRUE(hurried.result.in_time);
  EXPECT_GT(hurried.result.limit_factor, 1.05);
  EXPECT_LT(hurried.result.time_after_s, 1.02 * wanted);
  const Adapted never = adapted(folder, {.program = kStep}, {.time_limit_s = 0.1, .sweep = false, .progress = {}});
  EXPECT_FALSE(never.result.in_time);
}

TEST(Adapt, UnknownLoadKeepsTheProgrammedFeed) {
  const TempFolder folder;
  SmallJob job{.program = kStep};
  job.simulation += "\n[operations]\nblocks = [[10, 12]]";
  tests::write_job(folder, job);
  Diagnostics diagnostics;
  const machine::Job read = machine::read_job(folder / "job.toml", diagnostics);
  const AdaptResult r = adapt(read, diagnostics, {});
  EXPECT_NEAR(feed_at(r, 6, 20), 10, 1e-9);
  const auto unknown = std::ranges::find(diagnostics.all(), "load-unknown", &Diagnostic::check);
  ASSERT_NE(unknown, diagnostics.all().end());
  EXPECT_EQ(unknown->location.line, 6u);
}

TEST(AdaptSettings, AreWrittenAsTheyAreRead) {
  const TempFolder folder;
  tests::write_job(folder, {.program = kStep, .limits = "torque_Nm = 1.2, deflection_um = 30.0, chip_min_mm = 0.01"});
  Diagnostics diagnostics;
  const machine::Job job = machine::read_job(folder / "job.toml", diagnostics);
  ASSERT_TRUE(job.adapt);
  EXPECT_NEAR(*job.adapt->limits.torque_Nmm, 1200, 1e-9);
  EXPECT_NEAR(*job.adapt->limits.deflection_mm, 0.03, 1e-12);
  EXPECT_FALSE(job.adapt->limits.force_N);
  EXPECT_NEAR(job.adapt->step_fraction, 0.05, 1e-12);
  const std::string text = machine::to_toml(job);
  EXPECT_NE(text.find("[adapt]\nlimits = { torque_Nm = 1.2, deflection_um = 30, chip_min_mm = 0.01 }\n"
                      "feed_mm_per_min = [100, 4000]\nstep_percent = 5\n"),
            std::string::npos)
      << text;
}

}  // namespace
}  // namespace camber::adapt
