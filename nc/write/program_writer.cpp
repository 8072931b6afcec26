#include "nc/write/program_writer.h"

#include <algorithm>
#include <cassert>
#include <cctype>

#include <fmt/format.h>

#include "nc/language.h"

namespace camber::nc {
namespace {

std::size_t lines_of(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

std::string ProgramWriter::program_name(std::string_view title) {
  std::string out;
  for (const char c : title) {
    const auto byte = static_cast<unsigned char>(c);
    out += std::isalnum(byte) ? static_cast<char>(std::toupper(byte)) : '_';
  }
  return out;
}

void ProgramWriter::begin() { write_head(); }

void ProgramWriter::change_tool(const WrittenTool& tool) {
  if (!out_.operations.empty()) write_spindle_stop();
  into_ = &out_.operations.emplace_back();
  at_.reset(), feed_.clear();
  write_tool(tool);
}

std::string ProgramWriter::changed_places(const Vec3& to) {
  std::string out;
  for (int a = 0; a < 3; ++a) {
    const std::string now = coordinate("XYZ"[a], to[a]);
    if (at_ && now == coordinate("XYZ"[a], (*at_)[a])) continue;
    out += (out.empty() ? "" : " ") + now;
  }
  return out;
}

void ProgramWriter::rapid(const Vec3& to) {
  const std::string words = changed_places(to);
  if (!words.empty()) write_rapid(words);
  at_ = to;
}

void ProgramWriter::line(const Vec3& to, double feed_mm_per_min) {
  const std::string words = changed_places(to);
  if (!words.empty()) write_line(words, feed_mm_per_min);
  at_ = to;
}

void ProgramWriter::arc(const Vec3& to, const Vec2& centre, bool counter_clockwise, double feed_mm_per_min,
                        Plane plane) {
  assert(at_);
  write_arc({*at_, to, centre, counter_clockwise, plane, changed_places(to)}, feed_mm_per_min);
  at_ = to;
}

void ProgramWriter::turn(char axis, double to_deg, std::optional<double> feed_deg_per_min) {
  const std::string words = coordinate(axis, to_deg);
  if (feed_deg_per_min)
    write_line(words, *feed_deg_per_min);
  else
    write_rapid(words);
}

std::string ProgramWriter::number(double value, int decimals) const {
  std::string out = fmt::format("{:.{}f}", value, decimals);
  while (out.back() == '0') out.pop_back();
  if (out == "-0.") out = "0.";
  if (!whole_numbers_have_points() && out.back() == '.') out.pop_back();
  return out;
}

std::string ProgramWriter::feed_word(double feed) {
  constexpr int kDecimals = 1;
  const std::string now = number(feed, kDecimals);
  if (now == feed_) return {};
  feed_ = now;
  return " F" + now;
}

WrittenProgram ProgramWriter::finish() {
  if (!out_.operations.empty()) write_spindle_stop();
  into_ = &out_.end;
  write_end();
  return std::move(out_);
}

std::unique_ptr<ProgramWriter> program_writer(const Dialect& dialect, WriterFormat format) {
  return language_of(dialect.language).writer(dialect, std::move(format));
}

std::string text_of(const Dialect& dialect, const WrittenProgram& program) {
  std::string lines = program.head;
  for (const std::string& operation : program.operations) lines += operation;
  lines += program.end;
  if (!language_of(dialect.language).lines_have_numbers) return lines;
  std::string out;
  std::size_t number = 0;
  for (std::size_t at = 0; at < lines.size();) {
    const std::size_t end = lines.find('\n', at) + 1;
    out += std::to_string(number++) + " " + lines.substr(at, end - at);
    at = end;
  }
  return out;
}

std::string operation_of(const Dialect& dialect, const WrittenProgram& program, const std::string& changed_text) {
  const bool numbers = language_of(dialect.language).lines_have_numbers;
  const std::size_t first = lines_of(program.head), behind = lines_of(changed_text) - lines_of(program.end);
  std::string out;
  std::size_t line = 0;
  for (std::size_t at = 0; at < changed_text.size(); ++line) {
    const std::size_t end = changed_text.find('\n', at) + 1;
    if (line >= first && line < behind) {
      const std::size_t from = numbers ? changed_text.find(' ', at) + 1 : at;
      out += changed_text.substr(from, end - from);
    }
    at = end;
  }
  return out;
}

}  // namespace camber::nc
