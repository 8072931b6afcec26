#pragma once
// Stability of milling by the zero-order solution: the directional matrix is replaced by its mean over a turn.
// Source: Altintas, Budak, Analytical prediction of stability lobes in milling, CIRP Annals 44 (1995) 357-362.
//
// With A the mean of N W over a turn and G the receptance, the border is where
//   det(I + b (1 - e^(-i omega T)) G(i omega) A) = 0,  b real and positive,
// that is b = -1 / ((1 - e^(-i omega T)) lambda) for an eigenvalue lambda of G A: both eigenvalues and all lobes are
// searched. Helix has no influence; of unequal pitches the mean of the e^(-i omega T_j) counts. Where the teeth cut a
// small fraction of the time, the multipliers at -1 (flip lobes) are missing: semi_discretisation.h.
#include <array>
#include <complex>
#include <limits>
#include <vector>

#include "dynamics/vibrating_cut.h"

namespace camber::dynamics {

struct CriticalDepth {
  double depth_mm = std::numeric_limits<double>::infinity();  ///< infinite: no border
  double chatter_hz = 0;                                      ///< heard at the border; 0: no border
};

/// Borders of one cut at many speeds: the eigenvalues along the frequency are worked out once.
class ZeroOrderLobes {
 public:
  /// Borders up to `highest_hz`; 0: three times the highest mode.
  ZeroOrderLobes(std::vector<Mode> modes, Cut cut, double highest_hz = 0);

  /// Lowest depth of the border over both eigenvalues and all lobes, with process damping where the cut has it.
  CriticalDepth at(double speed_rpm) const;

  /// The lowest depth of the border at any speed, without process damping.
  double lowest_depth_mm() const;

 private:
  struct Sample {
    double hz = 0;
    std::complex<double> eigenvalue;
  };
  /// Neighbouring samples of one eigenvalue whose real part is negative.
  using Stretch = std::vector<Sample>;

  ZeroOrderLobes with_damping_at(double depth_mm, double speed_rpm) const;
  CriticalDepth undamped_at(double speed_rpm) const;
  CriticalDepth equal_pitches_at(double speed_rpm) const;
  CriticalDepth unequal_pitches_at(double speed_rpm) const;
  std::array<std::complex<double>, 2> eigenvalues(double hz) const;
  std::complex<double> eigenvalue_near(double hz, std::complex<double> near) const;
  void sample(double highest_hz);
  void add_branch(const std::vector<Sample>& branch);

  std::vector<Mode> modes_;
  Cut cut_;
  Eigen::Matrix2d directional_;
  double highest_hz_;
  std::vector<Stretch> stretches_;
};

}  // namespace camber::dynamics
