#include "camber/feed.h"

#include "api/commands/feed.h"
#include "api/feed_points.h"
#include "api/job.h"
#include "api/program.h"
#include "api/run.h"
#include "base/units.h"

namespace camber {

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
    const auto summary =
        feedmodel::predict_feed(moves, machine.impl().machine, [&](std::span<const feedmodel::TimedSample> samples) {
          if (options.points) keep(samples);
          if (!samples.empty()) run.show("timing", static_cast<double>(samples.back().move) / count);
        });
    result.time_s = summary.time_s;
    result.cutting_time_s = summary.cutting_time_s;
    result.blocks = summary.blocks;
    result.diagnostics = found.all();
    result.json = api::feed_json(summary);
  });
  return result;
}

}  // namespace camber
