#pragma once
// Backlash between the motor of an axis and its load.
#include <algorithm>

namespace camber::feedmodel {

/// The load stays until the motor has taken up half the play on either side (play operator): at a reversal `width` of
/// the motion is lost. Begins in the middle. width 0: nothing is changed.
class Backlash {
 public:
  Backlash(double width, double start) : half_(width / 2), load_(start) {}

  double operator()(double motor) {
    if (half_ <= 0) return motor;
    return load_ = std::clamp(load_, motor - half_, motor + half_);
  }

 private:
  double half_, load_;
};

}  // namespace camber::feedmodel
