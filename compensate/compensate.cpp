#include "compensate/compensate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "compensate/choice.h"
#include "compensate/expected.h"
#include "compensate/feed_lever.h"
#include "compensate/fit_shift.h"
#include "compensate/guard.h"
#include "compensate/not_emitted.h"
#include "compensate/sensitivity.h"
#include "compensate/shift_path.h"
#include "compensate/splits.h"
#include "nc/emit.h"
#include "simulate/operations.h"
#include "simulate/setup.h"
#include "simulate/verdict.h"

namespace camber::compensate {

using simulate::SimulatedProgram;

std::string to_string(Stop stop) {
  switch (stop) {
    case Stop::tolerance:
      return "tolerance";
    case Stop::stalled:
      return "stalled";
    case Stop::depth_limit:
      return "depth_limit";
    case Stop::rounds:
      break;
  }
  return "rounds";
}

namespace {

constexpr double kSpacing_mm = 0.4;  // between points of a long line
constexpr double kMinGain = 0.03;    // a round that lowers the rms by less has stalled
constexpr int kPatience = 2;         // rounds without that gain before it counts
constexpr double kWorse = 1.02;      // a round whose rms is over the best one's by this has over-corrected
constexpr double kShorter = 0.5;     // then the next step starts at the best one's shifts, shorter
constexpr std::array kRungs_percent{5.0, 10.0, 15.0, 25.0, 50.0, 100.0, 200.0};  // of extra time
constexpr int kRungRounds = 2;
constexpr int kBudgetRounds = 6;
constexpr double kTimeRoom = 0.003;  // by which a budget may be exceeded
constexpr double kWanted = 0.9;      // of the tolerance: what feeds are chosen for
constexpr double kForeign = 0.2;     // of the area, cut by another row than it should be: expected_errors are used
constexpr int kGuardRounds = 5;      // beyond max_rounds, to stay out of the part
constexpr int kStiffenings = 12;     // of the path where its angles grow by more than the bound
constexpr double kStiffer = 2.5;
constexpr double kRowReach_mm = 1.0;
constexpr double kGuardReach_mm = 2.0;   // a lift fades out over this length, or ...
constexpr double kGuardSmoothings = 8;   // ... so many smoothing lengths
constexpr double kLeftOver = 0.25;       // of the tolerance: what a shift can still correct is not worth a round
constexpr double kSplit_mm = 0.0005;     // a split of a line in the first round must be worth this, ...
constexpr double kLateSplit_mm = 0.002;  // ... a later one this

/// Lines of the given program that do not stand in the emitted one as they were.
std::size_t count_changed(const nc::Program& program, const Emitted& emitted) {
  const SourceText text("", emitted.emission.text);
  const auto& given_of = emitted.emission.block_of_line;
  const std::size_t count = program.source.line_count();
  std::vector<bool> same(count, false), met(count, false);
  for (std::size_t line = 0; line < std::min(given_of.size(), text.line_count()); ++line) {
    const std::size_t given = given_of[line];
    if (given >= count) continue;
    same[given] = !met[given] && text.line(line + 1) == program.source.line(given + 1);
    met[given] = true;
  }
  return static_cast<std::size_t>(std::count(same.begin(), same.end(), false));
}

/// Places along the path where the feed fraction changes.
std::size_t count_feed_changes(const ShiftPath& path) {
  std::size_t out = 0;
  for (const Chain& chain : path.chains()) {
    double now = 1;
    for (std::size_t i = chain.from + 1; i < chain.from + chain.count; ++i) {
      if (path.points()[i].feed_fraction != now) ++out;
      now = path.points()[i].feed_fraction;
    }
  }
  return out;
}

/// Share of the area whose error changed its sign and is still over the tolerance.
double overcorrected_fraction(const Observed& before, const Observed& now, double tolerance_mm) {
  double over = 0, area = 0;
  for (std::size_t i = 0; i < now.points.size(); ++i) {
    const double a = before.points[i].error_mm, b = now.points[i].error_mm;
    area += now.points[i].area_mm2;
    if (now.compensated[i] && a * b < 0 && std::abs(a) > tolerance_mm && std::abs(b) > tolerance_mm)
      over += now.points[i].area_mm2;
  }
  return area > 0 ? over / area : 0;
}

/// Where the control stops at every corner, a split would be a stop: the feed falls to nothing there, and the mark that
/// this leaves is a new error, which the next round answers with new splits.
double spacing_mm(const machine::Machine& machine) {
  const bool stops = machine.control.corner.law == machine::CornerLaw::exact_stop;
  return stops ? std::numeric_limits<double>::infinity() : kSpacing_mm;
}

/// What is known to be refused is refused before the long work.
void check_given(const machine::Job& job, const SimulatedProgram& program, Diagnostics& diagnostics) {
  const Finishing early = find_finishing(job, program, {});
  if (early.operations.size() == 1 || job.compensation.operations.given())
    check_compensated(program, early.moves, diagnostics);
  check_travel(job, program.text, program.moves, diagnostics);
  simulate::check_program(job, program, diagnostics);
}

class Loop {
 public:
  Loop(const machine::Job& job, Diagnostics& diagnostics, const CompensateOptions& options)
      : job_(job),
        diagnostics_(diagnostics),
        options_(options),
        setup_(simulate::set_up(
            job, {.check = [&](const SimulatedProgram& program) { check_given(job, program, diagnostics); }},
            {.program = diagnostics, .original = diagnostics, .target = diagnostics})),
        program_(setup_.program),
        trials_(job, setup_) {
    simulate::check_clearance(job_, setup_, diagnostics_);
    diagnostics_.throw_if_errors();
  }

