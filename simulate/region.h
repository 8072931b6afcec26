#pragma once
// The region of a job with operations: the part of its nominal surface that is a surface of the part.
#include <functional>
#include <span>

#include "removal/form_error.h"
#include "simulate/predict_path.h"

namespace camber::simulate {

/// A point is border if moves outside the job's operations cut deeper by more than this, mm. Smaller differences occur
/// between passes at one height and at the ridge between rows.
inline constexpr double kBorder_mm = 0.002;
/// Where more of the surface than this is cut deeper by other moves, the job is an intermediate stage (roughing)
/// without border: all of its surface is judged.
inline constexpr double kBetween = 0.99;

/// Sets Target::region. `points`: of a SurfaceMap of the target; `program`: the target program.
///
/// Border: points that the commanded sweep of the moves which the job leaves out, of tools that it describes and in
/// work offsets that it cuts in, passes by more than kBorder_mm below. The region's raw edges are such places: the rest
/// of the program takes them away, or has done so before. These moves are sampled so that what stands between two
/// samples is below 1 um.
///
/// Not judged: points of moves that [part] judged does not name.
void mark_region(const machine::Job& job, const SimulatedProgram& program,
                 std::span<const removal::SurfacePoint> points, Target& target);

/// Leaves the points of a map out that are not of the region; `surface` is in the map's order.
void drop_left_out(const SurfaceRegion& region, std::vector<removal::SurfacePoint>& surface);

}  // namespace camber::simulate
