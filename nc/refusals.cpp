#include "nc/refusals.h"

#include <regex>

#include <fmt/format.h>

#include "nc/block_words.h"

namespace camber::nc {

std::string why_g_is_refused(int tenths) {
  const std::string name = code_name('G', tenths);
  switch (tenths) {
    case 410:
    case 420:
      return name +
             ": cutter radius compensation in the control is not read yet; a programmed tool centre (G40) was expected";
    case 100:
      return name + ": setting offsets from the program is not read yet";
    case 520:
    case 920:
      return name + ": shifting the work offset in the program is not read yet";
    case 680:
      return name + ": rotating the coordinates is not read yet";
    case 501:
    case 511:
      return name + ": scaling and mirroring are not read yet";
    case 650:
    case 660:
    case 670:
      return name + ": macro calls are not read yet";
    case 960:
    case 970:
      return name + " (constant surface speed) belongs to turning; a milling program was expected";
    case 434:
    case 435:
      return name + ": five-axis tool centre point control is not read yet";
    default:
      return name + " is not a code that is known";
  }
}

void refuse_other_languages(const SourceText& source) {
  static const std::regex siemens(
      R"(^\s*(N\d+\s*)?(CYCLE\d+\s*\(|DEF\s|MSG\s*\(|TRAFOOF|TRAORI|SUPA\b|PROC\s|R\d+\s*=|[XYZABCDFST]\d*\s*=))",
      std::regex::icase);
  static const std::regex heidenhain(R"(^\s*(\d+\s+)?(BEGIN PGM|TOOL CALL|BLK FORM|CYCL DEF)\b)", std::regex::icase);
  const auto refuse = [&](std::size_t line, const char* language) {
    throw InputError(
        {Diagnostic{Severity::error,
                    {source.name(), line, 1},
                    fmt::format("this is a {} program, which is not read yet; an ISO program (Fanuc, Haas, Mazak EIA, "
                                "LinuxCNC) was expected",
                                language),
                    "dialect",
                    std::string(source.line(line).substr(0, 100))}});
  };
  constexpr std::size_t kLines = 200, kLongest = 200;  // these words stand at the top, on short lines
  for (std::size_t line = 1; line <= std::min(source.line_count(), kLines); ++line) {
    const std::string text(source.line(line).substr(0, kLongest));
    if (std::regex_search(text, siemens)) refuse(line, "Siemens 840D");
    if (std::regex_search(text, heidenhain)) refuse(line, "Heidenhain");
  }
}

}  // namespace camber::nc
