#pragma once
// What a cut does to the tool's vibration: where its teeth are in the material, and how stiff the chip is.
//
// Angles of the tool as in Altintas, Manufacturing Automation: clockwise (M3) from +y seen from above. A tooth at phi
// moves along t = (cos phi, -sin phi), and its outward normal is n = (sin phi, cos phi). With the feed along +x,
// up-milling is phi = 0 ... acos(1 - 2 a) and down-milling acos(2 a - 1) ... pi, a the radial depth over the diameter.
// Vibration r(t) of the tool changes the chip by n . (r(t) - r(t - T)), T the time since the tooth before, and the
// force on the tool by
//   -b W(phi) (r(t) - r(t - T)),  W = (K_t t + K_r n) n^T,   b the axial depth.                    [N] = [mm][MPa][mm]
// Edges whose normal leans by kappa from the axis (ball ends, corners) take part with K_r sin kappa + K_a cos kappa in
// the place of K_r: their chip is as much thinner as their edge is longer than the depth.
#include <complex>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "machine/tool.h"

namespace camber::dynamics {

using machine::Mode;

/// A slice of the axial depth whose edges cut on one arc with the same stiffness of the chip.
struct CutSlice {
  double from = 0, to = 1;             ///< fractions of the axial depth, from the tip
  double entry_rad = 0, exit_rad = 0;  ///< ascending; less than 2 pi apart, or a whole turn
  double kt_MPa = 0, kr_MPa = 0;       ///< slopes of the force by the chip
};

struct Cut {
  std::vector<CutSlice> slices;
  std::vector<double> pitch_rad;        ///< from each tooth to the next, in the order in which they cut; sum 2 pi
  double lag_rad_per_mm = 0;            ///< by which higher points follow: tan(helix) / radius
  double process_damping_N_per_mm = 0;  ///< C: force C / v per depth and speed of vibration along n; 0: none
  double radius_mm = 0;                 ///< for the cutting speed v of process damping
};

/// `teeth` equal pitches.
std::vector<double> equal_pitches(int teeth);
/// Whether all teeth are equally far apart.
bool has_equal_pitches(const Cut& cut);

/// A cylindrical cut with the feed along +x; radial_fraction (0, 1] of the diameter.
enum class Milling { up, down };
CutSlice shoulder(double radial_fraction, Milling milling, double kt_MPa, double kr_MPa);

/// Integrals of W of a slice over the angle, zero outside its arc: the first from 0 to phi, and the integral of that.
/// Exact, for any phi.
class DirectionalIntegral {
 public:
  explicit DirectionalIntegral(const CutSlice& slice);
  Eigen::Matrix2d first(double phi) const;
  Eigen::Matrix2d second(double phi) const;
  const Eigen::Matrix2d& per_turn() const { return turn_first_; }

 private:
  Eigen::Matrix2d primitive(double phi) const, second_primitive(double phi) const;
  Eigen::Matrix2d first_in_turn(double r) const, second_in_turn(double r) const;
  double entry_, arc_, kt_, kr_;
  Eigen::Matrix2d primitive_at_entry_, second_primitive_at_entry_;
  Eigen::Matrix2d arc_first_, arc_second_;    ///< at the exit
  Eigen::Matrix2d turn_first_, turn_second_;  ///< behind a turn
};

/// Mean of W over a turn and the depth, of one tooth.
Eigen::Matrix2d mean_directional(const Cut& cut);

/// Receptance at the tip, mm/N, x and y.
Eigen::Matrix2cd receptance(std::span<const Mode> modes, double frequency_hz);

/// The modes with the process damping of a depth at a speed, averaged over the turn:
/// c = C b / v * mean of n n^T over the arc and all teeth, added along each mode.
/// Source: Altintas, Eynian, Onozuka, Identification of dynamic cutting force coefficients and chatter stability with
/// process damping, CIRP Annals 57 (2008) 371-374, with the averaged coefficients of milling.
std::vector<Mode> with_process_damping(std::span<const Mode> modes, const Cut& cut, double depth_mm, double speed_rpm);

}  // namespace camber::dynamics
