#include "camber/feed.h"

#include "api/commands/feed.h"
#include "api/feed_points.h"
#include "api/job.h"
#include "api/program.h"
#include "api/run.h"
#include "base/units.h"
#include "machine/assumptions.h"

namespace camber {
namespace {

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
    Diagnostics found = machine.impl().found;
    found.append(program.impl().found);
    const nc::Interpretation moves =
        api::moves_of_feed(program.impl().text, machine.impl().machine, program.impl().options, {}, found);
    run.settle(found);
    const auto keep = api::points_sink(moves, result.points);
    const auto count = static_cast<double>(moves.moves.size());
    const auto summary = api::predict_feed(
        moves, machine.impl().machine,
        [&](std::span<const feedmodel::TimedSample> samples, std::span<const feedmodel::JointSample> joints) {
          if (options.points) {
            keep(samples);
            add_poses(joints, result);
          }
          if (!samples.empty()) run.show("timing", static_cast<double>(samples.back().move) / count);
        });
    result.time_s = summary.time_s;
    result.cutting_time_s = summary.cutting_time_s;
    result.blocks = summary.blocks;
    result.diagnostics = found.all();
    result.json = machine::with_assumptions(api::feed_json(summary), machine::assumptions(machine.impl().machine));
  });
  return result;
}

}  // namespace camber
