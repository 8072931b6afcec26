#include "plan/programs.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "base/folders.h"
#include "base/output_file.h"
#include "base/units.h"
#include "checks/collisions.h"
#include "checks/flute_reach.h"
#include "compensate/compensate_path.h"
#include "copymill/copy_milling.h"
#include "feedmodel/cycle_time.h"
#include "kinematics/control_options.h"
#include "kinematics/machine_program.h"
#include "machine/job_file.h"
#include "machine/number_key.h"
#include "nc/interpreter.h"
#include "nc/program_text.h"
#include "simulate/predict_path.h"

namespace camber::plan {
namespace {

struct CompensatedProgram {
  std::string text;  ///< the given one where compensation is of no use
  std::string note;  ///< form error before and after, or why it stays as it is
};

CompensatedProgram kept(const std::string& text, const std::string& why) { return {text, "not compensated: " + why}; }

/// `stock_vdb`: what stands before the operation. The part's mesh is the target. Throws Cancelled.
CompensatedProgram compensated(const machine::Job& job, const std::string& stock_vdb, const std::string& text) {
  const TemporaryFolder folder;
  machine::Job of = job;
  of.program = folder.path() + "/finish" + std::string(kinematics::dialect_of(job.machine.control.kind).file_extension);
  of.stock = {};
  of.stock.vdb = stock_vdb;
  write_file(of.program, text);
  try {
    Diagnostics ignored;  // of a program that is not the one that is written
    const compensate::CompensationResult done = compensate::compensate(of, ignored, {});
    const double before = done.figures.before_um.p95, after = done.figures.after_um.p95;
    if (!done.verdict.better)
      return kept(text, fmt::format("its form error, {:.1f} um (p95), does not become less", before));
    return {done.emitted.text,
            fmt::format("compensated: form error {:.1f} um (p95) without, {:.1f} um with it, both predicted", before,
                        after)};
  } catch (const BeyondModel& beyond) {
    return kept(text, beyond.what());
  } catch (const InputError& error) {
    return kept(text, error.diagnostics().front().message);
  }
}

machine::CopyMode mode_of(Pattern pattern) {
  switch (pattern) {
    case Pattern::scanning_line:
      return machine::CopyMode::scanning_line;
    case Pattern::contour_line:
      return machine::CopyMode::contour_line;
    case Pattern::drilling:
      break;
  }
  return machine::CopyMode::drilling;
}

/// Meshes have single precision: what lies beyond the micrometre is noise.
double to_micrometres(double mm) { return std::round(1000 * mm) / 1000 + 0.0; }
/// A floor stays where the mesh has it: a level a fraction of a micrometre below it would cut nothing.
double without_noise(double mm) {
  constexpr double kNoise_mm = 1e-9;
  return std::abs(mm - to_micrometres(mm)) < kNoise_mm ? to_micrometres(mm) : mm;
}
Vec2 rounded(const Vec2& p) { return {to_micrometres(p.x()), to_micrometres(p.y())}; }

/// Rows run along the longer side.
double row_angle_rad(const PlanOperation& o) {
  const Vec2 size = o.box_mm[1] - o.box_mm[0];
  return size.x() >= size.y() ? 0 : kPi / 2;
}

machine::CopyOperation copy_operation(const PlanOperation& o) {
  machine::CopyOperation out;
  out.tool = o.tool;
  out.mode = mode_of(o.pattern);
  out.spindle_rpm = o.conditions.spindle_rpm;
  out.feed_mm_per_s = mm_per_s_from_mm_per_min(o.conditions.feed_mm_per_min);
  out.axial_depth_mm = o.conditions.axial_mm;
  out.region.z_mm = {without_noise(o.from_mm), without_noise(o.to_mm)};
  if (o.pattern == Pattern::drilling) {
    out.holes_mm = {rounded(o.box_mm[0])};
    out.cycle = o.kind == OperationKind::centre ? machine::HoleCycle::centre
                : o.kind == OperationKind::ream ? machine::HoleCycle::ream
                                                : machine::HoleCycle::peck;
    return out;
  }
  out.radial_depth_mm = o.conditions.radial_mm;
  out.allowance_mm = o.allowance_mm;
  out.scallop_mm = o.pattern == Pattern::scanning_line ? o.scallop_mm : 0;
  out.region.box_mm = {rounded(o.box_mm[0]), rounded(o.box_mm[1])};
  if (o.pattern == Pattern::scanning_line) out.angle_rad = row_angle_rad(o);
  out.sense = machine::MillingSense::both;
  return out;
}

/// Rows run along the longer side of all boxes.
double row_angle_rad(const machine::CopyRegion& region) {
  Vec2 lo = region.boxes_mm.front()[0].head<2>(), hi = region.boxes_mm.front()[1].head<2>();
  for (const auto& b : region.boxes_mm) lo = lo.cwiseMin(b[0].head<2>()), hi = hi.cwiseMax(b[1].head<2>());
  return hi.x() - lo.x() >= hi.y() - lo.y() ? 0 : kPi / 2;
}

machine::CopyRegion::Box box_of(const machine::CopyRegion& region) {
  const auto& [lo, hi] = *region.box_mm;
  return {Vec3(lo.x(), lo.y(), (*region.z_mm)[0]), Vec3(hi.x(), hi.y(), (*region.z_mm)[1])};
}

/// One run: the region of `run` becomes that of both.
void join_to(machine::CopyOperation& run, const machine::CopyOperation& other) {
  machine::CopyRegion& region = run.region;
  if (region.boxes_mm.empty()) region.boxes_mm = {box_of(region)};
  region.box_mm.reset();
  region.boxes_mm.push_back(box_of(other.region));
  const auto& [low, high] = *other.region.z_mm;
  region.z_mm = {std::min((*region.z_mm)[0], low), std::max((*region.z_mm)[1], high)};
}

feedmodel::CycleTime cycle_time_of(const std::string& name, const std::string& text, const machine::Job& job) {
  Diagnostics ignored;
  const auto program =
      kinematics::open_program(SourceText(name, text), job.machine,
                               {.given = {.inch = job.inch}, .rotary = kinematics::RotaryWords::never}, ignored);
  return feedmodel::cycle_time(program.commanded(), job.machine);
}

/// Line of an error's place: the number of the operation.
std::size_t refused(const InputError& error) {
  for (const Diagnostic& d : error.diagnostics())
    if (d.check == "tool-too-large") return d.location.line;
  return 0;
}

/// Stock before each finishing operation, as files.
class SavedStocks {
 public:
  explicit SavedStocks(const PlannedDivision& plan) {
    for (const PlanOperation& o : plan.operations) finishes_.push_back(o.kind == OperationKind::finish);
  }
  bool has(std::size_t operation) const { return finishes_[operation]; }
  std::string path(std::size_t operation) const { return fmt::format("{}/stock-{}.vdb", folder_.path(), operation); }

