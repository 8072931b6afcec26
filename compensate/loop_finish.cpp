// The figures of the program that is written, and its text.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compensate/loop.h"
#include "compensate/not_emitted.h"
#include "simulate/verdict.h"

namespace camber::compensate {

using simulate::SimulatedProgram;

/// Blocks of the active version as those of the given program.
std::vector<std::uint32_t> Loop::given_blocks(std::vector<std::uint32_t> block_of_line) const {
  if (!now_->repeated) return block_of_line;
  for (std::uint32_t& block : block_of_line)
    if (block != nc::Emission::kNoBlock) block = now_->repeated->block_of_line[block];
  return block_of_line;
}

/// Lines of the given program that do not stand in the emitted one as they were, but for those of first cuts.
std::size_t Loop::count_changed(const Emitted& emitted) const {
  const nc::Program& program = given().text;
  const SourceText text("", emitted.emission.text);
  const std::size_t count = program.source.line_count();
  std::vector<bool> same(count, false), met(count, false);
  const auto& own = emitted.emission.block_of_line;
  const std::vector<std::uint32_t> given_of = given_blocks(own);
  for (std::size_t line = 0; line < std::min(given_of.size(), text.line_count()); ++line) {
    if (now_->repeated && own[line] < now_->repeated->added.size() && now_->repeated->added[own[line]]) continue;
    const std::size_t given = given_of[line];
    if (given >= count) continue;
    same[given] = !met[given] && text.line(line + 1) == program.source.line(given + 1);
    met[given] = true;
  }
  return static_cast<std::size_t>(std::count(same.begin(), same.end(), false));
}

std::vector<nc::EditNotMade> Loop::in_given(std::vector<nc::EditNotMade> not_made) const {
  if (now_->moves.empty()) return not_made;
  for (nc::EditNotMade& n : not_made)
    n.move = static_cast<std::uint32_t>(std::ranges::lower_bound(now_->moves, n.move) - now_->moves.begin());
  return not_made;
}

Stop Loop::verdict(const CompensationResult& out) const {
  if (out.within_tolerance && out.within_part) return Stop::tolerance;
  // The guard is the reason only where it made the error larger.
  const bool guarded = out.rounds[out.best].guard && out.rounds[free_round_].error_um.rms < out.after_um.rms;
  return guarded ? Stop::depth_limit : ended_;
}

/// One per point of the emitted program's surface: the line that made it.
std::vector<std::size_t> Loop::lines_of(const Trial& trial, const SimulatedProgram& program) const {
  std::vector<std::size_t> out;
  out.reserve(trial.surface.size());
  for (const auto& p : trial.surface) {
    const auto stamp = static_cast<std::size_t>(p.machined_stamp);
    const bool known = p.machined_stamp >= 0 && stamp < program.path.stamps.size();
    out.push_back(known ? program.moves.moves[program.path.stamps[stamp].move].block + 1 : 0);
  }
  return out;
}

void Loop::say_passes(CompensationResult& out) const {
  if (!now_->repeated) return;
  const auto runs = nc::cut_runs(given().text, given().moves, versions_.front()->compensated);
  std::vector<nc::CutRun> able;
  for (const nc::CutRun& run : runs)
    if (run.why_not == nc::RunGap::none) able.push_back(run);
  for (const std::size_t r : now_->passes)
    out.repeated.push_back({std::size_t{able[r].first_block} + 1, std::size_t{able[r].last_block} + 1});
  out.pass_allowance_mm = allowance_mm_;
  out.repeated_text = now_->repeated->text;
}

void Loop::finish(CompensationResult& out) {
  ShiftPath& path = *now_->path;
  path.set_shifts(best_->shifts);
  FeedLever::set_fractions(path, best_->fractions);
  const Round &first = out.rounds[0], &best = out.rounds[out.best];
  const SimulatedProgram& program = best_->emitted ? best_->emitted->program : setup_.program;
  out.before_um = first.error_um;
  out.after_um = best.error_um;
  out.split_before = first.split;
  out.split_after = best.split;
  out.surface_after = best_->surface;
  out.loads_after = best_->loads;
  out.feed_after = program.feed;
  out.max_shift_mm = best.largest_shift_mm;
  say_passes(out);
  if (best_->emitted) {
    warn_of_not_emitted(given().text, given().moves, in_given(best_->emitted->emission.not_made), diagnostics_);
    out.quality = best_->emitted->quality;
  }
  out.surface_steps =
      surface_steps(path, row_links(path, kRowReach_mm, RowSense::any), first_observed_, best_->observed);
  out.row_steps = row_steps(path, kRowReach_mm);
  const ThinPath thin(path, now_->splits->kept());
  out.row_turn_rad =
      row_turn(thin.path(), row_links(thin.path(), kRowReach_mm), job_.compensation.max_angle_growth_rad).max_rad;
  const double max_um = depth_limit_um_;
  out.depth_after = depth_of(out.surface_after, best_->observed, max_um, true);
  out.depth_others = depth_of(out.surface_after, best_->observed, max_um, false);
  out.depth_without_bending = depth_without_bending(job_, setup_.target, program, max_um);
  out.within_part = out.depth_after.gouge_depth_p999_um <= max_um;
  out.plain_after = figures_of(*best_);
  out.within_tolerance = within_tolerance(out.plain_after, job_.compensation);
  out.stop = verdict(out);
  if (!out.within_tolerance) {
    std::vector<PointCause> points;
    split_error(path, best_->observed, fit_options(), &points);
    out.causes = causes_of(best.split, points, best_->observed, lines_of(*best_, program));
    for (CauseFigure& cause : out.causes) cause.cut_twice = best.repeated > 0;
  }
  if (options_.max_stock_crossings > 0)
    out.stock = removal::stock_shape(setup_.target.surface, options_.max_stock_crossings);
  Diagnostics travel;  // the given program's warnings are said
  simulate::check_travel(job_, program, travel);
  for (const Diagnostic& d : travel.all())
    if (d.severity == Severity::error) diagnostics_.add(d);
  diagnostics_.throw_if_errors();
  out.blocks_before = given().text.source.line_count();
  out.blocks_after = program.text.source.line_count();
  out.blocks_changed = best_->emitted ? count_changed(*best_->emitted) : 0;
  out.settled = first.unsettled == 0 && best.unsettled == 0;
  const double imbalance = simulate::imbalance(best_->chip_mm3, best_->stock_mm3, job_.simulation.voxel_mm);
  if (out.doubts.empty() && std::abs(imbalance) > simulate::kMaxImbalance)
    out.doubts.push_back("in the emitted program " + simulate::imbalance_sentence(best_->chip_mm3, best_->stock_mm3));
}

/// Both programs on another grid, each with its own version; the given one first.
void Loop::recheck_on(double voxel_mm, CompensationResult& out) {
  const std::size_t version = active_;
  const Emitted* emitted = best_->emitted.get();
  const bool guarded = out.rounds[out.best].guard;
  const EmittedPair pair{emitted, guarded ? free_.get() : nullptr};
  std::optional<Recheck> of_given;
  if (version > 0) {
    activate(0);
    of_given =
        recheck(job_, voxel_mm, setup_, {}, *now_->path, fit_options(), {setup_.target_program()}, options_.progress);
    activate(version);
  }
  const SimulatedProgram& target = setup_.own_target() ? given() : *setup_.original;
  const std::vector<std::uint32_t> moves = setup_.own_target() ? now_->moves : std::vector<std::uint32_t>();
  out.rechecks.push_back(recheck(job_, voxel_mm, setup_, pair, *now_->path, fit_options(),
                                 {target, moves, now_->first_cuts}, options_.progress));
  if (!of_given) return;
  out.rechecks.back().before_um = of_given->before_um;
  out.rechecks.back().split_before = of_given->split_before;
}

void Loop::check(CompensationResult& out) {
  const Emitted* emitted = best_->emitted.get();
  for (const double voxel_mm : options_.recheck_voxels_mm) recheck_on(voxel_mm, out);
  std::vector<std::string> names;
  std::vector<std::vector<double>> changes;
  for (const ParameterGroup& group : options_.uncertainty) {
    names.push_back(group.name);
    changes.push_back(
        changes_mm(job_, group, setup_, emitted, out.surface_after, out.unknown_parameters, options_.progress));
  }
  if (!names.empty()) out.band = band_of(out.surface_before, out.surface_after, names, changes, depth_limit_um_ / 1000);
  out.text = emitted ? emitted->emission.text : setup_.program.text.source.text();
  if (emitted)
    out.block_of_line = given_blocks(emitted->emission.block_of_line);
  else if (now_->repeated)
    out.block_of_line = now_->repeated->block_of_line;
  if (!options_.header || !emitted) return;
  trials_.header = options_.header(out);
  nc::Emission with_header = trials_.text_of(*now_->path, emitted->splits);
  out.text = std::move(with_header.text);
  out.block_of_line = given_blocks(std::move(with_header.block_of_line));
  const std::size_t more = SourceText("", out.text).line_count() - out.blocks_after;
  for (CauseFigure& cause : out.causes)
    for (std::size_t& line : cause.lines) line += more;
}

}  // namespace camber::compensate
