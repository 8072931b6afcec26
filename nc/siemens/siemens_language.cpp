#include "nc/siemens/siemens_language.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/numbers.h"
#include "nc/durations.h"
#include "nc/reporter.h"
#include "nc/siemens/line_parser.h"
#include "nc/siemens/siemens_sequencer.h"
#include "nc/write/g_code_writer.h"

namespace camber::nc::siemens {
namespace {

/// Words that neither ISO G code nor Klartext has, at the beginning of a word.
bool shows_siemens(std::string_view name, char next) {
  if (name.starts_with("_N_")) return true;
  if (name == "MSG" || name == "DEF" || name == "PROC" || name == "EXTERN" || name == "MCALL" || name == "SUPA" ||
      name == "GOTOF" || name == "GOTOB" || name == "WORKPIECE" || name == "REPEATB" || name == "ENDFOR" ||
      name == "ENDLOOP")
    return true;
  const WordRow* row = find_word(name);
  if (!row) return false;
  if (row->kind == WordKind::address) return next == '=';
  if (row->kind == WordKind::cycle) return true;
  static constexpr std::string_view kNot[] = {"CALL",   "ROT",  "TRANS", "START", "GET",  "WRITE",
                                              "DELETE", "SAVE", "INIT",  "DRIVE", "SOFT", "HOME",
                                              "NORM",   "POLY", "RET",   "CT",    "CP"};
  if (std::ranges::find(kNot, name) != std::end(kNot)) return false;
  return true;
}

/// G functions that no other control has.
bool is_own_g(std::string_view digits) {
  const auto number = parse_number(digits);
  if (!number) return false;
  constexpr int kOwn[] = {450, 451, 500, 505, 506, 507, 508, 509, 601, 602, 603, 641, 642, 643, 644, 645, 700, 710};
  return std::ranges::any_of(kOwn, [&](int own) { return own == *number; });
}

class SiemensWriter : public GCodeWriter {
 public:
  SiemensWriter(const Dialect& dialect, WriterFormat format) : GCodeWriter(dialect, std::move(format)) {}

  void dwell(double seconds) override { put(fmt::format("G4 F{:g}", seconds)); }
  void stop_exactly() override { put("G60"); }

 private:
  void write_head() override {
    put(fmt::format("%_N_{}_MPF", program_name(format().title)));
    put(";$PATH=/_N_MPF_DIR");
    put("G17 G71 G90 G94 G40");
  }

  void write_tool(const WrittenTool& tool) override {
    put(fmt::format("T{} ; {}", tool.number, tool.comment));
    put("M6 D1");
    put(fmt::format("G54 S{:.0f} M3", tool.spindle_rpm));
    put("G0 " + coordinate('Z', tool.safe_z_mm));
    if (format().coolant) put("M8");
    set_motion("G0");
  }

  void write_end() override { put(std::string(dialect().program_end)); }
};

}  // namespace

/// Each line counts once. Comments are passed over: those behind a `;`, and round brackets where the text is ISO.
LanguageEvidence evidence(std::string_view text) {
  constexpr std::size_t kLines = 400;
  LanguageEvidence out;
  bool ended = false;  // behind M30 only further programs count
  std::size_t at = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  for (std::size_t line = 0; line < kLines && at < text.size(); ++line) {
    const std::size_t end = std::min(text.find_first_of("\r\n", at), text.size());
    const auto found = [&](std::size_t offset, std::string word) {
      if (out.lines++ == 0) {
        out.offset = offset;
        out.word = std::move(word);
      }
    };
    std::size_t i = at;
    while (i < end && is_blank(text[i])) ++i;
    if (i < end && text[i] == '(') i = end;  // a comment of ISO
    if (text.substr(i, 6) == ";$PATH") {
      found(i, ";$PATH");
      i = end;
    }
    if (text.substr(i, 4) == "%_N_") {
      found(i, "%_N_");
      i = end;
      ended = false;
    }
    if (ended) i = end;
    for (int words = 0; i < end && words < 60; ++words) {
      const char c = text[i];
      if (c == ';' || c == '(' || c == '"' || c == '#' || c == '[' || c == '<') break;
      if (!is_letter(c) && c != '_') {
        ++i;
        continue;
      }
      std::string name;
      const std::size_t begin = i;
      while (i < end && (is_letter(text[i]) || text[i] == '_' || (is_digit(text[i]) && name.size() > 1)))
        name += upper(text[i++]);
      std::size_t behind = i;
      while (behind < end && (text[behind] == ' ' || is_digit(text[behind]))) ++behind;
      const char next = behind < end ? text[behind] : '\0';
      if (name.size() == 1) {
        // X=R1, T="MILL", R1=5, M3=3: an equals sign behind an address.
        const bool equals = next == '=' && behind + 1 < end && text[behind + 1] != '=';
        const bool of_klartext = name[0] == 'Q' || name[0] == 'F';
        if (equals && !of_klartext) {
          found(begin, std::string(text.substr(begin, behind + 1 - begin)));
          break;
        }
        std::size_t digits = i;
        while (digits < end && is_digit(text[digits])) ++digits;
        const std::string_view code = text.substr(i, digits - i);
        ended |= name[0] == 'M' && (code == "30" || code == "2" || code == "02");
        if (name[0] == 'G' && is_own_g(code)) {
          found(begin, std::string(text.substr(begin, digits - begin)));
          break;
        }
        continue;
      }
      if (shows_siemens(name, next)) {
        found(begin, name);
        break;
      }
      // Text of another language: nothing behind it counts.
      break;
    }
    at = end < text.size() ? text.find_first_not_of("\r\n", end) : text.size();
    if (at == std::string_view::npos) break;
  }
  return out;
}

Interpretation interpret(const Program& program, const InterpreterOptions& options, Diagnostics& diagnostics) {
  Interpretation out;
  Reporter report(program.source, diagnostics);
  Sequencer sequencer(program, options, diagnostics, report, out);  // has the files that the report is about
  sequencer.run();
  check_durations(program, out, report);
  report.finish();
  return out;
}

std::unique_ptr<ProgramWriter> writer(const Dialect& dialect, WriterFormat format) {
  return std::make_unique<SiemensWriter>(dialect, std::move(format));
}

}  // namespace camber::nc::siemens
