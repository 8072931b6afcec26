#include "calib/feed_accuracy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <sstream>

#include "base/numbers.h"
#include "base/units.h"
#include "calib/line_speeds.h"
#include "feedmodel/timed_path.h"
#include "kinematics/joint_map.h"

namespace camber::calib {
namespace {

constexpr double kPartPercent = 0.5;
constexpr double kMoves = 2e-3;  // mm or degrees between two samples
constexpr double kCornerS = 0.02;
constexpr double kAtFeed = 0.98;  // of the programmed feed

/// Samples that trace and model have in common.
struct Record {
  double period_s = 0;
  std::vector<Vec3> command_mm, actual_mm;
  std::vector<std::uint32_t> line;
  std::vector<Vec3> rotary_actual_deg{};  ///< of programs with rotary motion
  std::vector<char> in_degrees{};         ///< where F counts degrees; empty: nowhere
};

/// Replaces the actual positions by what F counts, sample by sample: X Y Z, the tip in the part's frame, or degrees.
void set_feed_points(Record& r, const nc::Interpretation& program, const machine::Machine& machine) {
  if (!kinematics::has_rotary_motion(program, machine) || r.rotary_actual_deg.empty()) return;
  const std::vector<LineFeed> lines = feeds_of_lines(program, machine);
  const kinematics::JointMap map(machine, program);
  const LineFeed* line = nullptr;
  r.in_degrees.assign(r.line.size(), 0);
  for (std::size_t k = 0; k < r.line.size(); ++k) {
    if (r.line[k] < lines.size() && lines[r.line[k]].turn) line = &lines[r.line[k]];
    if (!line) continue;
    r.in_degrees[k] = line->rotary_alone;
    if (line->rotary_alone)
      r.actual_mm[k] = r.rotary_actual_deg[k];
    else if (line->turn->tip_control)
      r.actual_mm[k] =
          map.tool({r.actual_mm[k], r.rotary_actual_deg[k] * (kPi / 180)}, line->turn->tool_length_mm).tip_mm;
  }
}

Record record_of_joints(const nc::Interpretation& program, const machine::Machine& machine) {
  Record r;
  r.period_s = machine.control.period_s;
  const auto add = [&](std::span<const feedmodel::TimedSample> samples,
                       std::span<const feedmodel::JointSample> joints) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      r.command_mm.push_back(samples[i].command_mm + joints[i].command_rad);  // only looked at for changes
      r.actual_mm.push_back(samples[i].position_mm);
      r.rotary_actual_deg.push_back(joints[i].position_rad * (180 / kPi));
      const bool rests = samples[i].feed_command_mm_per_s == 0;
      r.line.push_back(rests ? 0 : program.moves[samples[i].move].block + 1);
    }
  };
  feedmodel::predict_joints(program, machine, add);
  set_feed_points(r, program, machine);
  return r;
}

Record record_of(const ServoTrace& trace, const nc::Interpretation& program, const machine::Machine& machine) {
  Record r{trace.period_s, trace.command_mm, trace.actual_mm, trace.line, trace.rotary_actual_deg};
  if (!kinematics::has_rotary_motion(program, machine)) return r;
  for (std::size_t k = 0; k < trace.rotary_command_deg.size(); ++k) r.command_mm[k] += trace.rotary_command_deg[k];
  set_feed_points(r, program, machine);
  return r;
}

Record record_of(const nc::Interpretation& program, const machine::Machine& machine) {
  if (kinematics::has_rotary_motion(program, machine)) return record_of_joints(program, machine);
  Record r;
  r.period_s = machine.control.period_s;
  feedmodel::predict_feed(program, machine, [&](std::span<const feedmodel::TimedSample> run) {
    for (const feedmodel::TimedSample& s : run) {
      r.command_mm.push_back(s.command_mm);
      r.actual_mm.push_back(s.position_mm);
      const bool rests = s.feed_command_mm_per_s == 0;
      r.line.push_back(rests ? 0 : program.moves[s.move].block + 1);
    }
  });
  return r;
}

struct Window {
  std::size_t first = 0, commanded_end = 0, end = 0;  ///< end - commanded_end: the tail
};

