#include "api/commands/feed.h"

#include <algorithm>

#include <fmt/format.h>

#include "api/commands/rotary_program.h"
#include "base/json.h"
#include "base/units.h"
#include "feedmodel/feed_csv.h"
#include "feedmodel/fitted_range.h"
#include "kinematics/joint_map.h"
#include "kinematics/machine_moves.h"
#include "kinematics/machine_program.h"
#include "simulate/machine_checks.h"

namespace camber::api {

nc::Interpretation moves_of_feed(const nc::Program& text, const machine::Machine& machine,
                                 const nc::InterpreterOptions& options, const std::string& csv,
                                 Diagnostics& diagnostics) {
  nc::Interpretation moves =
      kinematics::read_moves(text, machine, {.given = options, .rotary = kinematics::RotaryWords::always}, diagnostics);
  diagnostics.throw_if_errors();
  simulate::check_machine(machine, text, moves, diagnostics);
  simulate::check_spindle(text, moves, diagnostics);
  check_rotary_motion(machine, text, moves, true, diagnostics);
  if (kinematics::has_rotary_motion(moves, machine)) kinematics::place_moves(moves, machine);
  if (!csv.empty()) feedmodel::check_feed_csv_size(moves, machine, csv, diagnostics);
  feedmodel::check_range(moves, text.source.name(), machine, diagnostics);
  return moves;
}

std::string rotary_columns(const nc::Interpretation& moves, const machine::Machine& machine) {
  if (!kinematics::has_rotary_motion(moves, machine)) return {};
  std::string letters = machine.kinematics.rotary_axes();
  std::ranges::sort(letters);
  return letters;
}

feedmodel::FeedSummary predict_feed(const nc::Interpretation& moves, const machine::Machine& machine,
                                    const feedmodel::JointSampleSink& sink) {
  if (kinematics::has_rotary_motion(moves, machine)) return feedmodel::predict_joints(moves, machine, sink);
  return feedmodel::predict_feed(moves, machine,
                                 [&](std::span<const feedmodel::TimedSample> samples) { sink(samples, {}); });
}

std::string contour_text(const feedmodel::PoseContourFigures& contour) {
  return fmt::format(
      "contour error of the tip   {:.1f} um rms, {:.1f} um at most\n"
      "contour error of the axis  {:.4f} degrees rms, {:.4f} degrees at most\n",
      1000 * contour.tip_rms_mm, 1000 * contour.tip_max_mm, deg_from_rad(contour.axis_rms_rad),
      deg_from_rad(contour.axis_max_rad));
}

std::string feed_json(const feedmodel::FeedSummary& summary) {
  Json report = {{"time_s", summary.time_s}, {"cutting_time_s", summary.cutting_time_s}, {"blocks", summary.blocks}};
  if (summary.contour) {
    const feedmodel::PoseContourFigures& c = *summary.contour;
    report["contour"] = {{"tip_max_um", 1000 * c.tip_max_mm},
                         {"tip_rms_um", 1000 * c.tip_rms_mm},
                         {"axis_max_deg", deg_from_rad(c.axis_max_rad)},
                         {"axis_rms_deg", deg_from_rad(c.axis_rms_rad)}};
  }
  return report.dump(2) + "\n";
}

}  // namespace camber::api
