// The whole loop on a small inclined plane: the error falls, the emitted program is the user's own but for coordinates.
#include "compensate/compensate_path.h"

#include <cmath>

#include <cctype>
#include <regex>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compensate/verify_program.h"
#include "nc/emit.h"
#include "nc/interpreter.h"
#include "test_paths.h"
#include "tests/support/temp_folder.h"

namespace camber::compensate {
namespace {

/// Rows along X on the plane z = y (45 degrees), cut by a ball of R3; the tip stands R (1 - sqrt(1/2)) beside it.
std::string plane_program(double deeper_mm = 0) {
  std::string out = "%\nO0007 (PLANE)\nG21 G90 G17 G40 G49 G80\nT1 M6 (6. BALL)\nG54 S3000 M3\nG0 X8. Y-4. Z12.\n";
  int number = 10;
  for (double s = -1.8; s < 5; s += 0.3) {
    const double c = std::sqrt(0.5), y = s * c - 3 * c, z = s * c + 3 * c - 3 - deeper_mm;
    out += fmt::format("N{} G0 X8. Y{:.4f}\nZ{:.4f}\nG1 X4.25 F900\nX0.5\nX-3.\nG0 Z12. (ROW)\n", number, y, z);
    number += 10;
  }
  return out + "M5\nM30\n%\n";
}

machine::Job plane_job(const tests::TempFolder& folder) {
  machine::Job job;
  job.path = folder / "job.toml";
  job.program = folder.write("plane.nc", plane_program());
  for (auto& axis : job.machine.axis) {
    axis.acceleration_mm_per_s2 = 1000;
    axis.max_velocity_mm_per_s = 100;
  }
  machine::Tool tool;
  tool.number = 1;
  tool.diameter_mm = 6;
  tool.helix_rad = kPi / 6;
  tool.overhang_mm = 40;
  job.tools[1] = tool;
  job.material = {2000, 700, 0, 15, 15, 0};
  job.stock.box = machine::Box{{0, 0, -1}, {5, 3, 4}};
  job.stock.allowance_mm = 0.2;
  job.simulation.voxel_mm = 0.15;
  job.simulation.coupling = machine::Coupling::rigid;
  job.compensation.max_rounds = 2;
  job.compensation.tolerance_um = 0.1;
  job.compensation.max_overcut_um = 50;
  job.compensation.levers = {machine::Lever::shift};
  return job;
}

/// The text without its coordinate words.
std::string without_coordinates(const std::string& text) {
  static const std::regex coordinate(R"( ?[XYZIJK]-?[0-9.]+)");
  return std::regex_replace(text, coordinate, "");
}

TEST(Compensate, LowersTheFeedWhereNoShiftHelps) {
  Diagnostics diagnostics;
  machine::Job job = machine::read_job(CAMBER_SOURCE_DIR "/samples/06-wall/job.toml", diagnostics);
  job.compensation.levers = {machine::Lever::shift, machine::Lever::feed};
  CompensateOptions options;
  options.time_budget_percent = 15;
  const CompensationResult c = compensate(job, diagnostics, options);
  std::string rounds;
  for (const Round& r : c.rounds)
    rounds += fmt::format("{:.2f} um, {:.2f} s, {} changes\n", r.error_um.p95, r.machine_time_s, r.slowed);
  ASSERT_EQ(c.time_points.size(), 2u) << rounds;
  const Round &shifted = c.rounds[c.time_points[0].round], &slower = c.rounds[c.time_points[1].round];
  EXPECT_LT(slower.error_um.p95, 0.9 * shifted.error_um.p95) << rounds;
  EXPECT_GT(slower.machine_time_s, 1.02 * shifted.machine_time_s);
  EXPECT_LE(slower.machine_time_s, 1.154 * shifted.machine_time_s);
  EXPECT_NEAR(c.figures.feed_after.time_s, c.rounds[c.best].machine_time_s, 1e-9) << "of the text that is emitted";
  EXPECT_GT(slower.slowed, 0u);

  // Nothing but coordinates and F words is new.
  static const std::regex feeds(R"( ?F[0-9.]+)");
  const auto bare = [](const std::string& text) { return std::regex_replace(without_coordinates(text), feeds, ""); };
  std::set<std::string> given, emitted;
  std::istringstream before(bare(tests::file_text(job.program))), after(bare(c.emitted.text));
  for (std::string line; std::getline(before, line);) given.insert(line);
  for (std::string line; std::getline(after, line);) emitted.insert(line);
  for (const std::string& line : emitted) EXPECT_TRUE(line.empty() || given.contains(line)) << line;
}

TEST(Compensate, CutsTwiceWhereNoShiftHelps) {
  Diagnostics diagnostics;
  machine::Job job = machine::read_job(CAMBER_SOURCE_DIR "/samples/06-wall/job.toml", diagnostics);
  job.compensation.levers = {machine::Lever::shift, machine::Lever::passes};
  CompensateOptions options;
  options.time_budget_percent = 150;
  const CompensationResult c = compensate(job, diagnostics, options);
  EXPECT_EQ(diagnostics.all().size(), 0u);
  ASSERT_EQ(c.time_points.size(), 2u);
  const Round &shifted = c.rounds[c.time_points[0].round], &twice = c.rounds[c.time_points[1].round];
  EXPECT_LT(twice.error_um.p95, 0.6 * shifted.error_um.p95);
  EXPECT_EQ(twice.repeated, 2u);
  EXPECT_GT(twice.machine_time_s, 1.5 * shifted.machine_time_s);
  EXPECT_EQ(c.figures.feed_after.time_s, c.rounds[c.best].machine_time_s);
  EXPECT_GE(c.passes.allowance_mm, 0.02);
  ASSERT_EQ(c.passes.runs.size(), 2u);
  EXPECT_EQ(c.passes.runs[0].first_line, 10u);
  EXPECT_EQ(c.passes.runs[0].last_line, 15u);
  EXPECT_EQ(c.figures.before_um.p95, c.rounds[0].error_um.p95) << "the given program, cut once";
  EXPECT_EQ(c.surfaces.before.size(), c.surfaces.after.size());
  EXPECT_LE(c.safety.after.gouge_depth_p999_um, c.safety.depth_limit_um);

  // Beside coordinates the text differs by the first cuts and the rapids back alone. A split block's further lines have
  // coordinates only.
  const SourceText given("", tests::file_text(job.program)), emitted("", c.emitted.text);
  ASSERT_EQ(c.emitted.block_of_line.size(), emitted.line_count());
  std::vector<std::string> lines, back;
  std::vector<std::size_t> times(given.line_count(), 0);
  for (std::size_t i = 0; i < emitted.line_count(); ++i) {
    const std::string line(emitted.line(i + 1));
    const std::uint32_t block = c.emitted.block_of_line[i];
    if (block == nc::Emission::kNoBlock) {
      back.push_back(line);
      continue;
    }
    const std::string bare = without_coordinates(line), own = without_coordinates(std::string(given.line(block + 1)));
    if (bare.empty() && !own.empty()) continue;
    EXPECT_EQ(bare, own) << line;
    ++times[block];
  }
  EXPECT_EQ(back, (std::vector<std::string>{"G0 Z10.0", "G0 X-2.0 Y-7.0 Z10.0", "G0 Z-6.0", "G0 Z10.0",
                                            "G0 X-7.0 Y1.0 Z10.0", "G0 Z-6.0"}));
  for (std::size_t block = 0; block < times.size(); ++block) {
    const bool cut = (block >= 9 && block < 15) || (block >= 19 && block < 24);
    EXPECT_EQ(times[block], cut ? 2u : 1u) << given.line(block + 1);
  }

  const tests::TempFolder folder;
  const Record record = make_record(job, c, folder.write("out.nc", c.emitted.text));
  const machine::Job judging = machine::read_job(folder.write("out.verify.toml", record.job), diagnostics);
  const Verification v = verify(judging, record, diagnostics, {});
  EXPECT_NEAR(v.plain.error_um.p95, c.figures.after_um.p95, 1e-6) << "from the emitted text";
  EXPECT_NEAR(v.plain.error_um.rms, c.figures.after_um.rms, 1e-6);
}

TEST(Compensate, RefusesPassesWhereNothingCanBeCutTwice) {
  const tests::TempFolder folder;
  machine::Job job = plane_job(folder);
  std::string text = plane_program();
  for (std::size_t at = 0; (at = text.find("X0.5\n", at)) != std::string::npos; at += 8)
    text.replace(at, 5, "M8\nX0.5\n");
  job.program = folder.write("coolant.nc", text);
  job.compensation.levers = {machine::Lever::shift, machine::Lever::passes};
  Diagnostics diagnostics;
  try {
    compensate(job, diagnostics, {});
    FAIL() << "no error";
  } catch (const InputError& e) {
    Diagnostic first = e.diagnostics().front();
    EXPECT_EQ(first.check, "lever-unusable");
    EXPECT_EQ(first.location.line, 9u);
    EXPECT_EQ(first.message,
              "levers names \"passes\", but none of the cuts to compensate can be made twice: those from here on have "
              "M, S, T or H words among them; levers without \"passes\" were expected");
  }
}

TEST(Compensate, RefusesAFirstCutThatWouldCutNothing) {
  const tests::TempFolder folder;
  machine::Job job = plane_job(folder);
  job.compensation.levers = {machine::Lever::shift, machine::Lever::passes};
  job.compensation.pass_allowance_mm = 0.25;
  Diagnostics diagnostics;
  try {
    compensate(job, diagnostics, {});
    FAIL() << "no error";
  } catch (const InputError& e) {
    EXPECT_EQ(e.diagnostics().front().check, "lever-unusable");
    EXPECT_EQ(
        e.diagnostics().front().message,
        "pass_allowance_mm is 0.25, but the stock has an allowance of 0.2 mm, so that the first of two cuts would "
        "cut nothing; less than that was expected");
  }
}

TEST(Compensate, NeedsTheFeedLeverForATimeBudget) {
  const tests::TempFolder folder;
  Diagnostics diagnostics;
  CompensateOptions options;
  options.time_budget_percent = 15;
  const machine::Job job = plane_job(folder);
  try {
    compensate(job, diagnostics, options);
    FAIL() << "no error";
  } catch (const InputError& e) {
    EXPECT_EQ(e.diagnostics().front().message,
              "a time budget of 15 % has no lever to use it; levers = [\"shift\", \"feed\"] was expected in "
              "[compensation]");
    EXPECT_EQ(e.diagnostics().front().check, "lever-missing");
  }
}

TEST(Compensate, RefusesTheFeedLeverWhereAVariableSetsTheFeed) {
  const tests::TempFolder folder;
  machine::Job job = plane_job(folder);
  std::string text = plane_program();
  text.insert(text.find("T1 M6"), "#100=900\n");
  for (std::size_t at; (at = text.find("F900")) != std::string::npos;) text.replace(at, 4, "F#100");
  job.program = folder.write("variable.nc", text);
  job.compensation.levers = {machine::Lever::shift, machine::Lever::feed};
  Diagnostics diagnostics;
  try {
    compensate(job, diagnostics, {});
    FAIL() << "no error";
  } catch (const InputError& e) {
    EXPECT_EQ(e.diagnostics().front().check, "lever-unusable");
    EXPECT_EQ(
        e.diagnostics().front().message,
        "levers names \"feed\", but the feed of the moves to compensate cannot be changed: a move whose feed is set "
        "by an expression, or a program that reads its own feed; levers = [\"shift\"] was expected");
  }
}

TEST(Compensate, LowersTheErrorAndChangesNothingButCoordinates) {
  const tests::TempFolder folder;
  machine::Job job = plane_job(folder);
  job.machine.control.corner = {.law = machine::CornerLaw::blend, .tolerance_mm = 0.01};
  job.compensation.goal = machine::Goal::tolerance;  // the other one tries the third round, too
  Diagnostics diagnostics;
  const CompensationResult c = compensate(job, diagnostics, {});
  EXPECT_GT(c.path.quality.shortest_mm, 0) << "blocks were split";
  EXPECT_LE(c.path.row_turn_rad, job.compensation.max_angle_growth_rad);
  EXPECT_GT(c.path.row_turn_rad, 0);
  EXPECT_GT(c.figures.before_um.mean, 8);
  EXPECT_LT(std::abs(c.figures.after_um.mean), 1.0);
  EXPECT_LT(c.figures.after_um.p95, 0.35 * c.figures.before_um.p95);
  EXPECT_GT(c.path.max_shift_mm, 0.005);
  EXPECT_LT(c.path.max_shift_mm, 0.05);
  EXPECT_EQ(c.rounds.size(), 3u);
  EXPECT_EQ(c.verdict.stop, Stop::stalled) << "a third round is not expected to lower the rms by a twentieth";

  EXPECT_GT(c.figures.split_before.correctable_um, 8);
  EXPECT_LT(c.figures.split_after.correctable_um, 0.15 * c.figures.split_before.correctable_um);  // in two rounds
  EXPECT_LE(c.path.quality.angle_growth_rad, job.compensation.max_angle_growth_rad);
  EXPECT_TRUE(c.safety.within_part);

  // Lines that only split a block hold nothing but coordinates.
  std::string left = without_coordinates(c.emitted.text);
  left = std::regex_replace(left, std::regex("\n(?=\n)"), "");
  std::string wanted = without_coordinates(plane_program());
  wanted = std::regex_replace(wanted, std::regex("\n(?=\n)"), "");
  EXPECT_EQ(left, wanted);

  // What was emitted reads without complaint and has the same feeds.
  Diagnostics of_emitted;
  const auto text = nc::read_program(SourceText("emitted.nc", c.emitted.text), of_emitted);
  const auto moves = nc::interpret(text, {}, of_emitted);
  EXPECT_TRUE(of_emitted.all().empty());
  for (const auto& m : moves.moves) {
    if (m.kind == nc::MoveKind::linear) {
      EXPECT_DOUBLE_EQ(m.feed_mm_per_s, 15);
    }
  }
}

TEST(Compensate, MakesNoNewCornersWhereTheControlStopsAtEveryOne) {
  const tests::TempFolder folder;
  machine::Job job = plane_job(folder);
  ASSERT_EQ(job.machine.control.corner.law, machine::CornerLaw::exact_stop);
  job.compensation.max_rounds = 1;
  Diagnostics diagnostics;
  const CompensationResult c = compensate(job, diagnostics, {});
  EXPECT_EQ(c.emitted.blocks_after, c.emitted.blocks_before);
  EXPECT_EQ(c.path.quality.shortest_mm, 0);
  EXPECT_LT(c.figures.split_after.correctable_um, 0.3 * c.figures.split_before.correctable_um);
  EXPECT_EQ(c.verdict.stop, Stop::stalled) << "a second round is not expected to bring a tenth";
}

TEST(Compensate, GivesTheSameProgramTwice) {
  const tests::TempFolder folder;
  machine::Job job = plane_job(folder);
  job.compensation.max_rounds = 1;
  Diagnostics diagnostics;
  EXPECT_EQ(compensate(job, diagnostics, {}).emitted.text, compensate(job, diagnostics, {}).emitted.text);
}

TEST(Compensate, HoldsToTheLargestShift) {
  const tests::TempFolder folder;
  machine::Job job = plane_job(folder);
  job.compensation.max_rounds = 1;
  job.compensation.max_shift_mm = 0.004;
  Diagnostics diagnostics;
  const CompensationResult c = compensate(job, diagnostics, {});
  EXPECT_LE(c.path.max_shift_mm, 0.004 + 1e-12);
  EXPECT_GT(c.rounds.back().limited_points, 0u);
  EXPECT_GT(c.figures.split_after.limited_um, 5);
  EXPECT_GT(c.safety.without_bending.gouge_depth_p999_um, 0.5 * c.safety.without_bending.deepest_um);
  EXPECT_LE(c.safety.without_bending.deepest_um, 4.0 + 1.0);  // and what a grid of 0.15 mm shows of cusps
}

/// Whether a limit is named by its place, and with the effect that a run without it has.
TEST(Compensate, NamesTheLimitOfTheShiftWithWhatARunWithoutItLeaves) {
  const tests::TempFolder folder;
  machine::Job job = plane_job(folder);
  Diagnostics diagnostics;
  job.compensation.max_shift_mm = 0.004;
  const CompensationResult held = compensate(job, diagnostics, {});
  ASSERT_EQ(held.verdict.limits.size(), 1u);
  const BindingLimit& limit = held.verdict.limits[0];
  EXPECT_EQ(limit.key, "max_shift_mm");
  EXPECT_GT(limit.count, 40u) << "of about 23 rows of three points each";
  EXPECT_GE(limit.effect.first_line, 9u);
  EXPECT_LE(limit.effect.first_line, limit.line.given);
  EXPECT_LE(limit.line.given, limit.effect.last_line);
  EXPECT_LE(limit.effect.last_line - limit.effect.first_line, 2u) << "one row of three blocks is cut again";
  // The whole program is alike in all its rows. The stretch is fitted once without the limit, the program in two
  // rounds.
  job.compensation.max_shift_mm = limit.binds_no_more_at;
  const CompensationResult free = compensate(job, diagnostics, {});
  EXPECT_TRUE(free.verdict.limits.empty()) << sentence(free.verdict.limits[0]);
  EXPECT_GT(limit.effect.without_um, 0.7 * free.figures.after_um.p95);
  EXPECT_LT(limit.effect.without_um, 0.6 * held.figures.after_um.p95);
  EXPECT_NEAR(limit.effect.with_um, held.figures.after_um.p95, 0.3 * held.figures.after_um.p95);
}

TEST(Compensate, NamesTheLimitOfAnglesOnlyWhereItBinds) {
  const tests::TempFolder folder;
  machine::Job job = plane_job(folder);
  Diagnostics diagnostics;
  EXPECT_TRUE(compensate(job, diagnostics, {}).verdict.limits.empty());
  job.compensation.max_angle_growth_rad = 0.0005;
  const CompensationResult held = compensate(job, diagnostics, {});
  ASSERT_EQ(held.verdict.limits.size(), 1u);
  const BindingLimit& limit = held.verdict.limits[0];
  EXPECT_EQ(limit.key, "max_angle_growth_deg");
  EXPECT_GT(limit.count, 0u);
  EXPECT_GT(limit.line.given, 8u);
  EXPECT_GT(limit.effect.with_um, limit.effect.without_um);
  EXPECT_GT(limit.binds_no_more_at, limit.value);
}

TEST(Compensate, TheGuardLiftsWhatIsCutTooDeepAndTellsTheTruth) {
  const tests::TempFolder folder;
  machine::Job job = plane_job(folder);
  Diagnostics diagnostics;
  job.compensation.max_rounds = 1;
  const CompensationResult free = compensate(job, diagnostics, {});
  ASSERT_GT(free.safety.after.gouge_depth_p999_um, 1.5);
  EXPECT_GE(free.safety.after.deepest_um, free.safety.after.gouge_depth_p999_um);
  EXPECT_TRUE(free.safety.within_part);  // 50 um are allowed
  job.compensation.max_overcut_um = 0.5 * free.safety.after.gouge_depth_p999_um;
  const CompensationResult guarded = compensate(job, diagnostics, {});
  EXPECT_TRUE(guarded.rounds.back().guard);
  EXPECT_EQ(guarded.rounds.size(), free.rounds.size() + 1) << "one round, since its lifts are weighed beforehand";
  EXPECT_LT(guarded.safety.after.gouge_depth_p999_um, 0.9 * free.safety.after.gouge_depth_p999_um);
  EXPECT_EQ(guarded.safety.within_part, guarded.safety.after.gouge_depth_p999_um <= job.compensation.max_overcut_um);
  ASSERT_EQ(guarded.verdict.limits.size(), 1u);
  const BindingLimit& limit = guarded.verdict.limits[0];
  EXPECT_EQ(limit.key, "max_overcut_um");
  std::size_t below = 0;
  for (const auto& p : free.surfaces.after) below += p.error_mm < -limit.value / 1000 ? 1 : 0;
  EXPECT_EQ(limit.count, below) << "of the round before the guard, which the run without it has written";
  EXPECT_DOUBLE_EQ(limit.effect.without_um, free.figures.after_um.p95);
  EXPECT_DOUBLE_EQ(limit.effect.with_um, guarded.figures.after_um.p95);
  EXPECT_EQ(limit.line.given, free.safety.after.line.given);
  double deepest = 0;
  for (const auto& p : guarded.surfaces.after) deepest = std::max(deepest, -1000 * p.error_mm);
  EXPECT_NEAR(std::max(guarded.safety.after.deepest_um, guarded.safety.others.deepest_um), deepest, 1e-9);
}

TEST(Compensate, TheGuardMakesNoRoundWhereNoShiftCanLiftThePathEnough) {
  const tests::TempFolder folder;
  machine::Job job = plane_job(folder);
  job.part.program = job.program;
  job.program = folder.write("deeper.nc", plane_program(0.06));
  job.compensation.max_shift_mm = 0.004;
  job.compensation.max_overcut_um = 5;
  Diagnostics diagnostics;
  const CompensationResult bound = compensate(job, diagnostics, {});
  EXPECT_FALSE(bound.safety.within_part);
  EXPECT_GT(bound.safety.after.gouge_depth_p999_um, 10) << "not even with the largest shift";
  EXPECT_EQ(bound.rounds.size(), 2u) << "the first one has shifted as far as it may";
  for (const Round& r : bound.rounds) EXPECT_FALSE(r.guard);
}

TEST(Compensate, NothingIsEmittedWhereNoRoundIsBetter) {
  const tests::TempFolder folder;
  machine::Job job = plane_job(folder);
  Diagnostics diagnostics;
  // Next to no error, and a tolerance below the decimals of the program.
  job.tools[1].youngs_modulus_MPa = 1e12;
  job.compensation.tolerance_um = 1e-6;
  const CompensationResult none = compensate(job, diagnostics, {});
  EXPECT_FALSE(none.verdict.better);
  EXPECT_EQ(none.best, 0u);
  EXPECT_EQ(none.emitted.text, plane_program());
  EXPECT_EQ(none.figures.after_um.rms, none.figures.before_um.rms) << "the verdict is on what is emitted";
  EXPECT_FALSE(none.verdict.within_tolerance);
  EXPECT_GT(none.rounds.size(), 1u);
}

TEST(Compensate, TheFiguresAreOfTheEmittedProgram) {
  const tests::TempFolder folder;
  machine::Job job = plane_job(folder);
  Diagnostics diagnostics;
  const CompensationResult c = compensate(job, diagnostics, {});
  ASSERT_TRUE(c.verdict.better);
  machine::Job verify = job;
  verify.program = folder.write("emitted.nc", c.emitted.text);
  verify.part.program = job.program;
  const auto emitted = motion::simulate_motion(SourceText::read(verify.program), verify, {}, diagnostics);
  const auto given = motion::simulate_motion(SourceText::read(job.program), verify, {}, diagnostics);
  const auto target = simulate::make_target(verify, given, diagnostics);
  const auto fresh = simulate::predict(verify, target, emitted, {});
  // Every move is compensated here, so that everything is in reach.
  EXPECT_NEAR(fresh.form_error_um.rms, c.figures.after_um.rms, 1e-6);
  EXPECT_NEAR(fresh.form_error_um.p95, c.figures.after_um.p95, 1e-6);
  EXPECT_NEAR(fresh.form_error_um.area_mm2, c.figures.plain_after.error_um.area_mm2, 1e-6);
  EXPECT_EQ(c.verdict.within_tolerance, c.figures.after_um.p95 <= job.compensation.tolerance_um);
}

TEST(Compensate, JudgesOnAnotherGridAndMovesTheParameters) {
  const tests::TempFolder folder;
  machine::Job job = plane_job(folder);
  job.compensation.max_rounds = 1;
  CompensateOptions options;
  options.recheck_voxels_mm = {0.19};
  options.uncertainty = read_uncertainty("10 %");
  options.header = [](const CompensationResult&) { return std::string("TOLD"); };
  Diagnostics diagnostics;
  const CompensationResult c = compensate(job, diagnostics, options);
  ASSERT_EQ(c.uncertainty.rechecks.size(), 1u);
  EXPECT_NEAR(c.uncertainty.rechecks[0].before_um.rms / c.figures.before_um.rms, 1, 0.1);
  EXPECT_LT(c.uncertainty.rechecks[0].split_after.correctable_um,
            0.15 * c.uncertainty.rechecks[0].split_before.correctable_um);
  ASSERT_TRUE(c.uncertainty.band);
  // Rigid coupling: the deflection is force times compliance, ten per cent of either are the same and move the surface
  // by about ten per cent of what the tool bends (not all of the error at the plane's edges comes from that).
  ASSERT_EQ(c.uncertainty.band->groups.size(), 2u);
  EXPECT_NEAR(c.uncertainty.band->groups[0].rms_um, c.uncertainty.band->groups[1].rms_um,
              1e-3 * c.uncertainty.band->groups[0].rms_um);
  EXPECT_GT(c.uncertainty.band->groups[0].rms_um / c.figures.before_um.rms, 0.04);
  EXPECT_LT(c.uncertainty.band->groups[0].rms_um / c.figures.before_um.rms, 0.12);
  EXPECT_NE(c.emitted.text.find("(PLANE)\n(TOLD)\nG21"), std::string::npos);
}

}  // namespace
}  // namespace camber::compensate
