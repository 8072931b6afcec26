// The figures of the program that is written, and its text.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "compensate/fit_shift.h"
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
  if (out.verdict.within_tolerance && out.safety.within_part) return Stop::tolerance;
  // The guard is the reason only where it made the error larger.
  const bool guarded = out.rounds[out.best].guard && out.rounds[free_round_].error_um.rms < out.figures.after_um.rms;
  return guarded ? Stop::depth_limit : ended_;
}

/// Returns the lines of stamps of the emitted program.
std::vector<ProgramLine> Loop::lines_of(const Trial& trial, std::span<const std::int32_t> stamps) const {
  const SimulatedProgram& program = trial.emitted ? trial.emitted->program : setup_.program;
  std::vector<std::uint32_t> given_of;
  if (trial.emitted)
    given_of = given_blocks(trial.emitted->emission.block_of_line);
  else if (now_->repeated)
    given_of = now_->repeated->block_of_line;
  const auto given = [&](std::size_t block) -> std::size_t {
    if (given_of.empty()) return block + 1;
    return block < given_of.size() && given_of[block] != nc::Emission::kNoBlock ? given_of[block] + std::size_t{1} : 0;
  };
  std::vector<ProgramLine> out(stamps.size());
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const auto stamp = static_cast<std::size_t>(stamps[i]);
    if (stamps[i] < 0 || stamp >= program.path.stamps.size()) continue;
    const std::size_t block = program.moves.moves[program.path.stamps[stamp].move].block;
    out[i] = {given(block), block + 1};
  }
  return out;
}

/// Returns, for each limit that the best round met, the value from which it would not bind.
std::vector<BindingLimit> Loop::binding_limits(const CompensationResult& out) {
  const machine::CompensationSettings& asked = job_.compensation;
  const Round& best = out.rounds[out.best];
  std::vector<BindingLimit> limits;
  if (best.limited_points > 0) {
    FitShiftOptions free = fit_options();
    free.max_shift_mm = std::numeric_limits<double>::infinity();
    ShiftPath path = *now_->path;
    fit_shift(path, wanted_of(best_->observed, nullptr), free);
    if (const double wanted = path.largest_shift_mm(); wanted > asked.max_shift_mm)
      limits.push_back({kMaxShiftKey, asked.max_shift_mm, std::ceil(1000 * wanted) / 1000});
  }
  if (best.free_angle_growth_rad > asked.max_angle_growth_rad)
    limits.push_back({kAngleGrowthKey, deg_from_rad(asked.max_angle_growth_rad),
                      std::ceil(10 * deg_from_rad(best.free_angle_growth_rad)) / 10});
  if (const Round& unguarded = out.rounds[free_round_]; best.guard && unguarded.deepest_um > depth_limit_um_)
    limits.push_back({asked.profile_um ? kProfileKey : kOvercutKey, depth_limit_um_,
                      std::ceil(10 * unguarded.deepest_um) / 10, out.safety.own_depth_limit});
  return limits;
}

Tried Loop::tried(const CompensationResult& out) const {
  Tried found;
  found.rounds = ended_ == Stop::stalled;
  for (const Round& round : out.rounds) {
    found.feeds = found.feeds || round.slowed > 0;
    found.second_cuts = found.second_cuts || round.repeated > 0;
  }
  found.limits = out.verdict.limits;
  return found;
}

void Loop::say_passes(CompensationResult& out) const {
  if (!now_->repeated) return;
  const auto runs = nc::cut_runs(given().text, given().moves, versions_.front()->compensated);
  std::vector<nc::CutRun> able;
  for (const nc::CutRun& run : runs)
    if (run.why_not == nc::RunGap::none) able.push_back(run);
  for (const std::size_t r : now_->passes)
    out.passes.runs.push_back({std::size_t{able[r].first_block} + 1, std::size_t{able[r].last_block} + 1});
  out.passes.allowance_mm = allowance_mm_;
  out.passes.text = now_->repeated->text;
}