  CompensationResult run() {
    CompensationResult out;
    start(out);
    converge(out);
    lower_feeds(out);
    stay_out_of_part(out);
    choose(out);
    finish(out);
    check(out);
    return out;
  }

 private:
  double tolerance_mm() const { return job_.compensation.half_width_um() / 1000; }

  FitShiftOptions fit_options(std::span<const double> stiffness, std::span<const RowLink> links,
                              std::span<const double> link_stiffness) const {
    return {.smoothing_mm = smoothing_mm(job_.simulation.voxel_mm),
            .max_shift_mm = job_.compensation.max_shift_mm,
            .stiffness = stiffness,
            .links = links,
            .link_stiffness = link_stiffness};
  }
  /// Of the path with all its points, by which errors are judged.
  FitShiftOptions fit_options() const { return fit_options(stiffness_, links_, {}); }

  std::function<void(double)> progress(const std::string& what) const {
    return simulate::progress_of(options_.progress, what);
  }

  /// The program as given: its error, what of it is compensated, and the points of the path.
  void start(CompensationResult& out) {
    auto given = std::make_shared<Trial>();
    simulate::Prediction prediction = trials_.predict(program_, progress("as given"));
    out.doubts = simulate::doubts(job_, program_, prediction);
    if (simulate::beyond_model(prediction)) throw BeyondModel(fmt::format("{}", fmt::join(out.doubts, "; ")));
    out.own_target = setup_.own_target();
    out.unseen_mm2 = prediction.unseen_mm2;
    out.border_mm2 = prediction.border_mm2;
    out.not_judged_mm2 = prediction.not_judged_mm2;
    out.between = prediction.between;
    given->keep(std::move(prediction));
    out.finishing = find_finishing(job_, program_, given->surface);
    out.lines = line_roles(program_, out.finishing.moves);
    out.operations = simulate::as_lines(job_.operations, program_.text, program_.moves);
    check_compensated(program_, out.finishing.moves, diagnostics_);
    diagnostics_.throw_if_errors();
    if (job_.compensation.has(machine::Lever::feed)) check_feeds(program_, out.finishing.moves, diagnostics_);
    diagnostics_.throw_if_errors();
    nc::warn_of_uneditable(program_.text, program_.moves, out.finishing.moves, diagnostics_);
    compensated_ = out.finishing.moves;
    path_.emplace(program_.moves, compensated_, spacing_mm(job_.machine), job_.machine.control.block_time_s);
    sensitivity_.emplace(*path_);
    stiffness_.assign(path_->points().size(), 1.0);
    links_ = row_links(*path_, kRowReach_mm);
    splits_.emplace(*path_);
    given->shifts = path_->shifts();
    given->fractions = FeedLever::fractions(*path_);
    given->observed = trials_.observe(*path_, nullptr, given->surface);
    reach_ = reach_of(*path_, program_.moves, given->observed, given->surface, setup_.own_stamps());
    given->observed.reach = reach_;
    if (foreign_fraction(given->observed) > kForeign) {
      trials_.bending = nominal_bending(job_, setup_, progress("nominal chips"));
      scale_bending(*path_, job_, setup_, given->observed, given->surface, trials_.bending);
      given->observed = trials_.observe(*path_, nullptr, given->surface);
      given->observed.reach = reach_;
      expected_ = expected_errors(*path_, job_, setup_, given->observed, given->surface, trials_.bending);
    }
    last_ = best_ = allowed_ = given;
    first_observed_ = given->observed;
    out.reference = job_.compensation.reference;
    out.own_depth_limit = job_.compensation.depth_limit_um().has_value();
    depth_limit_um_ = job_.compensation.depth_limit_um().value_or(0);
    if (!out.own_depth_limit)
      depth_limit_um_ = default_depth_limit_um(*path_, given->observed, fit_options(), 1000 * tolerance_mm());
    out.depth_limit_um = depth_limit_um_;
    out.plain_before = figures_of(*given);
    out.feed_before = program_.feed;
    out.surface_before = last_->surface;
    out.loads_before = last_->loads;
    record(out, {});
    out.depth_before = depth_of(last_->surface, last_->observed, depth_limit_um_, true);
  }

