#pragma once
// Features of a part on the predicted surface, measured as the instrument would; how sure the model is of them.
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "machine/features.h"
#include "machine/job_file.h"
#include "removal/form_error.h"

namespace camber::inspect {

using machine::ModelError;

struct FeatureResult {
  std::string feature;
  machine::FeatureKind kind = machine::FeatureKind::bore;
  double nominal_mm = 0;
  std::optional<double> predicted_mm{};      ///< size of the machined feature
  std::string reason{};                      ///< why there is no prediction
  std::optional<double> commanded_mm{};      ///< size on the programmed surface
  double contour_um = 0, deflection_um = 0;  ///< what they change the size by; predicted - commanded is their sum
  std::optional<double> std_mm{};            ///< standard error of the prediction
  std::optional<double> form_um{};           ///< roundness, cylindricity, flatness, or spread of the local sizes
  std::optional<double> taper_um{};          ///< size at the upper end of the depth minus that at the lower
  std::optional<double> roundness_um{}, straightness_um{};  ///< bore, boss: of the roundest-off circle; of the axis
  std::optional<Vec3> position_um{};                        ///< position of the middle against nominal, after alignment
  std::optional<double> measured_mm{};                      ///< mean of the measured values
  std::optional<double> lower_mm{}, upper_mm{};
  std::size_t readings = 0, missed = 0;
  std::vector<double> deviations_um{};  ///< deviations of the readings from the nominal shape, for a picture

  std::optional<double> difference_um() const {
    if (!predicted_mm || !measured_mm) return std::nullopt;
    return 1000 * (*measured_mm - *predicted_mm);
  }
  /// Whether the predicted size is within the limits; nothing without limits or prediction.
  std::optional<bool> within() const {
    if (!predicted_mm || !lower_mm || !upper_mm) return std::nullopt;
    return *predicted_mm >= *lower_mm && *predicted_mm <= *upper_mm;
  }
};

/// Evaluates the features in their order. The surface is read at the instrument's places: evenly spaced angles (all
/// of `points`, or 72 a circle) at `depth_mm`, or on circles evenly spaced along the axis; grids of planes; stations
/// along walls. Each reading is a mean over about three voxels. A feature most of whose readings are missing (not cut
/// by the job's operations, or beyond the model) has no prediction, and `reason` says why.
///
/// Features with `align` give a small rigid motion (least squares, of least norm) which is taken off all positions;
/// sizes and forms do not depend on it.
std::vector<FeatureResult> evaluate(const std::vector<machine::Feature>& features,
                                    std::span<const removal::SurfacePoint> surface, double voxel_mm,
                                    const ModelError& error = {});

/// Columns feature,kind,nominal_mm,predicted_mm,std_mm,measured_mm,difference_um,form_um,taper_um,lower_mm,upper_mm,
/// within; what is not known is empty, within is 1 or 0.
std::string features_csv(const std::vector<FeatureResult>& results);

/// The job's [model_error] where it has one; else relative standard errors by where its numbers come from:
///
///   deflection  forces: the preset's scatter, or 25 %, and 150 % for the thin chips of small tools (size effect, edge
///               wear, rubbing); stiffness: 40 % where root or flutes are typical values, else 15 %
///   contour     50 %: gains of position loops, each axis to 15 %. Lag goes with their inverse square (21 %), and where
///               the axes differ arcs between lines lose more (46 % for 10 % either way, arcs of 1 mm at 15 mm/s)
///   size        28 um: a tool's diameter as it is called, ground to h10 (0 to -48 um from 3 to 6 mm; root mean square)
///
/// The distance of two parts of circles has the band of their sizes.
/// Source of the size effect: Altintas, Manufacturing Automation, 2nd ed., ch. 2; of the 150 %: docs/measured-parts.md.
machine::ModelError model_error_of(const machine::Job& job);

}  // namespace camber::inspect
