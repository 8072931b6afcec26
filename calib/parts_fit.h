#pragma once
// fit-parts: forces, stiffness, gains and tool diameters from measured features of parts.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "machine/job_file.h"

namespace camber::calib {

struct PredictedSize {
  double size_mm = 0;
  double deflection_mm = 0;  ///< of it, what bending changes
};

/// Predicted sizes of a job's features, in their order; nothing where there is no prediction.
using PredictFeatures = std::function<std::vector<std::optional<PredictedSize>>(const machine::Job&)>;

/// By a whole prediction (simulate::predict) and inspect::evaluate.
std::vector<std::optional<PredictedSize>> predict_features(const machine::Job& job);

/// The job on a grid half as fine, with steps of rotation four times as wide (4 degrees at most): for slopes.
machine::Job coarser(machine::Job job);

struct FitPartsOptions {
  PredictFeatures predict = predict_features;
  std::vector<std::string> hold_out{};  ///< names of jobs (file without folder and ending) or parts: judged, not fitted
  int max_rounds = 8;
  std::function<void(const std::string& what, double share)> progress{};
};

struct PartsParameter {
  std::string name;  ///< key of machine.toml, "tool.5.KEY", "force_scale", "radial_scale", "edge_scale", "drift"
  std::string unit;
  double value = 0;  ///< in the unit of the file
  double start = 0;
  std::optional<double> std_error;  ///< not given: not determined, and `value` is the start
  std::string note;
};

struct Correlation {
  std::string a, b;
  double value = 0;
};

/// A measured size and the fitted model's.
struct PartsResidual {
  std::string job, feature, part;
  int tool = 0;
  double measured_mm = 0, predicted_mm = 0;                      ///< with offsets
  double feed_mm_per_min = 0, overhang_mm = 0, spindle_rpm = 0;  ///< of the tool in that job
  bool held_out = false;
  double residual_um() const { return 1000 * (measured_mm - predicted_mm); }
};

struct PartsGroup {
  std::string feature;
  int tool = 0;
  std::optional<double> rms_um, held_out_rms_um;
};

struct FitPartsResult {
  std::vector<machine::Job> jobs;  ///< with the fitted numbers
  std::vector<PartsParameter> parameters;
  std::vector<Correlation> correlations;  ///< of all pairs of determined parameters
  std::vector<std::string> confounded;    ///< sentences: what cannot be told apart, and why
  std::vector<std::string> suggestions;   ///< experiments that would tell it
  std::vector<PartsResidual> residuals;
  std::vector<PartsGroup> groups;     ///< by feature and tool
  std::vector<std::string> left_out;  ///< measured features without a prediction, with the reason
  double rms_um = 0;                  ///< of what was fitted
  machine::ModelError error;          ///< what the fit leaves uncertain, for [model_error]
  int rounds = 0;
  std::size_t predictions = 0;
  bool converged = false;
  std::string message;
};

/// Least squares with a robust loss (Huber, 1.5 standard deviations) over all measured values of all jobs at once.
///
///   size = prediction(job; forces, stiffness, gains) + s_f offset(tool, clamping) + drift t
///
/// with s_f = Feature::size_per_diameter(). Forces, compliance and lag are scales, in which sizes are linear; one
/// offset for every tool and every clamping of it (jobs whose [tool.N] are alike). Every parameter that the
/// measurements do not determine, together with those before it (offsets, common gain, force, radial force, root
/// stiffness, edge force, gains apart), to half of its value stays at its start.
///
/// Ceres solves a linear model of the predictions, whose slopes come from predictions of coarser() jobs
/// (by gains in rigid coupling; none by forces and stiffness where bending changes sizes by less than
/// 0.1 um), those by forces and stiffness found again where one has moved by more than a fifth; predictions at its
/// solution correct it (Broyden), until the step is below a twentieth of the standard errors. The figures are of the
/// last predictions, which are of the jobs as they are. Source of the update: Broyden, A class of methods for solving
/// nonlinear simultaneous equations, Math. Comp. 19 (1965).
///
/// Errors [parts-unmeasured]: no feature of any job has a measured value. Throws InputError.
FitPartsResult fit_parts(const std::vector<machine::Job>& jobs, const FitPartsOptions& options);

/// The part of a path that names a job: "plate_01" of ".../plate_01.toml"; its folder's name for "job.toml".
std::string job_name(const machine::Job& job);

}  // namespace camber::calib
