#include "calib/cross_validate.h"

#include <cstddef>
#include <utility>

#include "base/units.h"

namespace camber::calib {
namespace {

using machine::Machine;

Machine stopping(Machine m) {
  m.control.corner.law = machine::CornerLaw::exact_stop;
  m.control.corner.step_fraction = 0;
  m.control.merge_tolerance_mm = 0;
  return m;
}

/// Returns the rms error of the model of a rotary drive, degrees.
double rotary_drive_rms(const ServoTrace& rotary, int axis, const machine::RotaryAxis& model) {
  machine::Axis drive;
  drive.position_gain_per_s = model.position_gain_per_s;
  drive.velocity_lag_s = model.velocity_lag_s;
  drive.feed_forward_percent = model.feed_forward_percent;
  drive.acceleration_feed_forward_s = model.acceleration_feed_forward_s;
  drive.dead_time_s = model.dead_time_s;
  drive.backlash_mm = deg_from_rad(model.backlash_rad);
  drive.filter_s = model.filter_s;
  return drive_rms_mm({&rotary}, axis, drive);
}

HeldOutRun judge(const FeedRun& run, const FitFeedResult& fit) {
  HeldOutRun held;
  held.program_name = run.program_name;
  held.converged = fit.converged;
  const std::vector<TracePart> parts = parts_of(run.program, fit.machine);
  held.accuracy = feed_accuracy(run.trace, run.program, fit.machine, parts, {});
  held.constant_feed = constant_feed_accuracy(run.trace, run.program, fit.machine, parts, {});
  held.stop_every_block = feed_accuracy(run.trace, run.program, stopping(fit.machine), parts, {});
  for (int axis = 0; axis < 3; ++axis)
    if (run.trace.has_command[axis] && run.trace.has_actual[axis])
      held.drive_rms_mm[axis] = drive_rms_mm({&run.trace}, axis, fit.machine.axis[axis]);
  if (run.trace.rotary_command_deg.empty()) return held;
  const ServoTrace rotary = rotary_trace(run.trace);
  for (const char letter : fit.machine.kinematics.rotary_axes()) {
    const auto axis = static_cast<std::size_t>(letter - 'a');
    if (rotary.has_command[axis] && rotary.has_actual[axis])
      held.rotary_drive_rms_deg.emplace_back(
          letter, rotary_drive_rms(rotary, static_cast<int>(axis), fit.machine.rotary[axis]));
  }
  return held;
}

}  // namespace

std::vector<HeldOutRun> leave_one_out(std::vector<FeedRun> runs, const Machine& start, const FitFeedOptions& options,
                                      const std::vector<StretchRun>& logs) {
  std::vector<HeldOutRun> result;
  for (std::size_t i = 0; i < runs.size() && runs.size() > 1; ++i) {
    if (runs[i].trace.line.empty()) continue;
    std::swap(runs[i], runs.back());
    const FeedRun held = std::move(runs.back());
    runs.pop_back();
    result.push_back(judge(held, fit_feed(runs, logs, start, options)));
    runs.push_back(held);
    std::swap(runs[i], runs.back());
  }
  return result;
}

}  // namespace camber::calib
