#include "nc/foreign.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "nc/dialect.h"

namespace camber::nc {
namespace {

constexpr std::array<std::string_view, 37> kSiemens = {
    "DEF",    "SUPA",  "CYCLE",  "TRAFOOF", "TRAORI", "COMPOF", "COMPON", "COMPCAD", "COMPCURV", "MSG",
    "MCALL",  "FNORM", "TRANS",  "ATRANS",  "ROT",    "AROT",   "MIRROR", "SCALE",   "FFWON",    "FFWOF",
    "SOFT",   "BRISK", "CR",     "TURN",    "CIP",    "CFTCP",  "DIAMOF", "DIAMON",  "REPEATB",  "WORKPIECE",
    "EXTERN", "PROC",  "STOPRE", "ORIWKS",  "OFFN",   "WCS",    "GROUP"};
constexpr std::array<std::string_view, 11> kHeidenhain = {"BEGIN", "PGM", "TOOL", "CYCL", "BLK", "FMAX",
                                                          "LBL",   "CC",  "RND",  "CHF",  "FN"};
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

ForeignWord explain_assignment(std::string_view address) {
  return {fmt::format("{}= belongs to a Siemens Sinumerik program, which is not supported; {}", address, expected()),
          "siemens", true};
}

}  // namespace camber::nc
