#include "compensate/outcome.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "compensate/fit_shift.h"
#include "compensate/judge.h"
#include "compensate/pass_before.h"
#include "compensate/propose.h"
#include "compensate/second_cuts.h"
#include "simulate/verdict.h"

namespace camber::compensate {

using simulate::SimulatedProgram;

namespace {

constexpr std::size_t kLinesShown = 8;

std::string list_of(const std::set<std::size_t>& lines) {
  std::string out = lines.size() == 1 ? "line " : "lines ";
  std::size_t shown = 0;
  for (const std::size_t line : lines) {
    if (shown == kLinesShown) return out + fmt::format(" and {} more", lines.size() - shown);
    out += (shown++ > 0 ? ", " : "") + std::to_string(line);
  }
  return out;
}

/// The program that the best trial cuts.
const SimulatedProgram& program_of(const Version& version, const Trial& trial) {
  return trial.emitted ? trial.emitted->program : *version.source.program;
}

/// Blocks of a version as those of the given program.
std::vector<std::uint32_t> given_blocks(const Version& version, std::vector<std::uint32_t> block_of_line) {
  if (!version.repeated) return block_of_line;
  for (std::uint32_t& block : block_of_line)
    if (block != nc::Emission::kNoBlock) block = version.repeated->text.block_of_line[block];
  return block_of_line;
}

/// Lines of the given program that do not stand in the emitted one as they were, but for those of first cuts.
std::size_t count_changed(const SourceText& program, const Version& version, const Emitted& emitted) {
  const SourceText text("", emitted.emission.text);
  const std::size_t count = program.line_count();
  std::vector<bool> same(count, false), met(count, false);
  const auto& own = emitted.emission.block_of_line;
  const std::vector<std::uint32_t> given_of = given_blocks(version, own);
  for (std::size_t line = 0; line < std::min(given_of.size(), text.line_count()); ++line) {
    if (version.repeated && own[line] < version.repeated->text.added.size() && version.repeated->text.added[own[line]])
      continue;
    const std::size_t given = given_of[line];
    if (given >= count) continue;
    same[given] = !met[given] && text.line(line + 1) == program.line(given + 1);
    met[given] = true;
  }
  return static_cast<std::size_t>(std::count(same.begin(), same.end(), false));
}

std::vector<nc::EditNotMade> in_given(const Version& version, std::vector<nc::EditNotMade> not_made) {
  if (!version.repeated) return not_made;
  const std::vector<std::uint32_t>& moves = version.repeated->moves;
  for (nc::EditNotMade& n : not_made)
    n.move = static_cast<std::uint32_t>(std::ranges::lower_bound(moves, n.move) - moves.begin());
  return not_made;
}

Stop stop_of(const State& state, const CompensationResult& out) {
  if (out.verdict.within_tolerance && out.safety.within_part) return Stop::tolerance;
  // The guard is the reason only where it made the error larger.
  const bool guarded =
      out.rounds[out.best].guard && out.rounds[state.free.round].error_um.rms < out.figures.after_um.rms;
  return guarded ? Stop::depth_limit : state.ended;
}

/// Returns the lines of stamps of a trial's program.
std::vector<ProgramLine> lines_of(const Version& version, const Trial& trial, std::span<const std::int32_t> stamps) {
  const SimulatedProgram& program = program_of(version, trial);
  std::vector<std::uint32_t> given_of;
  if (trial.emitted)
    given_of = given_blocks(version, trial.emitted->emission.block_of_line);
  else if (version.repeated)
    given_of = version.repeated->text.block_of_line;
  const auto given = [&](std::size_t block) -> std::size_t {
    if (given_of.empty()) return block + 1;
    return block < given_of.size() && given_of[block] != nc::Emission::kNoBlock ? given_of[block] + std::size_t{1} : 0;
  };
  std::vector<ProgramLine> out(stamps.size());
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const auto stamp = static_cast<std::size_t>(stamps[i]);
    if (stamps[i] < 0 || stamp >= program.path.stamps.size()) continue;
    const std::size_t block = program.moves_in_part().moves[program.path.stamps[stamp].move].block;
    out[i] = {given(block), block + 1};
  }
  return out;
}

Tried tried(const Task& task, const State& state, const CompensationResult& out) {
  Tried found;
  found.pass_before = task.has(machine::Lever::allowance) || !has_passes_before(task, *state.versions.front());
  found.rounds = state.ended == Stop::stalled;
  for (const Round& round : out.rounds) {
    found.feeds = found.feeds || round.slowed > 0;
    found.second_cuts = found.second_cuts || round.repeated > 0;
  }
  found.limits = out.verdict.limits;
  return found;
}

SecondCuts second_cuts(const Task& task, const State& state) {
  const Version& version = *state.active;
  if (!version.repeated) return {};
  const SimulatedProgram& given = task.setup->program;
  std::vector<nc::CutRun> able;
  for (const nc::CutRun& run : nc::cut_runs(given.text(), given.moves_in_part(), state.versions.front()->compensated))
    if (run.why_not == nc::RunGap::none) able.push_back(run);
  SecondCuts out{.allowance_mm = version.repeated->allowance_mm, .text = version.repeated->text.text};
  for (const std::size_t r : version.repeated->runs) {
    const std::size_t first_line = std::size_t{able[r].first_block} + 1;
    if (!out.runs.empty() && out.runs.back().first_line == first_line)
      ++out.runs.back().cuts;
    else
      out.runs.push_back({first_line, std::size_t{able[r].last_block} + 1});
  }
  return out;
}

PathFigures path_figures(const Task& task, const Version& version, const Trial& best) {
  const ShiftPath& path = version.path;
  PathFigures out;
  if (best.emitted) out.quality = best.emitted->quality;
  out.surface_steps =
      surface_steps(path, row_links(path, kRowReach_mm, RowSense::any), task.given.trial->observed, best.observed);
  out.row_steps = row_steps(path, kRowReach_mm);
  const ThinPath thin(path, version.splits.kept());
  out.row_turn_rad =
      row_turn(thin.path(), row_links(thin.path(), kRowReach_mm), task.job.compensation.max_angle_growth_rad).max_rad;
  return out;
}

void fill_safety(const Task& task, const Version& version, const Trial& best, Safety& out) {
  const double max_um = task.given.depth_limit_um;
  out.after = depth_of(best.surface, best.observed, max_um, true);
  out.after.line = lines_of(version, best, {&out.after.stamp, 1}).front();
  out.others = depth_of(best.surface, best.observed, max_um, false);
  out.without_bending =
      depth_without_bending(version.source.job, task.setup->target, program_of(version, best), max_um);
  out.within_part = out.after.gouge_depth_p999_um <= max_um;
}

/// The causes of the remaining error, with what may take them away.
std::vector<CauseFigure> causes(const Task& task, const State& state, const CompensationResult& out) {
  const Version& version = *state.active;
  const Trial& best = *state.best.trial;
  std::vector<PointCause> points;
  split_error(version.path, best.observed, fit_options(task, version), &points);
  std::vector<std::int32_t> stamps;
  for (const removal::SurfacePoint& p : best.surface) stamps.push_back(p.machined_stamp);
  std::vector<CauseFigure> found =
      causes_of(out.rounds[out.best].split, points, best.observed, lines_of(version, best, stamps));
  const Tried done = tried(task, state, out);
  for (CauseFigure& cause : found) {
    if (task.setup->target.contour_parts && cause.cause == Cause::short_range)
      cause.contour = contour_cause_of(cause.cause, points, best.surface);
    cause.remedies = remedies_of(cause, done);
  }
  return found;
}

/// Errors of the travel of the emitted program; its warnings are the given one's, which are said.
void check_emitted_travel(const machine::Job& job, const SimulatedProgram& program, Diagnostics& diagnostics) {
  Diagnostics travel;
  checks::check_travel(job, program, travel);
  for (const Diagnostic& d : travel.all())
    if (d.severity == Severity::error) diagnostics.add(d);
  diagnostics.throw_if_errors();
}

/// Both programs on another grid, each with its own version; the given one first.
Recheck recheck_on(double voxel_mm, const Task& task, const State& state) {
  const Version &version = *state.active, &first = *state.versions.front();
  const bool guarded = state.rounds[state.best.round].guard;
  const EmittedPair pair{state.best.trial->emitted.get(), guarded ? state.free.emitted.get() : nullptr};
  const auto& progress = task.options.progress;
  std::optional<Recheck> of_given;
  if (&version != &first)
    of_given = recheck(voxel_mm, first.source, {}, first.path, fit_options(task, first), {task.setup->target_program()},
                       progress);
  RecheckTarget made_by{task.setup->target_program()};
  if (task.setup->own_target() && version.repeated) made_by.moves = version.repeated->moves;
  Recheck out = recheck(voxel_mm, version.source, pair, version.path, fit_options(task, version), made_by, progress);
  if (!of_given) return out;
  out.before_um = of_given->before_um;
  out.split_before = of_given->split_before;
  return out;
}

void find_uncertainty(const Task& task, const State& state, CompensationResult& out) {
  std::vector<std::string> names;
  std::vector<std::vector<double>> changes;
  for (const ParameterGroup& group : task.options.uncertainty) {
    names.push_back(group.name);
    changes.push_back(changes_mm(group, state.active->source, state.best.trial->emitted.get(), out.surfaces.after,
                                 out.uncertainty.unknown_parameters, task.options.progress));
  }
  if (!names.empty())
    out.uncertainty.band =
        band_of(out.surfaces.before, out.surfaces.after, names, changes, task.given.depth_limit_um / 1000);
}

/// The program without its header.
void write_program(const State& state, CompensationResult& out) {
  const Version& version = *state.active;
  if (const Emitted* emitted = state.best.trial->emitted.get()) {
    out.emitted.text = emitted->emission.text;
    out.emitted.block_of_line = given_blocks(version, emitted->emission.block_of_line);
    return;
  }
  out.emitted.text = version.source.program->text().source.text();
  if (version.repeated) out.emitted.block_of_line = version.repeated->text.block_of_line;
}

/// Writes it again with the header; lines of the emitted program count from there.
void add_header(const Task& task, const State& state, CompensationResult& out) {
  const Version& version = *state.active;
  nc::Emission with_header =
      text_of(version.source, version.path, state.best.trial->emitted->splits, task.options.header(out));
  out.emitted.text = std::move(with_header.text);
  out.emitted.block_of_line = given_blocks(version, std::move(with_header.block_of_line));
  const std::size_t more = SourceText("", out.emitted.text).line_count() - out.emitted.blocks_after;
  for (CauseFigure& cause : out.verdict.causes)
    for (ProgramLine& line : cause.lines) line.emitted += more;
  for (BindingLimit& limit : out.verdict.limits)
    if (limit.line.emitted > 0) limit.line.emitted += more;
  if (out.safety.after.line.emitted > 0) out.safety.after.line.emitted += more;
}

}  // namespace

