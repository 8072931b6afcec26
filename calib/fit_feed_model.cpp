#include "calib/fit_feed_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "base/units.h"
#include "calib/fit_acceleration.h"
#include "calib/fit_limits.h"
#include "calib/line_speeds.h"
#include "feedmodel/fitted_range.h"
#include "kinematics/joint_map.h"
#include "machine/set_number.h"

namespace camber::calib {
namespace {

using machine::Machine;

constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
constexpr std::size_t kRestSamples = 20;  // a command that stands for longer rests
constexpr double kBelowHeld = 0.99;       // of a speed that an axis holds: a limit below it is wrong
constexpr double kSamePeriod = 0.02;      // two periods that differ by less are one
constexpr std::uint32_t kMaxBlocksApart = 60;
constexpr double kSameWindow = 0.3;         // two estimates of one window differ by less than this fraction of it
constexpr int kListIterations = 6;          // for each value of a list
constexpr double kMoves = 2e-3;             // mm or degrees between two samples
constexpr double kNoLengthMm = 1e-9;        // rounding of numbers, not a move
constexpr std::size_t kKeptStations = 250;  // of a part, for the page
constexpr double kSettledFraction = 1e-3;   // gain of cost under which a richer law is not worth it

/// The usual values of this kind of control for keys that the start file leaves out and the traces may not determine.
void set_control_defaults(machine::Control& control) {
  // No control takes up two blocks in one period.
  if (control.block_time_s == 0) control.block_time_s = control.kind.min_segment_periods * control.period_s;
  control.starts_on_period = control.kind.starts_on_period;
  if (control.corner.law != machine::CornerLaw::blend) return;
  if (control.corner.step_fraction == 0) control.corner.step_fraction = control.kind.default_step_fraction;
  if (control.lookahead_blocks == 0) control.lookahead_blocks = control.kind.usual_lookahead_blocks;
  if (control.corner.short_line_time_s == 0)
    control.corner.short_line_time_s = control.kind.usual_short_line_periods * control.period_s;
}

/// How long a command stands while axes move: the median, in samples.
double samples_of_a_command(const std::vector<const ServoTrace*>& traces) {
  std::vector<std::size_t> lengths;
  for (const ServoTrace* trace : traces) {
    if (trace->has_command == std::array<bool, 3>{}) continue;
    for (const Stretch& s : trace->stretches) {
      std::size_t length = 1;
      for (std::size_t k = s.first + 1; k < s.end; ++k, ++length) {
        bool changes = trace->command_mm[k] != trace->command_mm[k - 1];
        if (!trace->rotary_command_deg.empty())
          changes = changes || trace->rotary_command_deg[k] != trace->rotary_command_deg[k - 1];
        if (!changes) continue;
        if (length < kRestSamples) lengths.push_back(length);
        length = 0;
      }
    }
  }
  if (lengths.empty()) return 1;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return static_cast<double>(*middle);
}

/// The interpolation period is not the step of the log: it is how often commands change, where the log is fine enough
/// to show it, and else what the start file says.
void set_period(FitFeedResult& result, const std::vector<const ServoTrace*>& traces) {
  if (traces.empty()) return;
  double step_s = machine::kNoLimit;
  for (const ServoTrace* trace : traces) step_s = std::min(step_s, trace->period_s);
  const double samples = samples_of_a_command(traces), seen_s = samples * step_s;
  double& period_s = result.machine.control.period_s;
  const bool shows = samples > 1 || seen_s < (1 - kSamePeriod) * period_s;
  if (!shows && std::abs(seen_s / period_s - 1) < kSamePeriod) return;
  if (shows) period_s = seen_s;
  result.parameters.push_back(
      {"control.period_ms", 1000 * period_s, "ms", std::nullopt,
       shows ? "how often the commands change"
             : fmt::format("start value kept; the traces have a sample every {:.4g} ms", 1000 * step_s),
       shows});
}

bool moves_at(const ServoTrace& trace, std::size_t k) {
  const std::size_t from = k > 0 ? k - 1 : k, to = std::min(k + 1, trace.size() - 1);
  return joint_step(trace, from, to) > kMoves;
}

/// Commanded time of each part: first to last sample of its lines.
std::vector<double> traced_times_s(const ServoTrace& trace, const std::vector<TracePart>& parts) {
  std::vector<double> times(parts.size(), 0.0);
  std::size_t k = 0;
  const std::size_t n = trace.line.size();
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const auto inside = [&](std::size_t i) {
      return trace.line[i] >= parts[p].line_first && trace.line[i] <= parts[p].line_last;
    };
    std::size_t i = k;
    while (i < n && (trace.line[i] == 0 || trace.line[i] < parts[p].line_first)) ++i;
    if (i == n || !inside(i)) continue;
    const std::size_t first = i;
    std::size_t last = i;
    bool whole = true;
    for (; i < n && (inside(i) || trace.line[i] == 0); ++i) {
      if (!inside(i)) continue;
      if (i > last + 1) whole = false;  // the control waited inside the part
      last = i;
    }
    for (const Stretch& s : trace.stretches) {
      whole = whole && !(s.first > first && s.first <= last);
      // A stretch that begins or ends in motion may have only a piece of the part.
      whole = whole && !(s.first == first && moves_at(trace, first)) && !(s.end == last + 1 && moves_at(trace, last));
    }
    if (whole) times[p] = static_cast<double>(last + 1 - first) * trace.period_s;
    k = last + 1;
  }
  return times;
}

/// A run that the trace has in part only, since it begins or ends in motion or a part of it is missing, is cut in
/// pieces of a tenth of its lines, in place of the whole: what lies inside the trace tells as much.
void add_pieces(const FeedRun& run, TimedLines& lines) {
  constexpr std::uint32_t kPieces = 10;
  constexpr std::size_t kKeepBackEvery = 3;
  TimedLines out;
  for (std::size_t p = 0; p < lines.parts.size(); ++p) {
    const TracePart& part = lines.parts[p];
    const std::uint32_t count = part.line_last - part.line_first + 1;
    std::vector<TracePart> pieces{part};
    if (lines.time_s[p] == 0 && count >= kPieces) {
      pieces.clear();
      for (std::uint32_t i = 0; i < kPieces; ++i)
        pieces.push_back({part.line_first + count * i / kPieces, part.line_first + count * (i + 1) / kPieces - 1,
                          part.feed_mm_per_s});
    }
    for (const TracePart& piece : pieces) {
      const bool whole = pieces.size() == 1;
      out.parts.push_back(piece);
      out.kept_back.push_back(whole ? lines.kept_back[p] : static_cast<char>(out.parts.size() % kKeepBackEvery == 0));
      out.group.push_back(lines.group[p]);
    }
  }
  if (out.parts.size() == lines.parts.size()) return;
  lines.parts = std::move(out.parts);
  lines.kept_back = std::move(out.kept_back);
  lines.group = std::move(out.group);
  lines.time_s = traced_times_s(run.trace, lines.parts);
}

/// Parts are timed as a whole and, where they have few blocks, block by block as well: a line and the arc after it
/// tell more apart than together. Blocks that were merged into a later one do not appear in the trace and are left
/// out there and in the plan.
void add_timed_lines(const FeedRun& run, const Machine& machine, int keep_back_every, std::size_t& count,
                     std::vector<TimedLines>& data) {
  TimedLines parts, blocks;
  // Blocks that overlap have no times of their own.
  const bool overlap =
      machine.control.kind.turning_blocks_overlap && kinematics::has_rotary_motion(run.program, machine);
  const std::vector<LineFeed> feeds = overlap ? feeds_of_lines(run.program, machine) : std::vector<LineFeed>{};
  const auto turns_near = [&](std::uint32_t line) {
    for (std::uint32_t l = line > 0 ? line - 1 : 0; l <= line + 1; ++l)
      if (l < feeds.size() && feeds[l].turns) return true;
    return false;
  };
  for (const TracePart& part : parts_of(run.program, machine)) {
    const bool kept_back = ++count % static_cast<std::size_t>(keep_back_every) == 0;
    const bool by_block = part.line_last - part.line_first < kMaxBlocksApart && part.line_last > part.line_first;
    for (std::uint32_t line = part.line_first; by_block && line <= part.line_last; ++line) {
      if (overlap && turns_near(line)) continue;
      blocks.parts.push_back({line, line, part.feed_mm_per_s});
      blocks.kept_back.push_back(kept_back);
      blocks.group.push_back(static_cast<int>(count));
    }
    parts.parts.push_back(part);
    parts.kept_back.push_back(kept_back);
    parts.group.push_back(static_cast<int>(count));
  }
  for (TimedLines* lines : {&parts, &blocks}) {
    lines->program = &run.program;
    lines->time_s = traced_times_s(run.trace, lines->parts);
    add_pieces(run, *lines);
    lines->step_s = run.trace.period_s;
    data.push_back(std::move(*lines));
  }
}

bool moves_in_trace(const nc::Interpretation& program, const nc::Move& move, const LineFeed& line) {
  return line.turn && (length_mm(program, move) > kNoLengthMm || line.turns);
}

/// Positionings of programs with rotary motion, those that follow each other as one: blocks that turn are often limited
/// by rotary axes, so that the accelerations of X, Y and Z show here alone. Without the first one, which begins at a
/// place that the program does not give.
void add_positionings(const FeedRun& run, const Machine& machine, int keep_back_every, std::size_t& count,
                      std::vector<TimedLines>& data) {
  if (!kinematics::has_rotary_motion(run.program, machine)) return;
  const std::vector<LineFeed> lines = feeds_of_lines(run.program, machine);
  TimedLines out;
  bool open = false, first = true;
  for (const nc::Move& move : run.program.moves) {
    const std::uint32_t line = move.block + 1;
    const bool rapid = move.kind == nc::MoveKind::rapid && !move.reference;
    if (rapid && !moves_in_trace(run.program, move, lines[line])) continue;
    if (rapid && open) out.parts.back().line_last = line;
    if (rapid && !open && !first) out.parts.push_back({line, line, 0});
    open = rapid && !first;
    first = first && !rapid;
  }
  for (std::size_t i = 0; i < out.parts.size(); ++i) {
    out.kept_back.push_back(++count % static_cast<std::size_t>(keep_back_every) == 0);
    out.group.push_back(static_cast<int>(count));
  }
  out.program = &run.program;
  out.time_s = traced_times_s(run.trace, out.parts);
  out.step_s = run.trace.period_s;
  data.push_back(std::move(out));
}

std::vector<TimedLines> timed_lines(const std::vector<FeedRun>& runs, const Machine& machine, int keep_back_every,
                                    std::size_t& count) {
  std::vector<TimedLines> data;
  for (const FeedRun& run : runs)
    if (!run.trace.line.empty()) add_timed_lines(run, machine, keep_back_every, count, data);
  for (const FeedRun& run : runs)
    if (!run.trace.line.empty()) add_positionings(run, machine, keep_back_every, count, data);
  return data;
}

/// One of the six joints, by index.
struct JointName {
  std::size_t index = 0;
  std::string letter() const { return std::string(1, "xyzabc"[index]); }
  bool rotary() const { return index > 2; }
};

double& top_speed_of(Machine& machine, JointName joint) {
  return joint.rotary() ? machine.rotary[joint.index - 3].max_velocity_rad_per_s
                        : machine.axis[joint.index].max_velocity_mm_per_s;
}

void add_top_speed(FitFeedResult& result, JointName joint, const TopSpeed& top) {
  const std::string unit = joint.rotary() ? "deg/min" : "mm/min";
  const std::string name =
      fmt::format("axis.{}.max_velocity_{}_per_min", joint.letter(), joint.rotary() ? "deg" : "mm");
  double& limit = top_speed_of(result.machine, joint);
  if (top.limit) {
    limit = joint.rotary() ? rad_from_deg(top.limit->value) : top.limit->value;
    result.parameters.push_back(
        {name, 60 * top.limit->value, unit, 60 * top.limit->std_error, "held speed", true, top.moves});
    return;
  }
  const double start = 60 * (joint.rotary() ? deg_from_rad(limit) : limit);
  const bool exceeded = start < kBelowHeld * 60 * top.highest;
  const std::string kept = exceeded ? "the start value is exceeded and was taken out" : "start value kept";
  if (exceeded) limit = machine::kNoLimit;
  result.parameters.push_back(
      {name, 60 * (joint.rotary() ? deg_from_rad(limit) : limit), unit, std::nullopt,
       fmt::format("no move shows the axis at its limit (it holds up to {:.0f} {}); {} (run a long rapid of {} alone)",
                   60 * top.highest, unit, kept, static_cast<char>(std::toupper(joint.letter()[0]))),
       false});
}

/// The corner law stands; its number is the one that the machine had, or no limit. Numbers for each axis begin with the
/// one for all, which holds for an axis whose own number is not determined.
Machine base_with_law(const Machine& start, const Machine& fitted) {
  const machine::Corner& corner = fitted.control.corner;
  for (const auto& [name, machine] : machines_of_each_law(start)) {
    if (machine.control.corner.law != corner.law) continue;
    Machine m = machine;
    m.control.corner.stop_angle_rad = corner.stop_angle_rad;
    m.control.corner.threshold_rad = corner.threshold_rad;
    m.cycle.acceleration_law = fitted.cycle.acceleration_law;
    m.cycle.bell_time_s = fitted.cycle.bell_time_s;
    for (std::size_t i = 0; i < m.axis.size(); ++i) {
      if (std::isinf(fitted.axis[i].speed_difference_mm_per_s)) continue;
      m.axis[i].speed_difference_mm_per_s = corner.speed_difference_mm_per_s;
      m.control.corner.speed_difference_mm_per_s = corner.speed_difference_mm_per_s;
    }
    return m;
  }
  return start;
}

/// Every law, and angles under the best one. LinuxCNC's rounding knows neither a stop angle nor a threshold.
LimitFit choose_law(FitFeedResult& result, const std::vector<TimedLines>& data, const TracedAccelerations& acceleration,
                    int max_iterations, bool only_own) {
  std::size_t best = 0;
  std::vector<TriedLaw> tried = try_laws(data, result.machine, acceleration, max_iterations, best, only_own);
  LimitFit chosen = tried[best].fit;
  result.law = tried[best].name;
  if (chosen.machine.control.corner.law != machine::CornerLaw::blend && !only_own) {
    chosen = try_details(data, chosen, acceleration, tried, max_iterations);
    const auto same = [&](const TriedLaw& law) {
      const Machine &a = law.fit.whole, &b = chosen.whole;
      return a.control.corner.law == b.control.corner.law && a.cycle.acceleration_law == b.cycle.acceleration_law;
    };
    for (const TriedLaw& law : tried) {
      const bool detail = law.name.starts_with(' ');
      if (!detail && same(law)) result.law = law.name;
      if (detail && law.fit.held_out_cost == chosen.held_out_cost) result.law += law.name.substr(1);
    }
  }
  for (const TriedLaw& law : tried) result.laws.push_back({law.name, law.held_out_percent, law.fit.held_out_cost});
  return chosen;
}

/// Median of what rests took longer than programmed; 0 without rests.
double rest_latency_s(const std::vector<FeedRun>& runs) {
  std::vector<double> extra;
  for (const FeedRun& run : runs) {
    std::vector<double> after_line;  // dwell that follows the block with this line
    double dwell = 0;
    std::uint32_t last_line = 0;
    for (const nc::Move& move : run.program.moves) {
      if (move.kind == nc::MoveKind::dwell) {
        dwell += move.dwell_s;
      } else if (length_mm(run.program, move) > kNoLengthMm) {
        if (after_line.size() <= last_line) after_line.resize(last_line + 1, 0.0);
        after_line[last_line] = dwell;
        dwell = 0;
        last_line = move.block + 1;
      }
    }
    std::size_t rest_from = 0;
    std::uint32_t before = 0;
    for (std::size_t k = 1; k < run.trace.line.size(); ++k) {
      if (run.trace.line[k] == 0 && run.trace.line[k - 1] != 0) {
        rest_from = k;
        before = run.trace.line[k - 1];
      }
      if (run.trace.line[k] != 0 && run.trace.line[k - 1] == 0 && before > 0 && before < after_line.size() &&
          after_line[before] > 0)
        extra.push_back(static_cast<double>(k - rest_from) * run.trace.period_s - after_line[before]);
    }
  }
  if (extra.empty()) return 0;
  const auto middle = extra.begin() + static_cast<std::ptrdiff_t>(extra.size() / 2);
  std::nth_element(extra.begin(), middle, extra.end());
  return std::max(0.0, std::round(*middle * 1e6) / 1e6);
}

void start_from_fitted(LimitParameter& p) { p.start = std::clamp(p.fitted.value, p.least * 1.001, p.most * 0.999); }

/// Fits the limits for each value of a list and keeps the value that predicts the kept-back parts best; the
/// first one stands unless another is clearly better. A value that changes no time is passed over; returns whether any
/// was tried.
template <class Set>
bool choose(LimitFit& best, const std::vector<TimedLines>& data, const std::vector<double>& values, const Set& set,
            int iterations) {
  LimitFit standing = best;
  bool any = false;
  for (double value : values) {
    Machine m = best.machine;
    set(m, value);
    if (same_times(data, m, standing.machine)) continue;
    any = true;
    auto parameters = best.parameters;
    for (LimitParameter& p : parameters) start_from_fitted(p);
    const LimitFit fit = fit_limits(data, m, std::move(parameters), iterations, false);
    const double gain = kSettledFraction * (1 + standing.fitted_cost);
    if (fit.fitted_cost + fit.held_out_cost < standing.fitted_cost + standing.held_out_cost - gain) standing = fit;
  }
  best = standing;
  return any;
}

/// Fits again from the best block time of its whole range.
void refine_block_time(LimitFit& fit, const std::vector<TimedLines>& data, const Machine& base, int iterations) {
  auto parameters = fit.parameters;
  for (LimitParameter& p : parameters) start_from_fitted(p);
  constexpr int kSteps = 48, kFewSteps = 16;
  scan_start(data, base, parameters, parameters.size() - 1, blocks_overlap(data, base) ? kFewSteps : kSteps);
  fit = fit_limits(data, base, std::move(parameters), iterations, false);
}

/// Whether a block that follows the stop of another one waits for a period: as it is with this kind of control, unless
/// the other way is better.
void choose_starts(FitFeedResult& result, LimitFit& fit, const std::vector<TimedLines>& data) {
  bool& starts = result.machine.control.starts_on_period;
  if (blocks_overlap(data, result.machine)) return;
  if (!choose(
          fit, data, {starts ? 0.0 : 1.0}, [](Machine& m, double v) { m.control.starts_on_period = v > 0; },
          kListIterations))
    return;
  starts = fit.machine.control.starts_on_period;
  result.parameters.push_back({"control.starts_on_period", starts ? 1.0 : 0.0, "1", std::nullopt,
                               "1: a block that follows a stop waits for a period", true});
}

/// Whether the control waits at exact stops until the axes are in position: it does as the start file says, unless the
/// traces have such stops and their times are those of a control that does not. Requires the drives.
void set_waits(FitFeedResult& result, const std::vector<TimedLines>& data, double width_mm) {
  Machine waits = result.machine;
  waits.control.in_position_mm = width_mm;
  const LimitCost with = cost_of(data, waits), without = cost_of(data, result.machine);
  if (with.fitted + with.held_out < without.fitted + without.held_out + kSettledFraction * (1 + without.fitted)) {
    result.machine = waits;
    return;
  }
  result.parameters.push_back(
      {"control.in_position_mm", machine::kNoLimit, "mm", std::nullopt, "the traces do not wait at exact stops", true});
}

/// Says which program of camber protocol would determine a parameter.
std::string_view what_tells(std::string_view name) {
  if (name.ends_with("position_gain_per_s")) return "record commanded and actual positions";
  if (name.ends_with("block_time_ms")) return "run the saturation program of camber protocol";
  if (name.ends_with("deg_per_s2")) return "run the rotary program of camber protocol";
  if (name.find("arc_") != name.npos) return "run the circles of camber protocol";
  if (name.find("stop_acceleration") != name.npos) return "run a polygon program of camber protocol under G64";
  if (name.find("step_share") != name.npos) return "run a polygon program of camber protocol under G61";
  if (name.ends_with("rapid_change_ms")) return "log stretches of feed moves with rapids between them";
  if (name.find("stop_time") != name.npos) return "run the corners program of camber protocol";
  return "run the polygon programs of camber protocol in all planes";
}

/// Says which of two sources determined a parameter, traces or logged times.
std::string source_of(const LimitParameter& p) {
  constexpr double kMax = 0.9;
  if (p.logged_fraction > kMax) return "from the logged times";
  return p.logged_fraction < 1 - kMax ? "from the traces"
                                      : fmt::format("{:.0f} % from the logged times", 100 * p.logged_fraction);
}

void add_limits(FitFeedResult& result, const LimitFit& fit, const Machine& start, bool logged) {
  for (const LimitParameter& p : fit.parameters) {
    if (p.assumed) {
      result.parameters.push_back({p.name, p.fitted.value, p.unit, std::nullopt,
                                   "usual value: the traces tell it only together with the accelerations", true});
    } else if (p.determined) {
      const std::string note = p.from_ramps ? "constant accelerations of the commands"
                               : p.poor     ? fmt::format("poorly determined ({})", what_tells(p.name))
                               : logged     ? source_of(p)
                                            : "";
      const auto error = std::isfinite(p.fitted.std_error) ? std::optional(p.fitted.std_error) : std::nullopt;
      result.parameters.push_back({p.name, p.fitted.value, p.unit, error, note, true, p.stretches});
    } else {
      result.parameters.push_back({p.name, p.get(start), p.unit, std::nullopt,
                                   fmt::format("not determined by the {}; start value kept ({})",
                                               logged ? "traces and logs" : "traces", what_tells(p.name)),
                                   false});
    }
  }
}

/// Adds the parameters of LinuxCNC's rounding that are chosen from a list of values.
void add_listed(FitFeedResult& result) {
  const machine::Control& control = result.machine.control;
  result.parameters.push_back({"control.lookahead_blocks", static_cast<double>(control.lookahead_blocks), "1",
                               std::nullopt, "chosen from a list", true});
  result.parameters.push_back({"control.corner.short_line_time_ms", 1000 * control.corner.short_line_time_s, "ms",
                               std::nullopt, "chosen from a list", true});
}

void add_angles(FitFeedResult& result) {
  const machine::Corner& corner = result.machine.control.corner;
  const auto add = [&](const char* name, double angle_rad) {
    result.parameters.push_back(
        {name, angle_rad * 180 / kPi, "deg", std::nullopt, "between the corners of the programs", true});
  };
  if (std::isfinite(corner.stop_angle_rad)) add("control.corner.stop_angle_degrees", corner.stop_angle_rad);
  if (corner.threshold_rad > 0) add("control.corner.threshold_degrees", corner.threshold_rad);
}

/// Jerk of each axis: one window for all, so that it does not bend the path.
void add_jerk(FitFeedResult& result, const FittedValue& window_s) {
  for (int axis = 0; axis < 3; ++axis) {
    machine::Axis& a = result.machine.axis[axis];
    if (!std::isfinite(a.acceleration_mm_per_s2)) continue;
    a.jerk_mm_per_s3 = a.acceleration_mm_per_s2 / window_s.value;
    result.parameters.push_back({std::string("axis.") + kAxes[axis] + ".jerk_mm_per_s3", a.jerk_mm_per_s3, "mm/s3",
                                 a.jerk_mm_per_s3 * window_s.std_error / window_s.value,
                                 "rise of the commanded acceleration from rest", true});
  }
}

/// Adds the smoothing between the plan and the traced commands: a ramp of each axis, or, where the rise of the
/// acceleration from rest agrees with it, a limit of jerk.
void add_smoothing(FitFeedResult& result, const std::vector<FeedRun>& runs,
                   const std::vector<const ServoTrace*>& traces) {
  const bool bell = result.machine.cycle.acceleration_law == machine::AccelerationLaw::bell;
  const auto rise_s = bell ? std::nullopt : smoothing_time_s(traces);
  std::array<std::optional<FittedValue>, 3> ramps;
  bool any = false, agree = true;
  for (int axis = 0; axis < 3; ++axis) {
    // Without its acceleration a plan has no ramp that could be compared.
    if (!std::isfinite(result.machine.axis[axis].acceleration_mm_per_s2)) continue;
    auto& ramp = ramps[static_cast<std::size_t>(axis)] = ramp_time_s(runs, result.machine, axis);
    if (!ramp) continue;
    any = true;
    agree = agree && rise_s && std::abs(ramp->value - rise_s->value) < kSameWindow * ramp->value;
  }
  if (rise_s && (agree || !any)) return add_jerk(result, *rise_s);
  for (int axis = 0; axis < 3; ++axis) {
    const auto& ramp = ramps[static_cast<std::size_t>(axis)];
    if (!ramp) continue;
    double& filter_s = result.machine.axis[axis].filter_s;
    filter_s = std::max(filter_s, ramp->value);
    result.parameters.push_back({std::string("axis.") + kAxes[axis] + ".filter_ms", 1000 * filter_s, "ms",
                                 1000 * ramp->std_error, "ramp of the commands from rest", true});
  }
}

}  // namespace

