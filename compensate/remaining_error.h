#pragma once
// Verdict on a program: error figures of the surface of the compensated moves, and the causes of the remaining error.
#include <optional>
#include <string>
#include <vector>

#include "compensate/attribution.h"
#include "compensate/binding_limits.h"
#include "compensate/error_split.h"
#include "compensate/safety.h"
#include "machine/compensation_settings.h"
#include "machine/job_file.h"
#include "removal/form_error.h"

namespace camber::compensate {

/// Figures weighted by area over all surface that the moves to compensate can reach and that the map can see.
struct PlainFigures {
  removal::ErrorFigures error_um, deflection_um, contour_um;
  std::optional<removal::ErrorFigures> total_um;  ///< against the part's mesh
  /// Parts of deflection_um due to the tool and to the workpiece, where the workpiece yields.
  std::optional<removal::ErrorFigures> tool_um{}, part_um{};
  double in_band_fraction = 0;  ///< fraction of the area whose judged error is within tolerance or profile
};

/// `observed`: observations of the same surface, with their reach. `total_mm`: one per point, or empty.
PlainFigures plain_figures(const std::vector<removal::SurfacePoint>& surface, const std::vector<double>& total_mm,
                           const Observed& observed, const machine::CompensationSettings& asked);

/// The judged error: error_um, or deflection_um if the reference is the machine.
const removal::ErrorFigures& judged_of(const PlainFigures& figures, machine::Reference reference);

/// Returns whether the 95th percentile is within tolerance_um; with profile_um whether 95 % of the area is in the band.
bool within_tolerance(const PlainFigures& figures, const machine::CompensationSettings& asked);

/// As above, for judged errors in um, each with its area.
bool within_tolerance(const std::vector<double>& error_um, const std::vector<double>& area_mm2,
                      const machine::CompensationSettings& asked);

/// Cause of the contour error of a piece of surface (simulate/contour.h).
enum class ContourCause { none, lag, path_tolerance, corner_law };
/// Returns the cause of the contour error that makes half or more of the error of the points with `cause`. `surface`:
/// the same points.
ContourCause contour_cause_of(Cause cause, const std::vector<PointCause>& points,
                              const std::vector<removal::SurfacePoint>& surface);

/// 95th percentile of magnitudes, by area; 0 where there are none.
double p95_of(const std::vector<double>& error_um, const std::vector<double>& area_mm2);

/// A part of the remaining error, and the lines of the program with most of it.
struct CauseFigure {
  Cause cause = Cause::correctable;
  double rms_um = 0;
  std::vector<ProgramLine> lines{};           ///< the worst ones, ascending
  ContourCause contour = ContourCause::none;  ///< cause of an error that changes faster than a smooth shift can
  std::vector<std::string> remedies{};        ///< remedies that were not tried
};

/// Returns the causes that make a tenth of the mean square or more, the largest first, without remedies. `lines`: one
/// per point of the surface.
std::vector<CauseFigure> causes_of(const ErrorSplit& split, const std::vector<PointCause>& points,
                                   const Observed& observed, const std::vector<ProgramLine>& lines);

/// Levers and limits that a compensation has used.
struct Tried {
  bool rounds = false;  ///< the rounds ended before max_rounds: one more was not worth its prediction
  bool feeds = false, second_cuts = false;
  bool pass_before = true;  ///< false: there are passes before, and they were left as given
  std::vector<BindingLimit> limits{};
};
/// Returns the remedies of a cause that have not been tried.
std::vector<std::string> remedies_of(const CauseFigure& cause, const Tried& tried);

/// "line 12", "lines 12, 14 (15 as emitted)".
std::string lines_text(const std::vector<ProgramLine>& lines);

/// "4.10 um rms differs along the cutter (helix bow), most in lines 12, 14 (15 as emitted); a shorter tool would remove
/// it".
std::string sentence(const CauseFigure& cause);

}  // namespace camber::compensate
