#pragma once
// Uncertainty of the residual error due to the standard errors of the model parameters.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "machine/job_file.h"
#include "removal/form_error.h"

namespace camber::compensate {

/// One parameter with its standard error, in the unit of the file that it came from.
struct UncertainParameter {
  std::string name;  ///< name as fit-force and fit-feed write it: "ktc_MPa", "axis.x.position_gain_per_s"
  double value = 0, std_error = 0;
};

/// Parameters that are changed together by one standard error each.
struct ParameterGroup {
  std::string name;  ///< "cutting", "edge", "stiffness", "force", "drives", "limits"
  std::vector<UncertainParameter> parameters;
  double fraction = 0;  ///< relative standard error of the whole group, instead of parameters
};

/// A percentage ("10", "10 %"): the forces and the tool's stiffness, each uncertain by so much, two groups. Otherwise
/// the name of what fit-force or fit-feed wrote: the JSON report, or the TOML file with its comments
/// "# NAME: VALUE +- ERROR UNIT". Errors [uncertainty]: neither, or a file without a standard error.
std::vector<ParameterGroup> read_uncertainty(const std::string& file_or_percent);

/// Returns the job with one group changed by one standard error. Parameters that it does not have go to `unknown`.
machine::Job moved(const machine::Job& job, const ParameterGroup& group, std::vector<std::string>& unknown);

struct Band {
  struct Group {
    std::string name;
    double rms_um = 0;  ///< rms change of the error over the surface
  };
  std::vector<Group> groups;
  double sigma_rms_um = 0;   ///< rms over the surface of the standard error of the error
  double rms_um = 0;         ///< expected residual: sqrt(rms^2 + sigma^2)
  double p95_um = 0;         ///< 95th percentile of |error| + 1.96 sigma
  double deepest_um = 0;     ///< gouge depth: 99th percentile by area of the error minus 1.64 sigma
  double safe_fraction = 1;  ///< see band_of
};

/// First-order propagation: the standard error of each point of the surface is the root of the sum of squares of the
/// groups' changes (`changes_mm`, one list a group, of the surface of the compensated program).
///
/// safe_fraction: the largest fraction of the compensation with which, at 95 % confidence in each point, at most 5 % of
/// the area is cut deeper than the tolerance. The error is interpolated linearly between before and after.
Band band_of(const std::vector<removal::SurfacePoint>& before, const std::vector<removal::SurfacePoint>& after,
             const std::vector<std::string>& names, const std::vector<std::vector<double>>& changes_mm,
             double tolerance_mm);

}  // namespace camber::compensate
