#include "compensate/measure.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "compensate/hidden_rows.h"
#include "compensate/judge.h"
#include "compensate/pass_before.h"
#include "compensate/passes.h"
#include "compensate/propose.h"
#include "motion/operations.h"
#include "nc/emit.h"
#include "plausibility/plausibility.h"
#include "removal/engagement.h"
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
  plausibility::check_program(job, program, diagnostics);
}

std::function<void(double)> progress(const Task& task, const std::string& what) {
  return simulate::progress_of(task.options.progress, what);
}

void check_levers(Task& task, const std::vector<bool>& selected) {
  const SimulatedProgram& program = task.setup->program;
  Diagnostics& diagnostics = task.diagnostics;
  check_compensated(program, selected, diagnostics);
  diagnostics.throw_if_errors();
  if (task.job.compensation.levers.empty()) {
    Diagnostics unusable;
    check_feeds(program, selected, unusable);
    task.feed_unusable = !unusable.all().empty();
  } else if (task.has(machine::Lever::feed)) {
    check_feeds(program, selected, diagnostics);
  }
  if (task.has(machine::Lever::passes)) {
    kinematics::refuse_rotary_motion(program, "levers names \"passes\", which cuts a run twice", diagnostics);
    check_passes(program, selected, diagnostics);
  }
  diagnostics.throw_if_errors();
}

void check_passes_before(const Task& task, const Version& given) {
  if (!task.has(machine::Lever::allowance) || has_passes_before(task, given)) return;
  task.diagnostics.add({Severity::error,
                        {task.job.path, 0, 0},
                        "levers names \"allowance\", but no pass before those to compensate cuts what they cut, or its "
                        "moves cannot be shifted; levers without \"allowance\" were expected",
                        "lever-unusable",
                        {}});
  task.diagnostics.throw_if_errors();
}

/// Returns, for each point of the surface, the error that the best shift of its place alone would leave.
std::vector<double> bounds_of_bow(const Task& task, const Version& version, const Trial& given) {
  std::vector<std::size_t> index;
  std::vector<Observation> judged;
  for (std::size_t i = 0; i < given.observed.points.size(); ++i) {
    if (!given.observed.judged(i) || !given.observed.compensated[i]) continue;
    index.push_back(i);
    judged.push_back(given.observed.points[i]);
  }
  FitShiftOptions free = fit_options(task, version);
  free.bounded = false;
  free.max_shift_mm = std::numeric_limits<double>::infinity();
  free.smoothing_mm = kOnePlace_mm;
  const std::vector<double> left_mm = left_by_shift_mm(version.path, judged, free);
  std::vector<double> out(given.observed.points.size(), 0.0);
  for (std::size_t k = 0; k < index.size(); ++k) out[index[k]] = std::abs(left_mm[k]);
  return out;
}

/// Observation::bound_mm: no place may become worse than given. Where that would raise the 95th percentile by more than
/// a quarter, as where the cutter's bow leaves both signs at every place of the path, a place may reach what no shift
/// of its own could remove. Where the part yields, that is so wherever the 95th percentile falls by it: at the top of
/// each level the part does not give way, and so nothing is wrong there. Sets the bounds of `given`, too.
std::vector<double> choose_bounds(const Task& task, Version& version, Trial& given) {
  const std::size_t count = given.observed.points.size();
  const auto p95_within = [&](const std::vector<double>& bound_mm) {
    given.observed.set_bounds(bound_mm);
    const JudgedErrors left = errors_after_shift(task, version, given, 1);
    return p95_of(left.error_um, left.area_mm2);
  };
  const double free_um = p95_within(std::vector<double>(count, std::numeric_limits<double>::infinity()));
  std::vector<double> bound_mm;
  for (const Observation& o : given.observed.points)
    bound_mm.push_back(std::max(not_worse_mm(o.error_mm, task.tolerance_mm()) - kBoundRoom_mm, kBoundRoom_mm));
  const double cost = task.job.workpiece ? 0 : kBoundCost;
  if (p95_within(bound_mm) <= std::max((1 + cost) * free_um, 1000 * task.tolerance_mm())) return bound_mm;
  const std::vector<double> bow = bounds_of_bow(task, version, given);
  for (std::size_t i = 0; i < count; ++i) bound_mm[i] = std::max(bound_mm[i], bow[i]);
  given.observed.set_bounds(bound_mm);
  return bound_mm;
}