/// Windows of all parts in one walk. Parts are in the order of their lines.
std::vector<Window> windows_of(const Record& r, const std::vector<TracePart>& parts) {
  std::vector<Window> windows(parts.size());
  std::size_t i = 0;
  const std::size_t n = r.line.size();
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const auto inside = [&](std::size_t k) {
      return r.line[k] >= parts[p].line_first && r.line[k] <= parts[p].line_last;
    };
    std::size_t k = i;
    while (k < n && !inside(k)) ++k;
    if (k == n) continue;
    Window& w = windows[p];
    w.first = k;
    for (; k < n && (inside(k) || r.line[k] == 0); ++k) {
      if (inside(k)) w.commanded_end = k + 1;
    }
    w.end = k;
    i = w.commanded_end;
  }
  return windows;
}

/// Leaves out parts of which the trace has a piece only, since it begins or ends in motion, or misses samples in them.
void drop_incomplete(const ServoTrace& trace, std::vector<Window>& windows) {
  const auto moves = [&](std::size_t k) {
    const std::size_t from = k > 0 ? k - 1 : k, to = std::min(k + 1, trace.size() - 1);
    return joint_step(trace, from, to) > kMoves;
  };
  for (Window& w : windows)
    for (const Stretch& s : trace.stretches) {
      const bool missing = s.first > w.first && s.first < w.commanded_end;
      const bool begins = s.first == w.first && moves(w.first), ends = s.end == w.commanded_end && moves(s.end - 1);
      if (w.commanded_end > w.first && (missing || begins || ends)) w.end = w.commanded_end = w.first;
    }
}

Vec3 velocity_at(const Record& r, const Window& w, std::size_t k, std::size_t half) {
  const std::size_t from = std::max(k, w.first + half) - half, to = std::min(k + half, w.end - 1);
  if (to <= from) return Vec3::Zero();
  return (r.actual_mm[to] - r.actual_mm[from]) / (static_cast<double>(to - from) * r.period_s);
}

/// Speed at stations that lie evenly over the fraction of the length that the axes really went.
struct Profile {
  std::vector<double> speed;
  std::vector<Vec3> velocity;
  std::vector<std::size_t> sample;  ///< the one before the station
};

Profile profile_of(const Record& r, const Window& w, const FeedAccuracyOptions& options) {
  std::vector<double> length{0.0};
  for (std::size_t k = w.first + 1; k < w.end; ++k)
    length.push_back(length.back() + (r.actual_mm[k] - r.actual_mm[k - 1]).norm());
  const auto half = static_cast<std::size_t>(std::max(1L, std::lround(options.speed_window_s / r.period_s / 2)));
  Profile out;
  std::size_t k = 0;
  for (std::size_t i = 0; i < options.stations; ++i) {
    const double s = (static_cast<double>(i) + 0.5) / static_cast<double>(options.stations) * length.back();
    while (k + 2 < length.size() && length[k + 1] < s) ++k;
    const double step = length[k + 1] - length[k];
    const double u = step > 0 ? (s - length[k]) / step : 0.0;
    const Vec3 a = velocity_at(r, w, w.first + k, half), b = velocity_at(r, w, w.first + k + 1, half);
    out.speed.push_back((1 - u) * a.norm() + u * b.norm());
    out.velocity.emplace_back((1 - u) * a + u * b);
    out.sample.push_back(w.first + k);
  }
  return out;
}

// --- residuals by kind and axis ---------------------------------------------------------------------------------

/// Marks the lines with arcs, by their 1-based numbers.
std::vector<char> arc_lines(const nc::Interpretation& program) {
  std::vector<char> arcs;
  for (const nc::Move& move : program.moves) {
    if (arcs.size() <= move.block + 1) arcs.resize(move.block + 2, 0);
    arcs[move.block + 1] = move.kind == nc::MoveKind::arc;
  }
  return arcs;
}

bool near_a_corner(const Record& r, const Window& w, std::size_t k) {
  const auto reach = static_cast<std::size_t>(std::max(1L, std::lround(kCornerS / r.period_s)));
  const auto another = [&](std::size_t i) { return r.line[i] != 0 && r.line[k] != 0 && r.line[i] != r.line[k]; };
  return another(std::max(k, w.first + reach) - reach) || another(std::min(k + reach, w.commanded_end - 1));
}