void Loop::finish(CompensationResult& out) {
  ShiftPath& path = *now_->path;
  path.set_shifts(best_->shifts);
  FeedLever::set_fractions(path, best_->fractions);
  const Round &first = out.rounds[0], &best = out.rounds[out.best];
  const SimulatedProgram& program = best_->emitted ? best_->emitted->program : setup_.program;
  out.figures.before_um = first.error_um;
  out.figures.after_um = best.error_um;
  out.figures.split_before = first.split;
  out.figures.split_after = best.split;
  out.surfaces.after = best_->surface;
  out.surfaces.loads_after = best_->loads;
  out.figures.feed_after = program.feed;
  out.path.max_shift_mm = best.largest_shift_mm;
  say_passes(out);
  if (best_->emitted) {
    warn_of_not_emitted(given().text, given().moves, in_given(best_->emitted->emission.not_made), diagnostics_);
    out.path.quality = best_->emitted->quality;
  }
  out.path.surface_steps =
      surface_steps(path, row_links(path, kRowReach_mm, RowSense::any), first_observed_, best_->observed);
  out.path.row_steps = row_steps(path, kRowReach_mm);
  const ThinPath thin(path, now_->splits->kept());
  out.path.row_turn_rad =
      row_turn(thin.path(), row_links(thin.path(), kRowReach_mm), job_.compensation.max_angle_growth_rad).max_rad;
  const double max_um = depth_limit_um_;
  out.safety.after = depth_of(out.surfaces.after, best_->observed, max_um, true);
  out.safety.after.line = lines_of(*best_, {&out.safety.after.stamp, 1}).front();
  out.safety.others = depth_of(out.surfaces.after, best_->observed, max_um, false);
  out.safety.without_bending = depth_without_bending(job_, setup_.target, program, max_um);
  out.safety.within_part = out.safety.after.gouge_depth_p999_um <= max_um;
  out.figures.plain_after = figures_of(*best_);
  out.verdict.within_tolerance = within_tolerance(out.figures.plain_after, job_.compensation);
  out.figures.worse = worse_of(*best_);
  out.verdict.stop = verdict(out);
  out.verdict.limits = binding_limits(out);
  if (!out.verdict.within_tolerance) {
    std::vector<PointCause> points;
    split_error(path, best_->observed, fit_options(), &points);
    std::vector<std::int32_t> stamps;
    for (const removal::SurfacePoint& p : best_->surface) stamps.push_back(p.machined_stamp);
    out.verdict.causes = causes_of(best.split, points, best_->observed, lines_of(*best_, stamps));
    for (CauseFigure& cause : out.verdict.causes) {
      if (setup_.target.contour_parts && cause.cause == Cause::short_range)
        cause.contour = contour_cause_of(cause.cause, points, best_->surface);
      cause.remedies = remedies_of(cause, tried(out));
    }
  }
  if (options_.max_stock_crossings > 0)
    out.surfaces.stock = removal::stock_shape(setup_.target.surface, options_.max_stock_crossings);
  Diagnostics travel;  // the given program's warnings are said
  simulate::check_travel(job_, program, travel);
  for (const Diagnostic& d : travel.all())
    if (d.severity == Severity::error) diagnostics_.add(d);
  diagnostics_.throw_if_errors();
  out.emitted.blocks_before = given().text.source.line_count();
  out.emitted.blocks_after = program.text.source.line_count();
  out.emitted.blocks_changed = best_->emitted ? count_changed(*best_->emitted) : 0;
  out.verdict.settled = first.unsettled == 0 && best.unsettled == 0;
  const double imbalance = simulate::imbalance(best_->chip_mm3, best_->stock_mm3, job_.simulation.voxel_mm);
  if (out.verdict.doubts.empty() && best_->all_valid && std::abs(imbalance) > simulate::kMaxImbalance)
    out.verdict.doubts.push_back("in the emitted program " +
                                 simulate::imbalance_sentence(best_->chip_mm3, best_->stock_mm3));
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
  out.uncertainty.rechecks.push_back(recheck(job_, voxel_mm, setup_, pair, *now_->path, fit_options(),
                                             {target, moves, now_->first_cuts}, options_.progress));
  if (!of_given) return;
  out.uncertainty.rechecks.back().before_um = of_given->before_um;
  out.uncertainty.rechecks.back().split_before = of_given->split_before;
}

void Loop::check(CompensationResult& out) {
  const Emitted* emitted = best_->emitted.get();
  for (const double voxel_mm : options_.recheck_voxels_mm) recheck_on(voxel_mm, out);
  std::vector<std::string> names;
  std::vector<std::vector<double>> changes;
  for (const ParameterGroup& group : options_.uncertainty) {
    names.push_back(group.name);
    changes.push_back(changes_mm(job_, group, setup_, emitted, out.surfaces.after, out.uncertainty.unknown_parameters,
                                 options_.progress));
  }
  if (!names.empty())
    out.uncertainty.band = band_of(out.surfaces.before, out.surfaces.after, names, changes, depth_limit_um_ / 1000);
  out.emitted.text = emitted ? emitted->emission.text : setup_.program.text.source.text();
  if (emitted)
    out.emitted.block_of_line = given_blocks(emitted->emission.block_of_line);
  else if (now_->repeated)
    out.emitted.block_of_line = now_->repeated->block_of_line;
  if (!options_.header || !emitted) return;
  trials_.header = options_.header(out);
  nc::Emission with_header = trials_.text_of(*now_->path, emitted->splits);
  out.emitted.text = std::move(with_header.text);
  out.emitted.block_of_line = given_blocks(std::move(with_header.block_of_line));
  const std::size_t more = SourceText("", out.emitted.text).line_count() - out.emitted.blocks_after;
  for (CauseFigure& cause : out.verdict.causes)
    for (ProgramLine& line : cause.lines) line.emitted += more;
  if (out.safety.after.line.emitted > 0) out.safety.after.line.emitted += more;
}

}  // namespace camber::compensate
