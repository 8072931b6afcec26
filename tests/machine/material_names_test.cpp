// Materials by number and name, and what stands for those that are not in the library.
#include <gtest/gtest.h>

#include <cmath>

#include "machine/material_presets.h"

namespace camber::machine {
namespace {

struct NameCase {
  const char* name;
  const char* preset;
};

TEST(MaterialNames, AreThoseOfEveryStandard) {
  const NameCase cases[] = {
      {"1.2343", "1.2343"},
      {"W.-Nr. 1.2343", "1.2343"},
      {"X37CrMoV5-1", "1.2343"},
      {"AISI H11", "1.2343"},
      {"SKD61", "1.2343"},
      {"skd 61", "1.2343"},
      {"H13", "1.2343"},
      {"1.2311", "P20"},
      {"P20", "P20"},
      {"1.2738", "P20"},
      {"NAK80", "NAK80"},
      {"1.2379", "1.2379"},
      {"D2", "1.2379"},
      {"SKD11", "1.2379"},
      {"C45", "C45"},
      {"Ck45", "C45"},
      {"1045", "C45"},
      {"S45C", "C45"},
      {"1.0503", "C45"},
      {"42CrMo4", "42CrMo4"},
      {"1.7225", "42CrMo4"},
      {"AISI 4140", "42CrMo4"},
      {"SCM440", "42CrMo4"},
      {"316L", "316L"},
      {"1.4404", "316L"},
      {"SUS316L", "316L"},
      {"AISI 316 L", "316L"},
      {"1.4301", "304"},
      {"Ti64", "Ti6Al4V"},
      {"Ti-6Al-4V", "Ti6Al4V"},
      {"3.7165", "Ti6Al4V"},
      {"Inconel 718", "Inconel718"},
      {"2.4668", "Inconel718"},
      {"IN718", "Inconel718"},
      {"6061", "Al6082-T6"},
      {"6061-T6", "Al6082-T6"},
      {"EN AW-6061", "Al6082-T6"},
      {"AlMg1SiCu", "Al6082-T6"},
      {"7075", "Al7075-T6"},
      {"7075-T651", "Al7075-T6"},
      {"3.4365", "Al7075-T6"},
      {"graphite", "graphite"},
      {"brass", "brass"},
      {"CuZn39Pb3", "brass"},
      {"2.0401", "brass"},
      {"POM", "POM"},
      {"Delrin", "POM"},
      {"EN-GJL-250", "FC250"},
      {"GGG40", "GJS-400"},
      {"MDF", "particleboard"},
      {"1.4462", "2205"},
      {"1.2083", "420"},
  };
  for (const auto& c : cases) {
    const MaterialMatch match = find_material(c.name);
    ASSERT_TRUE(match.preset) << c.name;
    EXPECT_EQ(match.preset->name, c.preset) << c.name;
    EXPECT_EQ(match.note, "") << c.name;
  }
}

TEST(MaterialNames, NoNameStandsForTwoMaterials) {
  std::map<std::string, std::string_view> owner;
  for (const MaterialPreset& p : material_presets()) {
    std::string names = std::string(p.names) + " " + std::string(p.name);
    std::istringstream all(names);
    for (std::string one; all >> one;) {
      const auto [at, is_new] = owner.emplace(one, p.name);
      EXPECT_TRUE(is_new || at->second == p.name) << one << ": " << at->second << " and " << p.name;
      EXPECT_EQ(find_material(one).preset, &p) << one;
    }
  }
}

TEST(MaterialNames, UnknownOnesOfAKnownGroupStandForIt) {
  const NameCase cases[] = {{"1.2746", "1.2343"},          {"1.4529", "304"},      {"347", "304"},
                            {"4150", "42CrMo4"},           {"S275NL", "S235JR"},   {"6101", "Al6082-T6"},
                            {"7020", "Al7075-T6"},         {"1.8509", "42CrMo4"},  {"Ti-10-2-3", "Ti6Al4V"},
                            {"Hastelloy B", "Inconel718"}, {"X39CrMo17-1", "420"}, {"stainless", "304"},
                            {"aluminium", "Al6082-T6"}};
  for (const auto& c : cases) {
    const MaterialMatch match = find_material(c.name);
    ASSERT_TRUE(match.preset) << c.name;
    EXPECT_EQ(match.preset->name, c.preset) << c.name;
    EXPECT_NE(match.note.find("is not in the library"), std::string::npos) << c.name << ": " << match.note;
  }
  EXPECT_EQ(find_material("1.2746").note,
            "\"1.2746\" is not in the library; values of 1.2343 for tool steels, annealed");
}

TEST(MaterialNames, AHardnessSelectsTheClassOfSteel) {
  const NameCase cases[] = {{"1.2379 60 HRC", "hardened-60HRC"}, {"1.2343 (50-52 HRC)", "hardened-55HRC"},
                            {"Toolox 44 45 HRC", "P20"},         {"Weldox 300 HB", "P20"},
                            {"Something 30HRC", "34CrNiMo6"},    {"SKD61 HRC 48", "hardened-55HRC"},
                            {"42CrMo4 250 HB", "42CrMo4"},       {"C45 190 HB", "C45"},
                            {"mystery 130 HB", "S235JR"},        {"XYZ 700 HV", "hardened-60HRC"}};
  for (const auto& c : cases) {
    const MaterialMatch match = find_material(c.name);
    ASSERT_TRUE(match.preset) << c.name;
    EXPECT_EQ(match.preset->name, c.preset) << c.name << ": " << match.note;
  }
  EXPECT_EQ(find_material("1.2379 60 HRC").note,
            "\"1.2379 60 HRC\": values of hardened-60HRC, the class of steel nearest to 654 HB");
}

TEST(MaterialNames, OfNothingNothingIsKnown) {
  for (const char* name : {"foo", "", "S55Q", "17", "unobtainium"}) EXPECT_FALSE(find_material(name).preset) << name;
  EXPECT_EQ(unknown_material("S55Q"),
            "nothing is known of a material \"S55Q\" (did you mean \"S55C\"?); a name of docs/materials.md, a number "
            "(1.2343, 4140, SKD61), or a name with its hardness (\"S55Q 45 HRC\") was expected");
}

/// The tables of two makers of milling tools, which know nothing of each other, for the same steels: their forces at a
/// chip of 0.1 mm lie within the scatter that the library states.
TEST(MaterialNames, TheStatedScatterHoldsBetweenCatalogues) {
  const auto kc = [](const char* name) {
    const Material& m = find_preset(name)->material;
    return m.kc1_1_MPa * std::pow(0.1, -m.mc);
  };
  EXPECT_NEAR(kc("42CrMo4") / kc("34CrMo4"), 1, 0.25);
  EXPECT_NEAR(kc("S235JR") / kc("SS400"), 1, 0.25);
  EXPECT_NEAR(kc("P20") / kc("55NiCrMoV7"), 1, 0.25);
}

}  // namespace
}  // namespace camber::machine
