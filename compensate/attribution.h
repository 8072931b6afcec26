#pragma once
// Which place of the path made each piece of surface.
#include <span>
#include <vector>

#include "compensate/fit_shift.h"
#include "compensate/move_map.h"
#include "compensate/shift_path.h"
#include "simulate/predict.h"

namespace camber::compensate {

/// The surface of one prediction as the fit sees it: one entry a surface point, in its order.
struct Observed {
  std::vector<Observation> points;
  std::vector<bool> compensated;  ///< made by a move that may be shifted; the others' places mean nothing
  /// Those that may be shifted.
  std::vector<Observation> of_path() const;
};

/// A point belongs to the stamp that cut the machined surface there; where nothing did, to the stamp of the target's
/// sweep, if that is the program's own (`own_target`). `map`: from the emitted program's moves to those of `path`.
Observed observe(const ShiftPath& path, const machine::Job& job, const simulate::SimulatedProgram& given,
                 const simulate::SimulatedProgram& emitted, const MoveMap& map,
                 std::span<const removal::SurfacePoint> surface, bool own_target);

}  // namespace camber::compensate
