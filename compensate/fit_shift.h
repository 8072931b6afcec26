#pragma once
// Fits the shifts of the path nodes to the form error.
//
// Minimizes sum w a (e/g + n.(s - s_old))^2 + mu int |ds/dl|^2 + mu sum_links l |s_a - s_b|^2 / d^2 + kappa int |s|^2
// with error e, area a, weight w, normal n and sensitivity g of each observation, by conjugate gradients; the exact
// solution of each chain is the preconditioner. mu follows from the smoothing length and the local mean of w.
#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "base/geometry.h"
#include "compensate/row_links.h"
#include "compensate/shift_path.h"

namespace camber::compensate {

/// One piece of surface, its error, and the place of the path that made it.
struct Observation {
  ShiftPath::PointInterval place;
  Vec3 normal = Vec3::UnitZ();  ///< outward
  double error_mm = 0;
  double area_mm2 = 0;
  double gain = 1;                     ///< change of the error with the shift along the normal
  double weight = 1;                   ///< weight of its area in the fit
  Vec3 from_centre_mm = Vec3::Zero();  ///< position from the centre of the cutter's corner (its tip, if that is sharp)
  bool at_tip = false;                 ///< on the axis of a round tip, where the cutting speed is almost zero
  bool own = true;                     ///< the place is the one that cut the surface
  bool foreign = false;                ///< the surface belongs to one row on the nominal path and was cut by another
  bool above = false;                  ///< the place passes above the surface: see Observed::hidden
  bool opposed = false;                ///< generated at the same path position as an opposite surface
  double form_mm = 0;  ///< further part of the error, the form across the row, that the fit leaves alone
  double bound_mm = std::numeric_limits<double>::infinity();  ///< magnitude that error and form together may reach
};

struct FitShiftOptions {
  double smoothing_mm = 0.2;  ///< features of the shift shorter than this along the path are smoothed
  double decay_mm = 10;       ///< without surface to correct, the shift decays over this length
  double max_shift_mm = 0.1;
  /// Factor on mu between each point of the path and the next; empty: 1.
  std::span<const double> stiffness{};
  std::span<const RowLink> links{};          ///< links between rows
  std::span<const double> link_stiffness{};  ///< one per link, as `stiffness`
  bool bounded = false;                      ///< Observation::bound_mm is kept
  bool centred = false;                      ///< errors are judged by their 95th percentile, see without_row_form
};

/// Returns the length of the shortest feature of a shift that a grid of these voxels resolves. A shorter one would
/// follow the scatter of its points.
constexpr double smoothing_mm(double voxel_mm) { return std::max(0.2, 2.5 * voxel_mm); }

/// Finds the shifts that minimize
///
///   sum w a (e / g + n . (s - s_old))^2 + mu integral |ds/dl|^2 dl + kappa integral |s|^2 dl
///     + mu sum_links l |s_a - s_b|^2 / d^2
///
/// (d: distance of two rows, l: length of path that a link stands for; so the shift is as smooth across rows as along
/// them) with a the area, w the weight, e the error, g the gain, n the normal of each observation, s the shift at its
/// place (linear between the points), mu = rho smoothing^2, kappa = mu / decay^2 and rho the mean area per path length;
/// mu is larger by the mean weight about a place. Along a chain that is a block tridiagonal system of 3 x 3 blocks;
/// with links, conjugate gradients with the chains' exact solution as preconditioner. Directions in which hardly any
/// surface faces stay at rest; where surfaces face each other (a slot) the least squares between them results. Shifts
/// longer than max_shift_mm are cut to it. Returns how many points were.
///
/// `bounded`: subject to |e + form + g n . (s - s_old)| <= bound of each observation, by the method of multipliers
/// (augmented Lagrangian); where smoothness and bounds contradict each other, between the two.
std::size_t fit_shift(ShiftPath& path, std::span<const Observation> observations, const FitShiftOptions& options);

}  // namespace camber::compensate
