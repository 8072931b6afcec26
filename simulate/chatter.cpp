#include "simulate/chatter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "deflection/edge_force.h"
#include "dynamics/stability_table.h"
#include "dynamics/tool_modes.h"

namespace camber::simulate {
namespace {

using dynamics::ArcCut;
using dynamics::StabilityTable;

/// The angle whose sine is `ratio` times itself, 0 to pi.
double angle_of_sinc(double ratio) {
  double angle = std::sqrt(6 * std::max(0.0, 1 - ratio));
  for (int i = 0; i < 5 && angle > 1e-6; ++i) angle -= (std::sin(angle) - ratio * angle) / (std::cos(angle) - ratio);
  return std::clamp(angle, 0.0, kPi);
}

/// The cut of one tooth passing: one arc, and its depth.
struct PassageCut {
  ArcCut cut;
  double depth_mm = 0;
};

PassageCut cut_of(const StampLoad& load, const machine::Material& material) {
  const deflection::ChipArc& a = load.arc;
  const double area = a.area_mm_rad, ratio = std::hypot(a.cosine_mm_rad, a.sine_mm_rad) / area;
  PassageCut out;
  out.cut.arc_rad = std::max(angle_of_sinc(ratio), 1e-3);
  // From counter-clockwise of x to clockwise of y.
  out.cut.centre_rad = kPi / 2 - std::atan2(a.sine_mm_rad, a.cosine_mm_rad) / 2;
  out.depth_mm = area / out.cut.arc_rad;
  const double chip = load.chip_area_mm2 > 0 ? load.chip_mm3 / load.chip_area_mm2 : 0;
  const deflection::EdgeForce k = deflection::edge_force_slope(material, std::max(chip, 1e-3));
  const double sine = std::min(1.0, a.wall_mm_rad / area);
  out.cut.kt_MPa = k.tangential_N;
  out.cut.kr_MPa = k.radial_N * sine + k.axial_N * std::sqrt(1 - sine * sine);
  return out;
}

ArcCut worst_cut(const ChatterOperation& o) { return {o.arc_rad, o.centre_rad, o.kt_MPa, o.kr_MPa}; }

/// From half of a speed to the spindle's limit or twice.
std::vector<double> speeds_about(const machine::Job& job, double rpm, int count) {
  const double lowest = rpm / 2, highest = std::max(rpm, std::min(job.machine.spindle.max_rpm, 2 * rpm));
  std::vector<double> speeds;
  for (int i = 0; i < count; ++i) speeds.push_back(lowest + (highest - lowest) * i / (count - 1));
  return speeds;
}

StabilityTable table_of(const machine::Job& job, const machine::Tool& tool, std::vector<machine::Mode> modes,
                        double rpm, bool upright) {
  if (upright) modes.insert(modes.end(), job.workpiece_modes.begin(), job.workpiece_modes.end());
  return {std::move(modes), dynamics::teeth_of(tool), rpm,
          tool.modes.empty() ? dynamics::kBeamModeErrors : dynamics::kMeasuredModeErrors};
}

/// What is known of one tool at one speed.
struct ToolAtSpeed {
  std::unique_ptr<StabilityTable> table;
  ChatterOperation operation;
  bool any_invalid = false;
  PassageCut worst;
};

class ChatterSearch {
 public:
  ChatterSearch(const machine::Job& job, const SimulatedProgram& program, std::span<const StampLoad> loads)
      : job_(job), program_(program), loads_(loads) {}

  ChatterMargins run() {
    found_.passages.resize(loads_.size());
    for (const removal::ToolRun& run : program_.path.runs)
      if (run.kind == removal::RunKind::milling) look_at(run);
    for (ToolAtSpeed* t : in_order_) finish(*t);
    return std::move(found_);
  }

