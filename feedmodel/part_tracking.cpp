#include "feedmodel/part_tracking.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace camber::feedmodel {

void PartSamples::take(std::span<const TimedSample> samples, std::span<const JointSample> joints) {
  assert(samples.size() == joints.size());
  axes_ = samples;
  joints_ = joints;
  samples_.assign(samples.begin(), samples.end());
  tools_.clear();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    tools_.push_back({joints[i].tool, {samples[i].position_mm, joints[i].position_rad}});
    TimedSample& sample = samples_[i];
    sample.command_mm = joints[i].command_tool.tip_mm;
    sample.position_mm = joints[i].tool.tip_mm;
    sample.velocity_mm_per_s = last_tip_mm_ && sample.t_s > last_s_
                                   ? Vec3((sample.position_mm - *last_tip_mm_) / (sample.t_s - last_s_))
                                   : Vec3(Vec3::Zero());
    last_tip_mm_ = sample.position_mm;
    last_s_ = sample.t_s;
  }
}

PathPlace closest_on_part(const kinematics::PartPath& path, const nc::Interpretation& in_part, std::uint32_t move,
                          const ToolPlace& is, double from_u, double to_u) {
  PathPlace place;
  if (path.turn_rad(move) > 0 && path.start_known(move)) {
    const double u = std::clamp(path.nearest_fraction(move, is.joints), from_u, std::max(from_u, to_u));
    place = {move, u, (path.pose_at(move, u).tip_mm - is.tool.tip_mm).norm()};
  } else {
    place = closest_on_move(in_part, move, is.tool.tip_mm, from_u, to_u);
  }
  place.distance_mm = std::hypot(place.distance_mm, path.angle_distance_mm(move, place.u, is.joints));
  return place;
}

FeedSummary predict_on_part(const nc::Interpretation& moves_of_axes, const machine::Machine& machine,
                            const PartSink& sink) {
  PartSamples on_part;
  return predict_joints(moves_of_axes, machine,
                        [&](std::span<const TimedSample> samples, std::span<const JointSample> joints) {
                          on_part.take(samples, joints);
                          sink(on_part);
                        });
}

}  // namespace camber::feedmodel
