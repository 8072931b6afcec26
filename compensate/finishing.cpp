#include "compensate/finishing.h"

#include <algorithm>
#include <numeric>
#include <span>

#include <fmt/format.h>

#include "motion/operations.h"
#include "removal/tool_path.h"

namespace camber::compensate {
namespace {

using simulate::SimulatedProgram;

/// Operations in order, and for each move the index of its own (the moves that are not simulated: nonsense).
std::vector<Operation> operations_of(const SimulatedProgram& program, std::vector<std::size_t>& of_move) {
  std::vector<Operation> out;
  of_move.assign(program.moves_in_part().moves.size(), 0);
  for (std::size_t m = 0; m < program.moves_in_part().moves.size(); ++m) {
    if (!program.selected[m]) continue;
    const nc::Move& move = program.moves_in_part().moves[m];
    const int tool = program.moves_in_part().state_of(move).tool;
    const std::size_t line = move.block + 1;
    if (out.empty() || out.back().tool != tool) out.push_back({tool, line, line, 0, 0, 0});
    out.back().first_line = std::min(out.back().first_line, line);
    out.back().last_line = std::max(out.back().last_line, line);
    ++out.back().moves;
    of_move[m] = out.size() - 1;
  }
  return out;
}

/// Area of a surface that each move made.
struct MadeArea {
  std::vector<double> of_move_mm2;
  double whole_mm2 = 0;  ///< zero: there is no surface
};

/// `stamp_of`: index into `stamps` (of the moves) that made a point; negative: none.
MadeArea made_by(std::span<const removal::SurfacePoint> surface, std::size_t moves, const auto& stamps, auto stamp_of) {
  MadeArea out{std::vector<double>(moves, 0.0), 0};
  for (const removal::SurfacePoint& p : surface) {
    out.whole_mm2 += p.area_mm2;
    const std::int32_t stamp = stamp_of(p);
    if (stamp >= 0 && static_cast<std::size_t>(stamp) < stamps.size())
      out.of_move_mm2[stamps[static_cast<std::size_t>(stamp)].move] += p.area_mm2;
  }
  return out;
}

void distribute_surface(const SimulatedProgram& program, const MadeArea& made, const std::vector<std::size_t>& of_move,
                        std::vector<Operation>& operations) {
  if (made.whole_mm2 <= 0) return;
  for (std::size_t m = 0; m < of_move.size(); ++m)
    if (program.selected[m]) operations[of_move[m]].surface_fraction += made.of_move_mm2[m] / made.whole_mm2;
}

Finishing find_finishing(const machine::Job& job, const SimulatedProgram& program, const MadeArea& made) {
  Finishing out;
  std::vector<std::size_t> of_move;
  out.operations = operations_of(program, of_move);
  distribute_surface(program, made, of_move, out.operations);
  const auto& wanted = job.compensation.operations;
  out.moves = removal::selected_moves(program.moves_in_part(),
                                      motion::as_lines(wanted, program.text(), program.moves_in_part()));
  for (std::size_t m = 0; m < out.moves.size(); ++m) {
    out.moves[m] = out.moves[m] && program.selected[m];
    if (!out.moves[m]) continue;
    Operation& operation = out.operations[of_move[m]];
    if (!wanted.given() && made.whole_mm2 > 0) out.moves[m] = operation.surface_fraction >= kFinishingFraction;
    if (out.moves[m]) ++operation.compensated_moves;
  }
  return out;
}

}  // namespace

Finishing find_finishing(const machine::Job& job, const SimulatedProgram& program,
                         const std::vector<removal::SurfacePoint>& surface) {
  return find_finishing(job, program,
                        made_by(surface, program.moves_in_part().moves.size(), program.path.stamps,
                                [](const removal::SurfacePoint& p) { return p.machined_stamp; }));
}

Finishing expected_finishing(const machine::Job& job, const SimulatedProgram& program, const simulate::Target& target) {
  return find_finishing(job, program,
                        made_by(target.map->points(), program.moves_in_part().moves.size(), target.stamps,
                                [](const removal::SurfacePoint& p) { return p.target_stamp; }));
}

std::size_t runs_before(const SimulatedProgram& program, const std::vector<bool>& compensated) {
  const auto& runs = program.path.runs;
  const auto first = std::ranges::find_if(runs, [&](const removal::ToolRun& run) {
    return std::ranges::any_of(std::span(program.path.stamps).subspan(run.from, run.count),
                               [&](const removal::Stamp& s) { return compensated[s.move]; });
  });
  return static_cast<std::size_t>(first - runs.begin());
}

std::vector<LineRole> line_roles(const SimulatedProgram& program, const std::vector<bool>& compensated) {
  std::vector<LineRole> out(program.text().blocks.size(), LineRole::none);
  for (std::size_t m = 0; m < compensated.size(); ++m) {
    if (!program.selected[m]) continue;
    const nc::Move& move = program.moves_in_part().moves[m];
    LineRole& role = out[move.block];
    if (compensated[m] && move.editable)
      role = LineRole::compensated;
    else if (role == LineRole::none)
      role = LineRole::only_simulated;
  }
  return out;
}

void check_compensated(const SimulatedProgram& program, const std::vector<bool>& moves, Diagnostics& diagnostics) {
  const nc::Move* first = nullptr;
  std::size_t count = 0, all = 0, editable = 0;
  for (std::size_t m = 0; m < moves.size(); ++m) {
    if (!moves[m]) continue;
    ++all;
    const nc::Move& move = program.moves_in_part().moves[m];
    if (move.editable) ++editable;
    if (!program.moves_in_part().state_of(move).cutter_radius) continue;
    if (!first) first = &move;
    ++count;
  }
  if (all == 0)
    diagnostics.add({Severity::error,
                     {program.text().source.name(), 0, 0},
                     "[compensation] operations selects no simulated move; a tool, lines or a comment of cutting moves "
                     "was expected",
                     "nothing-to-compensate",
                     {}});
  if (!first && all > 0 && editable == 0) {
    const auto made = static_cast<std::size_t>(std::find(moves.begin(), moves.end(), true) - moves.begin());
    diagnostics.add(program.text().source.diagnostic(
        Severity::error, program.text().blocks[program.moves_in_part().moves[made].block].offset,
        "all moves to compensate, from here on, come from a loop, an expression or a "
        "subprogram that is called more than once or is in another file, and have no "
        "words of their own in the text; a program without these was expected",
        "nothing-to-compensate"));
  }
  if (!first) return;
  diagnostics.add(program.text().source.diagnostic(
      Severity::error, program.text().blocks[first->block].offset,
      fmt::format("{} move{} to compensate run{} under cutter radius compensation (G41, G42), from here on: the "
                  "control computes their path, and the text has no words for it; a program of the cutter centre, or "
                  "[compensation] operations without these blocks, was expected",
                  count, count == 1 ? "" : "s", count == 1 ? "s" : ""),
      "cutter-radius"));
}

}  // namespace camber::compensate