  void converge(CompensationResult& out) {
    int without_gain = 0;
    while (!done(out, without_gain)) {
      step(out, share_, nullptr);
      const double best = out.rounds[out.best].error_um.rms, now = out.rounds.back().error_um.rms;
      without_gain = now < (1 - kMinGain) * best ? 0 : without_gain + 1;
      if (now < best) {
        take(out);
      } else if (now > kWorse * best) {
        last_ = best_;
        share_ *= kShorter;
      }
    }
  }

  bool met(const CompensationResult& out) const {
    return within_tolerance(figures_of(*best_), job_.compensation) &&
           out.rounds[out.best].deepest_um <= depth_limit_um_;
  }

  /// What no shift takes away: lower feeds, rung by rung of machine time, until the tolerance is kept; with a budget
  /// its least error.
  void lower_feeds(CompensationResult& out) {
    if (!job_.compensation.has(machine::Lever::feed)) return;
    const bool splittable = !std::isinf(spacing_mm(job_.machine));
    FeedLever lever(*path_, program_, splittable, job_.compensation.min_feed_percent / 100);
    out.time_points.push_back({0, out.best});
    const auto& budget = options_.time_budget_percent;
    const std::vector<double> rungs =
        budget ? std::vector<double>{*budget} : std::vector<double>(kRungs_percent.begin(), kRungs_percent.end());
    for (const double percent : rungs) {
      if (!budget && met(out)) return;
      allowed_s_ = (1 + percent / 100 + kTimeRoom) * program_.feed.time_s;
      last_ = best_;
      const std::size_t before = out.best;
      for (int i = 0; i < (budget ? kBudgetRounds : kRungRounds); ++i) {
        if (i % 2 == 0)
          step_with_feeds(out, lever, percent);
        else
          step(out, 1, nullptr);  // the shifts to these feeds
        if (out.rounds.back().machine_time_s <= allowed_s_ &&
            out.rounds.back().error_um.p95 < out.rounds[out.best].error_um.p95)
          take(out);
        if (!budget && met(out)) break;
      }
      if (out.best == before) return;  // the least feed, or nothing that a feed changes
      out.time_points.push_back({percent, out.best});
    }
  }

  void step_with_feeds(CompensationResult& out, FeedLever& lever, double percent) {
    const std::shared_ptr<const Trial> from = last_;
    const double wanted_mm = options_.time_budget_percent ? 0.0 : kWanted * tolerance_mm();
    const double budget_s = percent / 100 * program_.feed.time_s;
    double planned_s = 0;
    step(out, 1, nullptr, [&](std::vector<Observation>& observations) {
      const std::vector<Observation> all = from->observed.of_path();
      planned_s = lever.choose(*path_, all, left_by_shift_mm(*path_, all, fit_options()), budget_s, wanted_mm).extra_s;
      splits_->add_feed_changes(*path_);
      lever.apply_to(observations, *path_, from->fractions);
    });
    lever.learn(*path_, from->fractions, from->shifts, from->observed, last_->observed, planned_s,
                out.rounds.back().machine_time_s - program_.feed.time_s);
  }

  /// Where the best round's surface lies deeper than the limit, further rounds lift the path there.
  void stay_out_of_part(CompensationResult& out) {
    if (out.best == 0 || out.rounds[out.best].deepest_um <= depth_limit_um_) return;
    const double reach = std::max(kGuardReach_mm, kGuardSmoothings * fit_options().smoothing_mm);
    Guard guard(*path_, depth_limit_um_ / 1000, reach);
    last_ = best_;
    free_correctable_um_ = out.rounds[out.best].split.correctable_um;
    free_ = best_->emitted;
    free_round_ = out.best;
    double deepest_um = out.rounds[out.best].deepest_um;
    for (int i = 0; i < kGuardRounds && deepest_um > depth_limit_um_; ++i) {
      guard.learn(last_->observed, deepest_um / 1000);
      step(out, share_, &guard);
      deepest_um = out.rounds.back().deepest_um;
    }
  }

