#include "compensate/pass_before.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "compensate/passes.h"
#include "compensate/propose.h"
#include "compensate/second_cuts.h"
#include "motion/operations.h"

namespace camber::compensate {
namespace {

using simulate::SimulatedProgram;

constexpr double kSplit_mm = 0.005;   // a split of a line of the passes before must be worth this
constexpr double kFarthest_mm = 2;    // stock that is thicker is not what a pass before leaves
constexpr int kSteps = 40;            // from the part's surface to the stock's
constexpr double kWorthMoving = 0.8;  // passes that leave no more than what is wanted over this stay

/// Stamps of a program before its first move to compensate.
removal::StampPath stamps_before(const Version& version) {
  const auto& stamps = version.source.program->path.stamps;
  const auto first = std::ranges::find_if(stamps, [&](const removal::Stamp& s) { return version.compensated[s.move]; });
  const auto before = static_cast<std::size_t>(first - stamps.begin());
  return removal::stamps_where(version.source.program->path, [&](std::size_t k) { return k < before; });
}

/// Stock above a point of the part's surface.
struct Left {
  std::size_t point = 0;    ///< of the surface
  std::size_t stamp = 0;    ///< of the passes before that made the stock's surface there
  double thickness_mm = 0;  ///< along the normal
};

/// The thickness along the normal; not given: more than kFarthest_mm.
std::optional<double> thickness_mm(const removal::Stock::Probe& stock, const removal::SurfacePoint& p,
                                   double close_mm) {
  double out = 0;
  for (int i = 0; i < kSteps && out < kFarthest_mm; ++i) {
    const double inside_mm = -stock.distance_mm(p.place_mm + out * p.normal);
    if (inside_mm <= close_mm) return out + inside_mm;
    out += inside_mm;
  }
  return std::nullopt;
}

/// Returns the material that a rigid tool has left above the judged surface when the first compensated move cuts.
std::vector<Left> left_before(const Task& task, const removal::StampPath& path) {
  const Trial& given = *task.given.trial;
  removal::Stock stock(task.setup->target.blank);
  simulate::sweep_path(stock, task.job, path, 0);
  const removal::Stock::Probe probe(stock);
  const double voxel_mm = stock.voxel_mm();
  std::vector<Left> out;
  for (std::size_t i = 0; i < given.surface.size(); ++i) {
    const removal::SurfacePoint& p = given.surface[i];
    if (!p.valid || !given.observed.judged(i) || !given.observed.compensated[i]) continue;
    const auto thickness = thickness_mm(probe, p, voxel_mm / 50);
    if (!thickness) continue;
    const Vec3 at = p.place_mm + *thickness * p.normal;
    const removal::Index3 voxel{static_cast<int>(std::lround(at.x() / voxel_mm)),
                                static_cast<int>(std::lround(at.y() / voxel_mm)),
                                static_cast<int>(std::lround(at.z() / voxel_mm))};
    if (const std::int32_t stamp = stock.stamp(voxel); stamp >= 0)
      out.push_back({i, static_cast<std::size_t>(stamp), *thickness});
  }
  return out;
}

/// Milling moves that cut what is left and can be edited.
std::vector<bool> moves_of(const SimulatedProgram& program, const removal::StampPath& path,
                           std::span<const Left> left) {
  std::vector<bool> out(program.moves_in_part().moves.size(), false);
  for (const Left& l : left) {
    const std::uint32_t move = path.stamps[l.stamp].move;
    out[move] = program.selected[move] && program.moves_in_part().moves[move].editable;
  }
  return out;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

double median_thickness_mm(std::span<const Left> left) {
  std::vector<double> values;
  values.reserve(left.size());
  for (const Left& l : left) values.push_back(l.thickness_mm);
  return median(std::move(values));
}

/// The deepest that the cutter of the passes before may be bent into the part.
double deepest_bend_mm(const Trial& given, std::size_t stamps) {
  double out = 0;
  for (std::size_t k = 0; k < std::min(stamps, given.loads.size()); ++k)
    out = std::max(out, given.loads[k].deflection_max_mm);
  return out;
}

/// Depth limit of what moves that are not compensated cut.
double others_limit_um(const Task& task) {
  const Trial& given = *task.given.trial;
  const double limit_um = task.given.depth_limit_um;
  return std::max(limit_um, depth_of(given.surface, given.observed, limit_um, false).gouge_depth_p999_um);
}

/// The shifts of the passes before: each place of them takes off what it leaves beyond `wanted_mm`.
ShiftPath shifted(const Task& task, const Version& given, const std::vector<bool>& moves,
                  const removal::StampPath& before, std::span<const Left> left, double wanted_mm) {
  const SimulatedProgram& program = *given.source.program;
  ShiftPath path(program.moves_in_part(), moves, task.spacing_mm(), task.job.machine.control.block_time_s,
                 kinematics::turning_moves(program));
  std::vector<Observation> asked;
  double most_mm = 0;
  for (const Left& l : left) {
    const removal::Stamp& stamp = before.stamps[l.stamp];
    if (!path.contains(stamp.move)) continue;
    const removal::SurfacePoint& p = task.given.trial->surface[l.point];
    asked.push_back({.place = path.find(stamp.move, stamp.fraction),
                     .normal = p.normal,
                     .error_mm = l.thickness_mm - wanted_mm,
                     .area_mm2 = p.area_mm2});
    most_mm = std::max(most_mm, std::abs(asked.back().error_mm));
  }
  const std::vector<RowLink> links = row_links(path, kRowReach_mm);
  FitShiftOptions options = fit_options(task, {}, links, {});
  options.max_shift_mm = most_mm;
  options.bounded = false;
  fit_shift(path, asked, options);
  return path;
}

/// The last emitted move of each given one.
std::vector<std::uint32_t> moves_as_emitted(const nc::Interpretation& given, const nc::Interpretation& emitted,
                                            const nc::Emission& emission) {
  const nc::MoveMap map(given, emitted, emission.block_of_line);
  std::vector<std::uint32_t> out(given.moves.size(), 0);
  for (std::uint32_t m = 0; m < emitted.moves.size(); ++m) out[map.given(m, 1).move] = m;
  return out;
}

}  // namespace

bool has_passes_before(const Task& task, const Version& given) {
  const removal::StampPath before = stamps_before(given);
  if (before.stamps.empty()) return false;
  const std::vector<bool> found = moves_of(*given.source.program, before, left_before(task, before));
  return std::ranges::find(found, true) != found.end();
}

std::unique_ptr<Version> with_less_left(const Task& task, const Version& given) {
  const SimulatedProgram& program = *given.source.program;
  const removal::StampPath before = stamps_before(given);
  if (before.stamps.empty()) return nullptr;
  const std::vector<Left> left = left_before(task, before);
  if (left.empty()) return nullptr;
  const double own_mm = task.job.compensation.pass_allowance_mm, given_mm = median_thickness_mm(left);
  const double wanted_mm =
      own_mm > 0 ? own_mm
                 : pass_allowance_mm(deepest_bend_mm(*task.given.trial, before.stamps.size()), task.tolerance_mm());
  if (wanted_mm > kWorthMoving * given_mm) return nullptr;
  const ShiftPath path = shifted(task, given, moves_of(program, before, left), before, left, wanted_mm);
  Splits splits(path);
  splits.add_strays(path, kSplit_mm);
  const nc::Emission emission = text_of(given.source, path, splits.kept());
  machine::Job job = task.job;
  job.operations =
      moved_ranges(motion::as_lines(job.operations, program.text(), program.moves_in_part()), emission.block_of_line);
  Diagnostics ignored;  // the given program's
  SimulatedProgram made = motion::simulate_motion(SourceText(job.program, emission.text), job, {}, ignored);
  EarlierCuts cuts{
      .text = {emission.text, emission.block_of_line, std::vector<bool>(emission.block_of_line.size(), false)},
      .moves = moves_as_emitted(program.moves_in_part(), made.moves_in_part(), emission),
      .allowance_mm = wanted_mm};
  std::unique_ptr<Version> out = taken_over(task, given, job, std::move(made), std::move(cuts));
  const removal::StampPath now = stamps_before(*out);
  const std::vector<Left> left_now = left_before(task, now);
  if (left_now.empty()) return nullptr;
  out->repeated->pass_before = PassBefore{given_mm, median_thickness_mm(left_now)};
  return out;
}

bool cuts_into_part(const Task& task, const Trial& trial) {
  return depth_of(trial.surface, trial.observed, task.given.depth_limit_um, false).gouge_depth_p999_um >
         others_limit_um(task);
}

}  // namespace camber::compensate
