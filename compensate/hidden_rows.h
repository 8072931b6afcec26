#pragma once
// Hidden rows: rows of which the surface shows nothing, because a neighbouring row cuts deeper.
#include <vector>

#include "compensate/move_map.h"
#include "compensate/shift_path.h"
#include "simulate/predict.h"

namespace camber::compensate {

/// Returns how far the tool is off the programmed path (servo lag, corner rounding, the shift itself), one per point of
/// `path`, mm: the mean over the stamps near it. `map`: from the moves of `emitted` to those of `given`.
std::vector<Vec3> path_offsets(const ShiftPath& path, const simulate::SimulatedProgram& given,
                               const simulate::SimulatedProgram& emitted, const MoveMap& map);

/// Returns whether two places of a path lie in different rows: in different chains, or much farther apart along the
/// path than across. `path` must outlive the object.
class Rows {
 public:
  explicit Rows(const ShiftPath& path);
  bool differ(const ShiftPath::PointInterval& a, const ShiftPath::PointInterval& b) const;

 private:
  const ShiftPath& path_;
  std::vector<std::size_t> chain_of_;  ///< one per point
};

}  // namespace camber::compensate
