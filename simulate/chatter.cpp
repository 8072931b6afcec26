#include "simulate/chatter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dynamics/tool_modes.h"
#include "simulate/passage_cut.h"
#include "simulate/stable_speed.h"

namespace camber::simulate {
namespace {

using dynamics::ArcCut;
using dynamics::StabilityTable;

ArcCut worst_cut(const ChatterOperation& o) { return {o.arc_rad, o.centre_rad, o.kt_MPa, o.kr_MPa}; }

/// Evenly from half of a speed to the spindle's limit or twice.
std::vector<double> speeds_about(const machine::Job& job, double rpm, int count) {
  const SpeedBounds bounds = usual_speeds(job, rpm);
  std::vector<double> speeds;
  for (int i = 0; i < count; ++i)
    speeds.push_back(bounds.lowest_rpm + (bounds.highest_rpm - bounds.lowest_rpm) * i / (count - 1));
  return speeds;
}

/// Stability of one tool at one speed.
struct ToolAtSpeed {
  StabilityTable* table = nullptr;
  ChatterOperation operation;
  bool any_invalid = false;
  PassageCut worst;
};

class ChatterSearch {
 public:
  ChatterSearch(const machine::Job& job, const SimulatedProgram& program, std::span<const StampLoad> loads,
                CriticalDepths& depths)
      : job_(job), program_(program), loads_(loads), depths_(depths) {}

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
      if (!cuts(loads_[k])) continue;
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
    t.table = &depths_.at(job_, tool, rpm, upright);
    t.operation.measured = !job_.tools.at(tool).modes.empty();
    in_order_.push_back(&t);
    return t;
  }

  std::size_t line_of(std::size_t stamp) const {
    return program_.moves_in_part().moves[program_.path.stamps[stamp].move].block + std::size_t{1};
  }

  void judge(std::size_t k, ToolAtSpeed& t) {
    const PassageCut c = passage_cut(loads_[k], job_.material);
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
    const std::vector<double> drawn = t.table->drawn_depths(c);  // ascending
    const auto stable = std::ranges::upper_bound(drawn, o.depth_mm);
    o.probability = static_cast<double>(stable - drawn.begin()) / static_cast<double>(drawn.size());
    o.margin_low = o.depth_mm / drawn[drawn.size() * 9 / 10];
    o.margin_high = o.depth_mm / drawn[drawn.size() / 10];
    if (o.margin > 1)
      o.stable_speed_rpm =
          find_stable_speed(job_, program_, loads_, o.tool, o.speed_rpm, usual_speeds(job_, o.speed_rpm)).rpm;
    std::ranges::sort(o.lines);
    const auto again = std::ranges::unique(o.lines);
    o.lines.erase(again.begin(), again.end());
    found_.operations.push_back(o);
  }

  const machine::Job& job_;
  const SimulatedProgram& program_;
  std::span<const StampLoad> loads_;
  CriticalDepths& depths_;
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

dynamics::StabilityTable& CriticalDepths::at(const machine::Job& job, int number, double speed_rpm, bool upright) {
  const auto known = tables_.find({number, speed_rpm, upright});
  if (known != tables_.end()) return known->second;
  const machine::Tool& tool = job.tools.at(number);
  auto& own = modes_[number];
  if (own.empty()) own = dynamics::modes_of(tool);
  return tables_.emplace(std::tuple{number, speed_rpm, upright}, stability_table(job, tool, own, speed_rpm, upright))
      .first->second;
}

ChatterMargins find_chatter(const machine::Job& job, const SimulatedProgram& program, std::span<const StampLoad> loads,
                            CriticalDepths& depths) {
  return ChatterSearch(job, program, loads, depths).run();
}

std::vector<dynamics::LobePoint> lobes_of(const machine::Job& job, const ChatterOperation& o) {
  constexpr int kSpeeds = 90;
  const machine::Tool& tool = job.tools.at(o.tool);
  const std::vector<double> speeds = speeds_about(job, o.speed_rpm, kSpeeds);
  const auto depths =
      stability_table(job, tool, dynamics::modes_of(tool), o.speed_rpm, true).at_speeds(worst_cut(o), speeds);
  std::vector<dynamics::LobePoint> out;
  for (std::size_t i = 0; i < speeds.size(); ++i)
    out.push_back(
        {speeds[i], depths[i],
         std::isfinite(depths[i].depth_mm) ? dynamics::StabilityBorder::hopf : dynamics::StabilityBorder::none});
  return out;
}

std::vector<MarginEffect> margin_effects(const machine::Job& job, const ChatterOperation& o) {
  const machine::Tool& tool = job.tools.at(o.tool);
  const StabilityTable table = stability_table(job, tool, dynamics::modes_of(tool), o.speed_rpm, true);
  const dynamics::ModeErrors& e = o.measured ? dynamics::kMeasuredModeErrors : dynamics::kBeamModeErrors;
  const auto effect = [&](std::string property, double dynamics::ModeErrors::*one) {
    MarginEffect out{std::move(property), e.*one};
    std::array<double, 2> margins{};
    for (std::size_t i = 0; i < 2; ++i) {
      dynamics::ModeErrors factors{1, 1, 1};
      factors.*one = std::exp(i == 0 ? -out.error : out.error);
      margins[i] = o.depth_mm / table.with_modes_times(factors, worst_cut(o)).depth_mm;
    }
    out.low = std::min(margins[0], margins[1]), out.high = std::max(margins[0], margins[1]);
    return out;
  };
  return {effect("frequency", &dynamics::ModeErrors::frequency), effect("damping", &dynamics::ModeErrors::damping),
          effect("stiffness", &dynamics::ModeErrors::stiffness)};
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
