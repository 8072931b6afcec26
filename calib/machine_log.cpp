#include "calib/machine_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <string_view>

#include "base/numbers.h"

namespace camber::calib {
namespace {

constexpr double kHoldS = 1.0;           // feed 0 for longer within a stretch is a feed hold
constexpr double kHoleS = 3.0;           // an adapter that counts seconds is never silent for longer
constexpr double kFullOverride = 100.0;  // %
constexpr double kOverrideNoise = 0.5;   // %
constexpr std::size_t kBrokenShown = 3;
constexpr double kBrokenFraction = 0.05;
constexpr std::size_t kFewestEvents = 3;
constexpr std::string_view kPositionNames[] = {"abs", "act", "pos", "position", "actual", "actualposition"};

/// Seconds since 1970 of 2017-02-14T14:56:22.9058750Z.
std::optional<double> seconds_of(std::string_view text) {
  const auto number = [&](std::size_t at, std::size_t length) -> std::optional<int> {
    int value = 0;
    for (std::size_t i = at; i < at + length; ++i) {
      if (text[i] < '0' || text[i] > '9') return std::nullopt;
      value = 10 * value + (text[i] - '0');
    }
    return value;
  };
  if (text.size() < 19 || text[4] != '-' || text[7] != '-' || text[10] != 'T' || text[13] != ':' || text[16] != ':')
    return std::nullopt;
  if (text.back() == 'Z') text.remove_suffix(1);
  const auto year = number(0, 4), month = number(5, 2), day = number(8, 2), hour = number(11, 2),
             minute = number(14, 2);
  const auto second = parse_number(text.substr(17));
  if (!year || !month || !day || !hour || !minute || !second || *second < 0) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(*year), std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day))};
  if (!date.ok() || *hour > 23 || *minute > 59 || *second >= 61) return std::nullopt;
  const double days = static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
  return days * 86400.0 + *hour * 3600.0 + *minute * 60.0 + *second;
}

class LogReader {
 public:
  LogReader(const SourceText& source, Diagnostics& diagnostics) : source_(source), diagnostics_(diagnostics) {}

