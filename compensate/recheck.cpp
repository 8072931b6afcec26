#include "compensate/recheck.h"

#include <fmt/format.h>

#include "compensate/safety.h"

namespace camber::compensate {
namespace {

deflection::Prediction predict(const machine::Job& job, const deflection::Target& target,
                               const deflection::MachinedProgram& program, const std::string& what,
                               const Progress& progress) {
  deflection::PredictOptions options;
  options.contacts = false;
  if (progress) options.progress = [&](double share) { progress(what, share); };
  return deflection::predict(job, target, program, options);
}

}  // namespace

Recheck recheck(const machine::Job& job, double voxel_mm, const deflection::MachinedProgram& target_program,
                const deflection::MachinedProgram& given, const Emitted* emitted, const ShiftPath& path,
                const FitShiftOptions& options, bool own_target, const Progress& progress) {
  machine::Job other = job;
  other.simulation.voxel_mm = voxel_mm;
  Diagnostics diagnostics;
  const deflection::Target target = deflection::make_target(other, target_program, diagnostics);
  Recheck out;
  out.voxel_mm = voxel_mm;
  const auto before = predict(other, target, given, fmt::format("as given, voxels of {:g} mm", voxel_mm), progress);
  out.before_um = before.form_error_um;
  out.split_before = split_error(path, observe(path, job, given, given, {}, before.surface, own_target), options);
  const auto& program = emitted ? emitted->program : given;
  const MoveMap map = emitted ? emitted->map : MoveMap();
  const auto after = predict(other, target, program, fmt::format("compensated, voxels of {:g} mm", voxel_mm), progress);
  out.after_um = after.form_error_um;
  const Observed observed = observe(path, job, given, program, map, after.surface, own_target);
  out.split_after = split_error(path, observed, options);
  out.deepest_um = depth_of(after.surface, observed, job.compensation.overcut_um(), true).deepest_um;
  return out;
}

std::vector<double> changes_mm(const machine::Job& job, const ParameterGroup& group, const deflection::Target& target,
                               const deflection::MachinedProgram& given, const Emitted* emitted,
                               const std::vector<removal::SurfacePoint>& after, std::vector<std::string>& unknown,
                               const Progress& progress) {
  machine::Job other = moved(job, group, unknown);
  if (emitted) other.operations = emitted->operations;
  Diagnostics repeated;
  const auto& text = (emitted ? emitted->program : given).text.source;
  const auto program = deflection::machine_program(text, other, {}, repeated);
  const auto prediction = predict(other, target, program, "uncertainty: " + group.name, progress);
  std::vector<double> out;
  out.reserve(after.size());
  for (std::size_t i = 0; i < after.size(); ++i) out.push_back(prediction.surface[i].error_mm - after[i].error_mm);
  return out;
}

}  // namespace camber::compensate
