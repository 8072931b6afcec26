#pragma once
// A dynamometer for tests: forces of a flat end mill in a shoulder or a slot, step by step in time, slow and obvious.
// It shares nothing with the product: edges are cut in slices of equal height, and a chip reaches from the edge to the
// deepest of the circles that the earlier teeth have left, each about its own centre.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace camber::testing {

struct SimulatedCut {
  double radius_mm = 10, helix_rad = 0, axial_depth_mm = 2, radial_depth_mm = 20;
  int flutes = 2;
  bool up = true;  ///< the work lies to the left of the feed
  double feed_per_tooth_mm = 0.05, rpm = 3000;
  double ktc = 0, krc = 0, kac = 0, kte = 0, kre = 0, kae = 0;
  double kienzle_m = 0;                    ///< K = k h^-m in place of k
  double run_out_mm = 0, run_out_rad = 0;  ///< offset of the cutter's axis, angle from tooth 1's edge at the tip
  double start_rad = 0;                    ///< angle of tooth 1 at t = 0, clockwise from the feed
};

struct ForceSample {
  double t_s = 0, x_N = 0, y_N = 0, z_N = 0;  ///< on the tool: feed, left of it, up
};

inline ForceSample simulate_at(const SimulatedCut& c, double t_s) {
  constexpr int kSlices = 60;
  const double pi = std::acos(-1.0);
  ForceSample out{t_s};
  const double turned = c.start_rad + 2 * pi * c.rpm / 60 * t_s, dz = c.axial_depth_mm / kSlices;
  for (int slice = 0; slice < kSlices; ++slice)
    for (int j = 0; j < c.flutes; ++j) {
      const double z = (slice + 0.5) * dz;
      const auto radius_of = [&](int tooth) {  // of the edge at this height, about the spindle's axis
        const double in_tool = 2 * pi * tooth / c.flutes + z * std::tan(c.helix_rad) / c.radius_mm;
        return c.radius_mm + c.run_out_mm * std::cos(in_tool - c.run_out_rad);
      };
      const double angle = 2 * pi * j / c.flutes + z * std::tan(c.helix_rad) / c.radius_mm - turned;
      const double r = radius_of(j), px = std::cos(angle), py = std::sin(angle);
      const double side = c.up ? r * py : -r * py;
      if (side < c.radius_mm - c.radial_depth_mm) continue;
      // How far from our centre, along our own radius, the circle of the tooth m passings ago reaches.
      double left = -1e9;
      for (int m = 1; m <= 3 * c.flutes; ++m) {
        const double back = m * c.feed_per_tooth_mm, rm = radius_of(j - m);
        const double across = back * py;
        left = std::max(left, -back * px + std::sqrt(rm * rm - across * across));
      }
      const double h = r - left;
      if (h <= 0 || px <= 0) continue;
      const double k = c.kienzle_m > 0 ? std::pow(h, -c.kienzle_m) : 1;
      const double ft = (c.ktc * k * h + c.kte) * dz, fr = (c.krc * k * h + c.kre) * dz,
                   fa = (c.kac * k * h + c.kae) * dz;
      // The edge moves clockwise: along (sin, -cos).
      out.x_N -= ft * py + fr * px;
      out.y_N -= -ft * px + fr * py;
      out.z_N -= fa;
    }
  return out;
}

/// `seconds` of samples at `rate_Hz`, with noise of this standard deviation.
inline std::vector<ForceSample> simulate(const SimulatedCut& c, double seconds, double rate_Hz, double noise_N,
                                         std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 1);
  std::vector<ForceSample> out;
  for (int i = 0; i < static_cast<int>(seconds * rate_Hz); ++i) {
    ForceSample s = simulate_at(c, i / rate_Hz);
    s.x_N += noise_N * noise(random);
    s.y_N += noise_N * noise(random);
    s.z_N += noise_N * noise(random);
    out.push_back(s);
  }
  return out;
}

}  // namespace camber::testing
