#include "copymill/program_writer.h"

#include <fmt/format.h>

#include "base/units.h"

namespace camber::copymill {
namespace {

/// With a point always: 12. and not 12, which some controls take for increments.
std::string number_text(double value, int decimals) {
  std::string out = fmt::format("{:.{}f}", value, decimals);
  while (out.back() == '0') out.pop_back();
  return out == "-0." ? "0." : out;
}

std::string tool_text(const machine::Tool& tool) {
  switch (tool.type) {
    case machine::ToolType::ball:
      return fmt::format("BALL D{:g}", tool.diameter_mm);
    case machine::ToolType::flat:
      return fmt::format("FLAT D{:g}", tool.diameter_mm);
    case machine::ToolType::bull:
      return fmt::format("BULL NOSE D{:g} R{:g}", tool.diameter_mm, tool.corner_radius_mm);
    case machine::ToolType::drill:
      return fmt::format("DRILL D{:g}", tool.diameter_mm);
    default:
      return fmt::format("D{:g}", tool.diameter_mm);
  }
}

std::string upper(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return out;
}

}  // namespace

ProgramWriter::ProgramWriter(const nc::Dialect& dialect, int decimals) : decimals_(decimals) {
  text_ = "%\n";
  if (dialect.has_program_number) text_ += "O0001 (COPY MILLING)\n";
  line("G21 G17 G90 G94 G40 G49 G80");
}

std::string ProgramWriter::word(char letter, double value) const { return letter + number_text(value, decimals_); }

void ProgramWriter::line(const std::string& text) { text_ += text + "\n", ++blocks_; }

void ProgramWriter::begin(const machine::CopyOperation& operation, const machine::Tool& tool, double safe_z) {
  if (begun_) line("M5");
  line(fmt::format("T{} M6 ({}, {})", tool.number, tool_text(tool), upper(machine::word_of(operation.mode))));
  line(fmt::format("G54 S{:.0f} M3", operation.spindle_rpm));
  line(fmt::format("G43 H{} G0 {}", tool.number, word('Z', safe_z)));
  motion_ = "G0", feed_.clear(), at_.reset();
  begun_ = true;
}

std::string ProgramWriter::places(const Vec3& to) {
  std::string out;
  for (int a = 0; a < 3; ++a) {
    const std::string now = word("XYZ"[a], to[a]);
    if (at_ && now == word("XYZ"[a], (*at_)[a])) continue;
    out += " " + now;
  }
  at_ = to;
  return out;
}

void ProgramWriter::rapid(const Vec3& to) {
  const std::string where = places(to);
  if (where.empty()) return;
  line(motion_ == "G0" ? where.substr(1) : "G0" + where);
  motion_ = "G0";
}

void ProgramWriter::cut(const PathPiece& piece, double feed) {
  std::string where = places(piece.to);
  if (piece.arc) {
    const Vec2 centre = piece.centre - piece.from.head<2>();
    where += " " + word('I', centre.x()) + " " + word('J', centre.y());
  }
  if (where.empty()) return;
  const std::string code = !piece.arc ? "G1" : piece.sweep_rad > 0 ? "G3" : "G2";
  const std::string f = number_text(mm_per_min_from_mm_per_s(feed), 1);
  std::string text = code == motion_ ? where.substr(1) : code + where;
  if (f != feed_) text += " F" + f;
  line(text);
  motion_ = code, feed_ = f;
}

std::string ProgramWriter::finish() {
  line("M5");
  line("M30");
  return text_ + "%\n";
}

}  // namespace camber::copymill