  /// What is written: the best round that keeps the limits; the given program where none is better than that.
  void choose(CompensationResult& out) {
    out.better = allowed_index_ > 0 || out.rounds.size() == 1;
    if (!out.better && options_.keep_anyway) return;
    out.best = allowed_index_;
    best_ = allowed_;
  }

  /// New shifts from the last trial's error, and their prediction.
  /// `prepare` may change the feeds of the path and the observations that the shifts are fitted to.
  void step(CompensationResult& out, double fraction, const Guard* guard,
            const std::function<void(std::vector<Observation>&)>& prepare = {}) {
    const std::shared_ptr<const Trial> from_trial = last_;
    const Observed& before = from_trial->observed;
    const bool by_expectation = !expected_.empty() && !guard;
    std::vector<Observation> observations = by_expectation ? expected_ : wanted_of(before, guard);
    expected_.clear();
    Round round;
    round.gain = sensitivity_->mean();
    round.step_fraction = fraction;
    round.guard = guard != nullptr;
    const std::vector<Vec3>& from = from_trial->shifts;
    auto made = std::make_shared<Trial>();
    Trial& next = *made;
    path_->set_shifts(from);
    FeedLever::set_fractions(*path_, from_trial->fractions);
    if (prepare) prepare(observations);
    choose_splits(observations);
    ThinPath thin(*path_, splits_->kept());
    const std::vector<Observation> asked = thin.places_of(observations);
    const std::vector<RowLink> links = row_links(thin.path(), kRowReach_mm);
    if (link_stiffness_.size() != links.size()) link_stiffness_.assign(links.size(), 1.0);
    for (int i = 0; i <= kStiffenings; ++i) {
      path_->set_shifts(from);
      thin.take_shifts(*path_);
      const std::vector<double> stiffness = thin.greatest_of(stiffness_);
      round.limited_points = fit_shift(thin.path(), asked, fit_options(stiffness, links, link_stiffness_));
      thin.give_shifts(*path_);
      for (std::size_t p = 0; p < from.size(); ++p) {
        Vec3& shift = path_->points()[p].shift_mm;
        shift = from[p] + fraction * (shift - from[p]);
      }
      next.emitted = trials_.emit(*path_, splits_->kept(), compensated_);
      thin.take_shifts(*path_);
      const RowTurn turn = row_turn(thin.path(), links, job_.compensation.max_angle_growth_rad);
      if (next.emitted->quality.over.empty() && turn.over.empty()) break;
      stiffen(next.emitted->quality.over);
      for (const std::size_t link : turn.over) link_stiffness_[link] *= kStiffer;
    }
    next.shifts = path_->shifts();
    next.fractions = FeedLever::fractions(*path_);
    round.largest_shift_mm = path_->largest_shift_mm();
    const std::size_t number = out.rounds.size();
    next.keep(trials_.predict(next.emitted->program, progress(fmt::format("round {}", number))));
    next.observed = trials_.observe(*path_, next.emitted.get(), next.surface);
    next.observed.reach = reach_;
    last_ = made;
    // What rows do that come out of the shadow of others says nothing of their gain.
    if (!by_expectation) sensitivity_->learn(*path_, from, before, last_->observed);
    round.overcorrected_fraction = overcorrected_fraction(before, last_->observed, tolerance_mm());
    record(out, round);
  }

  /// The errors that the next shifts are to take away.
  std::vector<Observation> wanted_of(const Observed& observed, const Guard* guard) {
    std::vector<Observation> out = without_row_form(*path_, observed.of_path(), fit_options());
    if (guard) guard->apply_to(out);
    sensitivity_->apply_to(out);
    return out;
  }

  /// Where the shifts that the path could take with all its points ask for it; a late one must be worth more.
  void choose_splits(const std::vector<Observation>& observations) {
    ShiftPath free = *path_;
    fit_shift(free, observations, fit_options());
    if (splits_->add_strays(free, split_once_ ? kLateSplit_mm : kSplit_mm) > 0) link_stiffness_.clear();
    split_once_ = true;
  }

