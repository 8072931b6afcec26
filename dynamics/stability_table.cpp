#include "dynamics/stability_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <tbb/parallel_for.h>

#include "base/cancel.h"
#include "dynamics/semi_discretisation.h"

namespace camber::dynamics {
namespace {

constexpr int kArcs = 60;       // arcs grow with the square of their number: short ones matter more
constexpr int kCentres = 16;    // of half a turn
constexpr double kRatio = 0.1;  // of kr / kt, between nodes
constexpr double kNodeKt_MPa = 1000;

double arc_of(int i) { return 2 * kPi * (static_cast<double>(i) / kArcs) * (static_cast<double>(i) / kArcs); }

/// Node below a value and how far beyond it.
struct Between {
  int node = 0;
  double way = 0;
};
Between between_nodes(double at) {
  const double below = std::floor(at);
  const double way = at - below;
  constexpr double kOnNode = 1e-3;
  if (way > 1 - kOnNode) return {static_cast<int>(below) + 1, 0};
  return {static_cast<int>(below), way < kOnNode ? 0 : way};
}

Between arc_between(double arc) {
  const double at = kArcs * std::sqrt(std::clamp(arc / (2 * kPi), 0.0, 1.0));
  const int below = std::min(static_cast<int>(at), kArcs - 1);
  return {below, (arc - arc_of(below)) / (arc_of(below + 1) - arc_of(below))};
}

/// With the critical depth proportional to the damping of the mode that is heard, which grows by a part per depth:
/// b = b_0 (1 + g b), unbounded where g b_0 reaches 1.
double depth_with_process_damping(const CriticalDepth& undamped, const std::vector<Mode>& modes, const Cut& cut,
                                  double speed_rpm) {
  const auto far = [&](const Mode& m) { return std::abs(m.frequency_hz - undamped.chatter_hz); };
  const auto heard = std::ranges::min_element(modes, {}, far) - modes.begin();
  const auto damped = with_process_damping(modes, cut, 1, speed_rpm);
  const auto i = static_cast<std::size_t>(heard);
  const double growth = damped[i].damping_ratio / modes[i].damping_ratio - 1;
  const double left = 1 - growth * undamped.depth_mm;
  return left > 0 ? undamped.depth_mm / left : std::numeric_limits<double>::infinity();
}

bool alike_in_x_and_y(std::span<const Mode> modes) {
  constexpr double kSame = 1e-9;
  for (const Mode& m : modes) {
    const Eigen::Matrix2cd g = receptance(modes, m.frequency_hz);
    if (std::abs(g(0, 0) - g(1, 1)) > kSame * std::abs(g(0, 0)) || std::abs(g(0, 1)) > kSame * std::abs(g(0, 0)))
      return false;
  }
  return true;
}

}  // namespace

StabilityTable::StabilityTable(std::vector<Mode> modes, Cut tool, double speed_rpm, ModeErrors errors)
    : modes_(std::move(modes)),
      tool_(std::move(tool)),
      speed_rpm_(speed_rpm),
      errors_(errors),
      alike_(alike_in_x_and_y(modes_)),
      period_s_(60 / speed_rpm / static_cast<double>(tool_.pitch_rad.size())),
      highest_hz_(0) {
  for (const Mode& m : modes_) highest_hz_ = std::max(highest_hz_, m.frequency_hz);
}

std::uint64_t StabilityTable::key(const NodePlace& p) {
  return static_cast<std::uint64_t>(p.arc) | static_cast<std::uint64_t>(p.centre) << 16 |
         static_cast<std::uint64_t>(p.ratio + 1000) << 32;
}

ArcCut StabilityTable::cut_of(const NodePlace& p) const {
  return {arc_of(p.arc), alike_ ? kPi / 2 : kPi * p.centre / kCentres, kNodeKt_MPa, kNodeKt_MPa * kRatio * p.ratio};
}

Cut StabilityTable::cut_with(const ArcCut& c) const {
  Cut cut = tool_;
  cut.slices = {{.entry_rad = c.centre_rad - c.arc_rad / 2,
                 .exit_rad = c.centre_rad + c.arc_rad / 2,
                 .kt_MPa = c.kt_MPa,
                 .kr_MPa = c.kr_MPa}};
  return cut;
}

bool StabilityTable::short_or_unequal(const ArcCut& c) const {
  const double fraction = static_cast<double>(tool_.pitch_rad.size()) * c.arc_rad / (2 * kPi);
  return fraction < kShortCut || !has_equal_pitches(tool_);
}

bool StabilityTable::needs_semi_discretisation(const ArcCut& c) const {
  return highest_hz_ * period_s_ <= kLowLobes && c.arc_rad >= kShortestArc_rad &&
         (tool_.lag_rad_per_mm > 0 || short_or_unequal(c));
}

CriticalDepth StabilityTable::exactly_at(const ArcCut& c) const {
  if (c.arc_rad <= 0) return {};
  const Cut cut = cut_with(c);
  if (needs_semi_discretisation(c)) return semi_border(modes_, cut, speed_rpm_).critical;
  return ZeroOrderLobes(modes_, cut).at(speed_rpm_);
}

CriticalDepth StabilityTable::with_modes_times(const ModeErrors& f, const ArcCut& c) const {
  std::vector<Mode> modes = modes_;
  for (Mode& m : modes)
    m.frequency_hz *= f.frequency, m.damping_ratio *= f.damping, m.stiffness_N_per_mm *= f.stiffness;
  return StabilityTable(std::move(modes), tool_, speed_rpm_, errors_).exactly_at(c);
}

CriticalDepth StabilityTable::zero_order_at(const ArcCut& c) const {
  return c.arc_rad > 0 ? ZeroOrderLobes(modes_, cut_with(c)).at(speed_rpm_) : CriticalDepth{};
}

std::vector<CriticalDepth> StabilityTable::at_speeds(const ArcCut& c, const std::vector<double>& speeds_rpm) const {
  const Cut cut = cut_with(c);
  const ZeroOrderLobes lobes(modes_, cut);
  std::vector<CriticalDepth> out;
  for (const double rpm : speeds_rpm) {
    cancellation_point();
    const bool low_lobes = highest_hz_ * period_s_ * speed_rpm_ / rpm <= kLowLobes;
    const bool semi = low_lobes && c.arc_rad >= kShortestArc_rad && short_or_unequal(c);
    out.push_back(semi ? semi_border(modes_, cut, rpm).critical : lobes.at(rpm));
  }
  return out;
}

const StabilityTable::Node& StabilityTable::node(const NodePlace& place) {
  const auto [at, fresh] = nodes_.try_emplace(key(place));
  if (fresh) {
    const CriticalDepth c = exactly_at(cut_of(place));
    at->second = {std::isfinite(c.depth_mm) ? 1 / c.depth_mm : 0.0, c.chatter_hz};
  }
  return at->second;
}

CriticalDepth StabilityTable::at(const ArcCut& c) {
  const Between arc = arc_between(c.arc_rad), ratio = between_nodes(c.kr_MPa / c.kt_MPa / kRatio);
  const double turn = std::fmod(std::fmod(c.centre_rad, kPi) + kPi, kPi);
  const Between centre = alike_ ? Between{} : between_nodes(turn / kPi * kCentres);
  double flexibility = 0, heaviest = -1, hz = 0;
  const auto add = [&](int arc_step, int centre_step, int ratio_step) {
    const double weight = (arc_step ? arc.way : 1 - arc.way) * (centre_step ? centre.way : 1 - centre.way) *
                          (ratio_step ? ratio.way : 1 - ratio.way);
    if (weight <= 0) return;
    const Node& n = node({arc.node + arc_step, (centre.node + centre_step) % kCentres, ratio.node + ratio_step});
    flexibility += weight * n.flexibility;
    if (n.hz > 0 && weight > heaviest) heaviest = weight, hz = n.hz;
  };
  for (int i = 0; i < 8; ++i) add(i & 1, i >> 1 & 1, i >> 2);
  if (flexibility <= 0) return {};
  return {kNodeKt_MPa / (c.kt_MPa * flexibility), hz};
}

std::vector<double> StabilityTable::drawn_depths(const ArcCut& c) const {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  struct Factors {
    double frequency, damping, stiffness, process_damping;
  };
  // A tool that is alike in x and y stays so: its modes come in pairs.
  std::array<Factors, kDraws> factors;
  const auto factor = [&](double error) { return std::exp(error * normal(random)); };
  for (Factors& f : factors)
    f = {factor(errors_.frequency), factor(errors_.damping), factor(errors_.stiffness), factor(kProcessDampingError)};
  std::vector<double> depths(kDraws);
  tbb::parallel_for(std::size_t{0}, depths.size(), [&](std::size_t i) {
    cancellation_point();
    const Factors& f = factors[i];
    std::vector<Mode> drawn = modes_;
    for (Mode& m : drawn)
      m.frequency_hz *= f.frequency, m.damping_ratio *= f.damping, m.stiffness_N_per_mm *= f.stiffness;
    Cut cut = cut_with(c);
    cut.process_damping_N_per_mm = 0;
    const CriticalDepth undamped = ZeroOrderLobes(drawn, cut).at(speed_rpm_);
    cut.process_damping_N_per_mm = kProcessDamping_mm * c.kt_MPa * f.process_damping;
    depths[i] = depth_with_process_damping(undamped, drawn, cut, speed_rpm_);
  });
  std::ranges::sort(depths);
  return depths;
}

double StabilityTable::probability(const ArcCut& c, double depth_mm) const {
  const auto depths = drawn_depths(c);
  const auto above = std::ranges::upper_bound(depths, depth_mm);
  return static_cast<double>(above - depths.begin()) / static_cast<double>(depths.size());
}

double StabilityTable::depth_of_probability(const ArcCut& c, double probability) {
  const Between arc = arc_between(c.arc_rad), ratio = between_nodes(c.kr_MPa / c.kt_MPa / kRatio);
  const double turn = std::fmod(std::fmod(c.centre_rad, kPi) + kPi, kPi);
  const Between centre = alike_ ? Between{} : between_nodes(turn / kPi * kCentres);
  const NodePlace place{arc.node + (arc.way > 0.5 || arc.node == 0), (centre.node + (centre.way > 0.5)) % kCentres,
                        ratio.node + (ratio.way > 0.5)};
  const auto [at, fresh] = draws_.try_emplace(key(place));
  if (fresh) at->second = drawn_depths(cut_of(place));
  const auto i = std::min(static_cast<std::size_t>(probability * kDraws), at->second.size() - 1);
  return at->second[i] * kNodeKt_MPa / c.kt_MPa;
}

}  // namespace camber::dynamics
