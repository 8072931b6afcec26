// Tool libraries against what their formats' descriptions say, worked out by another program.
#include <cmath>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "machine/quantity.h"
#include "machine/tool_proposal.h"
#include "test_paths.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_data.h"

namespace camber::machine {
namespace {

using nlohmann::json;
const std::string kTools = CAMBER_SOURCE_DIR "/tests/data/tools/";

std::vector<ToolProposal> read(const std::string& path) {
  Diagnostics diagnostics;
  return read_tools(path, false, diagnostics);
}

std::string message_of(const std::string& path, const std::string& folder) {
  try {
    read(path);
  } catch (const InputError& e) {
    return tests::replaced(e.what(), folder, "");
  }
  return "no error";
}

std::optional<double> half(const std::optional<double>& angle) {
  return angle ? std::optional(*angle / 2) : std::nullopt;
}

/// In the words of expected.json: corners of flat and ball cutters follow from their type.
json told(const ToolProposal& t) {
  json out = json::object();
  const auto put = [&](const char* key, const auto& value) {
    if (value) out[key] = *value;
  };
  put("number", t.number);
  out["name"] = t.what;
  if (!t.kind.empty()) out["type"] = t.kind;
  put("diameter", t.diameter_mm);
  put("corner_radius", t.kind == "flat" && t.diameter_mm              ? std::optional(0.0)
                       : t.kind == "ball" || t.kind == "tapered ball" ? half(t.diameter_mm)
                                                                      : t.corner_radius_mm);
  put("flutes", t.flutes);
  put("flute_length", t.flute_length_mm);
  put("overall", t.overall_length_mm);
  put("shank", t.shank_diameter_mm);
  put("stickout", t.overhang_mm);
  put("half_angle_deg", t.kind == "drill" ? std::nullopt : t.taper_deg ? t.taper_deg : half(t.point_angle_deg));
  put("tip_diameter", t.tip_diameter_mm);
  if (t.kind == "drill") put("tip_angle_deg", t.point_angle_deg);
  put("neck_diameter", t.neck_diameter_mm);
  put("shoulder_length", t.shoulder_length_mm);
  for (const auto& part : t.holder)
    out["holder"].push_back({part.length_mm, part.lower_diameter_mm, part.upper_diameter_mm});
  return out;
}

constexpr double kRounding_mm = 1e-5;  // of the table's decimals

bool same(const json& a, const json& b, double rounding = kRounding_mm) {
  if (a.is_number() && b.is_number()) return std::abs(a.get<double>() - b.get<double>()) <= rounding;
  if (!a.is_array() || !b.is_array() || a.size() != b.size()) return a == b;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!same(a[i], b[i], rounding)) return false;
  return true;
}

/// What one tool tells otherwise than expected; a tool table's type is that of its remark.
std::string differences(const json& told, const json& expected, bool table) {
  std::string out;
  for (const auto& [key, value] : expected.items())
    if (!value.is_null() && !same(told.value(key, json()), value))
      out += fmt::format(" {} is {} instead of {};", key, told.value(key, json()).dump(), value.dump());
  for (const auto& [key, value] : told.items())
    if (!table && expected.value(key, json()).is_null()) out += fmt::format(" {} is {};", key, value.dump());
  return out;
}

/// Compares every file of a table with what is read; counts its cutters.
int compare(const std::string& folder) {
  std::ifstream stream(folder + "expected.json");
  const json table = json::parse(stream);
  int count = 0;
  for (const auto& [file, cutters] : table.items()) {
    std::vector<json> expected;
    for (const json& cutter : cutters) {
      ++count;
      if (!cutter.contains("missing_file")) expected.push_back(cutter);
    }
    const auto tools = read(folder + file);
    EXPECT_EQ(tools.size(), expected.size()) << file;
    for (std::size_t i = 0; i < std::min(tools.size(), expected.size()); ++i)
      EXPECT_EQ(differences(told(tools[i]), expected[i], file.ends_with(".tbl")), "")
          << file << ", " << expected[i].dump();
  }
  return count;
}

TEST(ToolLibraries, TellWhatTheirFormatsSay) { EXPECT_EQ(compare(kTools), 67); }

TEST(ToolLibraries, OfOtherProgramsTellWhatTheirFormatsSay) {
  const std::string folder = tests::unshipped_data("tools");
  if (folder.empty()) GTEST_SKIP() << tests::not_shipped("tools");
  EXPECT_EQ(compare(folder + "/"), 276);
}

TEST(ToolLibraries, WithTheSameCuttersGiveTheSameTools) {
  // Of each number in the Fusion library: what another format tells as well must be the same; HSMWorks keeps six
  // figures.
  constexpr double kDecimals_mm = 1e-4;
  const auto fusion = read(kTools + "fusion.json");
  for (const char* file :
       {"fusion.tools", "fusion.csv", "hsmworks.hsmlib", "freecad/Library/Shop.fctl", "vectric.vtdb"})
    for (const auto& tool : read(kTools + file)) {
      ASSERT_TRUE(tool.number && *tool.number >= 1 && *tool.number <= 8) << file;
      json a = told(fusion[static_cast<std::size_t>(*tool.number) - 1]), b = told(tool);
      if (b["type"] == "vbit") b["type"] = "chamfer";
      for (const auto& [key, value] : b.items()) EXPECT_TRUE(same(a[key], value, kDecimals_mm)) << file << ": " << key;
      EXPECT_EQ(tool.type, fusion[static_cast<std::size_t>(*tool.number) - 1].type) << file;
    }
}

TEST(ToolLibraries, OfAFolderAreReadTogether) {
  // Eight of five libraries and of the table, seven of Vectric's, T99 of the table, three bits that no library lists.
  const auto tools = read(kTools);
  EXPECT_EQ(tools.size(), 8u * 6 + 7 + 1 + 3);
  const tests::TempFolder empty;
  empty.write("notes.txt", "none");
  empty.write("package.json", "{}");
  EXPECT_EQ(message_of(empty.path(), empty.path()),
            ": error: no tool library in this folder; .json, .tools, .csv, .hsmlib, .fctl, .vtdb or .tbl was expected "
            "[tool-library]");
}

TEST(FreecadLibrary, NamesTheLineOfAMissingBitAndKeepsTheOthers) {
  const tests::TempFolder folder;
  std::filesystem::create_directory(folder / "Bit");
  std::filesystem::create_directory(folder / "Library");
  folder.write("Bit/a.fctb", R"({"name": "A", "shape": "endmill.fcstd", "parameter": {"Diameter": "4 mm"}})");
  const auto path = folder.write("Library/shop.fctl",
                                 "{\"tools\": [\n  {\"nr\": 3, \"path\": \"b.fctb\"},\n  {\"nr\": 5, \"path\": "
                                 "\"a.fctb\"}\n]}\n");
  Diagnostics diagnostics;
  const auto tools = read_tools(path, false, diagnostics);
  ASSERT_EQ(tools.size(), 1u);
  EXPECT_EQ(tools[0].number, 5);
  EXPECT_EQ(tools[0].diameter_mm, 4);
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(tests::replaced(to_string(diagnostics.all()[0]), folder.path() + "/Library/", ""),
            "shop.fctl:2:21: warning: T3: no file b.fctb beside the library or in the folder Bit; the tool is left out "
            "[file-missing]\n      {\"nr\": 3, \"path\": \"b.fctb\"},\n                        ^");
}

TEST(FreecadBit, SaysWhereItIsDamaged) {
  const tests::TempFolder folder;
  const auto said = [&](const char* text) { return message_of(folder.write("a.fctb", text), folder.path() + "/"); };
  EXPECT_EQ(said("{\n\"name\": \"A\",\n"),
            "a.fctb:2:14: error: this is not JSON; a tool bit of FreeCAD (.fctb) was expected [tool-library]\n"
            "    \"name\": \"A\",\n                ^");
  EXPECT_EQ(said("[]"),
            "a.fctb:1:1: error: this is no table {...}; a tool bit of FreeCAD (.fctb) was expected [tool-library]\n"
            "    []\n    ^");
  EXPECT_EQ(said("{\"shape\": \"drill.fcstd\",\n \"parameter\": {\"Diameter\": \"5 bananas\"}}"),
            "a.fctb:2:16: error: Diameter is \"5 bananas\"; a number with a unit was expected, as in \"5.0 mm\" "
            "[tool-library]\n     \"parameter\": {\"Diameter\": \"5 bananas\"}}\n                   ^");
  EXPECT_EQ(said("{\"name\": \"A\"}"),
            "a.fctb:1:1: error: no shape; a tool bit of FreeCAD (.fctb) was expected [tool-library]\n"
            "    {\"name\": \"A\"}\n    ^");
}

TEST(FreecadBit, SaysThatAConeDoesNotReachItsDiameter) {
  // The chamfer tool that FreeCAD brings: 60 degrees fit its other sizes.
  const tests::TempFolder folder;
  const auto doubt = [&](const char* angle) {
    return read(folder.write("a.fctb", fmt::format(R"({{"shape": "chamfer.fcstd", "parameter": {{
        "CuttingEdgeAngle": "{} °", "CuttingEdgeHeight": "6.3500 mm", "Diameter": "12.3323 mm",
        "TipDiameter": "5.0000 mm"}}}})",
                                                   angle)))[0]
        .doubt;
  };
  EXPECT_EQ(doubt("45.0000"), "its cone of 45 degrees ends at D10.26, not at its diameter of 12.33");
  EXPECT_EQ(doubt("60.0000"), "");
}

