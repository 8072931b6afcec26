// Every force law of the list: its table of coefficients, its equations, what reads and writes it.
#include "machine/force_law.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "machine/material_reader.h"
#include "tests/support/law_material.h"
#include "tests/support/temp_folder.h"

namespace camber::machine {
namespace {

using tests::kSteelChip_mm;
using tests::kSteelForce;
using tests::material_of;
using tests::TempFolder;

ForceLaw law_at(std::size_t i) { return static_cast<ForceLaw>(i); }

Components specific_MPa(const Material& m, double h) {
  return with_law(m.law, [&](auto law) { return law.specific_MPa(m, h); });
}
Components slope_MPa(const Material& m, double h) {
  return with_law(m.law, [&](auto law) { return law.slope_MPa(m, h); });
}
Components force_N_per_mm(const Material& m, double h) {
  const Components k = specific_MPa(m, h);
  return {k.tangential * h + m.kte_N_per_mm, k.radial * h + m.kre_N_per_mm, k.axial * h + m.kae_N_per_mm};
}

void expect_near(const Components& a, const Components& b, double fraction) {
  EXPECT_NEAR(a.tangential, b.tangential, fraction * std::abs(b.tangential));
  EXPECT_NEAR(a.radial, b.radial, fraction * std::abs(b.radial));
  EXPECT_NEAR(a.axial, b.axial, fraction * std::abs(b.axial));
}

struct Result {
  Material material;
  std::string messages;
};

/// Reads a [material] table.
Result read(const std::string& lines) {
  const TempFolder folder;
  Diagnostics diagnostics;
  const auto file = read_toml(folder.write("m.toml", "[material]\n" + lines), "a material", diagnostics);
  TomlTable top = TomlTable::top(*file, diagnostics);
  Result out;
  out.material = read_material(*top.table("material"));
  for (const auto& d : diagnostics.all()) out.messages += to_string(d) + "\n";
  return out;
}

/// Without the line of a key.
std::string without(std::string text, std::string_view key) {
  const std::size_t at = ("\n" + text).find("\n" + std::string(key) + " = ");
  if (at != std::string::npos) text.erase(at, text.find('\n', at) + 1 - at);
  return text;
}

/// The table with its `law` line, which the default law lacks.
std::string text_with_law(const ForceLawDescription& law) {
  return "law = \"" + std::string(law.word) + "\"\n" + without(material_text(material_of(law)), "law");
}

TEST(ForceLaws, HaveWordsAndKeysOfTheirOwn) {
  std::set<std::string_view> words, keys;
  for (const auto& law : force_laws()) {
    EXPECT_TRUE(words.insert(law.word).second) << law.word;
    EXPECT_FALSE(law.title.empty()) << law.word;
    for (const auto key : law.keys) EXPECT_TRUE(keys.insert(key).second) << key;
    for (const auto key : law.header_keys) EXPECT_NE(find_coefficient(key), nullptr) << key;
    std::set<std::string_view> symbols;
    for (const auto& c : law.coefficients) {
      EXPECT_TRUE(symbols.insert(c.symbol).second) << c.key;
      EXPECT_FALSE(c.unit.empty() || c.meaning.empty()) << c.key;
      EXPECT_EQ(c.unit == "1", c.key.find('_') == std::string_view::npos) << c.key;
    }
  }
  EXPECT_EQ(description(ForceLaw::linear).word, "linear");
  EXPECT_EQ(description(ForceLaw::kienzle).word, "kienzle");
  EXPECT_EQ(find_coefficient("ktx_MPa"), nullptr);
}

TEST(ForceLaws, FieldsAreOneForEachKey) {
  for (const auto& law : force_laws()) {
    Material m;
    for (std::size_t i = 0; i < law.coefficients.size(); ++i) m.*law.coefficients[i].field = 1 + static_cast<double>(i);
    for (std::size_t i = 0; i < law.coefficients.size(); ++i)
      EXPECT_EQ(m.*law.coefficients[i].field, 1 + static_cast<double>(i)) << law.coefficients[i].key;
  }
}

TEST(ForceLaws, StartFromTheForceOfTheLinearLaw) {
  const LinearForce& f = kSteelForce;
  const double h = kSteelChip_mm;
  for (std::size_t i = 0; i < force_laws().size(); ++i) {
    SCOPED_TRACE(force_laws()[i].word);
    const Material m = material_of(force_laws()[i]);
    EXPECT_EQ(m.law, law_at(i));
    expect_near(force_N_per_mm(m, h),
                {f.cutting_MPa.tangential * h + f.edge_N_per_mm.tangential,
                 f.cutting_MPa.radial * h + f.edge_N_per_mm.radial, f.cutting_MPa.axial * h + f.edge_N_per_mm.axial},
                1e-12);
    expect_near(slope_MPa(m, h), f.cutting_MPa, 1e-12);
    for (const auto& c : force_laws()[i].coefficients) EXPECT_TRUE(c.range.holds(m.*c.field)) << c.key;
  }
}

TEST(ForceLaws, SlopeIsTheDerivativeOfTheForce) {
  for (const auto& law : force_laws()) {
    SCOPED_TRACE(law.word);
    const Material m = material_of(law);
    for (const double h : {0.002, 0.02, 0.1, 0.5}) {
      const double d = 1e-5 * h;
      const Components above = force_N_per_mm(m, h + d), below = force_N_per_mm(m, h - d);
      // Central differences: h'' d^2 is 1e-10 of the force, what rounding leaves 1e-11 of it over d.
      expect_near(slope_MPa(m, h),
                  {(above.tangential - below.tangential) / (2 * d), (above.radial - below.radial) / (2 * d),
                   (above.axial - below.axial) / (2 * d)},
                  1e-7);
    }
  }
}

TEST(ForceLaws, AnAffineLawHasOneSpecificForce) {
  for (const auto& law : force_laws()) {
    const Material m = material_of(law);
    const bool same = specific_MPa(m, 0.02).tangential == specific_MPa(m, 0.2).tangential;
    EXPECT_EQ(is_affine(m.law), same) << law.word;
  }
}

TEST(ForceLaws, WrittenTextReadsBackAlike) {
  for (const auto& law : force_laws()) {
    Material m = material_of(law);
    m.kte_N_per_mm = 3, m.kre_N_per_mm = 2, m.kae_N_per_mm = -1;
    for (std::size_t i = 0; i < law.coefficients.size(); ++i)
      m.*law.coefficients[i].field *= 1 + 0.001 * static_cast<double>(i + 1);
    const auto [again, messages] = read(material_text(m));
    EXPECT_EQ(messages, "") << material_text(m);
    EXPECT_EQ(again.law, m.law);
    for (const auto& c : law.coefficients) EXPECT_EQ(again.*c.field, m.*c.field) << c.key;
    EXPECT_EQ(material_text(again), material_text(m));
  }
}

TEST(ForceLaws, ShowThemselvesByTheirKeys) {
  for (const auto& law : force_laws()) {
    const auto [m, messages] = read(without(material_text(material_of(law)), "law"));
    EXPECT_EQ(messages, "") << law.word;
    EXPECT_EQ(description(m.law).word, law.word);
  }
}

TEST(ForceLaws, MissWhatIsRequired) {
  for (const auto& law : force_laws())
    for (const auto& c : law.coefficients) {
      const std::string messages = read(without(text_with_law(law), c.key)).messages;
      const bool missed = messages.find(std::string(c.key) + " is missing in [material]") != std::string::npos;
      EXPECT_TRUE(missed || !c.required) << c.key << messages;
      EXPECT_TRUE(messages.empty() || c.role != CoefficientRole::edge) << c.key << messages;
    }
}

TEST(ForceLaws, RefuseValuesOutOfRange) {
  for (const auto& law : force_laws())
    for (const auto& c : law.coefficients) {
      if (!std::isfinite(c.range.min)) continue;
      Material m = material_of(law);
      m.*c.field = c.range.min - 1;
      const std::string messages = read(material_text(m)).messages;
      EXPECT_NE(messages.find("error: " + std::string(c.key) + " is -1; " + c.range.wanted()), std::string::npos)
          << messages;
    }
}

TEST(ForceLaws, RefuseKeysOfOtherLaws) {
  for (const auto& law : force_laws())
    for (const auto& other : force_laws())
      for (const auto key : other.keys) {
        if (&other == &law) continue;
        const std::string messages = read(text_with_law(law) + std::string(key) + " = 1\n").messages;
        EXPECT_NE(messages.find("error: " + std::string(key) + " does not belong to law \"" + std::string(law.word) +
                                "\" [key-unused]\n"),
                  std::string::npos)
            << messages;
      }
}

}  // namespace
}  // namespace camber::machine
