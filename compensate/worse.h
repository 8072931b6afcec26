#pragma once
// Places that a compensation makes worse than the given program.
#include <cstddef>
#include <vector>

#include "compensate/attribution.h"
#include "machine/compensation_settings.h"
#include "removal/form_error.h"

namespace camber::compensate {

inline constexpr double kWorse_mm = 0.001;  ///< a place is worse if its error exceeds the given one by more than this

/// Largest magnitude of the error that counts as no worse than `given_mm`: the given one and kWorse_mm, or the
/// tolerance where that is larger.
double not_worse_mm(double given_mm, double tolerance_mm);

/// Points of the judged surface whose error exceeds not_worse_mm.
struct WorsePlaces {
  std::size_t points = 0;
  double area_fraction = 0;  ///< of the judged surface
  double max_um = 0;         ///< by which a point is worse than given at most
  double p999_um = 0;        ///< excess over not_worse_mm that no more than a thousandth of the surface has
};

/// `before`, `after`: the same points. `observed`: says which of them are judged.
WorsePlaces worse_places(const std::vector<removal::SurfacePoint>& before,
                         const std::vector<removal::SurfacePoint>& after, const Observed& observed,
                         const machine::CompensationSettings& asked);

}  // namespace camber::compensate
