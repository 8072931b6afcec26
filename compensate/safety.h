#pragma once
// Safety of the emitted program: depth into the part and travel of the axes.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "checks/travel.h"
#include "compensate/attribution.h"
#include "machine/job_file.h"
#include "removal/form_error.h"
#include "simulate/predict_path.h"

namespace camber::compensate {

/// A line of the given program, 1-based, and the one that it became; 0: unknown.
struct ProgramLine {
  std::size_t given = 0, emitted = 0;
  bool operator==(const ProgramLine&) const = default;
};

/// Gouge depth: depth of the surface below the undeflected sweep of the target.
struct Depth {
  double deepest_um = 0;           ///< deepest single point; not negative
  double gouge_depth_p999_um = 0;  ///< 99.9 % of the surface is not deeper; compared with the depth limit
  Vec3 place_mm = Vec3::Zero();
  double over_fraction = 0;  ///< fraction of the area deeper than the tolerance
  std::int32_t stamp = -1;   ///< stamp that made the deepest point; -1: none
  ProgramLine line{};        ///< line of that stamp, where it is asked for
};

/// Returns the depth of the points that compensated moves made (`compensated` false: of the others), by the judged
/// error.
Depth depth_of(const std::vector<removal::SurfacePoint>& surface, const Observed& observed, double tolerance_um,
               bool compensated);

/// Returns the depth of all points, by the judged error; `others_mm2`: area of the surface that is not among them.
Depth depth_of(const std::vector<removal::SurfacePoint>& surface, machine::Reference reference, double others_mm2,
               double tolerance_um);

/// Returns the gouge depth of the emitted program cut by a rigid tool. It is bounded by the largest shift and, where
/// rows cross other rows, by the sum of their shifts.
Depth depth_without_bending(const machine::Job& job, const simulate::Target& target,
                            const simulate::SimulatedProgram& emitted, double tolerance_um);

using checks::check_travel;

inline constexpr double kWorse_mm = 0.001;  ///< a place is worse if its error exceeds the given one by more than this

/// Returns the largest magnitude of the error that counts as no worse than `given_mm`: their sum with kWorse_mm, or the
/// tolerance where that is larger.
double not_worse_mm(double given_mm, double tolerance_mm);

/// Points of the judged surface whose error exceeds not_worse_mm.
struct WorsePlaces {
  std::size_t points = 0;
  double area_fraction = 0;  ///< fraction of the judged surface
  double max_um = 0;         ///< largest amount by which the error of a point exceeds the given one
  double p999_um = 0;        ///< excess over not_worse_mm that no more than a thousandth of the surface has
};

/// `before`, `after`: the same points. `observed`: says which of them are judged.
WorsePlaces worse_places(const std::vector<removal::SurfacePoint>& before,
                         const std::vector<removal::SurfacePoint>& after, const Observed& observed,
                         const machine::CompensationSettings& asked);

}  // namespace camber::compensate
