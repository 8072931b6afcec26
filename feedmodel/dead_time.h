#pragma once
// Delays the command of an axis by its dead time, before the position loop.
#include <cmath>
#include <cstddef>
#include <vector>

namespace camber::feedmodel {

/// Commands `periods` periods ago, which need not be whole: between two of them the command runs straight.
class DeadTime {
 public:
  DeadTime(double periods, double start)
      : whole_(static_cast<std::size_t>(periods)),
        fraction_(periods - std::floor(periods)),
        ring_(periods > 0 ? whole_ + 2 : 0, start) {}

  double operator()(double command) {
    if (ring_.empty()) return command;
    ring_[at_] = command;
    const std::size_t n = ring_.size(), later = (at_ + n - whole_) % n, earlier = (later + n - 1) % n;
    at_ = (at_ + 1) % n;
    return (1 - fraction_) * ring_[later] + fraction_ * ring_[earlier];
  }

 private:
  std::size_t whole_;
  double fraction_;
  std::vector<double> ring_;
  std::size_t at_ = 0;
};

}  // namespace camber::feedmodel
