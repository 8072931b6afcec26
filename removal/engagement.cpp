#include "removal/engagement.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/vector_clones.h"

namespace camber::removal {

std::vector<ChipSample> chips_of(const EnvelopeBlocks& blocks, std::span<const ChipBlock> chips) {
  std::vector<ChipSample> out;
  for (const ChipBlock& c : chips)
    for (int l = 0; l < EnvelopeBlocks::kLanes; ++l)
      if (const float h = c.thickness_mm[static_cast<std::size_t>(l)]; h > 0)
        out.push_back({blocks.point(c.block, l), h, (c.after_tooth >> l & 1u) != 0, (c.own_surface >> l & 1u) != 0,
                       c.cut_255[static_cast<std::size_t>(l)]});
  return out;
}

double chip_volume_mm3(const EnvelopeGrid& e, std::span<const ChipSample> chips) {
  const double turn = 2 * kPi / e.steps;
  double volume = 0;
  for (const ChipSample& c : chips) {
    const auto& ring = e.rings[c.point / static_cast<std::uint32_t>(e.steps)];
    const double k1 = ring.profile.meridian_curvature_per_mm, k2 = ring.profile.parallel_curvature_per_mm;
    const double h = c.thickness_mm;
    volume += (h - 0.5 * (k1 + k2) * h * h + k1 * k2 * h * h * h / 3) * c.width_fraction() * ring.width_mm *
              ring.profile.radius_mm * turn;
  }
  return volume;
}

namespace {

/// Sums over chips that stand side by side, of share h, share h^2 and share h^3.
struct Powers {
  std::array<double, EnvelopeBlocks::kLanes> h{}, h2{}, h3{};

  double sum(const std::array<double, EnvelopeBlocks::kLanes>& of, int half) const {
    double out = 0;
    for (std::size_t l = 0; l < EnvelopeBlocks::kSteps; ++l)
      out += of[static_cast<std::size_t>(half * EnvelopeBlocks::kSteps) + l];
    return out;
  }
};

CAMBER_VECTOR_CLONES
void add_powers(const ChipBlock* chips, std::size_t count, Powers& sums) {
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t l = 0; l < EnvelopeBlocks::kLanes; ++l) {
      const double h = std::max(0.0f, chips[k].thickness_mm[l]), cut = chips[k].cut_255[l] * h;
      sums.h[l] += cut, sums.h2[l] += cut * h, sums.h3[l] += cut * h * h;
    }
}

}  // namespace

double chip_volume_mm3(const EnvelopeGrid& e, const EnvelopeBlocks& blocks, std::span<const ChipBlock> chips) {
  const double per_255 = 2 * kPi / e.steps / 255;
  const int last = static_cast<int>(e.rings.size()) - 1;
  double volume = 0;
  for (std::size_t from = 0, end = 0; from < chips.size(); from = end) {
    const int lower = blocks.block(chips[from].block).ring;
    while (end < chips.size() && blocks.block(chips[end].block).ring == lower) ++end;
    Powers sums;
    add_powers(chips.data() + from, end - from, sums);
    for (int half = 0; half < EnvelopeBlocks::kRings; ++half) {
      const auto& ring = e.rings[static_cast<std::size_t>(std::min(lower + half, last))];
      const double k1 = ring.profile.meridian_curvature_per_mm, k2 = ring.profile.parallel_curvature_per_mm;
      volume +=
          (sums.sum(sums.h, half) - 0.5 * (k1 + k2) * sums.sum(sums.h2, half) + k1 * k2 * sums.sum(sums.h3, half) / 3) *
          ring.width_mm * ring.profile.radius_mm * per_255;
    }
  }
  return volume;
}

namespace {

/// Deflections of one stamp at rings and rotation steps.
class RingDeflections {
 public:
  RingDeflections(const DeflectionTable& deflections, const float* row) : deflections_(deflections), row_(row) {}

  Vec2 at(const NodeWeight& w, int step) const {
    const Vec2 lower = node(w.lower, step);
    return lower + static_cast<double>(w.upper_fraction) * (node(w.upper, step) - lower);
  }
  /// Derivative of the axial deflection by the rotation step.
  double axial_by_step(int step) const {
    const int last = deflections_.steps - 1;
    const float ahead = deflections_.axial_mm(row_, step == last ? 0 : step + 1);
    const float behind = deflections_.axial_mm(row_, step == 0 ? last : step - 1);
    return static_cast<double>(ahead - behind) / 2;
  }
  /// Derivative of the lateral deflection by the rotation step.
  Vec2 by_step(const NodeWeight& w, int step) const {
    const int last = deflections_.steps - 1;
    return (at(w, step == last ? 0 : step + 1) - at(w, step == 0 ? last : step - 1)) / 2;
  }
  Vec2 by_height(const NodeWeight& w, int step) const {
    if (w.upper == w.lower) return Vec2::Zero();
    return (node(w.upper, step) - node(w.lower, step)) / deflections_.node_height_mm[1];
  }

 private:
  Vec2 node(int node, int step) const {
    const float* v = row_ + 2 * (node * deflections_.steps + step);
    return {v[0], v[1]};
  }
  const DeflectionTable& deflections_;
  const float* row_;
};

}  // namespace

double swept_chip_volume_mm3(const EnvelopeGrid& e, std::span<const ChipSample> chips,
                             const DeflectionTable& deflections, const float* row) {
  constexpr float kLevel = 0.05f;  // nearly on the axis nothing is swept
  constexpr double kMax = 1;       // a deflection that jumps is no slope
  const double turn = 2 * kPi / e.steps;
  const RingDeflections deflection(deflections, row);
  double volume = 0;
  for (const ChipSample& c : chips) {
    const auto& ring = e.rings[c.point / static_cast<std::uint32_t>(e.steps)];
    const double k1 = ring.profile.meridian_curvature_per_mm, k2 = ring.profile.parallel_curvature_per_mm;
    const double h = c.thickness_mm, r = ring.profile.radius_mm;
    double wider = 0;
    if (ring.sine >= kLevel) {
      const NodeWeight w = node_weight(deflections.node_height_mm, ring.profile.height_mm);
      const int step = static_cast<int>(c.point % static_cast<std::uint32_t>(e.steps)) % deflections.steps;
      const Vec2 out(e.cos_phi[c.point], e.sin_phi[c.point]), around(-out.y(), out.x());
      const Vec2 by_angle = deflection.by_step(w, step) / turn;
      const Vec2 by_height = deflection.by_height(w, step) - e.lag_per_mm * by_angle;
      wider = by_angle.dot(around) / r + static_cast<double>(ring.sine * ring.cosine) * by_height.dot(out);
      const double axial_by_height = -e.lag_per_mm * deflection.axial_by_step(step) / turn;
      wider += static_cast<double>(ring.sine * ring.sine) * axial_by_height;
      wider = std::clamp(wider, -kMax, kMax);
    }
    volume += (h - 0.5 * (k1 + k2) * h * h + k1 * k2 * h * h * h / 3) * (1 + wider) * c.width_fraction() *
              ring.width_mm * r * turn;
  }
  return volume;
}

}  // namespace camber::removal
