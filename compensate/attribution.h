#pragma once
// Which place of the path made each piece of surface.
#include <span>
#include <vector>

#include "compensate/fit_shift.h"
#include "compensate/move_map.h"
#include "compensate/shift_path.h"
#include "simulate/predict.h"

namespace camber::compensate {

/// The error that a compensation works on and is judged by: error_um, or deflection_um where [compensation] reference
/// is the machine.
inline double judged_mm(const removal::SurfacePoint& p, machine::Reference reference) {
  return reference == machine::Reference::machine ? p.error_mm - p.contour_mm : p.error_mm;
}

/// The surface of one prediction as the fit sees it: one entry a surface point, in its order.
struct Observed {
  std::vector<Observation> points;
  std::vector<bool> compensated;  ///< made by a move that may be shifted; the others' places mean nothing
  /// What is judged: surface that the nominal path of the moves to compensate makes; where the target is another
  /// program, what they make in the given program. The same in every round. Empty: all.
  std::vector<bool> reach{};
  bool judged(std::size_t i) const { return reach.empty() || reach[i]; }
  /// Those that may be shifted.
  std::vector<Observation> of_path() const;
};

/// Observed::reach, from the first observation of the given program; `own_target`: see observe.
std::vector<bool> reach_of(const ShiftPath& path, const nc::Interpretation& given, const Observed& first,
                           std::span<const removal::SurfacePoint> surface,
                           std::span<const simulate::PathFraction> own_target);

/// A point belongs to the stamp that cut the machined surface there; where nothing did, to the stamp of the nominal
/// sweep, if that is the given program's own (`own_target`: Target::stamps; else empty). `map`: from the emitted
/// program's moves to those of `path`.
Observed observe(const ShiftPath& path, const machine::Job& job, const simulate::SimulatedProgram& given,
                 const simulate::SimulatedProgram& emitted, const MoveMap& map,
                 std::span<const removal::SurfacePoint> surface, std::span<const simulate::PathFraction> own_target);

}  // namespace camber::compensate
