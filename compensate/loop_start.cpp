// The program as given: its error, what of it is compensated, and the points of the path.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "checks/plausibility.h"
#include "compensate/expected.h"
#include "compensate/loop.h"
#include "nc/emit.h"
#include "removal/engagement.h"
#include "simulate/operations.h"
#include "simulate/verdict.h"

namespace camber::compensate {

using simulate::SimulatedProgram;

namespace {

constexpr double kSpacing_mm = 0.4;       // between points of a long line
constexpr double kBoundCost = 0.25;       // of the 95th percentile, for making no place worse than given
constexpr double kBoundRoom_mm = 0.0002;  // by which a fit stays within what is no worse than given
constexpr double kOnePlace_mm = 0.02;     // smoothing of a shift that may do almost anything
constexpr double kForeign = 0.2;          // of the area, cut by another row than it should be: expected_errors are used

/// Largest default depth limit: what the model can deflect, or the thickness of the stock.
double deepest_limit_um(const removal::Stock& blank) {
  const Vec3 size = blank.max_mm() - blank.min_mm();
  return 1000 * std::min(removal::DeflectedEngager::kMaxDeflection_mm, size.minCoeff());
}

/// Checks that the first of two cuts finds material where the blank has an allowance.
void check_allowance(const machine::Job& job, Diagnostics& diagnostics) {
  const double asked_mm = job.compensation.pass_allowance_mm, blank_mm = job.stock.allowance_mm;
  if (blank_mm <= 0 || asked_mm < blank_mm) return;
  diagnostics.add(
      {Severity::error,
       {job.path, 0, 0},
       fmt::format("pass_allowance_mm is {:g}, but the stock has an allowance of {:g} mm, so that the first "
                   "of two cuts would cut nothing; less than that was expected",
                   asked_mm, blank_mm),
       "lever-unusable",
       {}});
}

/// Refuses what is known to be wrong before the long work begins.
void check_given(const machine::Job& job, const SimulatedProgram& program, Diagnostics& diagnostics) {
  const Finishing early = find_finishing(job, program, {});
  if (early.operations.size() == 1 || job.compensation.operations.given())
    check_compensated(program, early.moves, diagnostics);
  if (job.compensation.has(machine::Lever::passes)) check_allowance(job, diagnostics);
  checks::check_program(job, program, diagnostics);
}

}  // namespace

Loop::Loop(const machine::Job& job, Diagnostics& diagnostics, const CompensateOptions& options)
    : job_(job),
      diagnostics_(diagnostics),
      options_(options),
      setup_(
          simulate::set_up(job,
                           {.check = [&](const SimulatedProgram& program) { check_given(job, program, diagnostics); },
                            .clearance = true},
                           {.program = diagnostics, .original = diagnostics, .target = diagnostics})),
      trials_(job_, setup_) {
  simulate::check_clearance(job_, setup_, diagnostics_);
  diagnostics_.throw_if_errors();
  versions_.push_back(std::make_unique<Version>());
  now_ = versions_.front().get();
}

double Loop::spacing_mm() const {
  const bool stops = job_.machine.control.corner.law == machine::CornerLaw::exact_stop;
  return stops ? std::numeric_limits<double>::infinity() : kSpacing_mm;
}

void Loop::start(CompensationResult& out) {
  auto given = std::make_shared<Trial>();
  simulate::Prediction prediction = trials_.predict(setup_.program, progress("as given"));
  read_given(prediction, out);
  given->keep(std::move(prediction));
  out.scope.finishing = find_finishing(job_, setup_.program, given->surface);
  out.scope.lines = line_roles(setup_.program, out.scope.finishing.moves);
  out.scope.operations = simulate::as_lines(job_.operations, setup_.program.text, setup_.program.moves);
  check_levers(out.scope.finishing.moves);
  nc::warn_of_uneditable(setup_.program.text, setup_.program.moves, out.scope.finishing.moves, diagnostics_);
  now_->compensated = out.scope.finishing.moves;
  begin_version(*now_);
  given->shifts = now_->path->shifts();
  given->fractions = FeedLever::fractions(*now_->path);
  given->observed = trials_.observe(*now_->path, nullptr, given->surface);
  reach_ = reach_of(*now_->path, setup_.program.moves, given->observed, given->surface, setup_.own_stamps());
  given->observed.reach = reach_;
  if (foreign_fraction(given->observed) > kForeign) expect_hidden_rows(*given);
  first_observed_ = given->observed;
  choose_bounds(*given);
  last_ = best_ = allowed_ = given_trial_ = given;
  out.scope.reference = job_.compensation.reference;
  out.safety.own_depth_limit = job_.compensation.depth_limit_um().has_value();
  depth_limit_um_ = job_.compensation.depth_limit_um().value_or(0);
  if (!out.safety.own_depth_limit)
    depth_limit_um_ =
        std::min(deepest_limit_um(setup_.target.blank),
                 default_depth_limit_um(*now_->path, given->observed, fit_options(), 1000 * tolerance_mm()));
  out.safety.depth_limit_um = depth_limit_um_;
  out.figures.plain_before = figures_of(*given);
  out.figures.feed_before = setup_.program.feed;
  given_s_ = out.figures.feed_before.time_s;
  out.surfaces.before = last_->surface;
  out.surfaces.loads_before = last_->loads;
  record(out, {});
  out.scope.feed_unusable = feed_unusable_;
  look_out(out);
  out.safety.before = depth_of(last_->surface, last_->observed, depth_limit_um_, true);
}

/// What shifts are expected to leave, before the first of them is predicted.
void Loop::look_out(CompensationResult& out) {
  const JudgedErrors left = errors_after_shift(*given_trial_, 1);
  out.figures.outlook = {out.rounds.front().error_um.p95, p95_of(left.error_um, left.area_mm2)};
  if (options_.outlook) options_.outlook(out.figures.outlook);
}

/// No place may become worse than given. Where that would raise the 95th percentile by more than a quarter, as where
/// the cutter's bow leaves both signs at every place of the path, a place may reach what no shift of its own could
/// remove.
void Loop::choose_bounds(Trial& given) {
  const std::size_t count = given.observed.points.size();
  const auto p95_within = [&](std::vector<double> bound_mm) {
    bound_mm_ = std::move(bound_mm);
    given.observed.set_bounds(bound_mm_);
    const JudgedErrors left = errors_after_shift(given, 1);
    return p95_of(left.error_um, left.area_mm2);
  };
  const double free_um = p95_within(std::vector<double>(count, std::numeric_limits<double>::infinity()));
  std::vector<double> strict;
  for (const Observation& o : given.observed.points)
    strict.push_back(std::max(not_worse_mm(o.error_mm, tolerance_mm()) - kBoundRoom_mm, kBoundRoom_mm));
  if (p95_within(strict) <= std::max((1 + kBoundCost) * free_um, 1000 * tolerance_mm())) return;
  const std::vector<double> bow = bounds_of_bow(given);
  for (std::size_t i = 0; i < count; ++i) bound_mm_[i] = std::max(strict[i], bow[i]);
  given.observed.set_bounds(bound_mm_);
}

/// What the best shift of each place by itself leaves, one per point of the surface.
std::vector<double> Loop::bounds_of_bow(const Trial& given) {
  std::vector<std::size_t> index;
  std::vector<Observation> judged;
  for (std::size_t i = 0; i < given.observed.points.size(); ++i) {
    if (!given.observed.judged(i) || !given.observed.compensated[i]) continue;
    index.push_back(i);
    judged.push_back(given.observed.points[i]);
  }
  FitShiftOptions free = fit_options();
  free.bounded = false;
  free.max_shift_mm = std::numeric_limits<double>::infinity();
  free.smoothing_mm = kOnePlace_mm;
  const std::vector<double> left_mm = left_by_shift_mm(*now_->path, judged, free);
  std::vector<double> out(given.observed.points.size(), 0.0);
  for (std::size_t k = 0; k < index.size(); ++k) out[index[k]] = std::abs(left_mm[k]);
  return out;
}

void Loop::read_given(const simulate::Prediction& prediction, CompensationResult& out) {
  out.verdict.doubts = simulate::doubts(job_, setup_.program, prediction);
  if (simulate::beyond_model(prediction)) throw BeyondModel(fmt::format("{}", fmt::join(out.verdict.doubts, "; ")));
  out.scope.own_target = setup_.own_target();
  out.figures.unseen_mm2 = prediction.unseen_mm2;
  out.figures.border_mm2 = prediction.border_mm2;
  out.figures.not_judged_mm2 = prediction.not_judged_mm2;
  out.figures.between = prediction.between;
}

void Loop::check_levers(const std::vector<bool>& selected) {
  check_compensated(setup_.program, selected, diagnostics_);
  diagnostics_.throw_if_errors();
  if (job_.compensation.levers.empty()) {
    Diagnostics unusable;
    check_feeds(setup_.program, selected, unusable);
    feed_unusable_ = !unusable.all().empty();
  } else if (has(machine::Lever::feed)) {
    check_feeds(setup_.program, selected, diagnostics_);
  }
  if (has(machine::Lever::passes)) {
    simulate::refuse_rotary_motion(setup_.program.rotary.get(), setup_.program.text,
                                   "levers names \"passes\", which cuts a run twice", diagnostics_);
    check_passes(setup_.program, selected, diagnostics_);
  }
  diagnostics_.throw_if_errors();
}

/// `version` is the active one.
void Loop::begin_version(Version& version) {
  version.path.emplace(setup_.program.moves, version.compensated, spacing_mm(), job_.machine.control.block_time_s,
                       turning_moves(setup_.program));
  version.sensitivity.emplace(*version.path);
  version.stiffness.assign(version.path->points().size(), 1.0);
  version.links = row_links(*version.path, kRowReach_mm);
  version.splits.emplace(*version.path);
}

void Loop::expect_hidden_rows(Trial& given) {
  trials_.bending = nominal_bending(job_, setup_, progress("nominal chips"));
  scale_bending(*now_->path, job_, setup_, given.observed, given.surface, trials_.bending);
  given.observed = trials_.observe(*now_->path, nullptr, given.surface);
  given.observed.reach = reach_;
  expected_ = expected_errors(*now_->path, job_, setup_, given.observed, given.surface, trials_.bending);
}

}  // namespace camber::compensate