 private:
  void look_at(const removal::ToolRun& run) {
    const auto& stamps = program_.path.stamps;
    std::uint32_t move = std::numeric_limits<std::uint32_t>::max();
    ToolAtSpeed* now = nullptr;
    for (std::size_t k = run.from; k < run.from + run.count && k < loads_.size(); ++k) {
      constexpr float kNoCut = 1e-4f;
      if (!(loads_[k].arc.area_mm_rad > kNoCut)) continue;
      if (stamps[k].move != move) {
        move = stamps[k].move;
        now = &at_speed(run.tool,
                        program_.moves_in_part().state_of(program_.moves_in_part().moves[move]).spindle_speed_rpm,
                        stamps[k].pose.upright());
      }
      judge(k, *now);
    }
  }

  ToolAtSpeed& at_speed(int tool, double rpm, bool upright) {
    ToolAtSpeed& t = tools_[{tool, rpm, upright}];
    if (t.table) return t;
    t.operation.tool = tool, t.operation.speed_rpm = rpm;
    t.table = std::make_unique<StabilityTable>(table_at(tool, rpm, upright));
    t.operation.measured = !job_.tools.at(tool).modes.empty();
    in_order_.push_back(&t);
    return t;
  }

  StabilityTable table_at(int number, double rpm, bool upright) {
    const machine::Tool& tool = job_.tools.at(number);
    auto& own = modes_[number];
    if (own.empty()) own = dynamics::modes_of(tool);
    return table_of(job_, tool, own, rpm, upright);
  }

  std::size_t line_of(std::size_t stamp) const {
    return program_.moves_in_part().moves[program_.path.stamps[stamp].move].block + std::size_t{1};
  }

  void judge(std::size_t k, ToolAtSpeed& t) {
    const PassageCut c = cut_of(loads_[k], job_.material);
    const dynamics::CriticalDepth critical = t.table->at(c.cut);
    const double margin = c.depth_mm / critical.depth_mm;
    found_.passages[k] = {static_cast<float>(margin), static_cast<float>(critical.chatter_hz)};
    if (margin > t.operation.margin) {
      t.operation.margin = margin, t.operation.chatter_hz = critical.chatter_hz, t.operation.line = line_of(k);
      t.worst = c;
    }
    if (margin <= 1) return;
    if (const std::size_t line = line_of(k); t.operation.lines.empty() || t.operation.lines.back() != line)
      t.operation.lines.push_back(line);
    if (t.operation.measured || c.depth_mm > t.table->depth_of_probability(c.cut, kSureOfChatter)) {
      found_.invalid_stamps.push_back(static_cast<std::uint32_t>(k));
      t.any_invalid = true;
    }
  }

  void finish(ToolAtSpeed& t) {
    ChatterOperation& o = t.operation;
    if (o.margin <= 0) return;
    const ArcCut& c = t.worst.cut;
    o.depth_mm = t.worst.depth_mm, o.arc_rad = c.arc_rad, o.centre_rad = c.centre_rad;
    o.kt_MPa = c.kt_MPa, o.kr_MPa = c.kr_MPa;
    o.stable_depth_mm = o.depth_mm / o.margin;
    o.probability = t.table->probability(c, o.depth_mm);
    if (o.margin > 1) o.stable_speed_rpm = advised_speed(t);
    std::ranges::sort(o.lines);
    const auto again = std::ranges::unique(o.lines);
    o.lines.erase(again.begin(), again.end());
    found_.operations.push_back(o);
  }

  /// The nearest speed to the programmed one; round, as a shop sets it.
  double advised_speed(const ToolAtSpeed& t) {
    constexpr int kSpeeds = 150;
    const ChatterOperation& o = t.operation;
    const ArcCut cut = worst_cut(o);
    std::vector<double> speeds = speeds_about(job_, o.speed_rpm, kSpeeds);
    for (double& rpm : speeds) rpm = std::max(10.0, 10 * std::floor(rpm / 10));
    const auto depths = t.table->at_speeds(cut, speeds);
    std::vector<double> stable;
    for (std::size_t i = 0; i < speeds.size(); ++i)
      if (o.depth_mm <= kAdvisedMargin * depths[i].depth_mm) stable.push_back(speeds[i]);
    std::ranges::sort(stable, {}, [&](double rpm) { return std::abs(rpm - o.speed_rpm); });
    // The method of the margins has the last word.
    for (const double rpm : stable)
      if (o.depth_mm <= kAdvisedMargin * table_at(o.tool, rpm, true).exactly_at(cut).depth_mm) return rpm;
    return 0;
  }