/// The prediction of the given program; throws where it lies beyond the model.
void read_given(const Task& task, const simulate::Prediction& prediction, CompensationResult& out) {
  out.verdict.doubts = simulate::doubts(task.job, task.setup->program, prediction);
  if (simulate::beyond_model(prediction)) throw BeyondModel(fmt::format("{}", fmt::join(out.verdict.doubts, "; ")));
  out.given = task.setup->program;
  out.scope.own_target = task.setup->own_target();
  out.scope.reference = task.job.compensation.reference;
  out.figures.unseen_mm2 = prediction.unseen_mm2;
  out.figures.border_mm2 = prediction.border_mm2;
  out.figures.not_judged_mm2 = prediction.not_judged_mm2;
  out.figures.between = prediction.between;
}

/// Selects what is compensated, and checks that the job's levers can be used for it.
void select_moves(Task& task, const Trial& given, CompensationResult& out) {
  const SimulatedProgram& program = task.setup->program;
  out.scope.finishing = find_finishing(task.job, program, given.surface);
  const std::vector<bool>& moves = out.scope.finishing.moves;
  out.scope.lines = line_roles(program, moves);
  out.scope.operations = motion::as_lines(task.job.operations, program.text(), program.moves_in_part());
  check_levers(task, moves);
  out.scope.feed_unusable = task.feed_unusable;
  nc::warn_of_uneditable(program.text(), program.moves_in_part(), moves, task.diagnostics);
}

std::vector<Observation> expect_hidden_rows(const Task& task, Version& version, Trial& given) {
  const simulate::Setup& setup = *task.setup;
  std::vector<Vec3>& bending = version.source.bending;
  bending = nominal_bending(task.job, setup, progress(task, "nominal chips"));
  scale_bending(version.path, task.job, setup, given.observed, given.surface, bending);
  const std::vector<bool> reach = given.observed.reach;
  given.observed = observe(version.source, version.path, nullptr, given.surface);
  given.observed.reach = reach;
  return expected_errors(version.path, task.job, setup, given.observed, given.surface, bending);
}

/// Attributes the surface of the given program to its path. Returns what the first round goes by; empty: as observed.
std::vector<Observation> observe_given(const Task& task, Version& version, Trial& given) {
  given.shifts = version.path.shifts();
  given.fractions = FeedLever::fractions(version.path);
  given.observed = observe(version.source, version.path, nullptr, given.surface);
  given.observed.reach = reach_of(version.path, task.setup->program.moves_in_part(), given.observed, given.surface,
                                  task.setup->own_stamps());
  // Rows cut each other's surface where a part has sprung back, and what is seen of them is right.
  if (!task.job.workpiece && foreign_fraction(given.observed) > kForeign)
    return expect_hidden_rows(task, version, given);
  return {};
}

double depth_limit_um(const Task& task, const Version& version, const Trial& given) {
  if (const auto own = task.job.compensation.depth_limit_um()) return *own;
  return std::min(
      deepest_limit_um(task.setup->target.blank),
      default_depth_limit_um(version.path, given.observed, fit_options(task, version), 1000 * task.tolerance_mm()));
}

/// Enters in `out` the error that shifts are expected to leave, before the first of them is predicted.
void look_out(const Task& task, State& state, CompensationResult& out) {
  const JudgedErrors left = errors_after_shift(task, *state.active, *task.given.trial, 1);
  const double given_um = state.rounds.front().error_um.p95;  // the squares fall, not always the percentile
  out.figures.outlook = {given_um, std::min(given_um, p95_of(left.error_um, left.area_mm2))};
  if (task.options.outlook) task.options.outlook(out.figures.outlook);
}

}  // namespace

