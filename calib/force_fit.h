#pragma once
// fit-force: coefficients of a force law from dynamometer measurements of steady cuts.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calib/force_signal.h"
#include "machine/material.h"

namespace camber::calib {

struct ForceParameter {
  std::string name, unit;
  double value = 0;
  std::optional<double> std_error;  ///< not given: kept by `hold`, or as many values as parameters
  std::string note;
};

/// A cut as measured and as the fitted law gives it.
struct CutResidual {
  std::string name;
  Vec3 measured_N = Vec3::Zero(), model_N = Vec3::Zero();  ///< means
  std::array<bool, 3> has{};
};

/// The run-out that one log shows.
struct RunOutFit {
  std::string log;
  double offset_mm = 0, angle_rad = 0;  ///< from tooth 1's edge at the tip; tooth 1 is the longest one
  double offset_std_error_mm = 0;
  std::string note;
};

struct FitForceResult {
  machine::Material material;
  std::vector<ForceParameter> parameters;  ///< run-out after the coefficients
  std::vector<RunOutFit> run_out;          ///< of waveforms
  std::vector<CutResidual> cuts;
  double residual_rms_N = 0;             ///< of what was fitted: means or waveforms
  std::optional<double> held_out_rms_N;  ///< every fourth turn of waveforms; means: each cut left out in turn
  bool converged = false;
  bool plausible = true;  ///< tangential and radial cutting coefficients are not negative
  std::string message;
};

/// Fits the law of the logs (all of one law) to all their cuts at once, by least squares (Ceres): means against
/// SteadyCutModel::mean_N, waveforms against waveform_N with one run-out a log and one phase a cut.
///
/// Coefficients that the cuts do not determine are refused, InputError [not-identifiable], with their names and the
/// reason: a singular value of the Jacobian (columns scaled to one) below 1e-3. A coefficient that [force_log] holds
/// keeps the material's value. Errors [force-log]: logs of different laws or held values.
FitForceResult fit_force(const std::vector<MeasuredLog>& logs);

}  // namespace camber::calib
