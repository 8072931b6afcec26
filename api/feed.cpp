#include "camber/feed.h"

#include <algorithm>
#include <memory>

#include "api/feed_points.h"
#include "api/job.h"
#include "api/program.h"
#include "api/rotary_program.h"
#include "api/run.h"
#include "base/units.h"
#include "feedmodel/feed_csv.h"
#include "feedmodel/fitted_range.h"
#include "kinematics/joint_map.h"
#include "kinematics/machine_moves.h"
#include "kinematics/machine_program.h"
#include "machine/assumptions.h"
#include "motion/machine_checks.h"
#include "report/time_summary.h"
#include "report/timed_track.h"

namespace camber {
namespace {

/// feedmodel::predict_feed, or predict_joints for a program with rotary motion; otherwise the sink gets no joints.
feedmodel::FeedSummary feed_or_joints(const nc::Interpretation& moves, const machine::Machine& machine,
                                      const feedmodel::JointSampleSink& sink) {
  if (kinematics::has_rotary_motion(moves, machine)) return feedmodel::predict_joints(moves, machine, sink);
  return feedmodel::predict_feed(moves, machine,
                                 [&](std::span<const feedmodel::TimedSample> samples) { sink(samples, {}); });
}

/// feed_mm_per_min of the points just added becomes what F counts.
void add_poses(std::span<const feedmodel::JointSample> joints, FeedResult& result) {
  std::size_t point = result.points.size() - joints.size();
  for (const feedmodel::JointSample& j : joints) {
    result.points[point++].feed_mm_per_min = mm_per_min_from_mm_per_s(j.feed_mm_per_s);
    const Vec3 &tip = j.tool.tip_mm, &axis = j.tool.axis;
    result.poses.push_back({deg_from_rad(j.position_rad.x()), deg_from_rad(j.position_rad.y()),
                            deg_from_rad(j.position_rad.z()), tip.x(), tip.y(), tip.z(), axis.x(), axis.y(), axis.z()});
  }
}

}  // namespace

nc::Interpretation api::moves_of_feed(const nc::Program& text, const machine::Machine& machine,
                                      const nc::InterpreterOptions& options, const std::string& csv,
                                      Diagnostics& diagnostics) {
  nc::Interpretation moves =
      kinematics::read_moves(text, machine, {.given = options, .rotary = kinematics::RotaryWords::always}, diagnostics);
  diagnostics.throw_if_errors();
  motion::check_machine(machine, text, moves, diagnostics);
  motion::check_spindle(text, moves, diagnostics);
  check_rotary_motion(machine, text, moves, true, diagnostics);
  if (kinematics::has_rotary_motion(moves, machine)) kinematics::place_moves(moves, machine);
  if (!csv.empty()) feedmodel::check_feed_csv_size(moves, machine, csv, diagnostics);
  feedmodel::check_range(moves, text.source.name(), machine, diagnostics);
  return moves;
}

std::string api::rotary_columns(const nc::Interpretation& moves, const machine::Machine& machine) {
  if (!kinematics::has_rotary_motion(moves, machine)) return {};
  std::string letters = machine.kinematics.rotary_axes();
  std::ranges::sort(letters);
  return letters;
}

feedmodel::SampleSink api::points_sink(const nc::Interpretation& moves, std::vector<FeedPoint>& points) {
  return [&moves, &points](std::span<const feedmodel::TimedSample> samples) {
    for (const feedmodel::TimedSample& s : samples) {
      const Vec3 v = s.velocity_mm_per_s;
      points.push_back({s.t_s, s.position_mm.x(), s.position_mm.y(), s.position_mm.z(), mm_per_min_from_mm_per_s(v.x()),
                        mm_per_min_from_mm_per_s(v.y()), mm_per_min_from_mm_per_s(v.z()),
                        mm_per_min_from_mm_per_s(s.feed_command_mm_per_s), mm_per_min_from_mm_per_s(v.norm()),
                        static_cast<std::int64_t>(moves.moves[s.move].block) + 1});
    }
  };
}

FeedResult v0::feed(const Program& program, const Machine& machine, const FeedOptions& options,
                    const RunOptions& run_options) {
  FeedResult result;
  api::Run run(run_options);
  run.execute([&] {
    const machine::Machine& on = machine.impl().machine;
    Diagnostics found = machine.impl().found;
    found.append(program.impl().found);
    const nc::Interpretation moves =
        api::moves_of_feed(program.impl().text, on, program.impl().options, options.csv, found);
    if (options.page && !kinematics::has_rotary_motion(moves, on))
      fail_on_file(program.path(),
                   "turns no rotary axis of the machine, and the page of feed shows those; camber check --report shows "
                   "programs of three axes",
                   "no-rotary-motion");
    run.settle_first(found);
    std::unique_ptr<feedmodel::FeedCsv> csv;
    if (!options.csv.empty())
      csv = std::make_unique<feedmodel::FeedCsv>(moves, options.csv, api::rotary_columns(moves, on));
    report::TimedTrack track(on, moves);
    const auto keep = api::points_sink(moves, result.points);
    const auto count = static_cast<double>(moves.moves.size());
    const auto summary = feed_or_joints(
        moves, on,
        [&](std::span<const feedmodel::TimedSample> samples, std::span<const feedmodel::JointSample> joints) {
          if (csv) joints.empty() ? csv->write(samples) : csv->write(samples, joints);
          if (options.page) track.add(samples, joints);
          if (options.points) {
            keep(samples);
            add_poses(joints, result);
          }
          if (!samples.empty()) run.show("timing", static_cast<double>(samples.back().move) / count);
        });
    if (csv) csv->commit();
    const std::vector<std::string> assumed = machine::assumptions(on);
    result.time_s = summary.time_s;
    result.cutting_time_s = summary.cutting_time_s;
    result.blocks = summary.blocks;
    result.diagnostics = found.all();
    result.json = machine::with_assumptions(report::feed_json(summary), assumed);
    result.printed = machine::assumptions_text(assumed) + report::feed_text(summary);
    if (options.page)
      result.page = report::feed_page({program.path(), summary, track.take(), api::texts_of(found)}, moves, on);
  });
  return result;
}

}  // namespace camber
