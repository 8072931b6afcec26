// Materials by their names in the standards, and what stands for a name that is not in the library.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <regex>

#include <fmt/format.h>

#include "machine/material_presets.h"
#include "machine/toml_table.h"

namespace camber::machine {
namespace {

constexpr std::size_t kLongestName = 80;  // std::regex needs stack for each character

/// Upper case, without blanks, hyphens, underlines and the words that only name a standard.
std::string plain(std::string_view name) {
  std::string out;
  for (const char c : name.substr(0, kLongestName))
    if (c != '-' && c != '_' && c != ' ' && c != '(' && c != ')' && c != ',' && c != '\t')
      out += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  static const std::regex kStandard(
      R"(^(?:AISI|SAE|ASTM|JIS|DIN|EN(?!GJ|AC)|AW|ISO|UNS|BS|GB|AA|W\.?NR\.?|WNR|MAT\.?NR\.?)+:?)"),
      kTemper(R"(^(?:AL|A)?([1-8]\d{3}A?)(?:H\d+|T\d+|O|F)$)"), kAluminium(R"(^ALU?(?:MIN(?:I?UM)?)?(?=\d{4}))");
  out = std::regex_replace(out, kStandard, "");
  if (std::smatch m; std::regex_match(out, m, kTemper)) return m[1].str();
  return std::regex_replace(out, kAluminium, "");
}

const std::map<std::string, const MaterialPreset*>& by_name() {
  static const auto names = [] {
    std::map<std::string, const MaterialPreset*> out;
    for (const MaterialPreset& p : material_presets())
      for (std::string_view rest = p.names; !rest.empty();) {
        const std::size_t end = std::min(rest.find(' '), rest.size());
        out.emplace(plain(rest.substr(0, end)), &p);
        rest.remove_prefix(std::min(end + 1, rest.size()));
      }
    for (const MaterialPreset& p : material_presets()) out.emplace(plain(p.name), &p);
    return out;
  }();
  return names;
}

/// Brinell hardness of a steel. ISO 18265, table A.1, in its range, within 3 %.
double hb_from_hrc(double hrc) {
  constexpr std::array<std::array<double, 2>, 9> kTable{
      {{20, 226}, {25, 253}, {30, 286}, {35, 327}, {40, 371}, {45, 421}, {50, 481}, {55, 560}, {60, 654}}};
  for (std::size_t i = 1; i < kTable.size(); ++i)
    if (hrc <= kTable[i][0] || i + 1 == kTable.size()) {
      const auto& [r0, b0] = kTable[i - 1];
      const auto& [r1, b1] = kTable[i];
      return b0 + (hrc - r0) / (r1 - r0) * (b1 - b0);
    }
  return 0;
}

/// A hardness that the name ends or begins with, taken out of it; the middle of a range.
std::optional<double> take_hardness_HB(std::string& name) {
  static const std::regex kBehind(
      R"((?:^|[\s,(@/])(\d{2,3})(?:\.\d+)?\s*(?:(?:-|\.\.|to|bis)\s*(\d{2,3}))?\s*(HRC|HB|HBW|HV)\b\)?)",
      std::regex::icase),
      kBefore(R"(\b(HRC|HB|HBW|HV)\s*(\d{2,3})(?:\s*(?:-|\.\.|to|bis)\s*(\d{2,3}))?)", std::regex::icase);
  std::smatch m;
  const bool behind = std::regex_search(name, m, kBehind);
  if (!behind && !std::regex_search(name, m, kBefore)) return std::nullopt;
  const std::string first = m[behind ? 1 : 2].str(), second = m[behind ? 2 : 3].str(), unit = m[behind ? 3 : 1].str();
  const double low = std::stod(first), value = second.empty() ? low : (low + std::stod(second)) / 2;
  const bool rockwell = unit.size() == 3 && (unit[1] == 'R' || unit[1] == 'r');
  const bool vickers = unit.size() == 2 && (unit[1] == 'V' || unit[1] == 'v');
  name = m.prefix().str() + " " + m.suffix().str();
  constexpr double kBrinellOfVickers = 0.95;  // ISO 18265
  return rockwell ? hb_from_hrc(value) : vickers ? kBrinellOfVickers * value : value;
}

/// A pattern of names of a standard, on the plain name, and the material that stands for its group.
struct Family {
  const char* pattern;
  std::string_view preset;
  std::string_view what;
};
constexpr std::array kFamilies{
    Family{R"(^1\.00.*|^1\.0[13].*|^S\d{3}[JKNMQ].*|^ST\d\d.*)", "S235JR", "structural steels"},
    Family{R"(^1\.0[4-9].*|^1\.1.*|^C\d\d[ERU]?$|^CK\d\d$|^S\d\dC$|^10\d\d$|^15[1-6]\d$)", "C45", "carbon steels"},
    Family{R"(^11\d\d$|^12\d\d$|^12L\d\d$|^SUM\d\dL?$)", "S235JR", "free-cutting steels"},
    Family{R"(^1\.2.*|^1\.3[23].*|^[AOSW]\d$|^A10$|^H[1-4]\d$|^SK[DST]\d{1,2}.*|^[ADM]\d$|^[MT]\d\d$|^SKH\d\d.*)",
           "1.2343", "tool steels, annealed"},
    Family{R"(^P\d{1,2}(?:\+.*)?$|^NAK\d\d$|^HPM.*|^TOOLOX.*)", "P20", "prehardened mould steels"},
    Family{R"(^1\.4[01].*|^4[0-4]\d[A-Z]{0,2}$|^SUS4\d\d.*|^X\d+CR(?!.*NI).*)", "420",
           "martensitic and ferritic stainless steels"},
    Family{R"(^1\.4[3-9].*|^[23]\d\d[A-Z]{0,2}$|^SUS[23]\d\d.*|^X\d+CR.*NI.*|^S3\d{4}$)", "304",
           "austenitic stainless steels"},
    Family{
        R"(^1\.[5-8].*|^4[1-8]\d\d$|^5[1]\d\d$|^61(?:1[78]|20|4\d|50)$|^8[1-8]\d\d$|^9[2-4]\d\d$|^SCM\d+.*|^S?NCM\d+.*|^SCR\d+.*|^\d\d(?:CR|MN|NI|MO|SI).*)",
        "42CrMo4", "low-alloy steels"},
    Family{R"(^0\.6.*|^GG\d\d$|^(?:EN)?GJL.*|^FC\d{3}$)", "FC250", "grey cast irons"},
    Family{R"(^0\.7.*|^GGG\d\d.*|^(?:EN)?GJS.*|^FCD\d{3}.*)", "GJS-600", "ductile cast irons"},
    Family{R"(^2\.0.*|^CUZN.*|^CW[5-7]\d\d[A-Z]$|^C[23]\d{3,4}$)", "brass", "copper-zinc alloys"},
    Family{R"(^2\.1.*|^CUSN.*|^CUAL.*|^CUNI.*|^C[5-9]\d{4}$)", "bronze", "copper-tin and copper-aluminium alloys"},
    Family{R"(^CU.*|^CW0.*|^C1\d{3,4}$)", "copper", "copper"},
    Family{R"(^2\.4.*|^NI.*|^N0\d{4}$|^INCONEL.*|^IN\d{3}$|^HASTELLOY.*|^NIMONIC.*|^ALLOY\d{3}$)", "Inconel718",
           "nickel alloys"},
    Family{R"(^3\.7.*|^TI.*|^R5\d{4}$)", "Ti6Al4V", "titanium alloys"},
    Family{R"(^3\.4.*|^A?7\d{3}A?$)", "Al7075-T6", "aluminium-zinc alloys"},
    Family{R"(^3\.1.*|^A?2\d{3}A?$|^ALCU.*)", "Al2024", "aluminium-copper alloys"},
    Family{R"(^3\.3[5-9].*|^A?5[0-9]\d\d[A-Z]?$|^ALMG[1-9].*)", "Al5083", "aluminium-magnesium alloys"},
    Family{R"(^3\.[23].*|^A?6\d{3}A?$|^ALMGSI.*|^ALSI1MG.*)", "Al6082-T6", "aluminium-magnesium-silicon alloys"},
    Family{R"(^ALSI.*|^AC\d[A-Z].*|^ADC\d+.*|^A3\d\d$|^ENAC.*)", "AlSi7Mg", "cast aluminium alloys"},
    Family{R"(^3\.0.*|^A?1[01]\d\dA?$|^AL99.*)", "soft-aluminium", "pure aluminium"},
    Family{R"(.*STAINLESS.*|.*INOX.*|.*EDELSTAHL.*)", "304", "stainless steels"},
    Family{R"(.*TOOLSTEEL.*|.*WERKZEUGSTAHL.*)", "1.2343", "tool steels, annealed"},
    Family{R"(.*(?:GREY|GRAY|CAST)IRON.*|.*GUSS.*)", "FC250", "cast irons"},
    Family{R"(.*STEEL.*|.*STAHL.*)", "C45", "steels"},
    Family{R"(^ALU?(?:MIN.*)?$|.*ALUMIN.*)", "Al6082-T6", "aluminium alloys"},
    Family{R"(.*BRASS.*|.*MESSING.*)", "brass", "copper-zinc alloys"},
    Family{R"(.*BRONZE.*)", "bronze", "bronzes"},
    Family{R"(.*COPPER.*|.*KUPFER.*)", "copper", "copper"},
    Family{R"(.*TITAN.*)", "Ti6Al4V", "titanium alloys"},
    Family{R"(.*(?:WOOD|PLY|MDF|HOLZ|BOARD|FIBRE|FIBER).*)", "particleboard", "wood and boards"},
    Family{R"(.*(?:ACRYL|PLASTIC|NYLON|POLY|KUNSTSTOFF).*)", "POM", "plastics"},
    Family{R"(.*FOAM.*|.*SCHAUM.*)", "tooling-board", "foams"},
    Family{R"(.*GRAPHIT.*)", "graphite", "graphites"},
};

const MaterialPreset* of_family(const std::string& name, std::string_view& what) {
  static const auto patterns = [] {
    std::vector<std::regex> out;
    for (const Family& f : kFamilies) out.emplace_back(f.pattern);
    return out;
  }();
  for (std::size_t i = 0; i < kFamilies.size(); ++i)
    if (std::regex_match(name, patterns[i])) {
      what = kFamilies[i].what;
      return find_preset(kFamilies[i].preset);
    }
  return nullptr;
}

/// Steels by hardness, from soft to hard.
constexpr std::array<std::string_view, 6> kSteelsByHardness{"S235JR",         "C45",           "34CrNiMo6", "P20",
                                                            "hardened-55HRC", "hardened-60HRC"};

const MaterialPreset* of_hardness(double hardness_HB) {
  const MaterialPreset* best = nullptr;
  for (const std::string_view name : kSteelsByHardness) {
    const MaterialPreset* p = find_preset(name);
    if (!best || std::abs(p->hardness_HB - hardness_HB) < std::abs(best->hardness_HB - hardness_HB)) best = p;
  }
  return best;
}

bool is_steel(const MaterialPreset& p) {
  return p.material.law == ForceLaw::kienzle && p.material.kc1_1_MPa > 1200 && p.hardness_HB > 0 &&
         p.what.find("steel") != std::string_view::npos;
}

/// A steel that is harder or softer than as supplied is another class.
constexpr double kSameHardness = 0.25;

}  // namespace

MaterialMatch find_material(std::string_view given) {
  if (const MaterialPreset* own = find_preset(given)) return {own, {}};
  std::string rest(given.substr(0, kLongestName));
  const auto hardness_HB = take_hardness_HB(rest);
  const std::string name = plain(rest);
  MaterialMatch match;
  if (const auto at = by_name().find(name); at != by_name().end()) match.preset = at->second;
  std::string_view family;
  if (!match.preset && !name.empty()) {
    match.preset = of_family(name, family);
    if (match.preset)
      match.note = fmt::format("\"{}\" is not in the library; values of {} for {}", given, match.preset->name, family);
  }
  const bool other_hardness =
      hardness_HB && (!match.preset || (is_steel(*match.preset) &&
                                        std::abs(*hardness_HB / match.preset->hardness_HB - 1) > kSameHardness));
  if (other_hardness) {
    match.preset = of_hardness(*hardness_HB);
    match.note = fmt::format("\"{}\": values of {}, the class of steel nearest to {:.0f} HB", given, match.preset->name,
                             *hardness_HB);
  }
  return match;
}

std::string unknown_material(std::string_view name) {
  std::vector<std::string> names;
  for (const MaterialPreset& p : material_presets()) names.emplace_back(p.name);
  const std::string near = nearest_word(name, names);
  return fmt::format(
      "nothing is known of a material \"{}\"{}; a name of docs/materials.md, a number (1.2343, 4140, SKD61), or a name "
      "with its hardness (\"{} 45 HRC\") was expected",
      name, near.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", near), name.empty() ? "steel" : name);
}

}  // namespace camber::machine
