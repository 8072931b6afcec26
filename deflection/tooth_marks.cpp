#include "deflection/run_out_offsets.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace camber::deflection {

ToothMarks::ToothMarks(const removal::EnvelopeGrid& envelope, const Teeth& teeth)
    : teeth_(teeth), steps_per_pitch_(envelope.steps_per_pitch) {
  envelope_.shape = envelope.shape;
  envelope_.flutes = 1;
  envelope_.steps = envelope_.steps_per_pitch = envelope.steps;
  envelope_.lag_per_mm = envelope.lag_per_mm;
}

int ToothMarks::instant(std::size_t passing, int point, int steps) const {
  const int teeth = teeth_.count(), pitch = steps / teeth, fine = pitch / steps_per_pitch_;
  const int tooth = (point / pitch + static_cast<int>(passing % static_cast<std::size_t>(teeth))) % teeth;
  return point % pitch - (teeth_.offset_steps(tooth, envelope_.steps) * fine - tooth * pitch);
}

removal::DeflectionTable ToothMarks::bending(const removal::DeflectionTable& deflections, std::size_t from,
                                             std::size_t count, std::size_t passing) const {
  const int pitch = deflections.steps, turn = pitch * teeth_.count();
  removal::DeflectionTable out(count, turn, deflections.node_height_mm, deflections.axial);
  out.edges_end_mm = deflections.edges_end_mm;
  const auto last = static_cast<std::ptrdiff_t>(deflections.stamps) - 1;
  for (std::size_t k = 0; k < count; ++k) {
    const auto stamp = static_cast<std::ptrdiff_t>(from + k);
    float* to = out.row(static_cast<std::ptrdiff_t>(k));
    for (int point = 0; point < turn; ++point) {
      const int m = instant(passing + k, point, turn);
      const int later = m < 0 ? (pitch - 1 - m) / pitch : -(m / pitch);  // passings
      const float* row = deflections.row(std::clamp(stamp + later, std::ptrdiff_t{-1}, last));
      for (std::size_t n = 0; n < out.nodes(); ++n) {
        const float* v = row + 2 * (static_cast<int>(n) * pitch + m + later * pitch);
        std::copy_n(v, 2, to + 2 * (static_cast<int>(n) * turn + point));
      }
      if (out.axial)
        removal::AxialRow({to + out.lateral_size(), static_cast<std::size_t>(2 * turn)})
            .set(static_cast<std::size_t>(point), static_cast<double>(deflections.axial_mm(row, m + later * pitch)));
    }
  }
  return out;
}

void ToothMarks::add_run_out(removal::DeflectionTable& deflections, std::size_t passing) const {
  if (teeth_.runout_mm() == 0) return;
  const int turn = deflections.steps, pitch = turn / teeth_.count();
  std::vector<Eigen::Vector2f> offset;  // by the place of tooth 0, from which the run-out's direction counts
  for (int i = 0; i < turn; ++i) {
    const double at = 2 * kPi * i / turn + teeth_.runout_angle_rad();
    offset.push_back((teeth_.runout_mm() * Vec2(std::cos(at), std::sin(at))).cast<float>());
  }
  for (std::size_t k = 0; k < deflections.stamps; ++k) {
    const int gone = static_cast<int>((passing + k) % static_cast<std::size_t>(teeth_.count())) * pitch;
    float* row = deflections.row(static_cast<std::ptrdiff_t>(k));
    for (int point = 0; point < turn; ++point) {
      const int tooth_0 = ((instant(passing + k, point, turn) - gone) % turn + turn) % turn;
      const Eigen::Vector2f& e = offset[static_cast<std::size_t>(tooth_0)];
      for (std::size_t n = 0; n < deflections.nodes(); ++n) {
        float* v = row + 2 * (static_cast<int>(n) * turn + point);
        v[0] += e.x(), v[1] += e.y();
      }
    }
  }
}

}  // namespace camber::deflection