  const machine::Job& job_;
  const SimulatedProgram& program_;
  std::span<const StampLoad> loads_;
  std::map<int, std::vector<machine::Mode>> modes_;  ///< by tool
  std::map<std::tuple<int, double, bool>, ToolAtSpeed> tools_;
  std::vector<ToolAtSpeed*> in_order_;
  ChatterMargins found_;
};

std::string cure(const ChatterOperation& o) {
  std::string depth = fmt::format("an axial depth below {:.2g} mm", o.stable_depth_mm);
  if (o.stable_speed_rpm <= 0) return depth;
  return fmt::format("S{:.0f} with F {:.2f} times as high, or {}", o.stable_speed_rpm, o.stable_speed_rpm / o.speed_rpm,
                     depth);
}

}  // namespace

ChatterMargins find_chatter(const machine::Job& job, const SimulatedProgram& program,
                            std::span<const StampLoad> loads) {
  return ChatterSearch(job, program, loads).run();
}

std::vector<dynamics::LobePoint> lobes_of(const machine::Job& job, const ChatterOperation& o) {
  constexpr int kSpeeds = 90;
  const machine::Tool& tool = job.tools.at(o.tool);
  const std::vector<double> speeds = speeds_about(job, o.speed_rpm, kSpeeds);
  const auto depths = table_of(job, tool, dynamics::modes_of(tool), o.speed_rpm, true).at_speeds(worst_cut(o), speeds);
  std::vector<dynamics::LobePoint> out;
  for (std::size_t i = 0; i < speeds.size(); ++i)
    out.push_back(
        {speeds[i], depths[i],
         std::isfinite(depths[i].depth_mm) ? dynamics::StabilityBorder::hopf : dynamics::StabilityBorder::none});
  return out;
}

std::string chatter_sentence(const ChatterOperation& o) {
  const std::string at =
      fmt::format("T{} at S{:.0f}: {:.2f} times the critical depth in line {}", o.tool, o.speed_rpm, o.margin, o.line);
  const std::string how =
      o.measured ? "with the modes of the job" : "with the modes of its beam and a usual damping of 3 %";
  if (o.margin <= 1)
    return fmt::format("{} at most, {}; probability of chatter {:.0f} %", at, how, 100 * o.probability);
  return fmt::format("{}, a sound of about {:.0f} Hz, {}; probability of chatter {:.0f} %; stable: {}", at,
                     o.chatter_hz, how, 100 * o.probability, cure(o));
}

void warn_of_chatter(const SimulatedProgram& program, const ChatterMargins& margins, Diagnostics& diagnostics) {
  constexpr std::size_t kNamed = 5;
  const std::vector<std::size_t> invalid = [&] {
    std::vector<std::size_t> lines;
    for (const std::uint32_t k : margins.invalid_stamps)
      lines.push_back(program.moves_in_part().moves[program.path.stamps[k].move].block + std::size_t{1});
    std::ranges::sort(lines);
    return lines;
  }();
  for (const ChatterOperation& o : margins.operations) {
    if (o.margin <= 1 || !std::ranges::binary_search(invalid, o.line)) continue;
    const auto shown = std::span(o.lines).first(std::min(o.lines.size(), kNamed));
    diagnostics.add(program.text().source.diagnostic(
        Severity::warning, program.text().blocks[o.line - 1].offset,
        fmt::format("{}; unstable in line{} {}{}, whose forces and errors are not valid", chatter_sentence(o),
                    o.lines.size() > 1 ? "s" : "", fmt::join(shown, ", "),
                    o.lines.size() > kNamed ? fmt::format(" and {} more", o.lines.size() - kNamed) : ""),
        "chatter"));
  }
}

}  // namespace camber::simulate
