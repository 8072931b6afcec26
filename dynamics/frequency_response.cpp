#include "dynamics/frequency_response.h"

#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/diagnostics.h"
#include "base/geometry.h"
#include "base/numbers.h"
#include "dynamics/universal_file.h"

namespace camber::dynamics {
namespace {

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

/// Which column has what.
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
