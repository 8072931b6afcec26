#include "dynamics/zero_order.h"

#include <algorithm>
#include <cmath>

namespace camber::dynamics {
namespace {

using Complex = std::complex<double>;

/// Frequencies that show every resonance: steps of an eighth of the half bandwidth near a mode, of 1 % elsewhere.
std::vector<double> frequencies(const std::vector<Mode>& modes, double highest_hz) {
  constexpr double kWidths = 30, kPerWidth = 8, kRatio = 1.01;
  std::vector<double> hz;
  double lowest = highest_hz;
  for (const Mode& m : modes) {
    lowest = std::min(lowest, m.frequency_hz / 20);
    // Steps grow away from the peak.
    const double width = std::max(m.damping_ratio, 1e-4) * m.frequency_hz;
    for (double d = 0; d < kWidths * width; d += std::max(width, d / 3) / kPerWidth) {
      hz.push_back(m.frequency_hz + d);
      if (d > 0 && d < m.frequency_hz) hz.push_back(m.frequency_hz - d);
    }
  }
  for (double f = lowest; f < highest_hz; f *= kRatio) hz.push_back(f);
  std::ranges::sort(hz);
  const auto last = std::ranges::upper_bound(hz, highest_hz);
  hz.erase(last, hz.end());
  return hz;
}

double highest_mode_hz(const std::vector<Mode>& modes) {
  double f = 0;
  for (const Mode& m : modes) f = std::max(f, m.frequency_hz);
  return f;
}

/// Depth of the border of an eigenvalue whose phase closes a lobe: 1 / (2 sin x |lambda|), x = arg lambda - pi/2.
double closing_depth(Complex lambda) { return -1 / (2 * lambda.real()); }

/// arg lambda - pi/2, in (0, pi) where the real part is negative.
double closing_phase(Complex lambda) {
  const double x = std::arg(lambda) - kPi / 2;
  return x < 0 ? x + 2 * kPi : x;
}

}  // namespace

ZeroOrderLobes::ZeroOrderLobes(std::vector<Mode> modes, Cut cut, double highest_hz)
    : modes_(std::move(modes)),
      cut_(std::move(cut)),
      directional_(static_cast<double>(cut_.pitch_rad.size()) * mean_directional(cut_)),
      highest_hz_(highest_hz > 0 ? highest_hz : 3 * highest_mode_hz(modes_)) {
  sample(highest_hz_);
}

std::array<Complex, 2> ZeroOrderLobes::eigenvalues(double hz) const {
  const Eigen::Matrix2cd m = receptance(modes_, hz) * directional_.cast<Complex>();
  const Complex half = (m(0, 0) + m(1, 1)) / 2.0;
  const Complex root = std::sqrt(half * half - (m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0)));
  return {half + root, half - root};
}

Complex ZeroOrderLobes::eigenvalue_near(double hz, Complex near) const {
  const auto e = eigenvalues(hz);
  return std::abs(e[0] - near) <= std::abs(e[1] - near) ? e[0] : e[1];
}

void ZeroOrderLobes::sample(double highest_hz) {
  std::vector<Sample> a, b;
  for (const double f : frequencies(modes_, highest_hz)) {
    auto e = eigenvalues(f);
    if (!a.empty() && std::abs(e[1] - a.back().eigenvalue) + std::abs(e[0] - b.back().eigenvalue) <
                          std::abs(e[0] - a.back().eigenvalue) + std::abs(e[1] - b.back().eigenvalue))
      std::swap(e[0], e[1]);
    a.push_back({f, e[0]});
    b.push_back({f, e[1]});
  }
  add_branch(a);
  add_branch(b);
}

/// Cuts a branch where the real part changes its sign.
void ZeroOrderLobes::add_branch(const std::vector<Sample>& branch) {
  double largest = 0;
  for (const Sample& s : branch) largest = std::max(largest, std::abs(s.eigenvalue));
  const double none = 1e-9 * largest;
  Stretch stretch;
  const auto border = [&](Sample in, Sample out) {
    for (int i = 0; i < 40; ++i) {
      const double hz = (in.hz + out.hz) / 2;
      const Sample middle{hz, eigenvalue_near(hz, in.eigenvalue)};
      (middle.eigenvalue.real() < -none ? in : out) = middle;
    }
    return in;
  };
  for (std::size_t i = 0; i < branch.size(); ++i) {
    const bool in = branch[i].eigenvalue.real() < -none;
    const bool was_in = i > 0 && branch[i - 1].eigenvalue.real() < -none;
    if (in && !was_in && i > 0) stretch.push_back(border(branch[i], branch[i - 1]));
    if (in) stretch.push_back(branch[i]);
    if (!in && was_in) stretch.push_back(border(branch[i - 1], branch[i]));
    if (!stretch.empty() && (!in || i + 1 == branch.size())) {
      stretches_.push_back(stretch);
      stretch.clear();
    }
  }
}

