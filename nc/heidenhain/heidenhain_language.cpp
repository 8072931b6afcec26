#include "nc/heidenhain/heidenhain_language.h"

#include <algorithm>
#include <array>
#include <cassert>

#include <fmt/format.h>

#include "nc/heidenhain/cursor.h"
#include "nc/heidenhain/klartext_tree.h"
#include "nc/write/program_writer.h"

namespace camber::nc::heidenhain {
namespace {

constexpr std::size_t kLines = 400;  ///< looked at

/// Beginnings of lines that only Klartext has.
constexpr std::array<std::string_view, 14> kPairs{"BEGIN PGM", "END PGM",   "BLK FORM",      "TOOL CALL",  "TOOL DEF",
                                                  "CYCL DEF",  "CYCL CALL", "CYCLE DEF",     "CALL LBL",   "CALL PGM",
                                                  "SEL PGM",   "TCH PROBE", "FUNCTION TCPM", "PLANE RESET"};
constexpr std::array<std::string_view, 11> kWords{"L", "LP", "LN", "CC", "CP", "CR", "CT", "RND", "CHF", "APPR", "DEP"};

/// The words that show it; empty: none.
std::string shown_by(std::string_view text, std::size_t at, std::size_t end) {
  Cursor cursor(text, at, end);
  if (!cursor.more()) return {};
  if (is_digit(cursor.peek())) cursor.integer();
  if (cursor.peek() == 'N' && is_digit(cursor.behind(1))) {
    cursor.advance();
    cursor.integer();
  }
  const std::string first = cursor.letters();
  if (first.empty()) return {};
  cursor.advance(first.size());
  if (first == "LBL" && (is_digit(cursor.peek()) || cursor.peek() == '"')) return first;
  if (first == "FN" && is_digit(cursor.peek())) {
    cursor.integer();
    return cursor.peek() == ':' ? first : std::string();
  }
  if (const std::string second = cursor.letters(); !second.empty()) {
    const std::string both = first + " " + second;
    if (std::ranges::find(kPairs, both) != kPairs.end()) return both;
    if (first == "PLANE") return both;
  }
  if (std::ranges::find(kWords, first) == kWords.end()) return {};
  // L X+5, CC Y-3, CR IX+1, LP PR+5, L M3: a blank, then an address with a number behind it.
  const std::string address = cursor.letters();
  const bool axis = address.size() == 1 && std::string_view("XYZABC").find(address[0]) != std::string_view::npos;
  const bool step = address.size() == 2 && address[0] == 'I' && address[1] >= 'A';
  const bool other = address == "M" || address == "FMAX" || address == "PR" || address == "PA" || address == "IPA" ||
                     address == "LT" || address == "LCT" || address == "R";
  return axis || step || other ? first : std::string();
}

class KlartextWriter : public ProgramWriter {
 public:
  KlartextWriter(const Dialect& dialect, WriterFormat format) : ProgramWriter(dialect, std::move(format)) {}

  void dwell(double seconds) override {
    put("CYCL DEF 9.0 DWELL TIME");
    put(fmt::format("CYCL DEF 9.1 DWELL {:g}", seconds));
  }
  /// No word of the language asks for it.
  void stop_exactly() override {}

 private:
  void write_head() override { put(fmt::format("BEGIN PGM {} MM", program_name(format().title))); }

  void write_tool(const WrittenTool& tool) override {
    put(fmt::format("TOOL CALL {} Z S{:.0f} ; {}", tool.number, tool.spindle_rpm, tool.comment));
    put(fmt::format("L {} R0 FMAX M3", coordinate('Z', tool.safe_z_mm)));
    if (format().coolant) put("M8");
  }

  void write_spindle_stop() override {
    if (format().coolant) put("M9");
    put("M5");
  }

  void write_end() override {
    put(std::string(dialect().program_end));
    put(fmt::format("END PGM {} MM", program_name(format().title)));
  }

  /// FMAX holds for its block alone.
  void write_rapid(const std::string& words) override { put("L " + words + " FMAX"); }
  void write_line(const std::string& words, double feed) override { put("L " + words + feed_word(feed)); }

  void write_arc(const Arc& arc, double feed) override {
    const PlaneAxes axes = axes_of(arc.plane);
    assert(arc.from[axes.normal] == arc.to[axes.normal]);
    const char first = "XYZ"[axes.first], second = "XYZ"[axes.second];
    put(fmt::format("CC {} {}", coordinate(first, arc.centre.x()), coordinate(second, arc.centre.y())));
    put(fmt::format("C {} {} DR{}{}", coordinate(first, arc.to[axes.first]), coordinate(second, arc.to[axes.second]),
                    arc.counter_clockwise ? '+' : '-', feed_word(feed)));
  }

  std::string coordinate(char letter, double value) const override {
    const std::string text = number(value, format().decimals);
    return letter + (text.front() == '-' ? text : "+" + text);
  }
};

}  // namespace

LanguageEvidence evidence(std::string_view text) {
  LanguageEvidence out;
  std::size_t at = text.substr(0, 3) == "\xEF\xBB\xBF" ? 3 : 0;
  for (std::size_t line = 0; line < kLines && at < text.size(); ++line) {
    const std::size_t end = std::min(text.find_first_of("\r\n", at), text.size());
    std::string word = shown_by(text, at, end);
    if (!word.empty() && ++out.lines == 1) {
      out.offset = text.find_first_not_of(" \t", at);
      out.word = std::move(word);
    }
    at = end + 1;
  }
  return out;
}

Program read(SourceText source, Diagnostics& diagnostics) { return read_text(std::move(source), diagnostics); }

std::unique_ptr<ProgramWriter> writer(const Dialect& dialect, WriterFormat format) {
  return std::make_unique<KlartextWriter>(dialect, std::move(format));
}

}  // namespace camber::nc::heidenhain