PathState state_at(const Record& r, const Window& w, const std::vector<char>& arcs, std::size_t k, double feed_share) {
  if (near_a_corner(r, w, k)) return PathState::corner;
  if (r.line[k] < arcs.size() && arcs[r.line[k]]) return PathState::arc;
  return feed_share >= kAtFeed ? PathState::feed : PathState::ramp;
}

/// `rms_percent` is a sum of squares until take_roots().
void count_residual(SpeedResidual& residual, double percent) {
  ++residual.stations;
  residual.rms_percent += percent * percent;
}

void take_roots(std::span<SpeedResidual> residuals) {
  for (SpeedResidual& r : residuals)
    if (r.stations > 0) r.rms_percent = std::sqrt(r.rms_percent / static_cast<double>(r.stations));
}

void add_residuals(FeedAccuracy& result, const Record& traced, const Window& w, const std::vector<char>& arcs,
                   double feed_mm_per_s, const Profile& a, const Profile& b) {
  const bool in_degrees = !traced.in_degrees.empty() && traced.in_degrees[w.first];
  for (std::size_t i = 0; i < a.speed.size(); ++i) {
    const PathState state = state_at(traced, w, arcs, a.sample[i], a.speed[i] / feed_mm_per_s);
    count_residual(result.by_state[static_cast<std::size_t>(state)], 100 * (b.speed[i] - a.speed[i]) / feed_mm_per_s);
    for (int axis = 0; axis < 3 && !in_degrees; ++axis)
      count_residual(result.by_axis[static_cast<std::size_t>(axis)],
                     100 * (b.velocity[i][axis] - a.velocity[i][axis]) / feed_mm_per_s);
  }
}

SpeedProfiles kept_speeds(const Profile& a, const Profile& b, std::size_t kept) {
  SpeedProfiles out;
  for (std::size_t i = 0; i < kept; ++i) {
    const std::size_t at = (2 * i + 1) * a.speed.size() / (2 * kept);
    out.traced.push_back(static_cast<float>(a.speed[at]));
    out.model.push_back(static_cast<float>(b.speed[at]));
  }
  return out;
}

double percentile_95(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double root_mean_square(const std::vector<double>& values) {
  double sum = 0;
  for (double v : values) sum += v * v;
  return values.empty() ? 0 : std::sqrt(sum / static_cast<double>(values.size()));
}

/// `t_s`: of the samples; empty: they are a period apart.
double motion_time(const Record& r, const std::vector<double>& t_s) {
  std::size_t first = r.command_mm.size(), last = 0;
  for (std::size_t k = 1; k < r.command_mm.size(); ++k) {
    if (r.command_mm[k] == r.command_mm[k - 1]) continue;
    first = std::min(first, k - 1);
    last = k;
  }
  if (last <= first) return 0;
  return t_s.empty() ? static_cast<double>(last - first) * r.period_s : t_s[last] - t_s[first];
}

/// Time of each line at its programmed feed, by its 1-based number.
std::vector<double> programmed_line_times_s(const nc::Interpretation& program, const machine::Machine& machine) {
  std::vector<double> line_s;
  if (kinematics::has_rotary_motion(program, machine)) {
    for (const LineFeed& line : feeds_of_lines(program, machine))
      line_s.push_back(line.feed_per_s > 0 ? line.length / line.feed_per_s : 0.0);
    return line_s;
  }
  for (const nc::Move& move : program.moves) {
    if (move.kind != nc::MoveKind::linear && move.kind != nc::MoveKind::arc) continue;
    if (line_s.size() <= move.block + 1) line_s.resize(move.block + 2, 0.0);
    line_s[move.block + 1] += length_mm(program, move) / move.feed_mm_per_s;
  }
  return line_s;
}

}  // namespace

std::vector<TracePart> parts_of(const nc::Interpretation& program) {
  std::vector<TracePart> parts;
  bool open = false;
  for (const nc::Move& move : program.moves) {
    const bool cutting = move.kind == nc::MoveKind::linear || move.kind == nc::MoveKind::arc;
    if (!cutting) {
      open = false;
      continue;
    }
    if (open && parts.back().feed_mm_per_s == move.feed_mm_per_s) {
      parts.back().line_last = move.block + 1;
    } else {
      parts.push_back({move.block + 1, move.block + 1, move.feed_mm_per_s});
    }
    open = true;
  }
  return parts;
}

