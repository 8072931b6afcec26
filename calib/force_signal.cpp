#include "calib/force_signal.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/numbers.h"
#include "base/units.h"

namespace camber::calib {
namespace {

using machine::ForceLog;

/// A log of samples, as forces on the tool.
struct Signal {
  std::vector<double> t_s;
  std::vector<Vec3> force_N;
};

std::vector<Vec3> forces_of(ForceTable& table, const ForceLog& how) {
  constexpr const char* kKeys[] = {"fx", "fy", "fz"};
  std::vector<Vec3> out(table.rows(), Vec3::Zero());
  for (int a = 0; a < 3; ++a) {
    if (!how.force[static_cast<std::size_t>(a)]) continue;
    const auto values = table.values(*how.force[static_cast<std::size_t>(a)], kKeys[a]);
    for (std::size_t i = 0; i < values.size(); ++i) out[i][a] = how.on_work ? -values[i] : values[i];
  }
  return out;
}

deflection::Milling milling_of(const ForceLog& how) {
  return how.up_milling ? deflection::Milling::up : deflection::Milling::down;
}

void read_means(ForceTable& table, MeasuredLog& log, const Diagnostics& diagnostics) {
  const ForceLog& how = log.how;
  const auto force = forces_of(table, how);
  const auto rpm = table.values(how.spindle_rpm, "spindle_rpm");
  const auto feed = table.values(how.feed, how.feed_is_per_tooth ? "feed_per_tooth_mm" : "feed_mm_per_min");
  const auto ap = table.values(how.axial_depth_mm, "ap_mm"), ae = table.values(how.radial_depth_mm, "ae_mm");
  if (diagnostics.has_errors()) return;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const struct {
      const char* name;
      double value;
    } positive[] = {{"spindle_rpm", rpm[i]}, {"the feed", feed[i]}, {"ap_mm", ap[i]}, {"ae_mm", ae[i]}};
    for (const auto& p : positive)
      if (p.value <= 0)
        table.error_at_row(i, fmt::format("{} is {}; a number greater than zero was expected", p.name, p.value),
                           "force-log");
    if (ae[i] > how.tool.diameter_mm * (1 + 1e-9))
      table.error_at_row(
          i, fmt::format("ae_mm is {}; at most the tool's diameter, {}, was expected", ae[i], how.tool.diameter_mm),
          "force-log");
    MeasuredCut cut;
    cut.name = fmt::format("{}:{}", log.path, table.line(i));
    cut.spindle_speed_rpm = rpm[i];
    cut.cut = {how.feed_is_per_tooth ? feed[i] : feed[i] / (rpm[i] * how.tool.flutes), ap[i],
               std::min(ae[i], how.tool.diameter_mm), milling_of(how)};
    cut.mean_N = force[i];
    log.cuts.push_back(std::move(cut));
  }
}

/// Takes a straight line through the idle ranges off each component.
void remove_drift(Signal& signal, const ForceLog& how, const std::string& path, Diagnostics& diagnostics) {
  if (how.idle_s.empty()) {
    diagnostics.add({Severity::warning,
                     {path, 0, 0},
                     "no idle_s in [force_log]: the forces are taken as they are, including any drift; ranges in which "
                     "the tool turns in air were expected",
                     "force-drift",
                     {}});
    return;
  }
  double n = 0, st = 0, stt = 0;
  Vec3 sf = Vec3::Zero(), stf = Vec3::Zero();
  for (const auto& range : how.idle_s) {
    const double before = n;
    for (std::size_t i = 0; i < signal.t_s.size(); ++i) {
      const double t = signal.t_s[i];
      if (t < range[0] || t > range[1]) continue;
      n += 1, st += t, stt += t * t;
      sf += signal.force_N[i], stf += t * signal.force_N[i];
    }
    if (n == before)
      fail_on_file(
          path, fmt::format("the log has no samples from {} to {} s, where idle_s says it is idle", range[0], range[1]),
          "force-log");
  }
  // With a single short range the slope is a guess over the whole log: level only, unless the ranges lie apart.
  const double spread = n * stt - st * st;
  const bool slope_known = how.idle_s.size() > 1 && spread > 0;
  const Vec3 slope = slope_known ? Vec3((n * stf - st * sf) / spread) : Vec3(Vec3::Zero());
  const Vec3 level = (sf - slope * st) / n;
  for (std::size_t i = 0; i < signal.t_s.size(); ++i) signal.force_N[i] -= level + slope * signal.t_s[i];
}

struct Folded {
  std::vector<Vec3> mean;
  std::vector<double> count;
};

/// Averages samples [from, to) by angle at this speed; `keep(turn)` chooses the turns.
template <class Keep>
Folded fold(const Signal& s, std::size_t from, std::size_t to, double rpm, int steps, Keep keep) {
  Folded out{std::vector<Vec3>(static_cast<std::size_t>(steps), Vec3::Zero()),
             std::vector<double>(static_cast<std::size_t>(steps), 0.0)};
  for (std::size_t i = from; i < to; ++i) {
    const double turns = (s.t_s[i] - s.t_s[from]) * rpm / 60;
    const double whole = std::floor(turns);
    if (!keep(static_cast<std::size_t>(whole))) continue;
    const auto step = std::min(static_cast<std::size_t>((turns - whole) * steps), out.mean.size() - 1);
    out.mean[step] += s.force_N[i];
    out.count[step] += 1;
  }
  for (std::size_t k = 0; k < out.mean.size(); ++k)
    if (out.count[k] > 0) out.mean[k] /= out.count[k];
  return out;
}

/// The speed at which the mean turn holds the most of the signal.
double best_speed_rpm(const Signal& s, std::size_t from, std::size_t to, double nominal_rpm) {
  constexpr int kSteps = 60;
  constexpr double kWithin = 0.01;
  const auto energy = [&](double rpm) {
    const Folded f = fold(s, from, to, rpm, kSteps, [](std::size_t) { return true; });
    double sum = 0;
    for (std::size_t k = 0; k < f.mean.size(); ++k) sum += f.count[k] * f.mean[k].squaredNorm();
    return sum;
  };
  const double turns = (s.t_s[to - 1] - s.t_s[from]) * nominal_rpm / 60;
  double best = nominal_rpm, most = energy(nominal_rpm), range = kWithin;
  // The peak is about 1 / turns wide; each pass looks between the last one's neighbours.
  const int n = std::max(4, static_cast<int>(std::ceil(kWithin * turns * 8)));
  double step = range / n;
  for (int i = -n; i <= n; ++i) {
    const double rpm = nominal_rpm * (1 + i * step), e = energy(rpm);
    if (e > most) most = e, best = rpm;
  }
  for (int pass = 0; pass < 4; ++pass) {
    const double centre = best;
    for (int i = -3; i <= 3; ++i) {
      const double rpm = centre + nominal_rpm * i * step / 4, e = energy(rpm);
      if (e > most) most = e, best = rpm;
    }
    step /= 4;
  }
  return best;
}

MeasuredCut measured_cut(const Signal& s, const machine::LoggedCut& logged, double rpm, const MeasuredLog& log) {
  constexpr std::size_t kHeldOutEvery = 4;
  constexpr int kMaxSteps = 180, kMinSteps = 24;
  const ForceLog& how = log.how;
  const auto from = static_cast<std::size_t>(std::ranges::lower_bound(s.t_s, logged.from_s) - s.t_s.begin());
  auto to = static_cast<std::size_t>(std::ranges::upper_bound(s.t_s, logged.to_s) - s.t_s.begin());
  const std::string name = fmt::format("{} from {} to {} s", log.path, logged.from_s, logged.to_s);
  const auto fail = [&](std::string what) {
    fail_on_file(log.path, fmt::format("the cut from {} to {} s {}", logged.from_s, logged.to_s, what), "force-log");
  };
  if (to < from + 2) fail("has no samples");
  const double sample_s = (s.t_s.back() - s.t_s.front()) / static_cast<double>(s.t_s.size() - 1);
  if (logged.from_s < s.t_s.front() - 1.5 * sample_s || logged.to_s > s.t_s.back() + 1.5 * sample_s)
    fail(fmt::format("reaches beyond the log, which has {:g} to {:g} s", s.t_s.front(), s.t_s.back()));
  MeasuredCut out;
  out.name = name;
  out.spindle_speed_rpm = how.waveform ? best_speed_rpm(s, from, to, rpm) : rpm;
  const double period_s = (s.t_s[to - 1] - s.t_s[from]) / static_cast<double>(to - 1 - from);
  const double turn_s = 60 / out.spindle_speed_rpm;
  out.turns = static_cast<std::size_t>(std::floor((s.t_s[to - 1] - s.t_s[from] + period_s) / turn_s + 1e-6));
  if (out.turns < 2) fail(fmt::format("lasts {} whole turns at {:g} rpm; at least two were expected", out.turns, rpm));
  while (to > from + 1 && s.t_s[to - 1] - s.t_s[from] >= static_cast<double>(out.turns) * turn_s - 1e-9) --to;
  for (std::size_t i = from; i < to; ++i) out.mean_N += s.force_N[i];
  out.mean_N /= static_cast<double>(to - from);
  out.cut = {logged.feed_mm_per_min / (out.spindle_speed_rpm * how.tool.flutes), logged.axial_depth_mm,
             std::min(logged.radial_depth_mm, how.tool.diameter_mm), milling_of(how)};
  // Published coefficients come from means by the closed forms, whose chip is straight; a waveform shows the circles.
  out.cut.circular_chip = how.waveform;
  if (!how.waveform) return out;
  if (out.turns < 8) fail(fmt::format("lasts {} whole turns; a waveform needs at least eight", out.turns));
  const double per_turn = turn_s / period_s;
  const int steps = std::clamp(static_cast<int>(static_cast<double>(to - from) / 8), 1, kMaxSteps) / how.tool.flutes *
                    how.tool.flutes;
  if (per_turn < kMinSteps || steps < kMinSteps)
    fail(fmt::format("has {:.1f} samples a turn; a waveform needs at least {}", per_turn, kMinSteps));
  const auto held = [](std::size_t turn) { return turn % kHeldOutEvery == kHeldOutEvery - 1; };
  Folded fitted = fold(s, from, to, out.spindle_speed_rpm, steps, [&](std::size_t t) { return !held(t); });
  out.waveform_N = std::move(fitted.mean);
  out.samples = std::move(fitted.count);
  Folded kept = fold(s, from, to, out.spindle_speed_rpm, steps, held);
  // Steps without a sample count for nothing: they take the fitted turns' value.
  for (std::size_t k = 0; k < kept.mean.size(); ++k)
    if (kept.count[k] == 0) kept.mean[k] = out.waveform_N[k];
  out.held_out_N = std::move(kept.mean);
  return out;
}

void read_samples(ForceTable& table, MeasuredLog& log, Diagnostics& diagnostics) {
  const ForceLog& how = log.how;
  Signal signal;
  signal.force_N = forces_of(table, how);
  signal.t_s = table.values(how.time, "t_s");
  const auto rpm = table.values(how.spindle_rpm, "spindle_rpm");
  if (diagnostics.has_errors()) return;
  if (how.time.constant)
    for (std::size_t i = 0; i < signal.t_s.size(); ++i) signal.t_s[i] = static_cast<double>(i) * *how.time.constant;
  for (std::size_t i = 1; i < signal.t_s.size(); ++i)
    if (signal.t_s[i] <= signal.t_s[i - 1]) {
      table.error_at_row(
          i, fmt::format("time {} s is not after the sample before it, {} s", signal.t_s[i], signal.t_s[i - 1]),
          "trace-time");
      return;
    }
  remove_drift(signal, how, log.path, diagnostics);
  for (const auto& cut : how.cuts) {
    const auto at = static_cast<std::size_t>(std::ranges::lower_bound(signal.t_s, cut.from_s) - signal.t_s.begin());
    log.cuts.push_back(measured_cut(signal, cut, rpm[std::min(at, rpm.size() - 1)], log));
  }
}

}  // namespace

