// [material]: presets, Kienzle's law, catalogue tables.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "machine/job_file.h"
#include "machine/material_presets.h"
#include "machine/material_reader.h"
#include "tests/support/temp_folder.h"

namespace camber::machine {
namespace {

using tests::replaced;
using tests::TempFolder;

struct Result {
  Material material;
  std::string messages;
};

/// Reads job.toml with these lines in [material]; they begin at line 8.
Result read(std::string_view lines) {
  const TempFolder folder;
  folder.write("finish.nc", "G21\nM30\n");
  folder.write("machine.toml", "[spindle]\nmax_rpm = 12000\n");
  folder.write("material.toml", "[material]\nktc_MPa = 1234\nkrc_MPa = 500\n");
  const std::string path =
      folder.write("job.toml",
                   "program = \"finish.nc\"\nmachine = \"machine.toml\"\n[tool.1]\ntype = \"ball\"\ndiameter_mm = 6.0\n"
                   "flutes = 2\noverhang_mm = 40.0\n[stock]\nbox_mm = [[0, 0, -20], [50, 40, 5]]\n[material]\n" +
                       std::string(lines));
  Result result;
  Diagnostics diagnostics;
  try {
    result.material = read_job(path, diagnostics).material;
    for (const auto& d : diagnostics.all()) result.messages += to_string(d) + "\n";
  } catch (const InputError& problem) {
    result.messages = problem.what();
  }
  result.messages = replaced(result.messages, folder.path() + "/", "");
  return result;
}

TEST(Material, TakesAPreset) {
  const auto [m, messages] = read("preset = \"Al7075\"\n");
  EXPECT_EQ(messages, "");
  EXPECT_EQ(m.law, ForceLaw::linear);
  EXPECT_EQ(m.ktc_MPa, 951.8);
  EXPECT_EQ(m.krc_MPa, 608.6);
  EXPECT_EQ(m.kac_MPa, 288.5);
  EXPECT_EQ(m.kte_N_per_mm, 14.0);
  EXPECT_EQ(m.kre_N_per_mm, 16.5);
}

TEST(Material, ExplicitKeysOverrideThePreset) {
  const auto [m, messages] = read("preset = \"Al7075\"\nktc_MPa = 900\nkae_N_per_mm = 0\n");
  EXPECT_EQ(messages, "");
  EXPECT_EQ(m.ktc_MPa, 900);
  EXPECT_EQ(m.krc_MPa, 608.6);
  EXPECT_EQ(m.kae_N_per_mm, 0);
}

TEST(Material, TakesKienzlePresetsWithARatio) {
  const auto [m, messages] = read("preset = \"C45\"\nkrc_ratio = 0.3\nkac_ratio = -0.1\n");
  EXPECT_EQ(messages, "");
  EXPECT_EQ(m.law, ForceLaw::kienzle);
  EXPECT_EQ(m.kc1_1_MPa, 2220);
  EXPECT_EQ(m.mc, 0.14);
  EXPECT_EQ(m.kr1_1_MPa, 666);
  EXPECT_EQ(m.mr, 0.14);
  EXPECT_EQ(m.ka1_1_MPa, -222);
}

TEST(Material, TakesKienzlePairsOfItsOwn) {
  const auto [m, messages] = read("kc1_1_MPa = 2000\nmc = 0.2\nkr1_1_MPa = 400\nmr = 0.5\nkte_N_per_mm = 3\n");
  EXPECT_EQ(messages, "");
  EXPECT_EQ(m.law, ForceLaw::kienzle);
  EXPECT_EQ(m.kr1_1_MPa, 400);
  EXPECT_EQ(m.mr, 0.5);
  EXPECT_EQ(m.kte_N_per_mm, 3);
}

TEST(Material, TakesACatalogueTable) {
  const auto [m, messages] = read(
      "kc_by_feed = [[0.1, 1970], [0.15, 1860], [0.2, 1800], [0.3, 1760], [0.4, 1620]]\n"
      "krc_ratio = 0.4\n");
  EXPECT_EQ(messages, "");
  const MaterialPreset* s55c = find_preset("S55C");
  ASSERT_TRUE(s55c);
  EXPECT_DOUBLE_EQ(m.kc1_1_MPa, s55c->material.kc1_1_MPa);
  EXPECT_DOUBLE_EQ(m.mc, s55c->material.mc);
  EXPECT_DOUBLE_EQ(m.kr1_1_MPa, 0.4 * m.kc1_1_MPa);
}

TEST(Material, CatalogueLinesPassNearTheirTables) {
  for (const auto& p : material_presets()) {
    if (p.catalogue.empty()) continue;
    const KienzlePair pair = kienzle_from_catalogue(p.catalogue);
    EXPECT_LT(pair.worst_fraction, 0.06) << p.name;  // rows are rounded to 10 MPa and more
    std::printf("%s: kc1.1 %.1f MPa, mc %.4f, worst %.2f %%\n", std::string(p.name).c_str(), pair.k1_1_MPa, pair.m,
                100 * pair.worst_fraction);
  }
}

TEST(Material, EveryPresetHasASourceAndARange) {
  for (const auto& p : material_presets()) {
    EXPECT_FALSE(p.source.empty()) << p.name;
    EXPECT_FALSE(p.range.empty()) << p.name;
    EXPECT_EQ(p.material.preset, p.name);
    EXPECT_GT(p.material.law == ForceLaw::linear ? p.material.ktc_MPa : p.material.kc1_1_MPa, 0) << p.name;
    const auto [m, messages] =
        read(fmt::format("preset = \"{}\"\n{}", p.name, p.radial_known ? "" : "krc_ratio = 0.3\n"));
    EXPECT_EQ(messages, "") << p.name;
  }
}

TEST(Material, TakesTheFileThatFitForceWrites) {
  const auto [m, messages] = read("file = \"material.toml\"\n");
  EXPECT_EQ(messages, "");
  EXPECT_EQ(m.ktc_MPa, 1234);
  EXPECT_EQ(
      read("file = \"nowhere.toml\"\n").messages,
      "job.toml:11:8: error: file: no such file: nowhere.toml (paths are relative to the job's folder) [file-missing]\n"
      "    file = \"nowhere.toml\"\n"
      "           ^");
}

TEST(Material, WrittenTextReadsBackAlike) {
  for (const char* lines : {"preset = \"C45\"\nkrc_ratio = 0.3\n", "preset = \"Al7075\"\n",
                            "kc_by_feed = [[0.1, 1970], [0.4, 1620]]\nkrc_ratio = 0.4\nkre_N_per_mm = 2\n"}) {
    const auto [m, messages] = read(lines);
    ASSERT_EQ(messages, "");
    const auto [again, more] = read(material_text(m));
    EXPECT_EQ(more, "");
    for (const auto field : coefficient_fields(m.law)) EXPECT_DOUBLE_EQ(again.*field, m.*field) << material_text(m);
    EXPECT_EQ(again.law, m.law);
  }
}

TEST(Material, RefusesWhatItCannotBe) {
  EXPECT_EQ(
      read("preset = \"S55\"\n").messages,
      "job.toml:11:10: error: nothing is known of a material \"S55\" (did you mean \"S55C\"?); a name of "
      "docs/materials.md, a number (1.2343, 4140, SKD61), or a name with its hardness (\"S55 45 HRC\") was expected "
      "[material-preset]\n"
      "    preset = \"S55\"\n"
      "             ^");
  EXPECT_EQ(
      read("preset = \"S55C\"\n").messages,
      "job.toml:10:1: error: krc_ratio is missing in [material]; krc_ratio or kr1_1_MPa, for preset \"S55C\" gives "
      "the tangential force only, was expected [key-missing]\n"
      "    [material]\n"
      "    ^");
  EXPECT_EQ(read("preset = \"Al7075\"\nlaw = \"kienzle\"\nkrc_ratio = 1\n").messages,
            "job.toml:12:7: error: law is \"kienzle\", but the values of preset \"Al7075\" belong to law \"linear\" "
            "[material-law]\n"
            "    law = \"kienzle\"\n"
            "          ^");
  EXPECT_EQ(read("ktc_MPa = 1\nkrc_MPa = 1\nmc = 0.2\n").messages,
            "job.toml:13:1: error: mc does not belong to law \"linear\" [key-unused]\n"
            "    mc = 0.2\n"
            "    ^");
  EXPECT_EQ(
      read("preset = \"Al6082-T6\"\nkrc_ratio = 0.3\n").messages,
      "job.toml:12:1: error: krc_ratio does not belong to law \"linear\", which preset \"Al6082-T6\" has; its keys "
      "are ktc_MPa, krc_MPa, kac_MPa [key-unused]\n"
      "    krc_ratio = 0.3\n"
      "    ^");
  EXPECT_EQ(read("law = \"kienzle\"\nkc1_1_MPa = 2000\nmc = 1.5\nkrc_ratio = 0.3\n").messages,
            "job.toml:13:6: error: mc is 1.5; a number from 0 to 0.9 was expected [value-range]\n"
            "    mc = 1.5\n"
            "         ^");
  EXPECT_EQ(read("kc_by_feed = [[0.1, 1970], [0.1, 1800]]\nkrc_ratio = 0.3\n").messages,
            "job.toml:11:14: error: kc_by_feed has a single feed per tooth; at least two different ones were expected "
            "[value-range]\n"
            "    kc_by_feed = [[0.1, 1970], [0.1, 1800]]\n"
            "                 ^");
  EXPECT_EQ(read("kc1_1_MPa = 2000\nmc = 0.2\nkr1_1_MPa = 1\nkrc_ratio = 0.3\n").messages,
            "job.toml:14:1: error: the material has krc_ratio and kr1_1_MPa; one of them was expected [key-unused]\n"
            "    krc_ratio = 0.3\n"
            "    ^");
}

}  // namespace
}  // namespace camber::machine
