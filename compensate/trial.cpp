#include "compensate/trial.h"

#include <optional>
#include <utility>

namespace camber::compensate {

void Trial::keep(simulate::Prediction prediction) {
  surface = std::move(prediction.surface);
  loads = std::move(prediction.cut.loads);
  chatter = std::move(prediction.chatter.passages);
  total_mm = std::move(prediction.total_error_mm);
  static_rounds = prediction.cut.rounds_max;
  unsettled = prediction.cut.unsettled;
  all_valid = prediction.validity.all();
  chip_mm3 = prediction.cut.chip_mm3;
  stock_mm3 = prediction.cut.milled_mm3();
  if (prediction.deflection_parts_um) part_yields = prediction.deflection_parts_um->survey;
}

ShiftedProgram given_program(const machine::Job& job, const std::shared_ptr<const simulate::Setup>& setup) {
  const auto own = setup->own_stamps();
  return {.job = job,
          .program = {setup, &setup->program},
          .target = &setup->target,
          .own_target = setup->own_target(),
          .predictor = setup->predictor,
          .stamps = {own.begin(), own.end()},
          .decimals = decimals_for(job.machine.control, setup->program.text())};
}

std::shared_ptr<const Emitted> emit(const ShiftedProgram& from, const ShiftPath& path, const std::vector<bool>& splits,
                                    const std::vector<bool>& compensated) {
  auto out = std::make_shared<Emitted>();
  out->splits = splits;
  out->emission = text_of(from, path, splits);
  Diagnostics repeated;  // the emitted program's warnings are the given one's
  machine::Job job = from.job;
  out->operations = moved_ranges(job.operations, out->emission.block_of_line);
  job.operations = out->operations;
  out->program = motion::simulate_motion(SourceText(job.program, out->emission.text), job, {}, repeated);
  out->map = nc::MoveMap(from.program->moves_in_part(), out->program.moves_in_part(), out->emission.block_of_line);
  out->quality = path_quality(from.program->moves_in_part(), compensated, out->program.moves_in_part(), out->map,
                              job.machine.control.block_time_s, job.compensation.max_angle_growth_rad);
  return out;
}

nc::Emission text_of(const ShiftedProgram& from, const ShiftPath& path, const std::vector<bool>& splits,
                     const std::string& header) {
  nc::EmitOptions options = from.decimals;
  options.header_comment = header;
  const simulate::SimulatedProgram& program = *from.program;
  return nc::emit_edits(program.text(), program.moves_in_program(),
                        kinematics::edits_of_text(program, path.edits(splits, kViaTolerance_mm)), options);
}

simulate::Prediction predict(const ShiftedProgram& from, const Emitted* emitted,
                             const std::function<void(double)>& progress) {
  simulate::PredictOptions options;
  options.progress = progress;
  options.part_yields = from.part_yields;
  options.leading = from.leading.get();
  return from.predictor(from.job, *from.target, emitted ? emitted->program : *from.program, options);
}

Observed observe(const ShiftedProgram& from, const ShiftPath& path, const Emitted* emitted,
                 const std::vector<removal::SurfacePoint>& surface) {
  return observe(path, from.job, *from.program, emitted ? emitted->program : *from.program,
                 emitted ? emitted->map : nc::MoveMap(), surface, {from.stamps, from.bending, from.first_cuts});
}

}  // namespace camber::compensate
