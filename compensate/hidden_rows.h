#pragma once
// Hidden rows: rows of which the surface shows nothing, because a neighbouring row cuts deeper.
#include <functional>
#include <vector>

#include "compensate/attribution.h"
#include "compensate/shift_path.h"
#include "nc/move_map.h"
#include "simulate/predict_path.h"
#include "simulate/setup.h"

namespace camber::compensate {

/// Returns how far the tool is off the programmed path (servo lag, corner rounding, the shift itself), one per point of
/// `path`, mm: the mean over the stamps near it. `map`: from the moves of `emitted` to those of `given`.
std::vector<Vec3> path_offsets(const ShiftPath& path, const simulate::SimulatedProgram& given,
                               const simulate::SimulatedProgram& emitted, const nc::MoveMap& map);

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

/// Returns the bending at the contact of every stamp of the nominal path under the force of the nominal chip, mm, by
/// one rigid prediction of that path.
std::vector<Vec3> nominal_bending(const machine::Job& job, const simulate::Setup& given,
                                  const std::function<void(double)>& progress);

/// Returns the error that `owner`, the place that makes the point on the nominal path, would leave there, mm:
///
///   e = n . o + n . d
///
/// o: how far the axes are off the programmed path (path_offsets); d: nominal_bending. With the right shift the cutter
/// is where it was programmed and takes the nominal chip, so this is what that shift takes away, also of a row of which
/// the surface shows nothing because its neighbour cuts deeper.
double expected_error_mm(const machine::Job& job, const removal::SurfacePoint& point,
                         const ShiftPath::PointInterval& owner, std::span<const Vec3> offsets,
                         std::span<const Vec3> bending);

/// The surface is made by the edge that cuts deepest of several that pass a point, and so lies deeper than the bending
/// at the contact says. Scales `bending` by the least squares over the points that their own row has cut in the given
/// program, and returns the scale (0 to 1).
void scale_bending(const ShiftPath& path, const machine::Job& job, const simulate::Setup& given,
                   const Observed& observed, const std::vector<removal::SurfacePoint>& surface,
                   std::vector<Vec3>& bending);

/// Returns expected_error_mm of the given program at every point of the surface that has an owner.
std::vector<Observation> expected_errors(const ShiftPath& path, const machine::Job& job, const simulate::Setup& given,
                                         const Observed& observed, const std::vector<removal::SurfacePoint>& surface,
                                         std::span<const Vec3> bending);

}  // namespace camber::compensate
