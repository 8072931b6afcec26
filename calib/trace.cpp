#include "calib/trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "base/numbers.h"
#include "base/units.h"

namespace camber::calib {
namespace {

constexpr double kGapPeriods = 1.5;  // more than this between two samples is a hole
constexpr std::size_t kGapsShown = 5;
constexpr double kMaxLine = 4e9;

/// Names of the columns, in the order of Quantity.
constexpr std::array<std::string_view, kQuantities> kColumnNames = {
    "t_s",  "x_cmd_mm",  "y_cmd_mm",  "z_cmd_mm",  "x_act_mm",  "y_act_mm",  "z_act_mm", "feed_mm_per_min",
    "line", "a_cmd_deg", "b_cmd_deg", "c_cmd_deg", "a_act_deg", "b_act_deg", "c_act_deg"};

using Values = std::array<double, kColumnNames.size()>;

struct Field {
  std::string_view text;
  std::size_t offset = 0;  ///< of its first character in the file
};

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

void split(std::string_view line, const char* file_begin, std::vector<Field>& fields) {
  fields.clear();
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    const std::string_view text = trimmed(line.substr(begin, end - begin));
    fields.push_back({text, static_cast<std::size_t>(text.data() - file_begin)});
    begin = end + 1;
  }
}

class Reader {
 public:
  Reader(const SourceText& source, Diagnostics& diagnostics) : source_(source), diagnostics_(diagnostics) {}

  ServoTrace run() {
    trace_.path = source_.name();
    std::string_view rest = source_.text();
    std::string_view line = next_line(rest);
    if (trimmed(line).empty())
      fail_on_file(trace_.path, "the trace is empty; a header line that names the columns is expected", "trace-empty");
    read_header(line);
    diagnostics_.throw_if_errors();
    while (!rest.empty()) {
      line = next_line(rest);
      ++row_;
      if (!trimmed(line).empty()) read_row(line);
    }
    diagnostics_.throw_if_errors();
    if (trace_.size() < 2)
      fail_on_file(trace_.path, fmt::format("the trace has {} samples; at least two are needed", trace_.size()),
                   "trace-empty");
    find_gaps();
    trace_.row = std::move(rows_);
    return std::move(trace_);
  }

 private:
  std::string_view next_line(std::string_view& rest) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    return line;
  }

  void report(Severity severity, const Field& field, std::string message, std::string check) {
    diagnostics_.add(source_.diagnostic(severity, field.offset, std::move(message), std::move(check)));
  }

  void read_header(std::string_view line) {
    split(line, source_.text().data(), fields_);
    std::array<bool, kColumnNames.size()> seen{};
    for (const Field& field : fields_) {
      const auto* at = std::find(kColumnNames.begin(), kColumnNames.end(), field.text);
      const auto index = static_cast<std::size_t>(at - kColumnNames.begin());
      columns_.push_back(at == kColumnNames.end() ? std::nullopt : std::optional(static_cast<Quantity>(index)));
      if (at == kColumnNames.end()) {
        report(Severity::warning, field, fmt::format("column \"{}\" is not known and is left out", field.text),
               "trace-column");
      } else if (seen[index]) {
        report(Severity::error, field, fmt::format("column {} appears twice in the header", field.text),
               "trace-column");
      } else {
        seen[index] = true;
      }
    }
    if (!seen[0]) report(Severity::error, fields_[0], "the header has no column t_s (time in seconds)", "trace-column");
    for (int i = 0; i < 3; ++i) {
      trace_.has_command[i] = seen[1 + i];
      trace_.has_actual[i] = seen[4 + i];
      trace_.has_rotary_command[i] = seen[9 + i];
      trace_.has_rotary_actual[i] = seen[12 + i];
    }
    has_rotary_ = std::any_of(seen.begin() + 9, seen.end(), [](bool b) { return b; });
    has_feed_ = seen[7];
    has_line_ = seen[8];
    if (!has_rotary_ && std::none_of(seen.begin() + 1, seen.begin() + 7, [](bool b) { return b; }))
      report(Severity::error, fields_[0],
             "the header has no position; at least one of x_cmd_mm y_cmd_mm z_cmd_mm x_act_mm y_act_mm z_act_mm is "
             "expected",
             "trace-column");
  }

