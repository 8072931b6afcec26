#include "cli/feed_page.h"

#include <fmt/format.h>

#include "base/units.h"
#include "report/machine_page.h"

namespace camber::cli {

TimedTrack::TimedTrack(const machine::Machine& machine, const nc::Interpretation& moves) : moves_(moves) {
  if (machine.kinematics.given()) chain_.emplace(machine);
  for (const nc::Move& move : moves.moves) {
    const nc::ModalState& state = moves.state_of(move);
    if (state.tool_length_mm.value_or(0) != 0) tool_length_mm_[state.tool] = *state.tool_length_mm;
  }
}

void TimedTrack::add(std::span<const feedmodel::TimedSample> samples, std::span<const feedmodel::JointSample> joints) {
  for (std::size_t i = 0; i < samples.size() && i < joints.size(); ++i, ++seen_) {
    // Where reference points are is not known.
    if (moves_.moves[samples[i].move].reference) continue;
    last_ = pose_of(samples[i], joints[i]);
    if (seen_ % every_ != 0) continue;
    kept_.push_back(last_);
    if (kept_.size() < 2 * kMax) continue;
    for (std::size_t k = 0; 2 * k < kept_.size(); ++k) kept_[k] = kept_[2 * k];
    kept_.resize((kept_.size() + 1) / 2);
    every_ *= 2;
  }
}

std::vector<kinematics::PoseSample> TimedTrack::take() {
  if (!kept_.empty() && kept_.back().time_s < last_.time_s) kept_.push_back(last_);
  return std::move(kept_);
}

kinematics::PoseSample TimedTrack::pose_of(const feedmodel::TimedSample& sample,
                                           const feedmodel::JointSample& joint) const {
  kinematics::PoseSample out;
  out.time_s = sample.t_s;
  out.joints = {sample.position_mm, joint.position_rad};
  const nc::Move& move = moves_.moves[sample.move];
  out.line = static_cast<int>(move.block) + 1;
  const auto length = tool_length_mm_.find(moves_.state_of(move).tool);
  if (chain_) out.pose = chain_->pose(out.joints, length == tool_length_mm_.end() ? 0 : length->second);
  return out;
}

std::string feed_page(const FeedPage& of, const nc::Interpretation& moves, const machine::Machine& machine,
                      const Diagnostics& found) {
  report::MachinePage page;
  page.title = "Feed of " + of.program;
  page.subtitle = fmt::format("on the machine {}, camber {}", of.machine, CAMBER_VERSION);
  const auto figure = [](const char* name, double value, const char* unit, int decimals, const char* key) {
    return report::Figure{name, value, std::nullopt, unit, decimals, key};
  };
  page.figures = {figure("time", of.summary.time_s, "s", 1, "time_s"),
                  figure("cutting", of.summary.cutting_time_s, "s", 1, "cutting_time_s"),
                  figure("blocks", static_cast<double>(of.summary.blocks), "", 0, "blocks")};
  if (const auto& c = of.summary.contour) {
    page.figures.push_back(
        figure("contour error of the tip, rms", 1000 * c->tip_rms_mm, "µm", 1, "contour.tip_rms_um"));
    page.figures.push_back(figure("at most", 1000 * c->tip_max_mm, "µm", 1, "contour.tip_max_um"));
    page.figures.push_back(
        figure("of the axis, at most", deg_from_rad(c->axis_max_rad), "degrees", 4, "contour.axis_max_deg"));
  }
  for (const Diagnostic& d : found.all()) page.warnings.push_back(to_string(d));
  page.time_label = "time, s";
  page.notes = {"Positions are the predicted actual axes, with look-ahead, limits of all axes and lag of the drives."};
  page.work_origin_mm = -moves.machine_origin_mm.value_or(Vec3::Zero());
  return report::machine_page(machine, of.track, page);
}

}  // namespace camber::cli
