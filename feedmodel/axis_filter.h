#pragma once
// Linear acceleration after interpolation: a moving average over a window of time.
#include <cstddef>
#include <vector>

#include "base/geometry.h"

namespace camber::feedmodel {

/// Mean of the last `window` commands of one axis (a step of speed becomes a linear ramp of window x period).
/// Source: KAKEN report, eqs. 4-5 (a ramp of 64 ms). window 0 or 1: nothing is changed.
class AxisFilter {
 public:
  AxisFilter(std::size_t window, double start_mm) : ring_(window, start_mm), mean_mm_(start_mm) {}

  double operator()(double command_mm) {
    if (ring_.size() < 2) return command_mm;
    mean_mm_ += (command_mm - ring_[at_]) / static_cast<double>(ring_.size());
    ring_[at_] = command_mm;
    if (++at_ == ring_.size()) {
      at_ = 0;
      double sum = 0;  // summed anew once a turn, so that rounding does not gather
      for (double v : ring_) sum += v;
      mean_mm_ = sum / static_cast<double>(ring_.size());
    }
    return mean_mm_;
  }

 private:
  std::vector<double> ring_;
  std::size_t at_ = 0;
  double mean_mm_;
};

}  // namespace camber::feedmodel