MeasuredLog read_measured_log(const std::string& path, const ForceLog& how, Diagnostics& diagnostics) {
  MeasuredLog log;
  log.path = path;
  log.how = how;
  for (std::size_t a = 0; a < 3; ++a) log.has[a] = how.force[a].has_value();
  ForceTable table(path, how.header_line, diagnostics);
  if (how.contents == machine::LogContents::means)
    read_means(table, log, diagnostics);
  else
    read_samples(table, log, diagnostics);
  diagnostics.throw_if_errors();
  if (std::ranges::all_of(log.cuts, [](const MeasuredCut& c) { return c.mean_N.isZero(); }))
    fail_on_file(path, "every force is zero; forces of cuts were expected", "force-log");
  return log;
}

namespace {

constexpr std::size_t kNoColumn = static_cast<std::size_t>(-1);

bool is_blank(std::string_view text) { return text.find_first_not_of(" \t\r") == std::string_view::npos; }

}  // namespace

ForceTable::ForceTable(const std::string& path, int header_line, Diagnostics& diagnostics)
    : source_(SourceText::read(path)), diagnostics_(diagnostics) {
  const std::string& text = source_.text();
  std::size_t number = 0;
  bool have_header = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line(text.data() + at, end - at);
    ++number;
    if (!have_header && number >= static_cast<std::size_t>(header_line) && !is_blank(line)) {
      have_header = true;
      header_offset_ = at;
      separator_ = line.find('\t') != std::string_view::npos  ? '\t'
                   : line.find(';') != std::string_view::npos ? ';'
                                                              : ',';
    } else if (have_header && !is_blank(line)) {
      rows_.push_back({number, at});
    }
    at = end + 1;
  }
  if (!have_header || rows_.empty())
    fail_on_file(path, "the log is empty; a line that names the columns and rows of numbers were expected",
                 "trace-empty");
  // A row of units has no number in it.
  const auto first = fields(rows_.front().offset);
  if (std::ranges::none_of(first, [](const Field& f) { return parse_number(f.text).has_value(); }) && rows_.size() > 1)
    rows_.erase(rows_.begin());
}

