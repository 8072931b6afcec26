#include "machine/material_presets.h"

#include <algorithm>

namespace camber::machine {

namespace {

using Rows = std::vector<CatalogueRow>;

constexpr std::string_view kTypical = "typical value for the group of materials, including the factor for milling";
constexpr std::string_view kTypicalRange =
    "not stated; tangential force only; Kienzle's law is a fit to chips of 0.05 mm and more";
constexpr std::string_view kCatalogue =
    "Tungaloy General Catalogue 2020-2021, Technical Reference, milling tools: specific cutting force by feed per "
    "tooth";
constexpr std::string_view kCatalogueRange = "feed per tooth 0.1 to 0.4 mm; tangential force only";
constexpr std::string_view kReview =
    "Milling Force Model for Aviation Aluminum Alloy, Chin. J. Mech. Eng. 34 (2021), doi:10.1186/s10033-021-00536-9, "
    "table 5";
constexpr std::string_view kPowerTable =
    "Mitsubishi Materials, technical information, cutting power for face milling: specific cutting force by feed per "
    "tooth";
constexpr std::string_view kPowerTableRange = "feed per tooth 0.1 to 0.6 mm; tangential force only";
constexpr std::string_view kGroups =
    "ISCAR catalogue 2022, user guide, material groups by ISO 513 and VDI 3323: kc1 and mc";
constexpr std::string_view kGroupsRange =
    "not stated; a neutral rake angle; tangential force only; tools with a positive rake need less";
constexpr std::string_view kHardGroupsRange =
    "not stated; a neutral rake angle; tangential force only; the exponent is that of tempered steels, 0.24";
constexpr std::string_view kParticleboard =
    "B. Palubicki, Cutting forces in peripheral up-milling of particleboard, Materials 14 (2021) 2208: 32.0 and 37.6 "
    "N/mm2";
constexpr std::string_view kEstimate = "an estimate; no published value was found";
constexpr std::string_view kEstimateRange = "not known; a factor of two either way";

// Scatter: published values for the same material differ by this much (42CrMo4, C45 and X5CrNi18-10 in the tables named
// above, and titanium between two editions of one catalogue), or it is the authors' own.
constexpr double kMeasured_percent = 15, kMillingTable_percent = 25, kGroup_percent = 40, kEstimate_percent = 100;

Material linear(double ktc, double krc, double kac, double kte, double kre, double kae) {
  return {ktc, krc, kac, kte, kre, kae};
}

Material kienzle(double kc1_1, double mc) {
  Material m;
  m.law = ForceLaw::kienzle;
  m.kc1_1_MPa = kc1_1;
  m.mc = mc;
  return m;
}

MaterialPreset typical(std::string_view name, std::string_view what, double kc1_1, double mc,
                       std::string_view names = {}, double hardness_HB = 0) {
  return {name, what, kTypical, kTypicalRange, kienzle(kc1_1, mc), false, {}, names, hardness_HB, kGroup_percent};
}

MaterialPreset table(std::string_view name, std::string_view what, std::string_view source, std::string_view range,
                     Rows rows, std::string_view names, double hardness_HB) {
  const KienzlePair pair = kienzle_from_catalogue(rows);
  return {name,
          what,
          source,
          range,
          kienzle(pair.k1_1_MPa, pair.m),
          false,
          std::move(rows),
          names,
          hardness_HB,
          kMillingTable_percent};
}

MaterialPreset catalogue(std::string_view name, std::string_view what, Rows rows, std::string_view names,
                         double hardness_HB) {
  return table(name, what, kCatalogue, kCatalogueRange, std::move(rows), names, hardness_HB);
}

MaterialPreset power_table(std::string_view name, std::string_view what, const Rows& rows, std::string_view names,
                           double hardness_HB) {
  return table(name, what, kPowerTable, kPowerTableRange, rows, names, hardness_HB);
}

/// kc1 and mc of a VDI 3323 group.
MaterialPreset group(std::string_view name, std::string_view what, double kc1, double mc, std::string_view names,
                     double hardness_HB) {
  return {name, what, kGroups, kGroupsRange, kienzle(kc1, mc), false, {}, names, hardness_HB, kGroup_percent};
}

MaterialPreset hardened(std::string_view name, std::string_view what, double kc1, double hardness_HB) {
  constexpr double kTempered = 0.24;
  return {name, what, kGroups, kHardGroupsRange, kienzle(kc1, kTempered), false, {}, {}, hardness_HB, kGroup_percent};
}

MaterialPreset estimate(std::string_view name, std::string_view what, double kc1, double mc, std::string_view names) {
  return {name, what, kEstimate, kEstimateRange, kienzle(kc1, mc), false, {}, names, 0, kEstimate_percent};
}

MaterialPreset measured(std::string_view name, std::string_view what, std::string_view source, std::string_view range,
                        Material material, std::string_view names, double hardness_HB) {
  return {name, what, source, range, material, true, {}, names, hardness_HB, kMeasured_percent};
}

// Rows of the table of face milling.
const Rows kMild{{0.1, 2200}, {0.2, 1950}, {0.3, 1820}, {0.4, 1700}, {0.6, 1580}},
    kHard{{0.1, 2520}, {0.2, 2200}, {0.3, 2040}, {0.4, 1850}, {0.6, 1740}},
    kTool770{{0.1, 2030}, {0.2, 1800}, {0.3, 1750}, {0.4, 1700}, {0.6, 1580}},
    kChromeManganese{{0.1, 2300}, {0.2, 2000}, {0.3, 1880}, {0.4, 1750}, {0.6, 1660}},
    kChromeMolybdenum{{0.1, 2540}, {0.2, 2250}, {0.3, 2140}, {0.4, 2000}, {0.6, 1800}},
    kNickelChrome940{{0.1, 2000}, {0.2, 1800}, {0.3, 1680}, {0.4, 1600}, {0.6, 1500}},
    kNickelChrome352HB{{0.1, 2100}, {0.2, 1900}, {0.3, 1760}, {0.4, 1700}, {0.6, 1530}},
    kAustenitic{{0.1, 2030}, {0.2, 1970}, {0.3, 1900}, {0.4, 1770}, {0.6, 1710}},
    kBrass{{0.1, 1150}, {0.2, 950}, {0.3, 800}, {0.4, 700}, {0.6, 630}},
    kAlMg{{0.1, 580}, {0.2, 480}, {0.3, 400}, {0.4, 350}, {0.6, 320}},
    kAlSi{{0.1, 700}, {0.2, 600}, {0.3, 490}, {0.4, 450}, {0.6, 390}},
    kAlZnMgCu{{0.1, 880}, {0.2, 840}, {0.3, 840}, {0.4, 810}, {0.6, 720}};

void add_steels(std::vector<MaterialPreset>& out) {
  out.push_back({"C45",
                 "carbon steel C45 (1.0503)",
                 "typical value",
                 kTypicalRange,
                 kienzle(2220, 0.14),
                 false,
                 {},
                 "1.0503 1.1191 C45E Ck45 1045 S45C S48C 080M46",
                 190,
                 kGroup_percent});
  out.push_back(catalogue("S55C", "carbon steel, JIS G 4051 (C55)",
                          {{0.1, 1970}, {0.15, 1860}, {0.2, 1800}, {0.3, 1760}, {0.4, 1620}},
                          "C55 1.0535 1.1203 C55E Ck55 1055 C50 C50E 1.1206 1050 S50C", 230));
  out.push_back(catalogue("SS400", "structural steel, JIS G 3101 (S275JR)",
                          {{0.1, 2150}, {0.15, 2000}, {0.2, 1900}, {0.3, 1750}, {0.4, 1650}},
                          "S275JR 1.0044 S355J2 1.0577 1.0570 St52-3 A572", 150));
  out.push_back(catalogue("34CrMo4", "low-alloy steel 34CrMo4 (SCM435)",
                          {{0.1, 2450}, {0.15, 2350}, {0.2, 2200}, {0.3, 1980}, {0.4, 1710}},
                          "1.7220 SCM435 4135 4130 25CrMo4 1.7218 SCM430", 217));
  out.push_back(catalogue("55NiCrMoV7", "die steel SKT4, prehardened to 352 HB",
                          {{0.1, 2030}, {0.15, 2010}, {0.2, 1810}, {0.3, 1680}, {0.4, 1590}},
                          "1.2714 1.2713 SKT4 L6 55NiCrMoV6 56NiCrMoV7", 352));
  out.push_back(catalogue("GS-52", "cast steel, JIS SC450",
                          {{0.1, 2710}, {0.15, 2530}, {0.2, 2410}, {0.3, 2240}, {0.4, 2120}},
                          "SC450 1.0552 GE260 GE240 GS-45 1.0446", 150));
  out.push_back(power_table("S235JR", "mild steel (1.0038)", kMild,
                            "1.0038 1.0037 St37-2 A36 C15 C15E 1.0401 1.1141 1015 1018 1020 C22 1.0402 S15C S20C "
                            "11SMn30 11SMnPb30 1.0715 1.0718 12L14 1215 SUM22 SUM24L",
                            125));
  out.push_back(power_table("C60", "carbon steel C60 (1.0601)", kHard,
                            "1.0601 1.1221 C60E Ck60 1060 S58C C70 1070 C75S 1.1248 C80U 1.1525 1.1730 C45U", 220));
  out.push_back(power_table("16MnCr5", "case hardening steel, annealed", kChromeManganese,
                            "1.7131 5115 20MnCr5 1.7147 5120 SCR420 SCR415 8620 20NiCrMo2-2 1.6523 SNCM220 18CrNiMo7-6 "
                            "1.6587 15CrNi6 1.5919 100Cr6 1.3505 52100 SUJ2",
                            200));
  out.push_back(power_table("42CrMo4", "low-alloy steel, annealed or tempered to 250 HB", kChromeMolybdenum,
                            "1.7225 1.7223 4140 4142 SCM440 SCM445 42CrMoS4 1.7227 51CrV4 1.8159 6150 SUP10 41Cr4 "
                            "1.7035 5140 SCr440 31CrMoV9 1.8519 34CrAlNi7 1.8550 Nitralloy",
                            230));
  out.push_back(power_table("34CrNiMo6", "low-alloy steel, tempered to 940 MPa", kNickelChrome940,
                            "1.6582 4340 SNCM439 SNCM447 30CrNiMo8 1.6580 36CrNiMo4 1.6511 300M", 290));
  out.push_back(power_table("P20", "plastic mould steel, prehardened to 300 HB (values of 352 HB)", kNickelChrome352HB,
                            "1.2311 1.2312 1.2738 40CrMnMo7 40CrMnMoS8-6 40CrMnNiMo8-6-4 P20+Ni P20+S PX5 Impax 718H "
                            "718HH SCM4 Toolox33",
                            300));
  out.push_back(power_table("NAK80", "mould steel, age hardened to 40 HRC (values of 352 HB)", kNickelChrome352HB,
                            "NAK55 P21 HPM50 CENA1 10Ni3MnCuAl Corrax", 370));
  out.push_back(power_table("1.2343", "hot work steel X37CrMoV5-1, annealed", kTool770,
                            "X37CrMoV5-1 X38CrMoV5-1 H11 SKD6 1.2344 X40CrMoV5-1 H13 SKD61 DHA1 DAC Orvar 8407 1.2367 "
                            "X38CrMoV5-3 1.2365 H10 Dievar 1.2606 H12 W302 W300 SKD62",
                            215));
  out.push_back(power_table("1.2379", "cold work steel X153CrMoV12, annealed", kTool770,
                            "X153CrMoV12 X155CrVMo12-1 D2 SKD11 SLD DC53 1.2080 X210Cr12 D3 SKD1 1.2436 K110 1.2363 A2 "
                            "SKD12 1.2601",
                            245));
  out.push_back(power_table("1.2842", "cold work steel 90MnCrV8, annealed", kTool770,
                            "90MnCrV8 O2 1.2510 100MnCrW4 O1 SKS3 SKS31 1.2767 45NiCrMo16 1.2550 S1 1.2210 115CrV3 L2 "
                            "1.3343 HS6-5-2 M2 SKH51 SKH9 1.3243 M35 SKH55",
                            230));
  out.push_back(typical("mild-steel", "mild steel", 2298, 0.20, {}, 125));
  out.push_back(typical("low-alloy-steel", "low-alloy steel", 2809, 0.24, {}, 220));
  out.push_back(typical("tool-steel", "tool steel", 3191, 0.27, {}, 230));
  out.push_back(hardened("hardened-55HRC", "hardened steel, 47 to 57 HRC", 4600, 560));
  out.push_back(hardened("hardened-60HRC", "hardened steel, more than 57 HRC", 4700, 650));
}

void add_stainless_and_cast(std::vector<MaterialPreset>& out) {
  out.push_back(power_table("304", "austenitic stainless steel X5CrNi18-10 (1.4301)", kAustenitic,
                            "1.4301 X5CrNi18-10 SUS304 304L 1.4306 1.4307 SUS304L 303 1.4305 SUS303 X8CrNiS18-9 321 "
                            "1.4541 SUS321 302 301",
                            155));
  out.push_back(power_table("316L", "austenitic stainless steel X2CrNiMo17-12-2 (1.4404)", kAustenitic,
                            "1.4404 X2CrNiMo17-12-2 SUS316L 316 1.4401 SUS316 X5CrNiMo17-12-2 1.4435 316Ti 1.4571 "
                            "X6CrNiMoTi17-12-2 1.4436 S31603 S31600",
                            155));
  out.push_back(group("2205", "duplex stainless steel X2CrNiMoN22-5-3 (1.4462)", 2150, 0.20,
                      "1.4462 X2CrNiMoN22-5-3 SUS329J3L S32205 S31803 1.4410 2507 904L 1.4539 1.4547", 260));
  out.push_back(group("420", "martensitic or ferritic stainless steel, annealed", 1875, 0.21,
                      "1.4021 1.4028 1.4034 X20Cr13 X46Cr13 SUS420J2 SUS420J1 1.2083 Stavax 1.2316 X36CrMo17 1.4016 "
                      "430 SUS430 430F 1.4104 410 1.4006 SUS410 416 1.4005 SUS416 440C 1.4125 SUS440C 1.2085 RoyAlloy",
                      200));
  out.push_back(group("17-4PH", "precipitation hardening stainless steel (1.4542)", 1875, 0.21,
                      "1.4542 630 SUS630 X5CrNiCuNb16-4 S17400 15-5PH 1.4545 1.4568 17-7PH 1.4122 1.4057 431 SUS431",
                      330));
  out.push_back(catalogue("FC250", "grey cast iron, JIS G 5501 (EN-GJL-250)",
                          {{0.1, 1660}, {0.15, 1450}, {0.2, 1320}, {0.3, 1150}, {0.4, 1030}},
                          "EN-GJL-250 GJL-250 GG25 0.6025 EN-GJL-200 GJL-200 GG20 0.6020 FC200 FC300 GJL-300 GG30 "
                          "0.6030 EN-GJL-300 5.1301 5.1201 G3000 G3500",
                          200));
  out.push_back(typical("grey-iron", "grey cast iron", 1286, 0.23, {}, 190));
  out.push_back(group("GJS-400", "ductile cast iron, ferritic (EN-GJS-400-15)", 1225, 0.25,
                      "EN-GJS-400-15 GJS-400-15 EN-GJS-400-18 GJS-400-18 GGG40 0.7040 FCD400 FCD450 60-40-18 65-45-12 "
                      "GJS-450-10",
                      160));
  out.push_back(group("GJS-600", "ductile cast iron, pearlitic (EN-GJS-600-3)", 1350, 0.28,
                      "EN-GJS-600-3 GJS-600-3 GGG60 0.7060 FCD600 EN-GJS-500-7 GJS-500-7 GGG50 0.7050 FCD500 80-55-06 "
                      "EN-GJS-700-2 GJS-700-2 GGG70 0.7070 FCD700 GGG70L",
                      250));
}

void add_others(std::vector<MaterialPreset>& out) {
  out.push_back(measured("Al6082-T6", "wrought aluminium alloy, cemented carbide, dry", kReview, "the table names none",
                         linear(631, 99, 273, 13, 10, 2.8),
                         "6082 3.2315 AlSi1MgMn AlMgSi1 6061 3.3211 AlMg1SiCu 6063 3.3206 AlMg0.7Si 6060 6005 6005A "
                         "Al6061 A6061 A6063",
                         95));
  out.push_back(measured("Al7075", "wrought aluminium alloy", "typical value for end mills", "not stated",
                         linear(951.8, 608.6, 288.5, 14.0, 16.5, -1.25), "7050 7022 3.4345 7010 Certal Alumold", 150));
  out.push_back(measured("Al7075-T6", "wrought aluminium alloy, cemented carbide, dry", kReview, "the table names none",
                         linear(767.01, 168.8, 222, 27.7, 26.6, 0.7), "7075 3.4365 AlZn5.5MgCu AlZnMgCu1.5 A7075 Ergal",
                         150));
  out.push_back(power_table("Al2024", "wrought aluminium alloy AlCu4Mg1 (values of AlZnMgCu)", kAlZnMgCu,
                            "2024 3.1355 AlCu4Mg1 AlCuMg2 A2024 2017 2017A 3.1325 AlCuMg1 A2017 2007 3.1645 2011 2014",
                            120));
  out.push_back(power_table("Al5083", "wrought aluminium alloy AlMg4.5Mn0.7, not hardened", kAlMg,
                            "5083 3.3547 AlMg4.5Mn AlMg4.5Mn0.7 A5083 5052 A5052 AlMg2.5 3.3523 5754 AlMg3 3.3535 "
                            "5005 5019 MIC-6 MIC6",
                            75));
  out.push_back(power_table("AlSi7Mg", "cast aluminium alloy with up to 12 % silicon", kAlSi,
                            "A356 3.2371 AC4C AlSi10Mg 3.2381 A360 ADC12 A380 AlSi9Cu3 3.2163 AC4CH A383 EN-AC-46000 "
                            "EN-AC-42100 AlSi12",
                            80));
  out.push_back(typical("soft-aluminium", "soft wrought aluminium", 641, 0.27, "1050A 1100 Al99.5 A1050 3.0255", 30));
  out.push_back(power_table("brass", "free-cutting brass CuZn39Pb3 (2.0401)", kBrass,
                            "CuZn39Pb3 2.0401 CW614N C36000 C38500 C3604 CuZn40Pb2 2.0402 CW617N Ms58 CuZn37 2.0321 "
                            "C2700 CZ121",
                            110));
  out.push_back(group("bronze", "tin bronze CuSn8", 700, 0.27,
                      "CuSn8 2.1030 CuSn6 CuSn12 2.1052 C52100 C93200 RG7 2.1090 CuAl10Ni5Fe4 2.0966 C63000", 100));
  out.push_back(group("copper", "electrolytic copper (2.0060)", 700, 0.27,
                      "Cu-ETP E-Cu 2.0060 2.0065 CW004A C11000 C1100 C1020 Cu-OF CW008A OFHC CuCr1Zr 2.1293", 80));
  out.push_back(group("Ti6Al4V", "titanium alloy, alpha and beta (the edition of 2017 has 2110 and 0.22)", 1245, 0.24,
                      "Ti64 3.7165 3.7164 TiAl6V4 Ti-6Al-4V R56400 TC4 Grade5 Ti-Grade5 Ti-6246 Ti5553", 330));
  out.push_back(group("Ti-Grade2", "titanium, commercially pure (the edition of 2017 has 1700 and 0.23)", 1160, 0.24,
                      "3.7035 3.7025 Grade2 Grade1 CP-Ti R50400 TB340", 160));
  out.push_back(group("Inconel718", "nickel alloy NiCr19Fe19Nb5Mo3, age hardened", 3300, 0.24,
                      "2.4668 IN718 Alloy718 N07718 NiCr19Fe19Nb5Mo3 Waspaloy N07001 2.4654 Nimonic80A 2.4952 Rene41 "
                      "Inconel",
                      350));
  out.push_back(group("Inconel625", "nickel alloy, annealed", 3300, 0.24,
                      "2.4856 IN625 Alloy625 N06625 HastelloyC276 2.4819 HastelloyX 2.4665 Inconel600 2.4816 Monel400 "
                      "2.4360 MonelK500",
                      250));
  out.push_back(group("A286", "iron-based heat resistant alloy, age hardened", 3100, 0.24,
                      "1.4980 S66286 Incoloy800 1.4876 Incoloy825", 280));
  out.push_back(estimate("graphite", "electrode graphite", 120, 0.2, "EDM-3 TTK-50 EllorPlus"));
  out.push_back(estimate("POM", "thermoplastics: POM, PA, PE, PMMA, PC, PEEK", 70, 0.25,
                         "Delrin Acetal PA6 PA66 Nylon PMMA Acrylic Plexiglas PC Polycarbonate PEEK PE PE-HD HDPE UHMW "
                         "PVC ABS PTFE PP HIPS"));
  out.push_back(estimate("tooling-board", "polyurethane board and rigid foam", 15, 0.25,
                         "Ureol Renshape Necuron Obomodulan PU-board foam wax Raku-Tool RAKU"));
  out.push_back({"particleboard",
                 "particleboard, MDF, plywood, wood",
                 kParticleboard,
                 "peripheral up-milling at 40 to 60 m/s; tangential force only",
                 kienzle(35, 0),
                 false,
                 {},
                 "MDF plywood wood pine birch beech oak maple walnut hardwood softwood HDF OSB bamboo",
                 0,
                 kEstimate_percent});
}

std::vector<MaterialPreset> make_presets() {
  std::vector<MaterialPreset> out;
  add_steels(out);
  add_stainless_and_cast(out);
  add_others(out);
  for (auto& p : out) p.material.preset = p.name;
  std::ranges::sort(out, {}, &MaterialPreset::name);
  return out;
}

}  // namespace

std::span<const MaterialPreset> material_presets() {
  static const std::vector<MaterialPreset> presets = make_presets();
  return presets;
}

const MaterialPreset* find_preset(std::string_view name) {
  const auto all = material_presets();
  const auto at = std::ranges::find(all, name, &MaterialPreset::name);
  return at == all.end() ? nullptr : &*at;
}

}  // namespace camber::machine