  MachineLog run() {
    log_.path = source_.name();
    const std::string_view text = source_.text();
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      std::string_view line = text.substr(begin, end - begin);
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      if (!line.empty()) read_line(line, begin);
      begin = end + 1;
    }
    diagnostics_.throw_if_errors();
    if (static_cast<double>(broken_) > kBrokenFraction * static_cast<double>(lines_))
      fail_on_file(log_.path,
                   fmt::format("{} of {} lines are not timestamp|item|value; is this a machine log?", broken_, lines_),
                   "log-fields");
    if (log_.line.empty() && !has_positions(log_))
      fail_on_file(log_.path,
                   "the log has no Block_Number and no Xabs, Yabs, Zabs; lines as "
                   "2017-02-14T14:56:34.62Z|Block_Number|18 were expected",
                   "log-item");
    return std::move(log_);
  }

 private:
  void report(Severity severity, std::size_t offset, std::string message, std::string check) {
    diagnostics_.add(source_.diagnostic(severity, offset, std::move(message), std::move(check)));
  }

  /// An adapter breaks a line now and then: not worth an error, unless the file is something else altogether.
  void broken(std::size_t offset) {
    if (++broken_ <= kBrokenShown)
      report(Severity::warning, offset, "this is not timestamp|item|value; the line is left out", "log-fields");
  }

  void read_line(std::string_view line, std::size_t offset) {
    ++lines_;
    const std::size_t bar = line.find('|'), bar2 = bar == line.npos ? bar : line.find('|', bar + 1);
    if (bar2 == line.npos) {
      broken(offset);
      return;
    }
    const std::string_view stamp = line.substr(0, bar);
    const auto seconds = seconds_of(stamp);
    if (!seconds) {
      report(Severity::error, offset,
             fmt::format("\"{}\" is not a time; one like 2017-02-14T14:56:22.905Z was expected", stamp), "log-time");
      return;
    }
    if (!begin_s_) begin_s_ = *seconds;
    const double t = *seconds - *begin_s_;
    if (!log_.any_s.empty() && t < log_.any_s.back()) {
      report(Severity::warning, offset, "the event is older than the one before it; it is left out", "log-time");
      return;
    }
    log_.any_s.push_back(t);
    std::string_view rest = line.substr(bar + 1);
    while (!rest.empty()) {
      const std::size_t middle = rest.find('|');
      if (middle == rest.npos) break;
      const std::size_t end = std::min(rest.find('|', middle + 1), rest.size());
      const std::string_view value = rest.substr(middle + 1, end - middle - 1);
      add(t, rest.substr(0, middle), value, static_cast<std::size_t>(value.data() - source_.text().data()));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }

  void add(double t, std::string_view item, std::string_view value, std::size_t offset) {
    if (value.empty() || value == "UNAVAILABLE") return;
    const std::string name = plain(item);
    if (name == "pathposition" || name == "pathpos") return add_path_position(t, item, value, offset);
    bool positive = true;
    std::vector<LogEvent>* into = events_of(name, positive);
    if (!into) return;
    const auto number = parse_number(value);
    if (!number || (positive && *number < 0)) {
      report(Severity::error, offset,
             fmt::format("{} is \"{}\"; a number{} was expected", item, value, positive ? " that is not negative" : ""),
             "log-number");
      return;
    }
    into->push_back({t, *number});
  }

  void add_path_position(double t, std::string_view item, std::string_view value, std::size_t offset) {
    std::array<double, 3> xyz{};
    std::string_view rest = value;
    for (double& v : xyz) {
      rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
      const std::size_t end = std::min(rest.find(' '), rest.size());
      const auto number = parse_number(rest.substr(0, end));
      if (!number) {
        report(Severity::error, offset, fmt::format("{} is \"{}\"; three numbers were expected", item, value),
               "log-number");
        return;
      }
      v = *number;
      rest.remove_prefix(end);
    }
    for (std::size_t i = 0; i < 3; ++i) log_.position_mm[i].push_back({t, xyz[i]});
  }

  /// Lower case, letters and digits alone.
  static std::string plain(std::string_view item) {
    std::string out;
    for (const char c : item) {
      const char lower = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
      if ((lower >= 'a' && lower <= 'z') || (lower >= '0' && lower <= '9')) out += lower;
    }
    return out;
  }

  std::vector<LogEvent>* events_of(const std::string& name, bool& positive) {
    const auto is_one_of = [&](std::initializer_list<std::string_view> names) {
      return std::ranges::find(names, std::string_view(name)) != names.end();
    };
    if (is_one_of({"blocknumber", "linenumber", "line"})) return &log_.line;
    if (is_one_of({"feedrate", "pathfeedrate", "fact", "feed"})) return &log_.feed_mm_per_s;
    if (is_one_of({"feedoverride", "pathfeedrateoverride", "fovr"})) return &log_.override_percent;
    const std::string_view axes = "xyz", after = std::string_view(name).substr(std::min<std::size_t>(1, name.size()));
    const std::size_t axis = name.empty() ? axes.npos : axes.find(name[0]);
    if (axis == axes.npos || std::ranges::find(kPositionNames, after) == std::end(kPositionNames)) return nullptr;
    positive = false;
    return &log_.position_mm[axis];
  }

  const SourceText& source_;
  Diagnostics& diagnostics_;
  MachineLog log_;
  std::optional<double> begin_s_;
  std::size_t lines_ = 0, broken_ = 0;
};

bool has_hole(const std::vector<double>& times, double from, double to) {
  auto at = std::lower_bound(times.begin(), times.end(), from);
  for (double last = from; last < to; ++at) {
    const double next = at == times.end() ? to : std::min(*at, to);
    if (next - last > kHoleS) return true;
    last = next;
    if (at == times.end()) break;
  }
  return false;
}

/// A value that holds from `from` on for longer than kHoldS before `to`, and is 0.
bool has_hold(const std::vector<LogEvent>& feed, double from, double to) {
  for (std::size_t i = 0; i < feed.size(); ++i) {
    if (feed[i].value > 0) continue;
    const double end = std::min(to, i + 1 < feed.size() ? feed[i + 1].t_s : to);
    if (end - std::max(from, feed[i].t_s) > kHoldS) return true;
  }
  return false;
}

