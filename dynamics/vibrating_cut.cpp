#include "dynamics/vibrating_cut.h"

#include <cmath>

namespace camber::dynamics {

std::vector<double> equal_pitches(int teeth) {
  return std::vector<double>(static_cast<std::size_t>(teeth), 2 * kPi / teeth);
}

bool has_equal_pitches(const Cut& cut) {
  constexpr double kSame_rad = 1e-9;
  for (const double p : cut.pitch_rad)
    if (std::abs(p - cut.pitch_rad.front()) > kSame_rad) return false;
  return true;
}

CutSlice shoulder(double radial_fraction, Milling milling, double kt, double kr) {
  CutSlice s{.kt_MPa = kt, .kr_MPa = kr};
  s.entry_rad = milling == Milling::up ? 0 : std::acos(2 * radial_fraction - 1);
  s.exit_rad = milling == Milling::up ? std::acos(1 - 2 * radial_fraction) : kPi;
  return s;
}

DirectionalIntegral::DirectionalIntegral(const CutSlice& s)
    : entry_(s.entry_rad), arc_(s.exit_rad - s.entry_rad), kt_(s.kt_MPa), kr_(s.kr_MPa) {
  primitive_at_entry_ = primitive(entry_);
  second_primitive_at_entry_ = second_primitive(entry_);
  arc_first_ = primitive(entry_ + arc_) - primitive_at_entry_;
  arc_second_ = second_primitive(entry_ + arc_) - second_primitive_at_entry_ - arc_ * primitive_at_entry_;
  turn_first_ = first_in_turn(2 * kPi);
  turn_second_ = second_in_turn(2 * kPi);
}

// W = [[Kt sc + Kr ss, Kt cc + Kr sc], [-Kt ss + Kr sc, -Kt sc + Kr cc]], s = sin phi, c = cos phi.
Eigen::Matrix2d DirectionalIntegral::primitive(double phi) const {
  const double sine = std::sin(2 * phi) / 4, ss = phi / 2 - sine, cc = phi / 2 + sine, sc = -std::cos(2 * phi) / 4;
  return Eigen::Matrix2d{{kt_ * sc + kr_ * ss, kt_ * cc + kr_ * sc}, {-kt_ * ss + kr_ * sc, -kt_ * sc + kr_ * cc}};
}

Eigen::Matrix2d DirectionalIntegral::second_primitive(double phi) const {
  const double cosine = std::cos(2 * phi) / 8, ss = phi * phi / 4 + cosine, cc = phi * phi / 4 - cosine;
  const double sc = -std::sin(2 * phi) / 8;
  return Eigen::Matrix2d{{kt_ * sc + kr_ * ss, kt_ * cc + kr_ * sc}, {-kt_ * ss + kr_ * sc, -kt_ * sc + kr_ * cc}};
}

/// r: angle beyond the entry, 0 to 2 pi.
Eigen::Matrix2d DirectionalIntegral::first_in_turn(double r) const {
  return r < arc_ ? Eigen::Matrix2d(primitive(entry_ + r) - primitive_at_entry_) : arc_first_;
}

Eigen::Matrix2d DirectionalIntegral::second_in_turn(double r) const {
  if (r > arc_) return arc_second_ + (r - arc_) * arc_first_;
  return second_primitive(entry_ + r) - second_primitive_at_entry_ - r * primitive_at_entry_;
}

Eigen::Matrix2d DirectionalIntegral::first(double phi) const {
  const double turns = std::floor((phi - entry_) / (2 * kPi)), r = phi - entry_ - 2 * kPi * turns;
  return turns * turn_first_ + first_in_turn(r);
}

Eigen::Matrix2d DirectionalIntegral::second(double phi) const {
  const double turns = std::floor((phi - entry_) / (2 * kPi)), r = phi - entry_ - 2 * kPi * turns;
  return turns * turn_second_ + (kPi * turns * (turns - 1) + turns * r) * turn_first_ + second_in_turn(r);
}

Eigen::Matrix2d mean_directional(const Cut& cut) {
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (const CutSlice& s : cut.slices) sum += (s.to - s.from) / (2 * kPi) * DirectionalIntegral(s).per_turn();
  return sum;
}

Eigen::Matrix2cd receptance(std::span<const Mode> modes, double frequency_hz) {
  Eigen::Matrix2cd g = Eigen::Matrix2cd::Zero();
  for (const Mode& m : modes) {
    const double r = frequency_hz / m.frequency_hz;
    const std::complex<double> below(1 - r * r, 2 * m.damping_ratio * r);
    g += (m.direction * m.direction.transpose()).cast<std::complex<double>>() / (m.stiffness_N_per_mm * below);
  }
  return g;
}

std::vector<Mode> with_process_damping(std::span<const Mode> modes, const Cut& cut, double depth, double speed_rpm) {
  std::vector<Mode> damped(modes.begin(), modes.end());
  if (cut.process_damping_N_per_mm <= 0) return damped;
  // With Kt = 0 and Kr = 1, W is n n^T.
  Cut normals = cut;
  for (CutSlice& s : normals.slices) s.kt_MPa = 0, s.kr_MPa = 1;
  const double speed_mm_per_s = 2 * kPi * cut.radius_mm * speed_rpm / 60;
  const double c = cut.process_damping_N_per_mm * depth / speed_mm_per_s * static_cast<double>(cut.pitch_rad.size());
  const Eigen::Matrix2d damping = c * mean_directional(normals);  // N s/mm
  for (Mode& m : damped) {
    const double omega = 2 * kPi * m.frequency_hz;
    // 2 zeta k / omega is the damping of a mode.
    m.damping_ratio += m.direction.dot(damping * m.direction) * omega / (2 * m.stiffness_N_per_mm);
  }
  return damped;
}

}  // namespace camber::dynamics
