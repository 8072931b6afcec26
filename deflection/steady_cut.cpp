#include "deflection/steady_cut.h"

#include <algorithm>
#include <cmath>

#include "deflection/tool_frame.h"

namespace camber::deflection {
namespace {

// Gauss-Legendre, 8 nodes on [-1, 1].
constexpr double kNodes[] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
constexpr double kWeights[] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
constexpr int kPanels = 4;

EdgeDirections directions(double sine, double cosine, double phi) {
  return edge_directions(sine, cosine, std::sin(phi), std::cos(phi));
}

}  // namespace

SteadyCutModel::SteadyCutModel(const machine::Tool& tool, const SteadyCut& cut, double ring_mm)
    : flutes_(tool.flutes), feed_per_tooth_mm_(cut.feed_per_tooth_mm) {
  const auto envelope = removal::make_envelope(tool, cut.axial_depth_mm, ring_mm, kPi / 6);
  const double wall = tool.diameter_mm / 2 - cut.radial_depth_mm;  // from the axis, towards the work's side
  for (const auto& r : envelope.rings) {
    Ring ring{.radius_mm = r.profile.radius_mm,
              .width_mm = r.width_mm,
              .lag_rad = r.lag_rad,
              .sine = std::sin(r.profile.normal_angle_rad),
              .cosine = std::cos(r.profile.normal_angle_rad)};
    // phi from the feed direction; chips where cos(phi) > 0, work where r sin(phi) > wall on the left.
    if (ring.sine > 1e-9 && wall < ring.radius_mm) {
      const double from = wall > -ring.radius_mm ? std::asin(wall / ring.radius_mm) : -kPi / 2;
      ring.entry_rad = cut.milling == Milling::up ? from : -kPi / 2;
      ring.exit_rad = cut.milling == Milling::up ? kPi / 2 : -from;
      const bool slot = wall <= -ring.radius_mm;
      ring.fades_in = slot || cut.milling == Milling::down;
      ring.fades_out = slot || cut.milling == Milling::up;
      if (cut.circular_chip) {
        ring.meridian_curvature = r.profile.meridian_curvature_per_mm;
        ring.parallel_curvature = r.profile.parallel_curvature_per_mm;
        // f cos(phi) sin(kappa) + k f^2 sin^2(phi) / 2 = 0 close to a right angle.
        const double beyond = std::asin(std::min(0.5, ring.parallel_curvature * feed_per_tooth_mm_ / (2 * ring.sine)));
        if (ring.fades_in) ring.entry_rad -= beyond;
        if (ring.fades_out) ring.exit_rad += beyond;
      }
    }
    if (ring.exit_rad > ring.entry_rad) rings_.push_back(ring);
  }
}

double SteadyCutModel::chip_mm(const Ring& ring, double feed, double phi) {
  const double ahead = feed * std::cos(phi), around = feed * std::sin(phi), up = ahead * ring.cosine;
  return ahead * ring.sine + (ring.parallel_curvature * around * around + ring.meridian_curvature * up * up) / 2;
}

template <class Function>
void SteadyCutModel::integrate(Function f) const {
  for (const Ring& ring : rings_) {
    const double half = (ring.exit_rad - ring.entry_rad) / (2 * kPanels);
    for (int panel = 0; panel < kPanels; ++panel)
      for (int i = 0; i < 4; ++i)
        for (const double side : {-1.0, 1.0}) {
          const double phi = ring.entry_rad + half * (2 * panel + 1 + side * kNodes[i]);
          f(ring, phi, chip_mm(ring, feed_per_tooth_mm_, phi), half * kWeights[i]);
        }
  }
}

Vec3 SteadyCutModel::mean_N(const machine::Material& material) const {
  Vec3 sum = Vec3::Zero();
  integrate([&](const Ring& ring, double phi, double h, double weight) {
    sum += weight * force_on_tool(edge_force(material, h, ring.width_mm), directions(ring.sine, ring.cosine, phi));
  });
  return sum * flutes_ / (2 * kPi);
}

double SteadyCutModel::torque_mean_Nmm(const machine::Material& material) const {
  double sum = 0;
  integrate([&](const Ring& ring, double, double h, double weight) {
    sum += weight * edge_force(material, h, ring.width_mm).tangential_N * ring.radius_mm;
  });
  return sum * flutes_ / (2 * kPi);
}

double SteadyCutModel::chip_mm3() const {
  double sum = 0;
  integrate(
      [&](const Ring& ring, double, double h, double weight) { sum += weight * h * ring.width_mm * ring.radius_mm; });
  return sum;
}

std::vector<Vec3> SteadyCutModel::waveform_N(const machine::Material& material, const RunOut& run_out, double phase_rad,
                                             int steps) const {
  std::vector<Vec3> out(static_cast<std::size_t>(steps), Vec3::Zero());
  const double step = 2 * kPi / steps, pitch = 2 * kPi / flutes_;
  const bool runs_out = !run_out.isZero();
  std::vector<double> ahead(static_cast<std::size_t>(flutes_));  // e_j - e_(j-m)
  for (const Ring& ring : rings_)
    for (int tooth = 0; tooth < flutes_; ++tooth) {
      const double in_tool = tooth * pitch + ring.lag_rad;
      const auto offset = [&](double angle) {
        return ring.sine * (run_out.x() * std::cos(angle) + run_out.y() * std::sin(angle));
      };
      for (int m = 1; m <= flutes_; ++m)
        ahead[static_cast<std::size_t>(m - 1)] = runs_out ? offset(in_tool) - offset(in_tool - m * pitch) : 0;
      const auto chip = [&](double phi) {
        double h = chip_mm(ring, feed_per_tooth_mm_, phi) + ahead[0];
        for (int m = 2; runs_out && m <= flutes_; ++m)
          h = std::min(h, chip_mm(ring, m * feed_per_tooth_mm_, phi) + ahead[static_cast<std::size_t>(m - 1)]);
        return h;
      };
      // The angles at which a tooth that stands out or back begins and ends to cut.
      const auto fade = [&](double in_cut, double in_air) {
        constexpr int kHalvings = 24;
        if (chip(in_cut) <= 0) return in_cut;
        for (int i = 0; i < kHalvings; ++i) {
          const double middle = (in_cut + in_air) / 2;
          (chip(middle) > 0 ? in_cut : in_air) = middle;
        }
        return in_cut;
      };
      constexpr double kReach_rad = 0.5;
      double entry = ring.entry_rad, exit = ring.exit_rad;
      const double inside = std::min(kReach_rad, (exit - entry) / 2);
      if (runs_out && ring.fades_in) entry = fade(entry + inside, entry - kReach_rad);
      if (runs_out && ring.fades_out) exit = fade(exit - inside, exit + kReach_rad);
      // Counter-clockwise from the feed, at the middle of step 0; each step takes it back by `step`.
      const double begin = in_tool - phase_rad - step / 2;
      for (int i = 0; i < steps; ++i) {
        const double middle = std::remainder(begin - i * step, 2 * kPi);
        const double from = std::max(middle - step / 2, entry), to = std::min(middle + step / 2, exit);
        if (to <= from) continue;
        const double phi = (from + to) / 2;
        out[static_cast<std::size_t>(i)] +=
            (to - from) / step *
            force_on_tool(edge_force(material, chip(phi), ring.width_mm), directions(ring.sine, ring.cosine, phi));
      }
    }
  return out;
}

}  // namespace camber::deflection
