#include "nc/foreign.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "nc/language.h"

namespace camber::nc {
namespace {

constexpr std::array<std::string_view, 37> kSiemensWords = {
    "DEF",    "SUPA",  "CYCLE",  "TRAFOOF", "TRAORI", "COMPOF", "COMPON", "COMPCAD", "COMPCURV", "MSG",
    "MCALL",  "FNORM", "TRANS",  "ATRANS",  "ROT",    "AROT",   "MIRROR", "SCALE",   "FFWON",    "FFWOF",
    "SOFT",   "BRISK", "CR",     "TURN",    "CIP",    "CFTCP",  "DIAMOF", "DIAMON",  "REPEATB",  "WORKPIECE",
    "EXTERN", "PROC",  "STOPRE", "ORIWKS",  "OFFN",   "WCS",    "GROUP"};
constexpr std::array<std::string_view, 12> kHeidenhainWords = {"BEGIN", "PGM", "TOOL", "CYCL", "BLK", "FMAX",
                                                               "LBL",   "CC",  "RND",  "CHF",  "FN",  "FUNCTION"};
constexpr std::array<std::string_view, 13> kOWord = {"SUB",    "CALL",      "ENDSUB", "ENDWHILE", "ELSEIF",
                                                     "RETURN", "REPEAT",    "BREAK",  "CONTINUE", "OCALL",
                                                     "OSUB",   "ENDREPEAT", "OIF"};

template <std::size_t N>
bool among(const std::array<std::string_view, N>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// "SUPA belongs to Siemens Sinumerik programs; this text is read as ISO G code ..."
ForeignWord of_language(std::string_view name, LanguageId id) {
  const Language& language = language_of(id);
  return {fmt::format("{} belongs to {} programs, and this text is read as {}; --dialect {} reads it in that language",
                      name, language.title, language_of(LanguageId::iso).title, language.name),
          std::string(language.name), true};
}

}  // namespace

ForeignWord explain_letters(std::string_view name) {
  if (among(kSiemensWords, name)) return of_language(name, LanguageId::siemens);
  if (among(kOWord, name))
    return {fmt::format("{} without its O number; O100 {} or O<name> {} was expected", name, name, name), "statement",
            false};
  if (among(kHeidenhainWords, name)) return of_language(name, LanguageId::heidenhain);
  if (name.size() == 2)
    return {fmt::format("{} has no number; a number was expected", name.front()), "no-number", false};
  return {fmt::format("{} is not an NC word; a letter and a number were expected", name), "not-a-word", false};
}

ForeignWord explain_assignment(std::string_view address) {
  if (address.size() > 1 && address.front() == 'Q')
    return {fmt::format("{}= is of a cycle in a DIN/ISO program of a Heidenhain control, which is not supported; the "
                        "program in Klartext was expected",
                        address),
            "not-supported", true};
  return of_language(fmt::format("{}=", address), LanguageId::siemens);
}

}  // namespace camber::nc