TEST(Quantities, OfFreecadAreRead) {
  const std::pair<const char*, double> lengths[] = {
      {"5.0000 mm", 5},       {"1.063 \"", 1.063 * 25.4}, {"0.000 in", 0},       {"6,0 mm", 6},
      {"1 cm", 10},           {"25,0 \u03bcm", 0.025},    {"25 \u00b5m", 0.025}, {"25um", 0.025},
      {"3.175", 3.175},       {"1/4 in", 6.35},           {"1 1/4\"", 31.75},    {"1' 2 1/2\"", 14.5 * 25.4},
      {"1.234,5 mm", 1234.5}, {"1,234.5 mm", 1234.5},     {"5\u00a0mm", 5},      {"1e1 mm", 10},
      {"-2 mm", -2},          {"1' + 1\"", 13 * 25.4}};
  for (const auto& [text, mm] : lengths) {
    ASSERT_TRUE(length_mm_of(text)) << text;
    EXPECT_NEAR(*length_mm_of(text), mm, 1e-9) << text;
  }
  for (const char* text : {"", "mm", "5 x", "5 mm 3", "five", "1/0 in", "5 mm mm", "/", "5 deg", ".", "1e999 mm"})
    EXPECT_FALSE(length_mm_of(text)) << text;
  EXPECT_EQ(angle_deg_of("60.0000 \u00b0"), 60);
  EXPECT_EQ(angle_deg_of("60,5 deg"), 60.5);
  EXPECT_NEAR(*angle_deg_of("3.14159265358979 rad"), 180, 1e-9);
  EXPECT_FALSE(angle_deg_of("5 mm"));
}

