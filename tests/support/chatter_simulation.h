#pragma once
// Milling with a vibrating tool in time, slow and obvious: small steps, the surface that the last three teeth left,
// teeth that leave the chip when they swing out of it. Of Camber's stability theory nothing is taken.
#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Core>

namespace camber::testing {

struct VibratingMode {
  Eigen::Vector2d direction;
  double hz = 0, zeta = 0, k_N_per_mm = 0;
};

struct VibratingCut {
  std::vector<VibratingMode> modes;
  int teeth = 2;
  double entry_rad = 0, exit_rad = 0;  ///< clockwise from +y; the feed along +x
  double kt_MPa = 0, kr_MPa = 0;
  double depth_mm = 0, lag_rad_per_mm = 0, speed_rpm = 0;
};

struct VibrationVerdict {
  bool chatters = false;
  double late_over_early = 0;  ///< differences from tooth to tooth: of the last fifth over the third
};

/// Feeds in over 100 teeth, so that no jump throws the tool into another motion, and gets a small blow.
inline VibrationVerdict simulate_chatter(const VibratingCut& c, int tooth_periods = 400, int slices = 12) {
  constexpr double kFeed_mm = 0.1, kBlow = 1e-4;
  constexpr int kMemory = 3, kRamp = 100;
  const double period_s = 60 / c.speed_rpm / c.teeth;
  double highest = 0;
  for (const auto& m : c.modes) highest = std::max(highest, m.hz);
  const double arc_s = (c.exit_rad - c.entry_rad) / (2 * M_PI) * 60 / c.speed_rpm;
  const int steps = static_cast<int>(std::ceil(std::max({60.0, 80 * highest * period_s, 30 * period_s / arc_s})));
  const double dt = period_s / steps, turn = 2 * M_PI / c.teeth / steps;
  if (c.lag_rad_per_mm == 0) slices = 1;
  // Each mode follows a force that is constant over a step exactly.
  struct Step {
    Eigen::Matrix2d free;
    Eigen::Vector2d push, state;
  };
  std::vector<Step> modes;
  for (const auto& m : c.modes) {
    const double w = 2 * M_PI * m.hz, wd = w * std::sqrt(1 - m.zeta * m.zeta), e = std::exp(-m.zeta * w * dt);
    const double co = e * std::cos(wd * dt), si = e * std::sin(wd * dt) / wd;
    Step s;
    s.free << co + m.zeta * w * si, si, -w * w * si, co - m.zeta * w * si;
    s.push = (Eigen::Matrix2d::Identity() - s.free) * Eigen::Vector2d(1 / m.k_N_per_mm, 0);
    s.state = Eigen::Vector2d(kBlow, 0);
    modes.push_back(s);
  }
  const int total = tooth_periods * steps;
  std::vector<Eigen::Vector2d> place(static_cast<std::size_t>(total + 1), Eigen::Vector2d::Zero());
  const auto feed_in = [&](int step) { return kFeed_mm * std::min(1.0, static_cast<double>(step) / steps / kRamp); };
  const auto force_at = [&](int i, const Eigen::Vector2d& now) {
    Eigen::Vector2d force = Eigen::Vector2d::Zero();
    for (int s = 0; s < slices; ++s)
      for (int j = 0; j < c.teeth; ++j) {
        double phi = turn * i - 2 * M_PI / c.teeth * j - c.lag_rad_per_mm * c.depth_mm * (s + 0.5) / slices;
        phi -= 2 * M_PI * std::floor(phi / (2 * M_PI));
        if (phi < c.entry_rad || phi > c.exit_rad) continue;
        const double si = std::sin(phi), co = std::cos(phi);
        double chip = 1e9;
        for (int k = 1; k <= kMemory; ++k) {
          const int before = i - k * steps;
          const Eigen::Vector2d was = before >= 0 ? place[static_cast<std::size_t>(before)] : Eigen::Vector2d::Zero();
          chip = std::min(chip, k * feed_in(i) * si + (now - was).dot(Eigen::Vector2d(si, co)));
        }
        if (chip <= 0) continue;
        const double b = c.depth_mm / slices;
        force -= b * chip * (c.kt_MPa * Eigen::Vector2d(co, -si) + c.kr_MPa * Eigen::Vector2d(si, co));
      }
    return force;
  };
  const auto put = [&](int i, const Eigen::Vector2d& force, bool keep) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (std::size_t m = 0; m < modes.size(); ++m) {
      const Eigen::Vector2d next = modes[m].free * modes[m].state + modes[m].push * force.dot(c.modes[m].direction);
      sum += next(0) * c.modes[m].direction;
      if (keep) modes[m].state = next;
    }
    place[static_cast<std::size_t>(i)] = sum;
    return sum;
  };
  for (std::size_t m = 0; m < modes.size(); ++m) place[0] += modes[m].state(0) * c.modes[m].direction;
  for (int i = 0; i < total; ++i) {
    // The force of the middle of the step: from its beginning and a first guess of its end.
    const Eigen::Vector2d begin = force_at(i, place[static_cast<std::size_t>(i)]);
    const Eigen::Vector2d guess = put(i + 1, begin, false);
    put(i + 1, 0.5 * (begin + force_at(i + 1, guess)), true);
  }
  const auto unrest = [&](double from, double to) {
    double sum = 0;
    int n = 0;
    for (int t = static_cast<int>(from * tooth_periods); t < static_cast<int>(to * tooth_periods); ++t, ++n)
      sum += (place[static_cast<std::size_t>(t * steps)] - place[static_cast<std::size_t>((t - 1) * steps)]).norm();
    return sum / n;
  };
  const double early = unrest(0.4, 0.6), late = unrest(0.8, 1.0);
  // What has died away is rounding.
  const bool grows = late > early && late > 1e-6 * kFeed_mm;
  return {grows || late > 0.02 * kFeed_mm, late / early};
}

}  // namespace camber::testing
