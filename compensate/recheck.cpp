#include "compensate/recheck.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "compensate/remaining_error.h"
#include "compensate/safety.h"

namespace camber::compensate {

Recheck recheck(double voxel_mm, const ShiftedProgram& of, const EmittedPair& emitted, const ShiftPath& path,
                const FitShiftOptions& options, const RecheckTarget& made_by, const simulate::Progress& progress) {
  const simulate::SimulatedProgram& given = *of.program;
  machine::Job other = of.job;
  other.simulation.voxel_mm = voxel_mm;
  Diagnostics diagnostics;
  simulate::Target target = simulate::make_target(other, made_by.program, diagnostics);
  for (simulate::PathFraction& stamp : target.stamps)
    if (!made_by.moves.empty()) stamp.move = made_by.moves[stamp.move];
  FitShiftOptions own = options;
  own.smoothing_mm = std::max(options.smoothing_mm, smoothing_mm(voxel_mm));
  struct Judged {
    simulate::Prediction prediction;
    Observed observed;
    ErrorSplit split;
    removal::ErrorFigures error_um;
  };
  const auto stamps = of.own_target ? std::span(target.stamps) : std::span<const simulate::PathFraction>();
  std::vector<bool> reach;
  const auto judge = [&](const Emitted* program, const std::string& what) {
    const auto& machined = program ? program->program : given;
    auto prediction = simulate::predict_surface(of.predictor, other, target, machined, progress,
                                                fmt::format("{}, voxels of {:g} mm", what, voxel_mm));
    Observed observed = observe(path, of.job, given, machined, program ? program->map : nc::MoveMap(),
                                prediction.surface, {stamps, {}, of.first_cuts});
    if (reach.empty()) reach = reach_of(path, given.moves_in_part(), observed, prediction.surface, stamps);
    observed.reach = reach;
    const ErrorSplit split = split_error(path, observed, own);
    const PlainFigures plain =
        plain_figures(prediction.surface, prediction.total_error_mm, observed, of.job.compensation);
    return Judged{std::move(prediction), std::move(observed), split, judged_of(plain, of.job.compensation.reference)};
  };
  Recheck out;
  out.voxel_mm = voxel_mm;
  const Judged before = judge(nullptr, "as given");
  out.before_um = before.error_um;
  out.split_before = before.split;
  std::optional<Judged> made;
  if (emitted.last) made.emplace(judge(emitted.last, "compensated"));
  const Judged& after = made ? *made : before;
  out.after_um = after.error_um;
  out.split_after = after.split;
  if (emitted.free) out.split_after.give_to_guard(judge(emitted.free, "without the guard").split.correctable_um);
  out.deepest_um = depth_of(after.prediction.surface, after.observed, 0, true).deepest_um;
  return out;
}

std::vector<double> changes_mm(const ParameterGroup& group, const ShiftedProgram& of, const Emitted* emitted,
                               const std::vector<removal::SurfacePoint>& after, std::vector<std::string>& unknown,
                               const simulate::Progress& progress) {
  machine::Job other = moved(of.job, group, unknown);
  if (emitted) other.operations = emitted->operations;
  Diagnostics repeated;
  const auto& text = (emitted ? emitted->program : *of.program).text().source;
  const auto program = motion::simulate_motion(text, other, {}, repeated);
  const auto prediction =
      simulate::predict_surface(of.predictor, other, *of.target, program, progress, "uncertainty: " + group.name);
  std::vector<double> out;
  out.reserve(after.size());
  for (std::size_t i = 0; i < after.size(); ++i) out.push_back(prediction.surface[i].error_mm - after[i].error_mm);
  return out;
}

}  // namespace camber::compensate
