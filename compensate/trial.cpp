#include "compensate/trial.h"

#include <cassert>
#include <optional>
#include <utility>

namespace camber::compensate {

void Trial::keep(simulate::Prediction prediction) {
  surface = std::move(prediction.surface);
  loads = std::move(prediction.cut.loads);
  total_mm = std::move(prediction.total_error_mm);
  static_rounds = prediction.cut.rounds_max;
  unsettled = prediction.cut.unsettled;
  all_valid = prediction.validity.all();
  chip_mm3 = prediction.cut.chip_mm3;
  stock_mm3 = prediction.cut.stock_mm3;
}

std::vector<bool> turning_moves(const simulate::SimulatedProgram& program) {
  std::vector<bool> out;
  if (const kinematics::PartPath* path = program.part_path())
    for (std::uint32_t m = 0; m < program.moves_in_part().moves.size(); ++m) out.push_back(path->turn_rad(m) > 0);
  return out;
}

std::vector<nc::MoveEdit> edits_of_text(const simulate::SimulatedProgram& program, std::vector<nc::MoveEdit> edits) {
  const kinematics::PartPath* path = program.part_path();
  if (!path) return edits;
  for (nc::MoveEdit& edit : edits) {
    const auto turn_back = [&](std::optional<Vec3>& place) {
      if (place) place = path->text_mm(edit.move, *place);
    };
    assert(edit.via.empty() || path->turn_rad(edit.move) == 0);
    for (nc::ViaPoint& via : edit.via) {
      via.point_mm = path->text_mm(edit.move, via.point_mm).value_or(via.point_mm);
      turn_back(via.center_mm);
    }
    turn_back(edit.end_mm);
    turn_back(edit.center_mm);
  }
  return edits;
}

TrialRunner::TrialRunner(const machine::Job& job, const simulate::Setup& given)
    : job_(job), given_(given), decimals_(decimals_for(job.machine.control, given.program.text())) {}

std::shared_ptr<const Emitted> TrialRunner::emit(const ShiftPath& path, const std::vector<bool>& splits,
                                                 const std::vector<bool>& compensated) const {
  auto out = std::make_shared<Emitted>();
  out->splits = splits;
  out->emission = nc::emit_edits(given_.program.text(), given_.program.moves_in_program(),
                                 edits_of_text(given_.program, path.edits(splits, kViaTolerance_mm)), decimals_);
  Diagnostics repeated;  // the emitted program's warnings are the given one's
  machine::Job job = job_;
  out->operations = moved_ranges(job_.operations, out->emission.block_of_line);
  job.operations = out->operations;
  out->program = simulate::simulate_motion(SourceText(job_.program, out->emission.text), job, {}, repeated);
  out->map = MoveMap(given_.program.moves_in_part(), out->program.moves_in_part(), out->emission.block_of_line);
  out->quality = path_quality(given_.program.moves_in_part(), compensated, out->program.moves_in_part(), out->map,
                              job_.machine.control.block_time_s, job_.compensation.max_angle_growth_rad);
  return out;
}

nc::Emission TrialRunner::text_of(const ShiftPath& path, const std::vector<bool>& splits) const {
  nc::EmitOptions options = decimals_;
  options.header_comment = header;
  return nc::emit_edits(given_.program.text(), given_.program.moves_in_program(),
                        edits_of_text(given_.program, path.edits(splits, kViaTolerance_mm)), options);
}

simulate::Prediction TrialRunner::predict(const simulate::SimulatedProgram& program,
                                          const std::function<void(double)>& progress) const {
  simulate::PredictOptions options;
  options.progress = progress;
  return given_.predictor(job_, given_.target, program, options);
}

Observed TrialRunner::observe(const ShiftPath& path, const Emitted* emitted,
                              const std::vector<removal::SurfacePoint>& surface) const {
  const std::span<const simulate::PathFraction> own = given_.own_stamps();
  if (!emitted)
    return compensate::observe(path, job_, given_.program, given_.program, {}, surface, own, bending, first_cuts);
  return compensate::observe(path, job_, given_.program, emitted->program, emitted->map, surface, own, bending,
                             first_cuts);
}

}  // namespace camber::compensate
