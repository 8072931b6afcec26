#pragma once
// Predicts the emitted program again under other conditions: another grid, other parameters.
#include <string>
#include <vector>

#include "compensate/error_split.h"
#include "compensate/trial.h"
#include "compensate/uncertainty.h"
#include "simulate/setup.h"

namespace camber::compensate {

/// Both programs on a grid of its own: other voxels, which lie elsewhere.
struct Recheck {
  double voxel_mm = 0;
  removal::ErrorFigures before_um, after_um;  ///< judged, of the surface in reach
  ErrorSplit split_before, split_after;
  double deepest_um = 0;  ///< depth into the part, compensated moves of the emitted program
};

struct EmittedPair {
  const Emitted* last = nullptr;  ///< null: the given program
  const Emitted* free = nullptr;  ///< the best one before the guard; null: the guard did nothing
};

/// The target program, and where its moves are in the program of the path.
struct RecheckTarget {
  const simulate::SimulatedProgram& program;
  std::vector<std::uint32_t> moves{};  ///< empty: the same
};

/// `path`: of the program `of`. What the guard gives up follows from the same rule as in the rounds: the
/// additional correctable error compared with the best program without it, on this grid.
Recheck recheck(double voxel_mm, const ShiftedProgram& of, const EmittedPair& emitted, const ShiftPath& path,
                const FitShiftOptions& options, const RecheckTarget& made_by, const simulate::Progress& progress);

/// Returns how much each point of the emitted surface (`after`) moves with a group of parameters.
std::vector<double> changes_mm(const ParameterGroup& group, const ShiftedProgram& of, const Emitted* emitted,
                               const std::vector<removal::SurfacePoint>& after, std::vector<std::string>& unknown,
                               const simulate::Progress& progress);

}  // namespace camber::compensate