std::optional<TimePromise> time_promise(const std::vector<double>& true_s, const std::vector<double>& predicted_s) {
  constexpr std::size_t kParts = 5, kDraws = 2000;
  if (true_s.size() < kParts) return std::nullopt;
  std::mt19937 random(1);
  std::vector<double> percent;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    double sum = 0, predicted = 0;
    for (std::size_t i = 0; i < kParts; ++i) {
      const std::size_t at = random() % true_s.size();
      sum += true_s[at];
      predicted += predicted_s[at];
    }
    percent.push_back(100 * (predicted / sum - 1));
  }
  std::ranges::sort(percent);
  return TimePromise{percent[kDraws / 40], percent[kDraws - 1 - kDraws / 40]};
}

namespace {

/// Enters the value of the start file beside each written parameter that has changed.
void add_changes(std::vector<FitParameter>& parameters, const Machine& start) {
  for (FitParameter& p : parameters)
    if (p.written)
      if (const auto was = machine::number_of(start, p.name); was && *was != p.value) p.changed_from = *was;
}

void judge(FitFeedResult& result, const std::vector<FeedRun>& runs, int keep_back_every) {
  double square[2] = {0, 0}, p95[2] = {0, 0};
  std::vector<double> true_s, predicted_s;  // of the parts held out
  std::size_t count = 0;
  for (const FeedRun& run : runs) {
    const std::vector<TracePart> parts = parts_of(run.program, result.machine);
    RunAccuracy accuracy{run.program_name, feed_accuracy(run.trace, run.program, result.machine, parts,
                                                         {.kept_stations = kKeptStations})};
    if (!run.trace.line.empty()) {
      std::size_t seen = 0;
      for (const TracePart& part : parts) {
        const bool kept_back = ++count % static_cast<std::size_t>(keep_back_every) == 0;
        if (seen == accuracy.accuracy.parts.size()) continue;
        const PartAccuracy& a = accuracy.accuracy.parts[seen];
        if (a.part.line_first != part.line_first) continue;
        ++seen;
        FitError& error = kept_back ? result.held_out : result.fitted;
        ++error.parts;
        error.part_time_percent += 100 * std::abs(a.time_model_s / a.time_trace_s - 1);
        if (kept_back) {
          true_s.push_back(a.time_trace_s);
          predicted_s.push_back(a.time_model_s);
        }
        square[kept_back] += a.speed_rms_percent * a.speed_rms_percent;
        p95[kept_back] += a.speed_p95_percent;
      }
    }
    result.runs.push_back(std::move(accuracy));
  }
  for (const LoggedTime& t : result.logged)
    if (t.kept_back) {
      true_s.push_back(t.time_s);
      predicted_s.push_back(t.model_s);
    }
  result.promise = time_promise(true_s, predicted_s);
  for (int i = 0; i < 2; ++i) {
    FitError& error = i ? result.held_out : result.fitted;
    if (error.parts == 0) continue;
    const auto n = static_cast<double>(error.parts);
    error.part_time_percent /= n;
    error.speed_rms_percent = std::sqrt(square[i] / n);
    error.speed_p95_percent = p95[i] / n;
  }
}

LoggedError error_of(const std::vector<LoggedTime>& logged, bool kept_back) {
  LoggedError error;
  for (const LoggedTime& t : logged) {
    if (t.kept_back != kept_back) continue;
    const double percent = 100 * std::abs(t.model_s / t.time_s - 1);
    ++error.stretches;
    error.mean += percent;
    error.worst = std::max(error.worst, percent);
  }
  if (error.stretches > 0) error.mean /= static_cast<double>(error.stretches);
  return error;
}

/// The logged stretches with the limits as they are written; their waits are still one number.
void judge_logged(FitFeedResult& result, const std::vector<LoggedLines>& logged, const Machine& machine) {
  for (const LoggedLines& l : logged) {
    const auto model_s = planned_times_s(l.lines, machine, feedmodel::plan_motion(*l.program, machine));
    for (std::size_t i = 0; i < model_s.size(); ++i)
      result.logged.push_back({l.program_name, l.lines.parts[i], l.lines.kept_back[i] != 0, l.lines.time_s[i],
                               l.lines.sigma_s[i], model_s[i]});
  }
  result.logged_fitted = error_of(result.logged, false);
  result.logged_held_out = error_of(result.logged, true);
}

double& backlash_of(machine::Axis& axis) { return axis.backlash_mm; }
double& backlash_of(machine::RotaryAxis& axis) { return axis.backlash_rad; }
double in_machine(const machine::Axis&, double mm) { return mm; }
double in_machine(const machine::RotaryAxis&, double deg) { return rad_from_deg(deg); }

/// Axis: machine::Axis or machine::RotaryAxis. A number that the traces do not determine keeps its start value.
template <class Axis>
void set_drive(Axis& a, std::vector<FitParameter>& parameters, const std::string& name, const char* unit,
               const DriveFit& drive) {
  if (!drive.moved) {
    parameters.push_back({name + "position_gain_per_s", a.position_gain_per_s, "1/s", std::nullopt,
                          "the axis does not move in the traces", false});
    return;
  }
  const auto add = [&](const std::string& key, const FittedValue& v, double& value, double fitted, double scale,
                       const char* in) {
    if (v.value == 0 && v.std_error == 0) {
      value = 0;
      return;
    }
    const bool determined = is_determined(v);
    if (determined) value = fitted;
    parameters.push_back(
        {name + key, determined ? v.value * scale : value * scale, in,
         determined ? std::optional(v.std_error * scale) : std::nullopt,
         determined ? ""
                    : "not determined by the traces; start value kept (run the polygon programs of camber protocol)",
         determined});
  };
  FittedValue gain = drive.gain_per_s;
  if (std::isinf(drive.feed_forward_percent.std_error)) {
    // The lag at a steady speed shows gain / (1 - feed forward): with the start file's feed forward it stays the same.
    // All of the speed fed forward would leave no lag, which the trace has.
    if (a.feed_forward_percent >= 100) a.feed_forward_percent = 0;
    const double left = 1 - a.feed_forward_percent / 100;
    gain = {gain.value * left, gain.std_error * left};
  }
  add("position_gain_per_s", gain, a.position_gain_per_s, gain.value, 1, "1/s");
  add("velocity_lag_ms", drive.velocity_lag_s, a.velocity_lag_s, drive.velocity_lag_s.value, 1000, "ms");
  add("feed_forward_percent", drive.feed_forward_percent, a.feed_forward_percent,
      std::clamp(drive.feed_forward_percent.value, 0.0, 100.0), 1, "%");
  add("acceleration_feed_forward_ms", drive.acceleration_feed_forward_s, a.acceleration_feed_forward_s,
      drive.acceleration_feed_forward_s.value, 1000, "ms");
  add("dead_time_ms", drive.dead_time_s, a.dead_time_s, drive.dead_time_s.value, 1000, "ms");
  add(fmt::format("backlash_{}", unit), drive.backlash, backlash_of(a), in_machine(a, drive.backlash.value), 1, unit);
  a.filter_s = drive.filter_s.value;
  if (drive.filter_s.value > 0)
    parameters.push_back(
        {name + "filter_ms", 1000 * drive.filter_s.value, "ms", std::nullopt, "chosen from a list", true});
}

}  // namespace

