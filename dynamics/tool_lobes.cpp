#include "dynamics/tool_lobes.h"

#include <algorithm>
#include <cmath>

#include "deflection/edge_force.h"
#include "dynamics/tool_modes.h"
#include "machine/cutter_parameters.h"

namespace camber::dynamics {
namespace {

/// Radius and normal of the profile at a height.
struct ProfileAt {
  double radius_mm = 0, sine = 1, cosine = 0;
};

ProfileAt profile_at(const machine::CutterParameters& p, double z) {
  const machine::CornerEnds ends = machine::corner_ends(p);
  if (z < ends.bottom.y() && p.bottom_angle_rad > 0)
    return {z / std::tan(p.bottom_angle_rad), std::sin(p.bottom_angle_rad), std::cos(p.bottom_angle_rad)};
  if (z < ends.wall.y() && p.corner_radius_mm > 0) {
    const double below = p.corner_centre_z_mm - z,
                 out = std::sqrt(std::max(0.0, std::pow(p.corner_radius_mm, 2) - below * below));
    return {p.corner_centre_r_mm + out, out / p.corner_radius_mm, below / p.corner_radius_mm};
  }
  const double wall = p.diameter_mm / 2 * (1 - std::tan(p.bottom_angle_rad) * std::tan(p.taper_rad)) +
                      std::min(z, p.height_mm) * std::tan(p.taper_rad);
  const bool tapered = p.taper_rad > 0 && z < p.height_mm;
  return {wall, tapered ? std::cos(p.taper_rad) : 1, tapered ? -std::sin(p.taper_rad) : 0};
}

bool straight(const machine::Tool& tool) { return tool.type == machine::ToolType::flat; }

/// The arc of a slice of radius r, the material beginning `inside` from the axis.
CutSlice slice_of(const ProfileAt& at, double inside, Milling milling, const deflection::EdgeForce& k) {
  CutSlice s{.kt_MPa = k.tangential_N, .kr_MPa = k.radial_N * at.sine + k.axial_N * at.cosine};
  const double arc = at.radius_mm > inside ? std::acos(std::clamp(inside / at.radius_mm, -1.0, 1.0)) : 0;
  s.entry_rad = milling == Milling::up ? 0 : kPi - arc;
  s.exit_rad = s.entry_rad + arc;
  return s;
}

/// Semi-discretised: the first depth of a grid with a multiplier beyond 1, then by bisection.
LobePoint rounded_semi(const LobeRequest& r, const std::vector<double>& depths, double rpm) {
  const auto multiplier = [&](double b) { return dominant_multiplier(r.modes, cut_at_depth(r, b), rpm, b); };
  double stable = 0;
  for (const double b : depths) {
    if (std::abs(multiplier(b)) <= 1) {
      stable = b;
      continue;
    }
    double unstable = b;
    constexpr double kExact = 1e-3;
    while (unstable - stable > kExact * unstable) {
      const double middle = (stable + unstable) / 2;
      (std::abs(multiplier(middle)) > 1 ? unstable : stable) = middle;
    }
    const Cut cut = cut_at_depth(r, unstable);
    const SemiBorder border = semi_border(r.modes, cut, rpm);
    return {rpm, {unstable, border.critical.chatter_hz}, border.border};
  }
  return {rpm, {}, StabilityBorder::none};
}

/// Limit of zero order: where the critical depth of a depth's cut falls below the depth.
LobePoint rounded_zero(const std::vector<ZeroOrderLobes>& lobes, const std::vector<double>& depths, double rpm) {
  CriticalDepth before;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const CriticalDepth now = lobes[i].at(rpm);
    if (now.depth_mm <= depths[i]) {
      // log(critical / depth) goes straight between depths.
      if (i == 0 || !std::isfinite(before.depth_mm)) return {rpm, now, StabilityBorder::hopf};
      const double a = std::log(before.depth_mm / depths[i - 1]), b = std::log(now.depth_mm / depths[i]);
      const double depth = depths[i - 1] * std::pow(depths[i] / depths[i - 1], a / (a - b));
      return {rpm, {depth, now.chatter_hz}, StabilityBorder::hopf};
    }
    before = now;
  }
  return {rpm, {}, StabilityBorder::none};
}

std::vector<LobePoint> rounded_lobes(const LobeRequest& r, const std::vector<double>& speeds) {
  constexpr int kDepths = 60;
  const double longest = std::min(r.tool.flute_length_mm.value_or(r.tool.overhang_mm), r.tool.overhang_mm);
  const double first = 0.002 * r.tool.diameter_mm;
  std::vector<double> depths;
  for (int i = 0; i <= kDepths; ++i) depths.push_back(first * std::pow(longest / first, i / double{kDepths}));
  std::vector<ZeroOrderLobes> lobes;
  if (r.method == LobeMethod::zero_order)
    for (const double b : depths) lobes.emplace_back(r.modes, cut_at_depth(r, b));
  std::vector<LobePoint> out;
  for (const double rpm : speeds)
    out.push_back(r.method == LobeMethod::zero_order ? rounded_zero(lobes, depths, rpm) : rounded_semi(r, depths, rpm));
  return out;
}

}  // namespace

Cut cut_at_depth(const LobeRequest& r, double depth) {
  Cut cut = teeth_of(r.tool);
  cut.process_damping_N_per_mm = r.process_damping_N_per_mm;
  const deflection::EdgeForce k = deflection::edge_force_slope(r.material, r.chip_mm);
  if (straight(r.tool)) {
    cut.slices = {shoulder(r.radial_mm / r.tool.diameter_mm, r.milling, k.tangential_N, k.radial_N)};
    return cut;
  }
  const machine::CutterParameters p = machine::parameters_of(r.tool);
  const double inside = profile_at(p, depth).radius_mm;
  const double from_axis = std::max(inside, r.tool.diameter_mm / 2) - r.radial_mm;
  for (int i = 0; i < kEndSlices; ++i) {
    const double from = i / double{kEndSlices}, to = (i + 1) / double{kEndSlices};
    CutSlice s = slice_of(profile_at(p, (from + to) / 2 * depth), from_axis, r.milling, k);
    s.from = from, s.to = to;
    if (s.exit_rad > s.entry_rad) cut.slices.push_back(s);
  }
  return cut;
}

std::vector<LobePoint> tool_lobes(const LobeRequest& r, const std::vector<double>& speeds) {
  if (!straight(r.tool)) return rounded_lobes(r, speeds);
  const Cut cut = cut_at_depth(r, 1);
  std::vector<LobePoint> out;
  if (r.method == LobeMethod::zero_order) {
    const ZeroOrderLobes lobes(r.modes, cut);
    for (const double rpm : speeds) {
      const CriticalDepth c = lobes.at(rpm);
      out.push_back({rpm, c, std::isfinite(c.depth_mm) ? StabilityBorder::hopf : StabilityBorder::none});
    }
    return out;
  }
  for (const double rpm : speeds) {
    const SemiBorder b = semi_border(r.modes, cut, rpm);
    out.push_back({rpm, b.critical, b.border});
  }
  return out;
}

}  // namespace camber::dynamics
