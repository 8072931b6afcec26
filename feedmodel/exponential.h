#pragma once
// Feed under exponential acceleration after interpolation: two first-order lags T1, T2 behind the command.

namespace camber::feedmodel {

/// f(t) = F + (f_s - F)/(T1 - T2) (T1 e^(-t/T1) - T2 e^(-t/T2)); the limit where T1 = T2. Times in s, >= 0.
/// Source: Yan & Shirase 1997, eq. 2.
struct ExponentialRamp {
  double start_mm_per_s = 0;    ///< f_s
  double command_mm_per_s = 0;  ///< F
  double t1_s = 0, t2_s = 0;    ///< 0: no lag

  double speed_at(double t_s) const;
  /// d(t) = F (t - T1 - T2) + f_s (T1 + T2) + (F - f_s)/(T1 - T2) (T1^2 e^(-t/T1) - T2^2 e^(-t/T2))
  /// Source: Yan & Shirase 1997, eq. 3 as corrected (docs/errata.md).
  double distance_at(double t_s) const;
  /// The time at which the distance is covered, exact to 1e-12 s. Infinite where it is never covered (F = 0).
  double time_of(double distance_mm) const;
  /// Returns the same by the printed model, once the lags have died out: d/F + (1 - f_s/F)(T1 + T2).
  double approximate_time_of(double distance_mm) const;
};

/// Returns the time from rest to rest: the ramp's time and T1 + T2 for the stop, d/F + 2 (T1 + T2) on a long block.
/// Source: Yan & Shirase 1997, eqs. 4-5.
double exponential_rest_to_rest_s(double distance_mm, double feed_mm_per_s, double t1_s, double t2_s);

}  // namespace camber::feedmodel
