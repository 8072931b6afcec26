#include "feedmodel/drive.h"

#include <cmath>

namespace camber::feedmodel {

PositionLoop::PositionLoop(const PositionLoopOptions& options, double start_mm)
    : options_(options), command_mm_(start_mm), position_mm_(start_mm) {
  const double t = options_.period_s, kp = options_.gain_per_s, tv = options_.velocity_lag_s;
  if (std::isinf(kp)) return;
  if (tv <= 0) {
    a_ = std::exp(-kp * t);
    c_ = -kp * a_;
    return;
  }
  // Tv z'' + z' + Kp z = 0. With m = 1/(2 Tv) and w^2 = m^2 - Kp/Tv (or its negative):
  // z = e^(-m t) (z0 C + (z0' + m z0) S), C = cosh wt, S = sinh(wt)/w, or cos and sin, or 1 and t.
  const double m = 0.5 / tv, q = m * m - kp / tv, decay = std::exp(-m * t);
  double C = 1, S = t;
  if (q > 0) {
    const double w = std::sqrt(q);
    C = std::cosh(w * t);
    S = std::sinh(w * t) / w;
  } else if (q < 0) {
    const double w = std::sqrt(-q);
    C = std::cos(w * t);
    S = std::sin(w * t) / w;
  }
  a_ = decay * (C + m * S);
  b_ = decay * S;
  c_ = -decay * S * kp / tv;
  d_ = decay * (C - m * S);
}

double PositionLoop::operator()(double command_mm) {
  const double speed = (command_mm - command_mm_) / options_.period_s;
  if (std::isinf(options_.gain_per_s)) {
    position_mm_ = command_mm;
    velocity_mm_per_s_ = speed;
  } else {
    const double step = options_.acceleration_feed_forward_s * (speed - command_speed_mm_per_s_);
    (options_.velocity_lag_s > 0 ? velocity_mm_per_s_ : position_mm_) +=
        options_.velocity_lag_s > 0 ? step / options_.velocity_lag_s : step;
    const double behind = speed * (1.0 - options_.feed_forward_percent / 100.0) / options_.gain_per_s;
    const double z = position_mm_ - (command_mm_ - behind), dz = velocity_mm_per_s_ - speed;
    position_mm_ = command_mm - behind + a_ * z + b_ * dz;
    velocity_mm_per_s_ = speed + c_ * z + d_ * dz;
  }
  command_mm_ = command_mm;
  command_speed_mm_per_s_ = speed;
  return position_mm_;
}

}  // namespace camber::feedmodel