double ZeroOrderLobes::lowest_depth_mm() const {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Stretch& s : stretches_)
    for (const Sample& p : s) lowest = std::min(lowest, closing_depth(p.eigenvalue));
  return lowest;
}

/// With equal pitches 1 - e^(-i w) = 2 sin(w/2) e^(i (pi - w)/2), w = omega T: the product with lambda is real and
/// negative where w/2 = arg lambda - pi/2 + m pi, and the depth there is -1 / (2 Re lambda).
CriticalDepth ZeroOrderLobes::equal_pitches_at(double speed_rpm) const {
  const double period_s = 60 / speed_rpm / static_cast<double>(cut_.pitch_rad.size());
  const auto turns = [&](const Sample& s) { return s.hz * period_s - closing_phase(s.eigenvalue) / kPi; };
  CriticalDepth best;
  for (const Stretch& s : stretches_)
    for (std::size_t i = 1; i < s.size(); ++i) {
      // Whole numbers of turns between two samples are lobes; the depth goes straight between them.
      if (std::min(closing_depth(s[i - 1].eigenvalue), closing_depth(s[i].eigenvalue)) > 1.5 * best.depth_mm) continue;
      Sample a = s[i - 1], b = s[i];
      const double low = std::min(turns(a), turns(b)), high = std::max(turns(a), turns(b));
      for (double m = std::ceil(low); m <= high && m < low + 1e4; ++m) {
        Sample from = a, to = b;
        for (int k = 0; k < 24; ++k) {
          const double hz = (from.hz + to.hz) / 2;
          const Sample middle{hz, eigenvalue_near(hz, from.eigenvalue)};
          ((turns(middle) < m) == (turns(from) < m) ? from : to) = middle;
        }
        const double depth = closing_depth(to.eigenvalue);
        if (depth > 0 && depth < best.depth_mm) best = {depth, to.hz};
      }
    }
  return best;
}

/// The imaginary part of the depth changes its sign along the frequency.
CriticalDepth ZeroOrderLobes::unequal_pitches_at(double speed_rpm) const {
  const auto teeth = static_cast<double>(cut_.pitch_rad.size());
  const auto factor = [&](double hz) {
    Complex f = 1;
    for (const double p : cut_.pitch_rad) f -= std::polar(1.0, -hz * p * 60 / speed_rpm) / teeth;
    return f;
  };
  const auto depth = [&](double hz, Complex near) { return -1.0 / (factor(hz) * near); };
  // Lobes are a revolution apart.
  const double step = speed_rpm / 60 / 24;
  CriticalDepth best;
  for (int branch = 0; branch < 2; ++branch) {
    Complex near = eigenvalues(step)[static_cast<std::size_t>(branch)];
    Complex before = depth(step, near);
    for (double hz = 2 * step; hz < highest_hz_; hz += step) {
      const Complex next = eigenvalue_near(hz, near), now = depth(hz, next);
      if (now.imag() * before.imag() < 0 && std::max(now.real(), before.real()) > 0) {
        double from = hz - step, to = hz;
        Complex at = near;
        for (int k = 0; k < 30; ++k) {
          const double middle = (from + to) / 2;
          at = eigenvalue_near(middle, at);
          (depth(middle, at).imag() * before.imag() > 0 ? from : to) = middle;
        }
        const Complex b = depth(to, at);
        // A pole changes the sign as well.
        if (b.real() > 0 && std::abs(b.imag()) < 1e-3 * b.real() && b.real() < best.depth_mm) best = {b.real(), to};
      }
      near = next, before = now;
    }
  }
  return best;
}

CriticalDepth ZeroOrderLobes::undamped_at(double speed_rpm) const {
  return has_equal_pitches(cut_) ? equal_pitches_at(speed_rpm) : unequal_pitches_at(speed_rpm);
}

ZeroOrderLobes ZeroOrderLobes::with_damping_at(double depth_mm, double speed_rpm) const {
  Cut undamped = cut_;
  undamped.process_damping_N_per_mm = 0;
  return {with_process_damping(modes_, cut_, depth_mm, speed_rpm), undamped, highest_hz_};
}

/// Process damping grows with the depth: the lowest depth that is critical with its own damping, by bisection.
CriticalDepth ZeroOrderLobes::at(double speed_rpm) const {
  CriticalDepth best = undamped_at(speed_rpm);
  if (cut_.process_damping_N_per_mm <= 0 || !std::isfinite(best.depth_mm)) return best;
  constexpr double kDeepest_mm = 1e4, kExact = 1e-4;
  double low = best.depth_mm, high = low;
  const auto stable = [&](double depth) {
    best = with_damping_at(depth, speed_rpm).undamped_at(speed_rpm);
    return best.depth_mm > depth;
  };
  while (stable(high)) {
    low = high, high *= 1.5;
    if (high > kDeepest_mm) return {};
  }
  while (high - low > kExact * high) {
    const double middle = (low + high) / 2;
    (stable(middle) ? low : high) = middle;
  }
  stable(high);
  return {high, best.chatter_hz};
}

}  // namespace camber::dynamics
