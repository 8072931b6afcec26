#include "deflection/teeth.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace camber::deflection {

Teeth::Teeth(const machine::Tool& tool) : runout_mm_(tool.runout_mm), runout_angle_rad_(tool.runout_angle_rad) {
  const double mean = 2 * kPi / tool.flutes;
  double at = 0;
  for (int j = 0; j < tool.flutes; ++j) {
    const double pitch = tool.pitch_rad.empty() ? mean : tool.pitch_rad[static_cast<std::size_t>(j)];
    offset_rad_.push_back(at);
    pitch_fraction_.push_back(pitch / mean);
    at += pitch;
    evenly_spaced_ = evenly_spaced_ && std::abs(pitch - mean) < 1e-9;
  }
  even_ = evenly_spaced_ && runout_mm_ == 0;
}

Teeth Teeth::without_run_out() const {
  Teeth out = *this;
  out.runout_mm_ = 0, out.even_ = evenly_spaced_;
  return out;
}

int Teeth::offset_steps(int tooth, int steps) const {
  return static_cast<int>(std::lround(offset_rad(tooth) * steps / (2 * kPi)));
}

double Teeth::tooth_runout_mm(int tooth, double lag_rad) const {
  return runout_mm_ * std::cos(offset_rad(tooth) + lag_rad - runout_angle_rad_);
}

double Teeth::max_runout_mm(double lag_rad) const {
  double most = -std::numeric_limits<double>::infinity();
  for (int j = 0; j < count(); ++j) most = std::max(most, tooth_runout_mm(j, lag_rad));
  return most;
}

double Teeth::room_mm(int tooth, double even_chip_mm, double sine, double lag_rad, double bulge_mm) const {
  const int n = count();
  const double own = tooth_runout_mm(tooth, lag_rad);
  double chip = std::numeric_limits<double>::infinity(), pitches = 0;
  for (int m = 1; m <= n; ++m) {
    const int before = ((tooth - m) % n + n) % n;
    pitches += pitch_fraction_[static_cast<std::size_t>(before)];
    chip = std::min(
        chip, pitches * (even_chip_mm + (pitches - 1) * bulge_mm) + sine * (own - tooth_runout_mm(before, lag_rad)));
  }
  return chip;
}

}  // namespace camber::deflection