  void stiffen(const std::vector<MoveMap::MovePlace>& places) {
    for (const auto& place : places) {
      if (!path_->contains(place.move)) continue;
      const std::size_t at = path_->find(place.move, place.fraction).lower;
      for (std::size_t i = at > 0 ? at - 1 : 0; i < std::min(at + 3, stiffness_.size()); ++i) stiffness_[i] *= kStiffer;
    }
  }

  PlainFigures figures_of(const Trial& trial) const {
    return plain_figures(trial.surface, trial.total_mm, trial.observed, job_.compensation);
  }

  void record(CompensationResult& out, Round round) {
    round.error_um = judged_of(figures_of(*last_), job_.compensation.reference);
    round.split = split_error(*path_, last_->observed, fit_options());
    if (round.guard) round.split.give_to_guard(free_correctable_um_);
    round.deepest_um = depth_of(last_->surface, last_->observed, depth_limit_um_, true).gouge_depth_p999_um;
    round.static_rounds = last_->static_rounds;
    round.unsettled = last_->unsettled;
    round.machine_time_s = (last_->emitted ? last_->emitted->program : program_).feed.time_s;
    round.slowed = count_feed_changes(*path_);
    out.rounds.push_back(round);
    figures_.push_back({round.error_um.rms, round.error_um.p95, round.deepest_um, round.machine_time_s > allowed_s_});
    const std::size_t allowed = choose_round(figures_, depth_limit_um_, job_.compensation.has(machine::Lever::feed));
    if (allowed != allowed_index_) allowed_ = last_;  // only the newest round can take the place of another
    allowed_index_ = allowed;
  }

  void take(CompensationResult& out) {
    out.best = out.rounds.size() - 1;
    best_ = last_;
  }

  bool done(CompensationResult& out, int without_gain) {
    const auto& c = job_.compensation;
    const double left_um = out.rounds[out.best].split.correctable_p95_um;
    const bool ready = out.best > 0 || within_tolerance(out.plain_before, c);
    ended_ = ready && left_um <= kLeftOver * c.half_width_um() ? Stop::stalled
             : without_gain >= kPatience                       ? Stop::stalled
                                                               : Stop::rounds;
    return ended_ == Stop::stalled || static_cast<int>(out.rounds.size()) > c.max_rounds;
  }

  Stop verdict(const CompensationResult& out) const {
    if (out.within_tolerance && out.within_part) return Stop::tolerance;
    // The guard is the reason only where it made the error larger.
    const bool guarded = out.rounds[out.best].guard && out.rounds[free_round_].error_um.rms < out.after_um.rms;
    return guarded ? Stop::depth_limit : ended_;
  }

  /// One per point of the emitted program's surface: the line that made it.
  std::vector<std::size_t> lines_of(const Trial& trial, const SimulatedProgram& program) const {
    std::vector<std::size_t> out;
    out.reserve(trial.surface.size());
    for (const auto& p : trial.surface) {
      const auto stamp = static_cast<std::size_t>(p.machined_stamp);
      const bool known = p.machined_stamp >= 0 && stamp < program.path.stamps.size();
      out.push_back(known ? program.moves.moves[program.path.stamps[stamp].move].block + 1 : 0);
    }
    return out;
  }

  void finish(CompensationResult& out) {
    path_->set_shifts(best_->shifts);
    FeedLever::set_fractions(*path_, best_->fractions);
    const Round &first = out.rounds[0], &best = out.rounds[out.best];
    const SimulatedProgram& program = best_->emitted ? best_->emitted->program : program_;
    out.before_um = first.error_um;
    out.after_um = best.error_um;
    out.split_before = first.split;
    out.split_after = best.split;
    out.surface_after = best_->surface;
    out.loads_after = best_->loads;
    out.feed_after = program.feed;
    out.max_shift_mm = best.largest_shift_mm;
    if (best_->emitted) {
      warn_of_not_emitted(program_.text, program_.moves, best_->emitted->emission.not_made, diagnostics_);
      out.quality = best_->emitted->quality;
    }
    out.surface_steps =
        surface_steps(*path_, row_links(*path_, kRowReach_mm, RowSense::any), first_observed_, best_->observed);
    out.row_steps = row_steps(*path_, kRowReach_mm);
    const ThinPath thin(*path_, splits_->kept());
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
      split_error(*path_, best_->observed, fit_options(), &points);
      out.causes = causes_of(best.split, points, best_->observed, lines_of(*best_, program));
    }
    if (options_.max_stock_crossings > 0)
      out.stock = removal::stock_shape(setup_.target.surface, options_.max_stock_crossings);
    check_travel(job_, program.text, program.moves, diagnostics_);
    diagnostics_.throw_if_errors();
    out.blocks_before = program_.text.source.line_count();
    out.blocks_after = program.text.source.line_count();
    out.blocks_changed = best_->emitted ? count_changed(program_.text, *best_->emitted) : 0;
    out.settled = first.unsettled == 0 && best.unsettled == 0;
    const double imbalance = simulate::imbalance(best_->chip_mm3, best_->stock_mm3, job_.simulation.voxel_mm);
    if (out.doubts.empty() && std::abs(imbalance) > simulate::kMaxImbalance)
      out.doubts.push_back("in the emitted program " + simulate::imbalance_sentence(best_->chip_mm3, best_->stock_mm3));
  }

