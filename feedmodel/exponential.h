#pragma once
// Exponential acceleration after interpolation: a step of the feed through two first-order lags.
namespace camber::feedmodel {

/// From `start` to `feed` with time constants T1, T2 (s; equal ones and zeros are allowed). With f_s = start, F = feed:
///   f(t) = F + (f_s - F) / (T1 - T2) (T1 e^(-t/T1) - T2 e^(-t/T2))
///   d(t) = F (t - T1 - T2) + f_s (T1 + T2) + (F - f_s) / (T1 - T2) (T1^2 e^(-t/T1) - T2^2 e^(-t/T2))
/// Source: Yan & Shirase 1997, corrected (docs/errata.md). Axis filters exponential_1_ms and exponential_2_ms do the
/// same to any command; these closed forms are for whole blocks.
struct Exponential {
  double start_mm_per_s = 0, feed_mm_per_s = 0;
  double t1_s = 0, t2_s = 0;

  double speed_mm_per_s(double t_s) const;
  double distance_mm(double t_s) const;
  /// Time to go a distance >= 0, exact (Newton, 1e-12 s). Needs feed > 0.
  double time_s(double distance_mm) const;
  /// What the printed model takes for it: the exponentials have died away, t = d/F + (1 - f_s/F)(T1 + T2).
  double approximate_time_s(double distance_mm) const;
};

}  // namespace camber::feedmodel