std::vector<TracePart> parts_of(const nc::Interpretation& program, const machine::Machine& machine) {
  if (!kinematics::has_rotary_motion(program, machine)) return parts_of(program);
  const std::vector<LineFeed> lines = feeds_of_lines(program, machine);
  std::vector<TracePart> parts;
  const LineFeed* last = nullptr;  // of the open part
  double last_f = 0;
  for (const nc::Move& move : program.moves) {
    const LineFeed& line = lines[std::min<std::size_t>(move.block + 1, lines.size() - 1)];
    if (move.kind == nc::MoveKind::dwell || !line.cutting) {
      last = nullptr;
      continue;
    }
    if (line.length <= 0) continue;
    const auto meaning = line.turn->feed;
    const bool inverse = meaning == kinematics::FeedMeaning::inverse;
    // Speeds of lines that only turn are in degrees.
    if (last && meaning == last->turn->feed && line.rotary_alone == last->rotary_alone &&
        (inverse || move.feed_mm_per_s == last_f))
      parts.back().line_last = move.block + 1;
    else
      parts.push_back({move.block + 1, move.block + 1, line.feed_per_s});
    last = &line;
    last_f = move.feed_mm_per_s;
  }
  return parts;
}

std::vector<TracePart> read_parts(const std::string& path) {
  const SourceText source = SourceText::read(path);
  std::istringstream text(source.text());
  std::string line, field;
  std::vector<std::string> header;
  std::vector<TracePart> parts;
  while (std::getline(text, line)) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) continue;
    std::istringstream row(line);
    std::vector<std::string> fields;
    while (std::getline(row, field, ',')) fields.push_back(field);
    if (header.empty()) {
      header = fields;
      continue;
    }
    const auto value = [&](std::string_view name) {
      const auto at = std::find(header.begin(), header.end(), name) - header.begin();
      const auto v = at < static_cast<std::ptrdiff_t>(fields.size()) ? parse_number(fields[at]) : std::nullopt;
      if (!v) fail_on_file(path, "column " + std::string(name) + " is missing or not a number", "parts-column");
      return *v;
    };
    const auto line_of = [&](std::string_view name) {
      const double line_number = value(name);
      if (!(line_number >= 0 && line_number <= std::numeric_limits<std::uint32_t>::max()))
        fail_on_file(path, "column " + std::string(name) + " has a value that is no line of a program", "parts-column");
      return static_cast<std::uint32_t>(line_number);
    };
    const std::uint32_t first = line_of("line_first"), last = line_of("line_last");
    parts.push_back({first, last, mm_per_s_from_mm_per_min(value("feed_mm_min"))});
  }
  return parts;
}

PartTimes part_times(const FeedAccuracy& accuracy) {
  PartTimes times;
  times.parts = accuracy.parts.size();
  if (accuracy.parts.empty()) return times;
  std::vector<double> errors;
  for (const PartAccuracy& p : accuracy.parts) errors.push_back(100 * std::abs(p.time_model_s / p.time_trace_s - 1));
  std::sort(errors.begin(), errors.end());
  for (double e : errors) {
    times.mean += e / static_cast<double>(errors.size());
    times.over += e > kPartPercent;
  }
  times.p90 = errors[static_cast<std::size_t>(std::ceil(0.9 * static_cast<double>(errors.size()))) - 1];
  times.worst = errors.back();
  return times;
}