  void read_row(std::string_view line) {
    split(line, source_.text().data(), fields_);
    if (fields_.size() != columns_.size()) {
      report(Severity::error, fields_.back(),
             fmt::format("{} fields; the header names {} columns", fields_.size(), columns_.size()), "trace-fields");
      return;
    }
    Values values{};
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      if (!columns_[i]) continue;
      const std::optional<double> value = parse_number(fields_[i].text);
      const auto column = static_cast<std::size_t>(*columns_[i]);
      if (!value || !std::isfinite(*value) || (columns_[i] == Quantity::line && (*value < 0 || *value > kMaxLine))) {
        report(Severity::error, fields_[i],
               fmt::format("{} is \"{}\"; a number is expected", kColumnNames[column], fields_[i].text),
               "trace-number");
        return;
      }
      values[column] = *value;
      if (columns_[i] == Quantity::time && trace_.size() > 0 && *value <= trace_.t_s.back()) {
        report(Severity::error, fields_[i],
               fmt::format("time {} s is not after the sample before it, {} s", fields_[i].text, trace_.t_s.back()),
               "trace-time");
        return;
      }
    }
    store(values);
    row_offsets_.push_back(fields_[0].offset);
    rows_.push_back(row_);
  }

  void store(const Values& v) {
    trace_.t_s.push_back(v[0]);
    trace_.command_mm.emplace_back(v[1], v[2], v[3]);
    trace_.actual_mm.emplace_back(v[4], v[5], v[6]);
    if (has_rotary_) {
      trace_.rotary_command_deg.emplace_back(v[9], v[10], v[11]);
      trace_.rotary_actual_deg.emplace_back(v[12], v[13], v[14]);
    }
    if (has_feed_) trace_.feed_mm_per_s.push_back(mm_per_s_from_mm_per_min(v[7]));
    if (has_line_) trace_.line.push_back(static_cast<std::uint32_t>(v[8]));
  }

  void find_gaps() {
    const std::vector<std::size_t> gaps = set_stretches(trace_);
    for (std::size_t n = 0; n < std::min(gaps.size(), kGapsShown); ++n)
      report_gap(gaps[n], trace_.t_s[gaps[n]] - trace_.t_s[gaps[n] - 1]);
    if (gaps.size() > kGapsShown)
      diagnostics_.add({.severity = Severity::warning,
                        .location = {trace_.path, 0, 0},
                        .message = fmt::format("{} more gaps in the trace", gaps.size() - kGapsShown),
                        .check = "trace-gap",
                        .source_line = {}});
  }

  void report_gap(std::size_t i, double step_s) {
    report(Severity::warning, {{}, row_offsets_[i]},
           fmt::format("{:.6g} s are missing before {:.6g} s (the samples are {:.6g} s apart); the parts before and "
                       "after are used separately",
                       step_s - trace_.period_s, trace_.t_s[i], trace_.period_s),
           "trace-gap");
  }

  const SourceText& source_;
  Diagnostics& diagnostics_;
  ServoTrace trace_;
  std::vector<std::optional<Quantity>> columns_;  ///< none: not known
  std::vector<Field> fields_;
  std::vector<std::size_t> row_offsets_, rows_;
  std::size_t row_ = 1;
  bool has_feed_ = false, has_line_ = false, has_rotary_ = false;
};

}  // namespace

double joint_position(const ServoTrace& trace, std::size_t sample, std::size_t joint) {
  const auto i = static_cast<Eigen::Index>(joint % 3);
  if (joint < 3) return trace.has_command[joint] ? trace.command_mm[sample][i] : trace.actual_mm[sample][i];
  if (trace.rotary_command_deg.empty()) return 0;
  return trace.has_rotary_command[joint - 3] ? trace.rotary_command_deg[sample][i] : trace.rotary_actual_deg[sample][i];
}

double joint_step(const ServoTrace& trace, std::size_t from, std::size_t to) {
  double most = 0;
  for (std::size_t joint = 0; joint < kJoints; ++joint)
    most = std::max(most, std::abs(joint_position(trace, to, joint) - joint_position(trace, from, joint)));
  return most;
}

std::vector<std::size_t> set_stretches(ServoTrace& trace) {
  std::vector<double> steps(trace.size() - 1);
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = trace.t_s[i + 1] - trace.t_s[i];
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  trace.period_s = std::round(*middle * 1e6) / 1e6 > 0 ? std::round(*middle * 1e6) / 1e6 : *middle;
  std::vector<std::size_t> gaps;
  trace.stretches.clear();
  std::size_t first = 0;
  for (std::size_t i = 1; i < trace.size(); ++i) {
    if (trace.t_s[i] - trace.t_s[i - 1] <= kGapPeriods * trace.period_s) continue;
    gaps.push_back(i);
    trace.stretches.push_back({first, i});
    first = i;
  }
  trace.stretches.push_back({first, trace.size()});
  return gaps;
}

ServoTrace rotary_trace(const ServoTrace& trace) {
  ServoTrace out = trace;
  out.command_mm = trace.rotary_command_deg;
  out.actual_mm = trace.rotary_actual_deg;
  out.has_command = trace.has_rotary_command;
  out.has_actual = trace.has_rotary_actual;
  if (!trace.rotary_command_deg.empty()) return out;
  out.command_mm.assign(trace.size(), Vec3::Zero());
  out.actual_mm.assign(trace.size(), Vec3::Zero());
  return out;
}

ServoTrace read_trace(const std::string& path, Diagnostics& diagnostics) {
  const SourceText source = SourceText::read(path);
  return Reader(source, diagnostics).run();
}

}  // namespace camber::calib
