#include "simulate/traced.h"

#include <cassert>
#include <vector>

#include "simulate/contour.h"
#include "simulate/region.h"

namespace camber::simulate {
double difference_mm(const TracedRun& run, const Prediction& measured, std::size_t point) {
  return measured.surface[point].error_mm - run.predicted.surface[point].error_mm;
}

Prediction predict_traced(const machine::Job& job, Target& target, SimulatedProgram& program, TracedRun& run,
                          const PredictOptions& options) {
  const auto half = [&](double from) {
    return [&options, from](double share) {
      if (options.progress) options.progress(from + share / 2);
    };
  };
  exchange(program, run.model);
  run.predicted =
      predict(job, target, program, {.contacts = true, .turn_from = {}, .progress = half(0), .surface_read = {}});
  run.predicted.machined.reset();
  exchange(program, run.model);
  mark_contour(job, program.path, target);
  target.contour_parts.reset();  // of the feed model
  PredictOptions measured_options = options;
  measured_options.progress = half(0.5);
  Prediction measured = predict(job, target, program, measured_options);
  assert(measured.surface.size() == run.predicted.surface.size());
  std::vector<double> difference_um, area;
  for (std::size_t i = 0; i < measured.surface.size(); ++i) {
    if (!measured.surface[i].valid || !run.predicted.surface[i].valid) continue;
    difference_um.push_back(1000 * difference_mm(run, measured, i));
    area.push_back(measured.surface[i].area_mm2);
  }
  run.difference_um = removal::error_figures(difference_um, area);
  return measured;
}

}  // namespace camber::simulate
