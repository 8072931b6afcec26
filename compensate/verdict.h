#pragma once
// Verdict on a program: error figures of the surface of the compensated moves, and the causes of the remaining error.
#include <optional>
#include <string>
#include <vector>

#include "compensate/attribution.h"
#include "compensate/error_split.h"
#include "machine/job.h"
#include "removal/form_error.h"

namespace camber::compensate {

/// Weighted by area over everything that the moves to compensate can reach; nothing else is left out but what the map
/// cannot see.
struct PlainFigures {
  removal::ErrorFigures error_um, deflection_um, contour_um;
  std::optional<removal::ErrorFigures> total_um;  ///< against the part's mesh
  double in_band_fraction = 0;                    ///< of the area whose judged error is within tolerance or profile
};

/// `observed`: of the same surface, with its reach. `total_mm`: one per point, or empty.
PlainFigures plain_figures(const std::vector<removal::SurfacePoint>& surface, const std::vector<double>& total_mm,
                           const Observed& observed, const machine::CompensationSettings& asked);

/// The judged error: error_um, or deflection_um if the reference is the machine.
const removal::ErrorFigures& judged_of(const PlainFigures& figures, machine::Reference reference);

/// The 95th percentile is within tolerance_um; with profile_um: 95 % of the area is within the band.
bool within_tolerance(const PlainFigures& figures, const machine::CompensationSettings& asked);

/// The same of judged errors, um, each of an area.
bool within_tolerance(const std::vector<double>& error_um, const std::vector<double>& area_mm2,
                      const machine::CompensationSettings& asked);

/// A part of the remaining error, and the lines of the program with most of it.
struct CauseFigure {
  Cause cause = Cause::correctable;
  double rms_um = 0;
  std::vector<std::size_t> lines;  ///< 1-based, the worst ones, ascending
  bool cut_twice = false;          ///< the program has second cuts already
};

/// Those that make a tenth of the mean square or more, the largest first. `lines`: of the judged program, one per point
/// of the surface; 0: unknown.
std::vector<CauseFigure> causes_of(const ErrorSplit& split, const std::vector<PointCause>& points,
                                   const Observed& observed, const std::vector<std::size_t>& lines);

/// "4.10 um rms differs along the cutter (helix bow), most in lines 12, 14; a second cut ... would remove it".
std::string sentence(const CauseFigure& cause);

}  // namespace camber::compensate