void add_drive(Machine& machine, std::vector<FitParameter>& parameters, int axis, const DriveFit& drive) {
  set_drive(machine.axis[axis], parameters, std::string("axis.") + kAxes[axis] + ".", "mm", drive);
}

FitFeedResult fit_feed(const std::vector<FeedRun>& runs, const Machine& start, const FitFeedOptions& options) {
  return fit_feed(runs, {}, start, options);
}

FitFeedResult fit_feed(const std::vector<FeedRun>& runs, const std::vector<StretchRun>& logs, const Machine& start,
                       const FitFeedOptions& options) {
  FitFeedResult result;
  result.machine = start;
  std::vector<const ServoTrace*> traces;
  for (const FeedRun& run : runs) traces.push_back(&run.trace);
  std::vector<ServoTrace> rotary_traces;
  for (const FeedRun& run : runs)
    if (!run.trace.rotary_command_deg.empty()) rotary_traces.push_back(rotary_trace(run.trace));
  std::vector<const ServoTrace*> rotary;
  for (const ServoTrace& trace : rotary_traces) rotary.push_back(&trace);
  bool drives_converged = true;
  set_period(result, traces);
  set_control_defaults(result.machine.control);

  std::size_t parts = 0;
  std::vector<TimedLines> data = timed_lines(runs, result.machine, options.keep_back_every, parts);
  const std::vector<LoggedLines> logged = logged_lines(logs, options.keep_back_every, parts);
  for (const LoggedLines& l : logged) data.push_back(l.lines);
  std::vector<HeldSpeed> held;
  for (const FeedRun& run : runs)
    for (const HeldSpeed& h : held_speeds(run, result.machine)) held.push_back(h);
  const auto tops = top_speeds(held);
  for (std::size_t axis = 0; axis < 3; ++axis) add_top_speed(result, {axis}, tops[axis]);
  for (const char letter : start.kinematics.rotary_axes()) {
    const auto joint = static_cast<std::size_t>(3 + letter - 'a');
    add_top_speed(result, {joint}, tops[joint]);
  }
  const double width_mm = result.machine.control.in_position_mm;
  result.machine.control.in_position_mm = machine::kNoLimit;  // waits are between the parts
  const Machine base_of_all = result.machine;
  LimitFit limits = choose_law(result, data, {traced_accelerations(traces, rotary), held_accelerations(runs)},
                               options.max_iterations / 4, options.update);
  result.machine = base_with_law(base_of_all, limits.whole);
  choose_starts(result, limits, data);
  refine_block_time(limits, data, result.machine, options.max_iterations);
  const double period = result.machine.control.period_s;
  if (start.control.kind.fits_short_lines && limits.machine.control.corner.law == machine::CornerLaw::blend) {
    bool tried = choose(
        limits, data, {2 * period, 4 * period, 8 * period},
        [](Machine& m, double v) { m.control.corner.short_line_time_s = v; }, kListIterations);
    tried |= choose(
        limits, data, {25, 50, 100}, [](Machine& m, double v) { m.control.lookahead_blocks = static_cast<int>(v); },
        kListIterations);
    if (tried) refine_block_time(limits, data, limits.machine, options.max_iterations / 3);
  }
  const Machine base = result.machine;
  result.machine = limits.machine;
  add_limits(result, limits, base, !logged.empty());
  Machine lagging = limits.machine;
  for (std::size_t i = 0; i < lagging.axis.size(); ++i)
    lagging.axis[i].position_gain_per_s = limits.whole.axis[i].position_gain_per_s;
  judge_logged(result, logged, lagging);
  if (start.control.kind.fits_short_lines && limits.machine.control.corner.law == machine::CornerLaw::blend)
    add_listed(result);
  add_angles(result);
  if (!runs.empty()) {
    result.machine.control.rest_latency_s = rest_latency_s(runs);
    result.parameters.push_back({"control.rest_latency_ms", 1000 * result.machine.control.rest_latency_s, "ms",
                                 std::nullopt, "median of the rests", true});
  }
  const DriveFitOptions drive_options{.period_s = result.machine.control.period_s};
  for (int axis = 0; axis < 3 && !runs.empty(); ++axis) {
    result.drives[axis] = fit_drive(traces, axis, drive_options);
    add_drive(result.machine, result.parameters, axis, result.drives[axis]);
    drives_converged = drives_converged && (!result.drives[axis].moved || result.drives[axis].converged);
  }
  for (const char letter : start.kinematics.rotary_axes()) {
    const int axis = letter - 'a';
    DriveFit& drive = result.rotary_drives[static_cast<std::size_t>(axis)] = fit_drive(rotary, axis, drive_options);
    set_drive(result.machine.rotary[static_cast<std::size_t>(axis)], result.parameters, fmt::format("axis.{}.", letter),
              "deg", drive);
    drives_converged = drives_converged && (!drive.moved || drive.converged);
  }
  set_waits(result, data, width_mm);
  add_smoothing(result, runs, traces);
  std::vector<const nc::Interpretation*> programs;
  for (const FeedRun& run : runs) programs.push_back(&run.program);
  for (const LoggedLines& l : logged) programs.push_back(l.program.get());
  result.machine.fitted_range = feedmodel::range_of(programs);
  result.residual_median_ms = limits.residual_median_ms;
  add_changes(result.parameters, start);
  judge(result, runs, options.keep_back_every);
  result.converged = limits.converged && drives_converged;
  result.message = !drives_converged ? "the fit of a drive did not converge"
                   : !limits.converged
                       ? "the fit of the limits did not converge: too few parts for its parameters, or too many steps"
                       : "converged";
  return result;
}

}  // namespace camber::calib
