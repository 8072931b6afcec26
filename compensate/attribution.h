#pragma once
// Which place of the path made each piece of surface.
#include <optional>
#include <span>
#include <vector>

#include "compensate/fit_shift.h"
#include "compensate/move_map.h"
#include "compensate/shift_path.h"
#include "simulate/setup.h"

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
  /// program, what they make in the program as given. The same in every round. Empty: all.
  std::vector<bool> reach{};
  bool judged(std::size_t i) const { return reach.empty() || reach[i]; }
  /// Of rows that pass above the surface because a neighbouring row cuts deeper (hidden_rows.h): the same points again,
  /// at the places that should have made them, with the errors that these would leave (expected_error_mm).
  std::vector<Observation> hidden{};
  /// Those that may be shifted; of points above which their place passes, the hidden ones.
  std::vector<Observation> of_path() const;
};

/// The place that makes the point on the nominal path; nothing where that is another program's, or may not be shifted.
std::optional<ShiftPath::PointInterval> owner_place(const ShiftPath& path, const simulate::Setup& given,
                                                    const removal::SurfacePoint& point);
/// Puts an observation of `point` to a place of the path.
void set_place(Observation& o, const removal::SurfacePoint& point, const ShiftPath::PointInterval& place,
               const ShiftPath& path, const machine::Job& job, const nc::Interpretation& given);

/// Observed::reach, from the first observation of the program as given; `own_target`: see observe.
std::vector<bool> reach_of(const ShiftPath& path, const nc::Interpretation& given, const Observed& first,
                           std::span<const removal::SurfacePoint> surface,
                           std::span<const simulate::PathShare> own_target);

/// Area of the judged surface which one row makes on the nominal path and a neighbouring one has cut, over all of it.
double foreign_fraction(const Observed& observed);

/// A point belongs to the stamp that cut the machined surface there; where nothing did, or the stamp of the nominal
/// sweep is of another row and material is left, to that one, which should have removed it, if the target is the given
/// program's own (`own_target`: Target::stamps; else empty). `map`: from the emitted program's moves to those of
/// `path`. `bending` (one a stamp of the nominal path, or empty: no hidden points): see expected.h.
Observed observe(const ShiftPath& path, const machine::Job& job, const simulate::SimulatedProgram& given,
                 const simulate::SimulatedProgram& emitted, const MoveMap& map,
                 std::span<const removal::SurfacePoint> surface, std::span<const simulate::PathShare> own_target,
                 std::span<const Vec3> bending = {});

}  // namespace camber::compensate
