#pragma once
// Corrects the model by points measured on a part: fits one scale of the deflection.
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/geometry.h"
#include "machine/job_file.h"
#include "simulate/setup.h"

namespace camber::compensate {

struct MeasuredPoint {
  Vec3 place_mm = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();
  double error_mm = 0;  ///< along the normal, positive: excess material
};

/// A table with a header; columns x_mm y_mm z_mm nx ny nz error_um (or x y z nx ny nz error, error in um), in any order
/// among others, separated by commas, semicolons, tabs or blanks: form_error.csv is one. Normals are made unit.
/// Throws InputError: [measured-column], [measured-number], [measured-normal], [measured-empty], with the place.
std::vector<MeasuredPoint> read_measured(const std::string& path);

struct MeasuredFit {
  double scale = 1;                            ///< scale of the deflection: larger forces or a more compliant tool
  double std_error = 0;                        ///< standard error from the points' scatter about the fit
  std::size_t points = 0, left_out = 0;        ///< left out: no machined surface of the job there
  double rms_before_um = 0, rms_after_um = 0;  ///< measured less predicted, with the scale 1 and the fitted one
  int predictions = 0;
};

/// The job with the compliance of tools and axes multiplied by `scale`; scaling the forces would be equivalent.
machine::Job softened(const machine::Job& job, double scale);

/// Least squares of the points against the prediction of `program` (what the measured part was cut with; empty: the
/// job's program), by Newton steps with the secant between predictions. Throws InputError [measured-not-identifiable]:
/// fewer than three points lie on the job's surface, their predicted error hardly depends on the deflection, or the
/// standard error of the scale is over a quarter of it.
MeasuredFit fit_measured(const machine::Job& job, const std::string& path, const std::vector<MeasuredPoint>& points,
                         const std::string& program, Diagnostics& diagnostics, const simulate::Progress& progress,
                         const simulate::Predictor& predictor = simulate::predict);

}  // namespace camber::compensate
