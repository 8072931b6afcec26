#pragma once
// Servo of one axis: a position loop of gain Kp around a velocity loop with a lag, Tv x'' + x' = Kp (c - x) + Kf c'.

namespace camber::feedmodel {

struct PositionLoopOptions {
  double gain_per_s = 0;                   ///< Kp; infinite: the axis is where it is commanded
  double velocity_lag_s = 0;               ///< Tv, time constant of the velocity loop; 0: none
  double feed_forward_percent = 0;         ///< Kf
  double acceleration_feed_forward_s = 0;  ///< Ka
  double period_s = 0.001;
};

/// Tv x'' + x' = Kp (c - x) + Kf/100 c' + Ka c''
///
/// solved exactly for a command c that runs straight between two periods (its acceleration is a step of speed at each
/// of them). At a constant speed v the axis is
/// behind by v (1 - Kf/100) / Kp.
/// Source: Yan & Shirase 1997; Takata 1999 (Kp, Kf; docs/feed-model.md); Tv as the traces of real drives show it.
class PositionLoop {
 public:
  PositionLoop(const PositionLoopOptions& options, double start_mm);

  /// Advances by one period in which the command goes from the last one to `command_mm`; returns the position.
  double operator()(double command_mm);
  double position_mm() const { return position_mm_; }
  double velocity_mm_per_s() const { return velocity_mm_per_s_; }

 private:
  PositionLoopOptions options_;
  double command_mm_, position_mm_;
  double command_speed_mm_per_s_ = 0;
  double velocity_mm_per_s_ = 0;
  // Deviation from the steady following, advanced by one period: [z z'] <- [[a b] [c d]] [z z'].
  double a_ = 0, b_ = 0, c_ = 0, d_ = 0;
};

}  // namespace camber::feedmodel