FeedAccuracy constant_feed_accuracy(const ServoTrace& trace, const nc::Interpretation& program,
                                    const machine::Machine& machine, const std::vector<TracePart>& parts,
                                    const FeedAccuracyOptions& options) {
  const Record traced = record_of(trace, program, machine);
  const std::vector<double> line_s = programmed_line_times_s(program, machine);
  FeedAccuracy result;
  if (trace.line.empty()) return result;
  auto windows = windows_of(traced, parts);
  drop_incomplete(trace, windows);
  std::vector<double> all;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (windows[p].end < windows[p].first + 3) continue;
    PartAccuracy part;
    part.part = parts[p];
    part.time_trace_s = static_cast<double>(windows[p].commanded_end - windows[p].first) * traced.period_s;
    for (std::size_t line = parts[p].line_first; line <= parts[p].line_last && line < line_s.size(); ++line)
      part.time_model_s += line_s[line];
    std::vector<double> errors = profile_of(traced, windows[p], options).speed;
    for (double& e : errors) e = 100 * std::abs(1 - e / parts[p].feed_mm_per_s);
    part.speed_rms_percent = root_mean_square(errors);
    part.speed_p95_percent = percentile_95(errors);
    result.time_trace_s += part.time_trace_s;
    result.time_model_s += part.time_model_s;
    result.part_time_error_percent += 100 * std::abs(part.time_model_s / part.time_trace_s - 1);
    all.insert(all.end(), errors.begin(), errors.end());
    result.parts.push_back(part);
  }
  if (!result.parts.empty()) result.part_time_error_percent /= static_cast<double>(result.parts.size());
  if (result.time_trace_s > 0) result.time_error_percent = 100 * (result.time_model_s / result.time_trace_s - 1);
  result.speed_rms_percent = root_mean_square(all);
  result.speed_p95_percent = percentile_95(all);
  return result;
}

FeedAccuracy feed_accuracy(const ServoTrace& trace, const nc::Interpretation& program, const machine::Machine& machine,
                           const std::vector<TracePart>& parts, const FeedAccuracyOptions& options) {
  const Record traced = record_of(trace, program, machine);
  const Record model = record_of(program, machine);
  FeedAccuracy result;
  result.time_trace_s = motion_time(traced, trace.t_s);
  result.time_model_s = motion_time(model, {});
  if (result.time_trace_s > 0) result.time_error_percent = 100 * (result.time_model_s / result.time_trace_s - 1);
  if (trace.line.empty()) return result;

  auto in_trace = windows_of(traced, parts);
  const auto in_model = windows_of(model, parts);
  drop_incomplete(trace, in_trace);
  const std::vector<char> arcs = arc_lines(program);
  std::vector<double> all;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (in_trace[p].end < in_trace[p].first + 3 || in_model[p].end < in_model[p].first + 3) continue;
    PartAccuracy part;
    part.part = parts[p];
    part.time_trace_s = static_cast<double>(in_trace[p].commanded_end - in_trace[p].first) * traced.period_s;
    part.time_model_s = static_cast<double>(in_model[p].commanded_end - in_model[p].first) * model.period_s;
    const Profile a = profile_of(traced, in_trace[p], options), b = profile_of(model, in_model[p], options);
    std::vector<double> errors(a.speed.size());
    for (std::size_t i = 0; i < errors.size(); ++i)
      errors[i] = 100 * std::abs(b.speed[i] - a.speed[i]) / parts[p].feed_mm_per_s;
    add_residuals(result, traced, in_trace[p], arcs, parts[p].feed_mm_per_s, a, b);
    part.speeds = kept_speeds(a, b, std::min(options.kept_stations, options.stations));
    part.speed_rms_percent = root_mean_square(errors);
    part.speed_p95_percent = percentile_95(errors);
    result.part_time_error_percent += 100 * std::abs(part.time_model_s / part.time_trace_s - 1);
    all.insert(all.end(), errors.begin(), errors.end());
    result.parts.push_back(part);
  }
  if (!result.parts.empty()) result.part_time_error_percent /= static_cast<double>(result.parts.size());
  result.speed_rms_percent = root_mean_square(all);
  result.speed_p95_percent = percentile_95(all);
  take_roots(result.by_state);
  take_roots(result.by_axis);
  if (result.parts.size() == parts.size() || result.parts.empty()) return result;
  // The trace has a piece of the program: the times of its whole parts are what can be compared.
  result.time_trace_s = result.time_model_s = 0;
  for (const PartAccuracy& part : result.parts) {
    result.time_trace_s += part.time_trace_s;
    result.time_model_s += part.time_model_s;
  }
  result.time_error_percent = 100 * (result.time_model_s / result.time_trace_s - 1);
  return result;
}

}  // namespace camber::calib