  /// The other grid and the uncertainty; the text last, since its header may tell of them.
  void check(CompensationResult& out) {
    const Emitted* emitted = best_->emitted.get();
    const bool guarded = out.rounds[out.best].guard;
    for (const double voxel_mm : options_.recheck_voxels_mm)
      out.rechecks.push_back(recheck(job_, voxel_mm, setup_, {emitted, guarded ? free_.get() : nullptr}, *path_,
                                     fit_options(), options_.progress));
    std::vector<std::string> names;
    std::vector<std::vector<double>> changes;
    for (const ParameterGroup& group : options_.uncertainty) {
      names.push_back(group.name);
      changes.push_back(
          changes_mm(job_, group, setup_, emitted, out.surface_after, out.unknown_parameters, options_.progress));
    }
    if (!names.empty())
      out.band = band_of(out.surface_before, out.surface_after, names, changes, depth_limit_um_ / 1000);
    out.text = emitted ? emitted->emission.text : program_.text.source.text();
    if (emitted) out.block_of_line = emitted->emission.block_of_line;
    if (!options_.header || !emitted) return;
    trials_.header = options_.header(out);
    nc::Emission with_header = trials_.text_of(*path_, emitted->splits);
    out.text = std::move(with_header.text);
    out.block_of_line = std::move(with_header.block_of_line);
    const std::size_t more = SourceText("", out.text).line_count() - out.blocks_after;
    for (CauseFigure& cause : out.causes)
      for (std::size_t& line : cause.lines) line += more;
  }

  const machine::Job& job_;
  Diagnostics& diagnostics_;
  const CompensateOptions& options_;
  simulate::Setup setup_;
  const SimulatedProgram& program_;  ///< of the set-up: as given
  TrialRunner trials_;
  std::vector<bool> compensated_;
  std::optional<ShiftPath> path_;
  std::optional<Sensitivity> sensitivity_;
  std::vector<double> stiffness_;  ///< of the path, one per point
  std::vector<RowLink> links_;
  double share_ = 1;                   ///< of a step that is taken; less after over-corrections
  std::vector<Observation> expected_;  ///< for the first round; empty: as observed
  std::optional<Splits> splits_;
  bool split_once_ = false;
  std::vector<double> link_stiffness_;                  ///< one per link of the path that the splits leave
  std::shared_ptr<const Trial> last_, best_, allowed_;  ///< allowed_: the best one that keeps the limits
  std::size_t allowed_index_ = 0;
  std::vector<RoundFigures> figures_;  ///< one a round
  std::vector<bool> reach_;
  double depth_limit_um_ = 0;
  double allowed_s_ = std::numeric_limits<double>::infinity();  ///< machine time
  Stop ended_ = Stop::rounds;                                   ///< why the rounds ended
  Observed first_observed_;                                     ///< of the given program
  double free_correctable_um_ = 0;                              ///< of the best round before the guard
  std::size_t free_round_ = 0;                                  ///< that round
  std::shared_ptr<const Emitted> free_;                         ///< its program
};

}  // namespace

CompensationResult compensate(const machine::Job& job, Diagnostics& diagnostics, const CompensateOptions& options) {
  if (options.time_budget_percent && !job.compensation.has(machine::Lever::feed))
    diagnostics.add({Severity::error,
                     {job.path, 0, 0},
                     fmt::format("a time budget of {:g} % has no lever to use it; levers = [\"shift\", \"feed\"] was "
                                 "expected in [compensation]",
                                 *options.time_budget_percent),
                     "lever-missing",
                     {}});
  diagnostics.throw_if_errors();
  return Loop(job, diagnostics, options).run();
}

}  // namespace camber::compensate