TEST(VectricLibrary, SaysWhatWasExpected) {
  const tests::TempFolder folder;
  const auto wanted = "; a tool database of Vectric (.vtdb) was expected [tool-library]";
  EXPECT_EQ(message_of(folder.write("a.vtdb", std::string(2000, 'x')), folder.path() + "/"),
            std::string("a.vtdb: error: file is not a database") + wanted);
  EXPECT_EQ(message_of(folder.write("b.vtdb", ""), folder.path() + "/"),
            std::string("b.vtdb: error: there is no table tool_geometry") + wanted);
  std::ifstream whole(kTools + "vectric.vtdb", std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(whole)), {});
  // Cut off, and with pages of noise: an error, whatever is met first.
  EXPECT_NE(message_of(folder.write("c.vtdb", bytes.substr(0, 6000)), folder.path() + "/").find(wanted),
            std::string::npos);
  for (std::size_t i = 2048; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 167);
  EXPECT_NE(message_of(folder.write("d.vtdb", bytes), folder.path() + "/").find(wanted), std::string::npos);
}

TEST(VectricLibrary, IsReadInAFolderThatMayNotBeWritten) {
  const tests::TempFolder folder;
  std::filesystem::copy(kTools + "vectric.vtdb", folder / "100% of it?.vtdb");
  EXPECT_EQ(read(folder / "100% of it?.vtdb").size(), 7u);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(FusionCsv, SaysWhereItIsDamaged) {
  const tests::TempFolder folder;
  const std::string head = "A (tool_index),B (tool_type),C (tool_diameter),D (tool_unit),E (tool_number)\n";
  const auto said = [&](const std::string& text) {
    return message_of(folder.write("a.csv", text), folder.path() + "/");
  };
  EXPECT_EQ(said("a,b\n1,2\n"),
            "a.csv:1:1: error: no column (tool_index); a tool library of Fusion (Export, CSV) was expected "
            "[tool-library]\n    a,b\n    ^");
  EXPECT_EQ(said(head + "1,drill,5,furlongs,2\n"),
            "a.csv:2:11: error: unit \"furlongs\"; millimeters or inches was expected [tool-library]\n"
            "    1,drill,5,furlongs,2\n              ^");
  EXPECT_EQ(said(head + "1,drill,x,inches,2\n"),
            "a.csv:2:9: error: tool_diameter \"x\"; a number was expected [tool-library]\n"
            "    1,drill,x,inches,2\n            ^");
  EXPECT_EQ(said(head + "1,\"drill,5\n"),
            "a.csv:2:3: error: the quotes that begin here do not end; a closing \" was expected [tool-library]\n"
            "    1,\"drill,5\n      ^");
  EXPECT_EQ(said(head + "1,drill,5,inches,2.5\n"),
            "a.csv:2:18: error: tool number 2.5; a whole number was expected [tool-library]\n"
            "    1,drill,5,inches,2.5\n                     ^");
}

TEST(ToolLibraries, SayThatANumberHasSeveralCutters) {
  std::vector<ToolProposal> known(1), library(4);
  known[0].number = 1;
  known[0].diameter_mm = 6;
  for (std::size_t i = 0; i < library.size(); ++i) {
    library[i].number = i < 2 ? 1 : 2;
    library[i].diameter_mm = i == 1 ? 6.0 : 8.0;
    library[i].what = fmt::format("mill {}", i);
    library[i].from = fmt::format("lib, tool {}", i + 1);
  }
  library[1].flutes = 3;
  add_tools(known, library);
  ASSERT_EQ(known.size(), 2u);
  EXPECT_EQ(known[0].flutes, 3) << "of the cutter that fits the program's words";
  EXPECT_EQ(known[0].doubt, "");
  EXPECT_EQ(known[1].what, "mill 2");
  EXPECT_EQ(known[1].doubt, "lib, tool 4 is another cutter of this number: mill 3");
  library[1].diameter_mm = 3;
  library[3].what = library[2].what;  // the same cutter in two formats of a folder
  library[3].flutes = 4;
  std::vector<ToolProposal> twice;
  add_tools(twice, {library[2], library[3]});
  ASSERT_EQ(twice.size(), 1u);
  EXPECT_EQ(twice[0].doubt, "");
  EXPECT_EQ(twice[0].flutes, 4);
  add_tools(known, library);
  EXPECT_EQ(known[0].doubt, "lib, tool 1 has another cutter of this number: mill 0");
}

}  // namespace
}  // namespace camber::machine
