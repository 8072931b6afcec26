#include "nc/foreign.h"

#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/format.h>

#include "nc/dialect.h"

namespace camber::nc {
namespace {

constexpr std::array<std::string_view, 37> kSiemens = {
    "DEF",    "SUPA",  "CYCLE",  "TRAFOOF", "TRAORI", "COMPOF", "COMPON", "COMPCAD", "COMPCURV", "MSG",
    "MCALL",  "FNORM", "TRANS",  "ATRANS",  "ROT",    "AROT",   "MIRROR", "SCALE",   "FFWON",    "FFWOF",
    "SOFT",   "BRISK", "CR",     "TURN",    "CIP",    "CFTCP",  "DIAMOF", "DIAMON",  "REPEATB",  "WORKPIECE",
    "EXTERN", "PROC",  "STOPRE", "ORIWKS",  "OFFN",   "WCS",    "GROUP"};
constexpr std::array<std::string_view, 12> kHeidenhain = {"BEGIN", "PGM", "TOOL", "CYCL", "BLK", "FMAX",
                                                          "LBL",   "CC",  "RND",  "CHF",  "FN",  "FUNCTION"};
constexpr std::array<std::string_view, 13> kOWord = {"SUB",    "CALL",      "ENDSUB", "ENDWHILE", "ELSEIF",
                                                     "RETURN", "REPEAT",    "BREAK",  "CONTINUE", "OCALL",
                                                     "OSUB",   "ENDREPEAT", "OIF"};

template <std::size_t N>
bool among(const std::array<std::string_view, N>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// "Camber reads programs in the style of Fanuc, Haas and LinuxCNC".
std::string expected() {
  const std::span<const Dialect> all = dialects();
  std::string out = "Camber reads programs for ";
  for (std::size_t i = 0; i < all.size(); ++i)
    out += fmt::format("{}{}", i == 0 ? "" : i + 1 < all.size() ? ", " : " and ", all[i].title);
  return out;
}

}  // namespace

ForeignWord explain_letters(std::string_view name) {
  if (among(kSiemens, name))
    return {fmt::format("{} belongs to a Siemens Sinumerik program, which is not supported; {}", name, expected()),
            "siemens", true};
  if (among(kOWord, name))
    return {fmt::format("{} without its O number; O100 {} or O<name> {} was expected", name, name, name), "statement",
            false};
  if (among(kHeidenhain, name))
    return {fmt::format("{} belongs to a Heidenhain program, which is not supported; {}", name, expected()),
            "heidenhain", true};
  if (name.size() == 2)
    return {fmt::format("{} has no number; a number was expected", name.front()), "no-number", false};
  return {fmt::format("{} is not an NC word; a letter and a number were expected", name), "not-a-word", false};
}

std::optional<ForeignProgram> foreign_program(std::string_view text) {
  constexpr std::size_t kLines = 200;
  constexpr std::array<std::string_view, 9> kStatements = {"BEGIN PGM", "BLK FORM", "TOOL CALL", "TOOL DEF", "CYCL DEF",
                                                           "LBL ",      "FN ",      "CC ",       "FUNCTION "};
  std::size_t at = 0;
  for (std::size_t line = 0; line < kLines && at < text.size(); ++line) {
    const std::size_t end = std::min(text.find_first_of("\r\n", at), text.size());
    const std::string_view whole = text.substr(at, end - at);
    const std::size_t number = whole.find_first_not_of(" \t"), digits = whole.find_first_not_of("0123456789", number);
    if (number != std::string_view::npos && digits != std::string_view::npos && digits > number &&
        (whole[digits] == ' ' || whole[digits] == '\t')) {
      const std::size_t word = std::min(whole.find_first_not_of(" \t", digits), whole.size());
      std::string statement;
      for (const char c : whole.substr(word, 12))
        if (c != ' ' || (!statement.empty() && statement.back() != ' '))
          statement += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      for (const std::string_view known : kStatements)
        if (statement.starts_with(known)) {
          ForeignProgram found{at + word, explain_letters(known.substr(0, known.find(' ')))};
          if (found.word.other_language) return found;
        }
    }
    at = end + 1;
  }
  return std::nullopt;
}

ForeignWord explain_assignment(std::string_view address) {
  return {fmt::format("{}= belongs to a Siemens Sinumerik program, which is not supported; {}", address, expected()),
          "siemens", true};
}

}  // namespace camber::nc
