#include "dynamics/modal_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/diagnostics.h"
#include "base/geometry.h"
#include "base/numbers.h"

namespace camber::dynamics {
namespace {

/// A field of columns [from, from + width) of a line, without blanks; empty where the line ends before.
std::string_view field(std::string_view line, std::size_t from, std::size_t width) {
  if (from >= line.size()) return {};
  std::string_view text = line.substr(from, width);
  const auto first = text.find_first_not_of(" \t\r");
  return first == text.npos ? std::string_view{} : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// Exponents of Fortran are written with D as well.
std::optional<double> fortran_number(std::string_view text) {
  std::string plain(text);
  std::ranges::replace(plain, 'D', 'E');
  std::ranges::replace(plain, 'd', 'E');
  return parse_number(plain);
}

/// A response of the file, as its header says.
struct UniversalResponse {
  std::size_t header = 0;  ///< line of the data set's number
  FrequencyResponse response;
  bool at_the_tap = false;  ///< response and reference are one point and one axis
};

class UniversalReader {
 public:
  explicit UniversalReader(const SourceText& source) : source_(source) {}

  FrequencyResponse read() {
    // Units may stand behind the data.
    for_each_set([&](std::size_t line, std::string_view number) {
      if (number == "164") read_units(line);
    });
    for_each_set([&](std::size_t line, std::string_view number) {
      if (number.starts_with("58b")) fail(line, "a binary data set 58; one in text was expected", "response-file");
      if (number == "58" && function_type(line) == 4) found_.push_back(read_response(line));
    });
    return chosen();
  }

 private:
  enum Ordinate { real_single = 2, real_double = 4, complex_single = 5, complex_double = 6 };

  [[noreturn]] void fail(std::size_t line, std::string message, std::string check) const {
    line = std::min(line, source_.line_count());
    throw InputError({{.severity = Severity::error,
                       .location = {source_.name(), line, 1},
                       .message = std::move(message),
                       .check = std::move(check),
                       .source_line = std::string(source_.line(line))}});
  }

  /// Calls f(line of its number, number) for every data set.
  template <class Function>
  void for_each_set(const Function& f) const {
    bool inside = false;
    for (std::size_t line = 1; line <= source_.line_count(); ++line) {
      if (field(source_.line(line), 0, 6) != "-1" || !field(source_.line(line), 6, 80).empty()) continue;
      inside = !inside;
      if (inside && line < source_.line_count()) f(line + 1, field(source_.line(line + 1), 0, 80));
    }
  }

  double number(std::size_t line, std::size_t from, std::size_t width, std::string_view what) const {
    const auto text = line <= source_.line_count() ? field(source_.line(line), from, width) : std::string_view{};
    const auto value = fortran_number(text);
    if (!value) fail(line, fmt::format("{}: \"{}\" is no number", what, text), "response-value");
    return *value;
  }

  /// A code or a count: none of them is negative or has more digits than this.
  int whole(std::size_t line, std::size_t from, std::size_t width, std::string_view what) const {
    const double value = number(line, from, width, what);
    if (!(value >= 0 && value <= 1e9)) fail(line, fmt::format("{}: {} cannot be", what, value), "response-value");
    return static_cast<int>(value);
  }

  /// Numbers of the file over these are SI.
  void read_units(std::size_t line) {
    length_ = number(line + 2, 0, 25, "factor of lengths");
    force_ = number(line + 2, 25, 25, "factor of forces");
  }

  int function_type(std::size_t line) const { return whole(line + 6, 0, 5, "function type"); }

  ResponseKind kind(std::size_t line) const {
    const int type = whole(line + 9, 0, 10, "type of the response");
    switch (type) {
      case 8:
        return ResponseKind::receptance;
      case 11:
        return ResponseKind::mobility;
      case 12:
        return ResponseKind::accelerance;
      default:
        fail(line + 9,
             fmt::format(
                 "the response is of type {}; 8 (displacement), 11 (velocity) or 12 (acceleration) was expected", type),
             "response-header");
    }
  }

  void expect_force(std::size_t line) const {
    const int type = whole(line + 10, 0, 10, "type of the reference");
    if (type != 13 && type != 9)
      fail(line + 10, fmt::format("the reference is of type {}; 13 (excitation force) was expected", type),
           "response-header");
  }

  bool at_the_tap(std::size_t line) const {
    const auto text = source_.line(line + 6);
    const auto axis = [](std::string_view t) { return t.starts_with('-') ? t.substr(1) : t; };
    return field(text, 41, 10) == field(text, 66, 10) && axis(field(text, 51, 4)) == axis(field(text, 76, 4));
  }

  UniversalResponse read_response(std::size_t line) const {
    UniversalResponse u{line, {}, at_the_tap(line)};
    u.response.path = source_.name();
    u.response.kind = kind(line);
    expect_force(line);
    const int ordinate = whole(line + 7, 0, 10, "type of the ordinates");
    const auto count = static_cast<std::size_t>(whole(line + 7, 10, 10, "number of values"));
    const bool even = number(line + 7, 20, 10, "spacing") == 1;
    const double first = number(line + 7, 30, 13, "lowest frequency"), step = number(line + 7, 43, 13, "step");
    if (ordinate != complex_single && ordinate != complex_double)
      fail(line + 7,
           fmt::format("ordinates of type {}; complex ones, 5 or 6, were expected: a response without a phase shows no "
                       "damping",
                       ordinate),
           "response-header");
    const auto numbers = data(line + 12, (even ? 2 : 3) * count);
    // [mm/N] of [m/N] = numbers * force / length.
    const double mm = 1000 * force_ / length_;
    for (std::size_t i = 0; i < count; ++i) {
      const double* at = &numbers[(even ? 2 : 3) * i];
      u.response.hz.push_back(even ? first + static_cast<double>(i) * step : at[0]);
      u.response.value.emplace_back(mm * at[even ? 0 : 1], mm * at[even ? 1 : 2]);
    }
    return u;
  }

  std::vector<double> data(std::size_t line, std::size_t count) const {
    std::vector<double> numbers;
    numbers.reserve(count);
    for (; numbers.size() < count; ++line) {
      if (line > source_.line_count() || field(source_.line(line), 0, 80) == "-1")
        fail(line, fmt::format("the data set ends after {} numbers; {} were expected", numbers.size(), count),
             "response-value");
      add_numbers(line, numbers);
    }
    return numbers;
  }

  void add_numbers(std::size_t line, std::vector<double>& numbers) const {
    const std::string_view text = source_.line(line);
    constexpr std::string_view kBlank = " \t\r";
    for (auto begin = text.find_first_not_of(kBlank); begin != text.npos;) {
      const auto end = std::min(text.find_first_of(kBlank, begin), text.size());
      const auto value = fortran_number(text.substr(begin, end - begin));
      if (!value) fail(line, fmt::format("\"{}\" is no number", text.substr(begin, end - begin)), "response-value");
      numbers.push_back(*value);
      begin = text.find_first_not_of(kBlank, end);
    }
  }

  FrequencyResponse chosen() {
    if (found_.size() > 1) std::erase_if(found_, [](const UniversalResponse& u) { return !u.at_the_tap; });
    if (found_.size() != 1)
      fail_on_file(source_.name(),
                   fmt::format("has {} frequency responses at the point of the tap; one was expected", found_.size()),
                   "response-count");
    return std::move(found_.front().response);
  }

  const SourceText& source_;
  double length_ = 1, force_ = 1;
  std::vector<UniversalResponse> found_;
};

/// See read_frequency_response.
FrequencyResponse read_universal_file(const SourceText& source) { return UniversalReader(source).read(); }

struct ResponseUnit {
  std::string_view word;
  ResponseKind kind;
  double mm;  ///< mm (per s, s2) per N in one of it
};
constexpr std::array kResponseUnits{
    ResponseUnit{"m_per_N", ResponseKind::receptance, 1e3},
    ResponseUnit{"mm_per_N", ResponseKind::receptance, 1},
    ResponseUnit{"um_per_N", ResponseKind::receptance, 1e-3},
    ResponseUnit{"m_per_s_per_N", ResponseKind::mobility, 1e3},
    ResponseUnit{"mm_per_s_per_N", ResponseKind::mobility, 1},
    ResponseUnit{"m_per_s2_per_N", ResponseKind::accelerance, 1e3},
    ResponseUnit{"mm_per_s2_per_N", ResponseKind::accelerance, 1},
    ResponseUnit{"g_per_N", ResponseKind::accelerance, 9806.65},
};

[[noreturn]] void fail_in_line(const SourceText& source, std::size_t line, std::string message, std::string check) {
  throw InputError({{.severity = Severity::error,
                     .location = {source.name(), line, 1},
                     .message = std::move(message),
                     .check = std::move(check),
                     .source_line = std::string(source.line(line))}});
}

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\"";
  const auto first = text.find_first_not_of(kBlanks);
  return first == text.npos ? std::string_view{} : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::vector<std::string_view> cells_of(std::string_view line) {
  const char separator = line.find(';') != line.npos ? ';' : line.find('\t') != line.npos ? '\t' : ',';
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    cells.push_back(without_blanks(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return cells;
}

/// Columns of the table by their meaning.
struct ResponseColumns {
  std::size_t hz = 0, first = 0, second = 0;
  bool polar = false;
  double radians = 1;  ///< per unit of the phase
  const ResponseUnit* unit = nullptr;

  std::complex<double> value(double a, double b) const {
    return unit->mm * (polar ? std::polar(a, b * radians) : std::complex<double>(a, b));
  }
};

const ResponseUnit* unit_named(std::string_view word) {
  for (const ResponseUnit& u : kResponseUnits)
    if (u.word == word) return &u;
  return nullptr;
}

ResponseColumns columns_of(const SourceText& source, std::size_t line) {
  std::optional<std::size_t> hz, re, im, magnitude, phase;
  ResponseColumns c;
  const auto cells = cells_of(source.line(line));
  std::string_view unit;
  const auto starts = [&](std::string_view name, std::string_view word, std::optional<std::size_t>& at, std::size_t i) {
    if (!name.starts_with(word)) return;
    at = i, unit = name.substr(word.size());
  };
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i] == "frequency_Hz") hz = i;
    if (cells[i] == "phase_deg" || cells[i] == "phase_rad")
      phase = i, c.radians = cells[i] == "phase_deg" ? kPi / 180 : 1;
    starts(cells[i], "re_", re, i);
    starts(cells[i], "im_", im, i);
    starts(cells[i], "magnitude_", magnitude, i);
  }
  c.polar = magnitude && phase;
  if (!hz || !((re && im) || c.polar))
    fail_in_line(source, line,
                 "the header has no frequency response; frequency_Hz with re_m_per_N and im_m_per_N, or with "
                 "magnitude_m_per_N and phase_deg, was expected",
                 "response-header");
  c.unit = unit_named(unit);
  if (!c.unit) {
    std::string words;
    for (const ResponseUnit& u : kResponseUnits) words += fmt::format("{}{}", words.empty() ? "" : ", ", u.word);
    fail_in_line(source, line, fmt::format("\"{}\" is no unit of a response; one of {} was expected", unit, words),
                 "response-header");
  }
  c.hz = *hz, c.first = c.polar ? *magnitude : *re, c.second = c.polar ? *phase : *im;
  return c;
}

double number_in(const SourceText& source, std::size_t line, const std::vector<std::string_view>& cells,
                 std::size_t i) {
  const auto value = i < cells.size() ? parse_number(cells[i]) : std::nullopt;
  if (!value)
    fail_in_line(source, line,
                 i < cells.size() ? fmt::format("\"{}\" is no number", cells[i])
                                  : fmt::format("the row has {} cells; at least {} were expected", cells.size(), i + 1),
                 "response-value");
  return *value;
}

FrequencyResponse read_response_csv(const SourceText& source) {
  std::size_t line = 1;
  while (line < source.line_count() && (source.line(line).empty() || source.line(line).front() == '#')) ++line;
  const ResponseColumns c = columns_of(source, line);
  FrequencyResponse r{.path = source.name(), .kind = c.unit->kind, .hz = {}, .value = {}};
  for (++line; line <= source.line_count(); ++line) {
    if (without_blanks(source.line(line)).empty()) continue;
    const auto cells = cells_of(source.line(line));
    const double hz = number_in(source, line, cells, c.hz);
    if (!r.hz.empty() && hz <= r.hz.back())
      fail_in_line(source, line, fmt::format("{} Hz is not above the row before it, {} Hz", hz, r.hz.back()),
                   "response-value");
    r.hz.push_back(hz);
    r.value.push_back(c.value(number_in(source, line, cells, c.first), number_in(source, line, cells, c.second)));
  }
  return r;
}

}  // namespace

std::complex<double> response_factor(ResponseKind kind, double hz) {
  const std::complex<double> s(0, 2 * kPi * hz);
  return kind == ResponseKind::receptance ? 1.0 : kind == ResponseKind::mobility ? s : s * s;
}

FrequencyResponse read_frequency_response(const std::string& path) {
  const SourceText source = SourceText::read(path);
  const bool universal = source.line_count() > 0 && without_blanks(source.line(1)) == "-1";
  FrequencyResponse r = universal ? read_universal_file(source) : read_response_csv(source);
  constexpr std::size_t kFewest = 16;
  if (r.hz.size() < kFewest)
    fail_on_file(path, fmt::format("has {} frequencies; at least {} were expected", r.hz.size(), kFewest),
                 "response-count");
  return r;
}

}  // namespace camber::dynamics
