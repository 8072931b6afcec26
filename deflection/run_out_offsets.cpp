#include "deflection/run_out_offsets.h"

#include <cassert>
#include <cmath>

namespace camber::deflection {

RunOutOffsets::RunOutOffsets(const Teeth& teeth, int steps_per_pitch)
    : steps_(static_cast<std::size_t>(steps_per_pitch)), teeth_(static_cast<std::size_t>(teeth.count())) {
  assert(teeth.evenly_spaced());
  if (teeth.runout_mm() == 0) return;
  const int turn = steps_per_pitch * teeth.count();
  for (int passing = 0; passing < teeth.count(); ++passing)
    for (int m = 0; m < steps_per_pitch; ++m) {
      // Tooth 0, from which the run-out's direction counts, stands `passing` pitches ahead of step m.
      const double at = 2 * kPi * (m - passing * steps_per_pitch) / turn + teeth.runout_angle_rad();
      offset_mm_.push_back(teeth.runout_mm() * Vec2(std::cos(at), std::sin(at)));
    }
}

std::span<const Vec2> RunOutOffsets::of(std::size_t passing) const {
  if (none()) return {};
  return std::span(offset_mm_).subspan(passing % teeth_ * steps_, steps_);
}

void RunOutOffsets::add(std::size_t passing, float times, std::size_t nodes, std::span<float> row) const {
  if (none()) return;
  const auto offsets = of(passing);
  for (std::size_t n = 0; n < nodes; ++n)
    for (std::size_t m = 0; m < steps_; ++m)
      for (std::size_t a = 0; a < 2; ++a)
        row[2 * (n * steps_ + m) + a] += times * static_cast<float>(offsets[m][static_cast<Eigen::Index>(a)]);
}

}  // namespace camber::deflection