double Task::spacing_mm() const {
  const bool stops = job.machine.control.corner.law == machine::CornerLaw::exact_stop;
  return stops ? std::numeric_limits<double>::infinity() : kSpacing_mm;
}

Version::Version(ShiftedProgram shifted, std::vector<bool> moves_to_compensate, double spacing_mm)
    : source(std::move(shifted)),
      compensated(std::move(moves_to_compensate)),
      path(source.program->moves_in_part(), compensated, spacing_mm, source.job.machine.control.block_time_s,
           kinematics::turning_moves(*source.program)),
      sensitivity(path),
      stiffness(path.points().size(), 1.0),
      links(row_links(path, kRowReach_mm)),
      splits(path) {}

Task open_task(const machine::Job& job, const CompensateOptions& options, Diagnostics& diagnostics) {
  simulate::SetupOptions how{.clearance = true, .predictor = options.predictor};
  how.check = [&](const SimulatedProgram& program) { check_given(job, program, diagnostics); };
  Task out{.job = job,
           .options = options,
           .diagnostics = diagnostics,
           .setup = std::make_shared<const simulate::Setup>(
               simulate::set_up(job, how, {.program = diagnostics, .original = diagnostics, .target = diagnostics}))};
  simulate::check_clearance(job, *out.setup, diagnostics);
  diagnostics.throw_if_errors();
  return out;
}

State measure_given(Task& task, CompensationResult& out) {
  State state;
  auto given = std::make_shared<Trial>();
  ShiftedProgram source = given_program(task.job, task.setup);
  source.leading = std::make_shared<simulate::LeadingRuns>();
  if (task.setup->own_target())
    source.leading->runs =
        runs_before(*source.program, expected_finishing(task.job, *source.program, task.setup->target).moves);
  simulate::Prediction prediction = predict(source, nullptr, progress(task, "as given"));
  read_given(task, prediction, out);
  given->keep(std::move(prediction));
  select_moves(task, *given, out);
  source.leading->runs = runs_before(*source.program, out.scope.finishing.moves);
  state.versions.push_back(std::make_unique<Version>(std::move(source), out.scope.finishing.moves, task.spacing_mm()));
  state.activate(0);
  Version& version = *state.active;
  state.expected = observe_given(task, version, *given);
  task.given.reach = given->observed.reach;
  task.given.bound_mm = choose_bounds(task, version, *given);
  task.given.trial = given;
  state.last = given;
  state.best = state.allowed = {given, 0};
  task.given.depth_limit_um = depth_limit_um(task, version, *given);
  task.given.plain = figures_of(task, *given);
  task.given.time_s = task.setup->program.feed.time_s;
  check_passes_before(task, version);
  record(task, state, {});
  look_out(task, state, out);
  out.figures.plain_before = task.given.plain;
  out.figures.feed_before = task.setup->program.feed;
  out.surfaces.before = given->surface;
  out.surfaces.loads_before = given->loads;
  out.surfaces.chatter_before = given->chatter;
  out.safety.own_depth_limit = task.job.compensation.depth_limit_um().has_value();
  out.safety.depth_limit_um = task.given.depth_limit_um;
  out.safety.before = depth_of(given->surface, given->observed, task.given.depth_limit_um, true);
  return state;
}

void measure(const Task& task, const Version& version, Trial& trial, const std::string& what) {
  trial.version = version.index;
  trial.shifts = version.path.shifts();
  trial.fractions = FeedLever::fractions(version.path);
  trial.keep(predict(version.source, trial.emitted.get(), progress(task, what)));
  trial.observed = observe(version.source, version.path, trial.emitted.get(), trial.surface);
  trial.observed.reach = task.given.reach;
  trial.observed.set_bounds(task.given.bound_mm);
}

}  // namespace camber::compensate