std::vector<ForceTable::Field> ForceTable::fields(std::size_t offset) const {
  const std::string& text = source_.text();
  const std::size_t end = std::min(text.find('\n', offset), text.size());
  std::vector<Field> out;
  for (std::size_t at = offset; at <= end;) {
    std::size_t to = std::min(text.find(separator_, at), end), from = at;
    at = to + 1;
    const auto blank = [&](std::size_t i) { return text[i] == ' ' || text[i] == '\r' || text[i] == '"'; };
    while (from < to && blank(from)) ++from;
    while (to > from && blank(to - 1)) --to;
    out.push_back({std::string_view(text).substr(from, to - from), from});
  }
  return out;
}

std::size_t ForceTable::find_column(const machine::LogQuantity& q, const char* key) {
  const auto header = fields(header_offset_);
  const auto error = [&](std::string message) {
    diagnostics_.add(source_.diagnostic(Severity::error, header.front().offset, std::move(message), "trace-column"));
    return kNoColumn;
  };
  if (q.index > 0) {
    if (static_cast<std::size_t>(q.index) <= header.size()) return static_cast<std::size_t>(q.index - 1);
    return error(fmt::format("{} is column {}; the log has {} columns", key, q.index, header.size()));
  }
  const auto at = std::ranges::find(header, q.column, &Field::text);
  if (at != header.end()) return static_cast<std::size_t>(at - header.begin());
  std::vector<std::string_view> names;
  names.reserve(header.size());
  for (const Field& f : header) names.push_back(f.text);
  return error(fmt::format("there is no column \"{}\" for {} of [force_log]; the columns are {}", q.column, key,
                           fmt::join(names, ", ")));
}