/// 1 for 100 %, also where the log does not tell; nothing where it changes.
std::optional<double> constant_override(const std::vector<LogEvent>& overrides, double from, double to) {
  std::optional<double> found;
  for (std::size_t i = 0; i < overrides.size(); ++i) {
    const double end = i + 1 < overrides.size() ? overrides[i + 1].t_s : INFINITY;
    if (overrides[i].t_s >= to || end <= from) continue;
    if (found && std::abs(overrides[i].value - *found) > kOverrideNoise) return std::nullopt;
    found = found.value_or(overrides[i].value);
  }
  if (!found || std::abs(*found - kFullOverride) <= kOverrideNoise) return 1.0;
  if (*found <= 0) return std::nullopt;
  return *found / kFullOverride;
}

/// Interval at which the adapter looks: the median distance of line events that follow each other closely.
double interval_s(const MachineLog& log) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < log.line.size(); ++i) {
    const double step = log.line[i].t_s - log.line[i - 1].t_s;
    if (step > 0 && step < 1.0) steps.push_back(step);
  }
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

}  // namespace

bool is_machine_log(const std::string& path) {
  const SourceText source = SourceText::read(path);
  const std::string_view line = source.line_count() > 0 ? source.line(1) : std::string_view();
  return std::count(line.begin(), line.end(), '|') >= 2;
}

MachineLog read_machine_log(const std::string& path, Diagnostics& diagnostics) {
  const SourceText source = SourceText::read(path);
  return LogReader(source, diagnostics).run();
}

std::vector<TimedStretch> logged_stretches(const MachineLog& log, const std::vector<FeedStretch>& stretches) {
  // Each end is late by 0 to one interval, evenly: the difference has interval / sqrt(6).
  const double sigma = interval_s(log) / std::sqrt(6.0);
  std::vector<TimedStretch> timed;
  std::size_t i = 0;
  for (const FeedStretch& s : stretches) {
    const auto inside = [&](std::size_t k) {
      return log.line[k].value >= s.line_first && log.line[k].value <= s.line_last;
    };
    std::size_t first = i;
    while (first < log.line.size() && !inside(first)) ++first;
    std::size_t end = first;
    while (end < log.line.size() && inside(end)) ++end;
    if (end == log.line.size()) continue;
    i = end;
    const double from = log.line[first].t_s, to = log.line[end].t_s;
    const auto override = steady_override(log, from, to);
    if (end - first < kFewestEvents || !override) continue;
    timed.push_back({s, to - from, sigma, *override});
  }
  return timed;
}

std::optional<double> steady_override(const MachineLog& log, double from_s, double to_s) {
  if (has_hole(log.any_s, from_s, to_s) || has_hold(log.feed_mm_per_s, from_s, to_s)) return std::nullopt;
  return constant_override(log.override_percent, from_s, to_s);
}

bool has_positions(const MachineLog& log) {
  return std::ranges::all_of(log.position_mm, [](const auto& events) { return !events.empty(); });
}

ServoTrace position_trace(const MachineLog& log) {
  std::vector<double> times;
  for (const auto& events : log.position_mm)
    for (const LogEvent& e : events) times.push_back(e.t_s);
  std::ranges::sort(times);
  times.erase(std::unique(times.begin(), times.end()), times.end());
  ServoTrace trace;
  trace.path = log.path;
  trace.has_actual = {true, true, true};
  std::array<std::size_t, 3> next{};
  for (const double t : times) {
    Vec3 at = Vec3::Zero();
    bool known = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& events = log.position_mm[i];
      while (next[i] < events.size() && events[next[i]].t_s <= t) ++next[i];
      known = known && next[i] > 0;
      if (next[i] > 0) at[static_cast<Eigen::Index>(i)] = events[next[i] - 1].value;
    }
    if (!known) continue;
    trace.t_s.push_back(t);
    trace.command_mm.emplace_back(Vec3::Zero());
    trace.actual_mm.push_back(at);
  }
  if (trace.size() > 1) set_stretches(trace);
  return trace;
}

}  // namespace camber::calib
