#include "camber/post.h"

#include <algorithm>

#include "api/commands/post.h"
#include "api/job.h"
#include "api/program.h"
#include "api/run.h"
#include "base/stage.h"

namespace camber {
namespace {

repath::PostOptions rules_of(const PostOptions& options) {
  return {.target = options.to_tip ? repath::PostTarget::tcp : repath::PostTarget::joints,
          .tolerance_mm = options.tolerance_mm,
          .rapid_tolerance_mm = options.rapid_tolerance_mm,
          .inverse_time = options.inverse_time,
          .one_degree = options.one_degree,
          .retract_mm = options.retract_mm,
          .decimals = options.decimals};
}

PostResult posted(const Program& program, const machine::Machine& machine, const machine::Job* job,
                  const Diagnostics& before, const PostOptions& options, const RunOptions& run_options) {
  PostResult result;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found = before;
    found.append(program.impl().found);
    const StageScope stages([&](const std::string& what, double share) { run.show(what, share); });
    const api::PostRequest request{.text = &program.impl().text,
                                   .output = program.path(),
                                   .machine = &machine,
                                   .job = job,
                                   .interpreter = program.impl().options,
                                   .options = rules_of(options)};
    const api::PostedProgram out = api::post_program(request, found);
    run.settle(found);
    const repath::Posted& p = out.posted;
    result = {.text = p.text,
              .moves = p.moves,
              .feed_moves = p.feed_moves,
              .feed_blocks = p.feed_blocks,
              .tip_bound_mm = p.tip_bound_mm,
              .turns_back = p.turns_back.size(),
              .turns_back_in_cuts = static_cast<std::size_t>(std::count_if(
                  p.turns_back.begin(), p.turns_back.end(), [](const repath::TurnBack& t) { return !t.in_air; })),
              .diagnostics = found.all(),
              .json = api::post_json(out, request)};
  });
  return result;
}

}  // namespace

PostResult v0::post(const Program& program, const Machine& machine, const PostOptions& options, const RunOptions& run) {
  return posted(program, machine.impl().machine, nullptr, machine.impl().found, options, run);
}

PostResult v0::post(const Program& program, const Job& job, const PostOptions& options, const RunOptions& run) {
  return posted(program, job.impl().job.machine, &job.impl().job, job.impl().found, options, run);
}

}  // namespace camber