std::vector<double> ForceTable::values(const machine::LogQuantity& q, const char* key) {
  if (q.constant) return std::vector<double>(rows_.size(), *q.constant);
  std::vector<double> out;
  const std::size_t column = find_column(q, key);
  if (column == kNoColumn) return std::vector<double>(rows_.size(), 1.0);
  out.reserve(rows_.size());
  for (const Row& row : rows_) {
    const auto all = fields(row.offset);
    if (column >= all.size()) {
      diagnostics_.add(source_.diagnostic(
          Severity::error, all.back().offset,
          fmt::format("{} fields; column {} was expected for {}", all.size(), column + 1, key), "trace-fields"));
      out.push_back(1);
      continue;
    }
    const auto value = parse_number(all[column].text);
    if (!value || !std::isfinite(*value)) {
      diagnostics_.add(source_.diagnostic(Severity::error, all[column].offset,
                                          fmt::format("{} is \"{}\"; a number was expected", key, all[column].text),
                                          "trace-number"));
      out.push_back(1);
      continue;
    }
    out.push_back(*value * q.scale);
  }
  return out;
}

void ForceTable::error_at_row(std::size_t row, std::string message, std::string check) {
  diagnostics_.add(source_.diagnostic(Severity::error, rows_[row].offset, std::move(message), std::move(check)));
}

}  // namespace camber::calib
