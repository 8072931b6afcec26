#include "camber/post.h"

#include <algorithm>

#include "api/job.h"
#include "api/new_program.h"
#include "api/program.h"
#include "api/rotary_program.h"
#include "api/run.h"
#include "kinematics/machine_program.h"
#include "report/rewrite_summary.h"

namespace camber {
namespace {

constexpr int kPostSamples = 16;  ///< samples of each piece

repath::PostOptions rules_of(const PostOptions& options) {
  return {.target = options.to_tip ? repath::PostTarget::tcp : repath::PostTarget::joints,
          .tolerance_mm = options.tolerance_mm,
          .rapid_tolerance_mm = options.rapid_tolerance_mm,
          .inverse_time = options.inverse_time,
          .one_degree = options.one_degree,
          .retract_mm = options.retract_mm,
          .decimals = options.decimals};
}

void require_kinematics(const machine::Machine& machine) {
  if (machine.kinematics.given()) return;
  fail_on_file(machine.path, "the machine has no [kinematics]; the chain of its axes was expected", "kinematics");
}

std::size_t blocks_with_words(const nc::Program& program) {
  return static_cast<std::size_t>(
      std::ranges::count_if(program.blocks, [](const nc::Block& b) { return b.word_count > 0; }));
}

/// Throws InputError: what post() says of the program, and of the new one, at the blocks that it came from, what the
/// checks of travel and of collisions with the machine's bodies say. `job`: null: without those bodies.
report::PostSummary post_program(const Program& given, const machine::Machine& machine, const machine::Job* job,
                                 const PostOptions& options, Diagnostics& diagnostics) {
  const nc::Program& text = given.impl().text;
  require_kinematics(machine);
  const nc::InterpreterOptions& read = given.impl().options;
  const kinematics::MachineProgram before(
      {},  // its text is the given one's
      kinematics::read_moves(text, machine, {.given = read, .rotary = kinematics::RotaryWords::always}, diagnostics),
      machine);
  diagnostics.throw_if_errors();
  const nc::Interpretation& moves = before.moves_in_program();
  report::PostSummary out{.asked = rules_of(options), .posted = {}, .deviation = {}};
  out.posted = repath::post(text, moves, machine, out.asked, diagnostics);
  diagnostics.throw_if_errors();
  const kinematics::MachineProgram after =
      api::read_new_program(machine, options.output.empty() ? given.path() : options.output, out.posted.text, read);
  api::check_new_program(machine, job, text, after.commanded(), out.posted.block_of_line, diagnostics);
  diagnostics.throw_if_errors();
  out.deviation = repath::post_deviation(moves, after.commanded(), machine, out.posted, kPostSamples);
  out.blocks_before = blocks_with_words(text);
  out.blocks_after = blocks_with_words(after.text());
  return out;
}

PostResult posted(const Program& program, const machine::Machine& machine, const machine::Job* job,
                  const Diagnostics& before, const PostOptions& options, const RunOptions& run_options) {
  PostResult result;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found = before;
    found.append(program.impl().found);
    const report::PostSummary out = post_program(program, machine, job, options, found);
    run.settle_first(found);
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
              .json = report::post_json(out),
              .printed = report::post_text(out)};
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