 private:
  TemporaryFolder folder_;
  std::vector<bool> finishes_;
};

/// Operations whose tool has no place are taken out of `operations`; places of the others tell their number.
copymill::CopyResult copy_what_fits(const PlanInput& input, const machine::Job& job,
                                    std::vector<machine::CopyOperation>& operations,
                                    const std::optional<SavedStocks>& saved, Diagnostics& diagnostics) {
  while (true) {
    copymill::CopyOptions options{.loads = false, .coolant = input.coolant};
    if (saved)
      options.before = [&](std::size_t k, const removal::Stock& stock) {
        const std::size_t i = operations[k].place.location.line - 1;
        if (saved->has(i)) stock.save(saved->path(i));
      };
    try {
      return copymill::copy(job, operations, options, diagnostics);
    } catch (const InputError& error) {
      const std::size_t number = refused(error);
      if (number == 0) throw;
      const auto of = std::ranges::find(operations, number, [](const auto& o) { return o.place.location.line; });
      diagnostics.add(
          {Severity::warning,
           {input.path, 0, 0},
           fmt::format("operation {}: T{} has no place between the part's walls; it is left out", number, of->tool),
           "plan-no-place",
           {}});
      operations.erase(of);
    }
  }
}

/// Adds warnings about what the emitted text does besides cutting; a plan is a proposal, so that none is an error.
void add_warnings(const machine::Job& job, const std::string& name, const std::string& text,
                  const removal::Stock& blank, Diagnostics& diagnostics) {
  Diagnostics found;
  const simulate::SimulatedProgram emitted = motion::simulate_motion(SourceText(name, text), job, {}, found);
  checks::check_collisions(job, emitted, blank, found);
  checks::check_flute_reach(job, emitted, blank, found);
  for (Diagnostic d : found.all()) {
    d.severity = Severity::warning;
    diagnostics.add(std::move(d));
  }
}

}  // namespace

std::vector<machine::CopyOperation> copy_operations(const PlanInput& input, const PlannedDivision& plan) {
  std::vector<machine::CopyOperation> out;
  for (std::size_t i = 0; i < plan.operations.size(); ++i) {
    const PlanOperation& o = plan.operations[i];
    if (o.joined) {
      join_to(out.back(), copy_operation(o));
      continue;
    }
    out.push_back(copy_operation(o));
    out.back().place.location = {input.path, i + 1, 0};
  }
  for (machine::CopyOperation& o : out)
    if (!o.region.boxes_mm.empty() && o.mode == machine::CopyMode::scanning_line) o.angle_rad = row_angle_rad(o.region);
  return out;
}

machine::Job copy_job(const PlanInput& input, const std::string& part_stl, const std::string& blank_stl) {
  machine::Job job;
  job.path = input.path;
  job.machine_path = input.machine_path;
  job.machine = input.machine;
  for (const auto& [number, tool] : input.tools) job.tools.emplace(number, tool.tool);
  job.material = input.material;
  job.part.mesh = part_stl;
  job.simulation = input.simulation;
  if (blank_stl.empty())
    job.stock = input.blank;
  else
    job.stock.mesh = blank_stl;
  return job;
}

std::string copy_job_toml(const machine::Job& job, const std::vector<machine::CopyOperation>& operations) {
  std::string out = machine::to_toml(job);
  for (const machine::CopyOperation& o : operations) out += "\n" + machine::to_toml(o);
  return out;
}

PlanProgram make_program(const PlanInput& input, const machine::Job& job, const PlannedDivision& plan,
                         const std::string& name, Diagnostics& diagnostics) {
  std::vector<machine::CopyOperation> operations = copy_operations(input, plan);
  const std::size_t count = plan.operations.size();
  std::optional<SavedStocks> saved;
  if (input.compensate) saved.emplace(plan);
  const copymill::CopyResult copied = copy_what_fits(input, job, operations, saved, diagnostics);
  const nc::Dialect& dialect = kinematics::dialect_of(job.machine.control.kind);
  nc::WrittenProgram written = copied.program;
  PlanProgram out;
  out.each.resize(count), out.times_s.resize(count), out.notes.resize(count);
  for (std::size_t k = 0; k < operations.size(); ++k) {
    const std::size_t i = operations[k].place.location.line - 1;
    const nc::WrittenProgram one{written.head, {written.operations[k]}, written.end};
    out.each[i] = nc::text_of(dialect, one);
    if (saved && saved->has(i)) {
      CompensatedProgram done = compensated(job, saved->path(i), out.each[i]);
      written.operations[k] = nc::operation_of(dialect, one, done.text);
      out.each[i] = std::move(done.text);
      out.notes[i] = std::move(done.note);
    }
    out.times_s[i] = cycle_time_of(name, out.each[i], job).all.time.total_s();
  }
  out.whole = nc::text_of(dialect, written);
  add_warnings(job, name, out.whole, *copied.blank, diagnostics);
  out.figures = {.time_s = cycle_time_of(name, out.whole, job).all.time.total_s(),
                 .removed_mm3 = copied.removed_mm3,
                 .left_p95_um = copied.left.p95_um,
                 .left_max_um = copied.left.max_um,
                 .gouge_um = copied.left.gouge_um};
  return out;
}

}  // namespace camber::plan
