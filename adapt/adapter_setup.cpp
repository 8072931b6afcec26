// What is read and refused before the first cut.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>

#include "adapt/adapter.h"
#include "base/units.h"
#include "checks/collisions.h"
#include "checks/flute_reach.h"
#include "checks/region_start.h"
#include "motion/operations.h"
#include "plausibility/plausibility.h"

namespace camber::adapt {
namespace {

/// Refuses a job that cannot be adapted before the long work begins.
void check_given(const machine::Job& job, const simulate::SimulatedProgram& program, Diagnostics& diagnostics) {
  plausibility::check_program(job, program, diagnostics);
  if (job.adapt->limits.chatter_margin)
    kinematics::refuse_rotary_motion(program, "chatter_margin in [adapt] limits changes spindle speeds", diagnostics);
}

/// Length of the cells of each move: a fiftieth of the tool's diameter; the whole move where the control stops at the
/// end of every block, since a split would stop it.
std::vector<double> cell_lengths(const machine::Job& job, const simulate::SimulatedProgram& program) {
  constexpr double kOfDiameter = 0.02, kMin_mm = 0.1, kMax_mm = 0.5;
  std::vector<double> out;
  const std::vector<bool> turning = kinematics::turning_moves(program);
  const bool stops = job.machine.control.corner.law == machine::CornerLaw::exact_stop;
  for (const nc::Move& m : program.moves_in_part().moves) {
    const nc::ModalState& state = program.moves_in_part().state_of(m);
    const auto tool = job.tools.find(state.tool);
    const bool turns = !turning.empty() && turning[out.size()];  // its pieces would need their own angles
    if (stops || turns || state.path_control == nc::PathControl::exact_stop)
      out.push_back(std::numeric_limits<double>::infinity());
    else
      out.push_back(tool == job.tools.end() ? kMax_mm
                                            : std::clamp(kOfDiameter * tool->second.diameter_mm, kMin_mm, kMax_mm));
  }
  return out;
}

/// Thickest chip of the highest feed, or of the programmed ones.
double thickest_chip_mm(const machine::Job& job, const simulate::SimulatedProgram& program) {
  double out = 0;
  for (std::size_t m = 0; m < program.selected.size(); ++m) {
    if (!program.selected[m]) continue;
    const auto& state = program.moves_in_part().state_of(program.moves_in_part().moves[m]);
    const auto tool = job.tools.find(state.tool);
    if (tool == job.tools.end() || state.spindle_speed_rpm <= 0) continue;
    const double highest = job.adapt->highest_feed_mm_per_s;
    const double feed = highest > 0 ? highest : program.moves_in_part().moves[m].feed_mm_per_s;
    out = std::max(out, feed * 60 / (state.spindle_speed_rpm * tool->second.flutes));
  }
  return out;
}

}  // namespace

Adapter::Adapter(const machine::Job& job, Diagnostics& diagnostics, const AdaptOptions& options)
    : job_(job),
      settings_(*job_.adapt),
      diagnostics_(diagnostics),
      options_(options),
      limits_(limits_of(settings_.limits)) {
  for (const LoadLimit& l : limits_) by_surface_ = by_surface_ || l.load == Load::form_error;
  set_up();
  if (settings_.limits.chatter_margin) change_speeds();
  cells_.emplace(given(), job_.machine, cell_lengths(job_, given()));
  check_cells();
  for (const Cell& c : cells_->cells()) {
    const auto tool = job_.tools.find(given().moves_in_part().state_of(given().moves_in_part().moves[c.move]).tool);
    flutes_.push_back(tool == job_.tools.end() ? 1 : tool->second.flutes);
  }
}

void Adapter::set_up() {
  const auto check = [&](const simulate::SimulatedProgram& p) { check_given(job_, p, diagnostics_); };
  if (by_surface_ || !job_.part.program.empty() || job_.part.operations) {
    setup_.emplace(simulate::set_up(job_, {.program = {}, .check = check},
                                    {.program = diagnostics_, .original = diagnostics_, .target = diagnostics_}));
  } else {
    program_.emplace(motion::simulate_motion(SourceText::read(job_.program), job_, {}, diagnostics_));
    check(*program_);
    diagnostics_.throw_if_errors();
    blank_.emplace(simulate::make_blank(job_, *program_, diagnostics_, thickest_chip_mm(job_, *program_)));
  }
  checks::check_collisions(job_, given(), blank(), diagnostics_);
  checks::check_region_start(job_, given(), blank(), diagnostics_);
  checks::check_flute_reach(job_, given(), blank(), diagnostics_);
  diagnostics_.throw_if_errors();
}

/// Stable speeds come before feeds by load.
void Adapter::change_speeds() {
  const auto loads =
      simulate::predict_loads(job_, blank(), original(),
                              {.coupling = job_.simulation.coupling,
                               .progress = simulate::progress_of(options_.progress, "chatter as programmed")});
  speeds_ = find_speed_changes(job_, original(), loads.cut.loads);
  SpeedText changed = emit_speed_changes(job_, original(), speeds_);
  if (changed.text.empty()) return;
  job_.operations = motion::moved_ranges(
      motion::as_lines(job_.operations, original().text(), original().moves_in_part()), changed.block_of_line);
  Diagnostics repeated;  // those of the given program
  stable_.emplace(motion::simulate_motion(SourceText(job_.program, changed.text), job_, {}, repeated));
  stable_blocks_ = std::move(changed.block_of_line);
}

Diagnostic Adapter::at_line(Severity severity, std::size_t block, std::string message, std::string check) const {
  return given().text().source.diagnostic(severity, given().text().blocks[block].offset, std::move(message),
                                          std::move(check));
}

/// Says which feeds are not changed. Errors [nothing-to-adapt] where that is all of them.
void Adapter::check_cells() {
  if (!by_load()) return;
  bool any = false;
  std::map<Kept, std::set<std::size_t>> lines;
  for (const Cell& c : cells_->cells()) {
    any = any || c.kept == Kept::no;
    lines[c.kept].insert(given().moves_in_part().moves[c.move].block);
  }
  if (const auto& unknown = lines[Kept::unknown_load]; !unknown.empty())
    diagnostics_.add(at_line(Severity::warning, *unknown.begin(),
                             fmt::format("the load of {} blocks is not known, since they are not among the job's "
                                         "operations; the programmed feed stays, here first",
                                         unknown.size()),
                             "load-unknown"));
  if (const auto& fixed = lines[Kept::not_editable]; !fixed.empty())
    diagnostics_.add(at_line(Severity::warning, *fixed.begin(),
                             fmt::format("the feed of {} blocks cannot be changed in the text; the programmed feed "
                                         "stays, here first, where the move belongs to {}",
                                         fixed.size(), nc::to_string(cells_->not_editable().front().why)),
                             "not-emitted"));
  if (any) return;
  diagnostics_.add({Severity::error,
                    {given().text().source.name(), 0, 0},
                    "has no cutting move whose feed can be changed; a line or an arc of the job's operations was "
                    "expected",
                    "nothing-to-adapt",
                    {}});
  diagnostics_.throw_if_errors();
}

/// [limit-unreachable] where more than half of the cut exceeds a limit at the lowest feed.
void Adapter::check_limits() {
  for (const LoadLimit& limit : limits_) {
    if (limit.load == Load::chip_min) continue;
    std::vector<double> at_lowest;
    std::size_t over = 0;
    for (const PlacedLoad& p : loads_.points) {
      if (p.cell == FeedCells::kNone || (*cells_)[p.cell].kept != Kept::no) continue;
      const double value = p.load.at(limit.load, settings_.lowest_feed_mm_per_s);
      if (value <= 0) continue;
      at_lowest.push_back(value);
      over += value > limit.value ? 1 : 0;
    }
    if (2 * over <= at_lowest.size()) continue;
    const auto middle = at_lowest.begin() + static_cast<std::ptrdiff_t>(at_lowest.size() / 2);
    std::ranges::nth_element(at_lowest, middle);
    const LoadText& text = text_of(limit.load);
    Diagnostic d = settings_.limits_place;
    d.severity = Severity::error;
    d.message = fmt::format(
        "{} = {:g} is exceeded at the lowest feed, {:g} mm/min, in {:.0f} % of the cut; the median there is {:.{}f} "
        "{}: a higher limit, a lower feed or a smaller cut was expected",
        text.key, text.scale * limit.value, mm_per_min_from_mm_per_s(settings_.lowest_feed_mm_per_s),
        100.0 * static_cast<double>(over) / static_cast<double>(at_lowest.size()), text.scale * *middle, text.decimals,
        text.unit);
    d.check = "limit-unreachable";
    diagnostics_.add(std::move(d));
  }
  diagnostics_.throw_if_errors();
}

}  // namespace camber::adapt