void warn_of_not_emitted(const nc::Program& program, const nc::Interpretation& moves,
                         std::span<const nc::EditNotMade> not_made, Diagnostics& diagnostics) {
  std::map<nc::EmitGap, std::set<std::size_t>> lines;
  for (const auto& n : not_made) lines[n.why].insert(moves.moves[n.move].block + 1);
  for (const auto& [why, of_kind] : lines) {
    const auto words = program.words_of(*of_kind.begin() - 1);
    const std::string what = why == nc::EmitGap::subprogram || why == nc::EmitGap::arc_not_split
                                 ? "splits of a line are not written"
                                 : "shifts are not written";
    diagnostics.add(program.source.diagnostic(
        Severity::warning, words.empty() ? program.blocks[*of_kind.begin() - 1].offset : words.front().offset,
        fmt::format("{} where the move belongs to {}: {}", what, nc::to_string(why), list_of(of_kind)), "not-emitted"));
  }
}

void conclude(const Task& task, State& state, bool better, CompensationResult& out) {
  Version& version = *state.active;
  const Trial& best = *state.best.trial;
  version.path.set_shifts(best.shifts);
  FeedLever::set_fractions(version.path, best.fractions);
  out.rounds = state.rounds;
  out.best = state.best.round;
  out.time_points = state.time_points;
  const Round &first_round = out.rounds[0], &best_round = out.rounds[out.best];
  const SimulatedProgram &given = task.setup->program, &program = program_of(version, best);
  out.surfaces.after = best.surface;
  out.surfaces.loads_after = best.loads;
  out.surfaces.chatter_after = best.chatter;
  out.passes = second_cuts(task, state);
  if (version.repeated) out.pass_before = version.repeated->pass_before;
  if (best.emitted)
    warn_of_not_emitted(given.text(), given.moves_in_part(), in_given(version, best.emitted->emission.not_made),
                        task.diagnostics);
  out.path = path_figures(task, version, best);
  out.path.max_shift_mm = best_round.largest_shift_mm;
  fill_safety(task, version, best, out.safety);

  FormFigures& figures = out.figures;
  figures.before_um = first_round.error_um;
  figures.after_um = best_round.error_um;
  figures.split_before = first_round.split;
  figures.split_after = best_round.split;
  figures.feed_after = program.feed;
  figures.plain_after = figures_of(task, best);
  figures.worse = worse_of(task, best);

  CompensationVerdict& verdict = out.verdict;
  verdict.better = better;
  verdict.within_tolerance = within_tolerance(figures.plain_after, task.job.compensation);
  verdict.stop = stop_of(state, out);
  verdict.limits = binding_limits(task, state);
  if (!verdict.within_tolerance) {
    verdict.causes = causes(task, state, out);
    verdict.unused = unused_levers(task, state);
  }
  if (task.options.max_stock_crossings > 0)
    out.surfaces.stock = removal::stock_shape(task.setup->target.surface, task.options.max_stock_crossings);
  check_emitted_travel(version.source.job, program, task.diagnostics);
  out.emitted.blocks_before = given.text().source.line_count();
  out.emitted.blocks_after = program.text().source.line_count();
  out.emitted.blocks_changed = best.emitted ? count_changed(given.text().source, version, *best.emitted) : 0;
  verdict.settled = first_round.unsettled == 0 && best_round.unsettled == 0;
  const double imbalance = simulate::imbalance(best.chip_mm3, best.stock_mm3, task.job.simulation.voxel_mm);
  if (verdict.doubts.empty() && best.all_valid && std::abs(imbalance) > simulate::kMaxImbalance)
    verdict.doubts.push_back("in the emitted program " + simulate::imbalance_sentence(best.chip_mm3, best.stock_mm3));
}

void check_outcome(const Task& task, const State& state, CompensationResult& out) {
  for (const double voxel_mm : task.options.recheck_voxels_mm)
    out.uncertainty.rechecks.push_back(recheck_on(voxel_mm, task, state));
  find_uncertainty(task, state, out);
  write_program(state, out);
  if (task.options.header && state.best.trial->emitted) add_header(task, state, out);
}

}  // namespace camber::compensate
