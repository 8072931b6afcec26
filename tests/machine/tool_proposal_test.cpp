#include "machine/tool_proposal.h"

#include <gtest/gtest.h>
#include <zip.h>

#include "tests/support/temp_folder.h"

namespace camber::machine {
namespace {

struct WordsCase {
  const char* words;
  bool inch;
  std::optional<ToolType> type;
  std::optional<double> diameter_mm, corner_radius_mm;
};

TEST(ToolWords, AreReadAsTheirCamSystemsWriteThem) {
  const std::optional<double> none;
  const WordsCase cases[] = {
      // Fusion; Mastercam (NIST's box programs); SolidWorks CAM.
      {" D=0.125 CR=0.0625 - ZMIN=-0.54 - BALL END MILL", true, ToolType::ball, 3.175, none},
      {" D=10. CR=1. - ZMIN=-5. - bullnose end mill", false, ToolType::bull, 10.0, 1.0},
      {"| 3/4 FLAT ENDMILL|H0|XY STOCK TO LEAVE - .005|Z STOCK TO LEAVE - 0.", true, ToolType::flat, 19.05, none},
      {"| 1/2 BULL ENDMILL 0.125 RAD|H0", true, ToolType::bull, 12.7, 3.175},
      {"|.093 FLAT ENDMILL|H0", true, ToolType::flat, 2.3622, none},
      {"|1-1/4 FACE MILL|H0", true, ToolType::flat, 31.75, none},
      {"|2\"  FACE MILL|H0", true, ToolType::flat, 50.8, none},
      {"|    6. BALL END MILL CRB|H47|XY STOCK TO LEAVE - .0001", true, ToolType::ball, 6.0, none},
      {" ID=002  DIA-0.5000  TOOL END MILL", true, ToolType::flat, 12.7, none},
      {"| 1/8 SPOTDRILL|H0", true, ToolType::drill, 3.175, none},
      {"| NO. 33 DRILL|H0", true, ToolType::drill, 0.113 * 25.4, none},
      {"|   4.00-0.7 TAP RH|H0", true, ToolType::drill, 4.0, none},
      // Comments above the change (NIST's D2MI programs).
      {" 1/2\" DIA. 2 FLUTE STUBBY FULLERTON E.M.   ", true, ToolType::flat, 12.7, none},
      {" 1/4\" DIA. X .032\" RADIUS 2 FLUTE STUBBY BULLNOSE E.M.   ", true, ToolType::bull, 6.35, 0.032 * 25.4},
      {" #30 DRILL   ", true, ToolType::drill, 0.1285 * 25.4, none},
      {" LET. B DRILL   ", true, ToolType::drill, 0.238 * 25.4, none},
      {" .2505\" REAMER   ", true, ToolType::drill, 0.2505 * 25.4, none},
      {".505 REAM", false, ToolType::drill, 0.505 * 25.4, none},
      {".5 BALL", false, ToolType::ball, 0.5, none},
      {" 1/4\" X .093\" CORNER ROUNDING E.M.   ", true, std::nullopt, 6.35, none},
      {" 1/4\" 2 FLUTE E.M. WITH .020\" X 45 DEG CHAMFERS   ", true, ToolType::flat, 6.35, none},
      {" 10. END_MILL_SPHER DIA. 10. ", false, ToolType::ball, 10.0, none},
      {" #99 DRILL", true, ToolType::drill, none, none},
      {" 6MM 4 FLUTE BALL", false, ToolType::ball, 6.0, none},
      // Setters' own words: the corner behind the diameter, "EM".
      {"TOOL 1 = 12.0 R2.0 ENDMILL 4FL", false, ToolType::bull, 12.0, 2.0},
      {"12MM R1 FRAESER", false, ToolType::bull, 12.0, 1.0},
      {"EM 10MM Z4 LOC22 OAL72", false, ToolType::flat, 10.0, none},
      {"8. R4 BALL", false, ToolType::ball, 8.0, none},
      {" 3/0 BALL", false, ToolType::ball, none, none},
      {"", false, std::nullopt, none, none},
  };
  for (const auto& c : cases) {
    const ToolProposal tool = tool_of_words(c.words, c.inch);
    EXPECT_EQ(tool.type, c.type) << c.words;
    ASSERT_EQ(tool.diameter_mm.has_value(), c.diameter_mm.has_value()) << c.words;
    if (c.diameter_mm) {
      EXPECT_NEAR(*tool.diameter_mm, *c.diameter_mm, 1e-9) << c.words;
    }
    ASSERT_EQ(tool.corner_radius_mm.has_value(), c.corner_radius_mm.has_value()) << c.words;
    if (c.corner_radius_mm) {
      EXPECT_NEAR(*tool.corner_radius_mm, *c.corner_radius_mm, 1e-9) << c.words;
    }
  }
  EXPECT_EQ(tool_of_words(" 6MM 4 FLUTE BALL", false).flutes, 4);
  EXPECT_EQ(tool_of_words("EM 10MM Z4 LOC22", false).flutes, 4);
  EXPECT_EQ(tool_of_words("FRAISE D16 Z=3", false).flutes, 3);
  EXPECT_EQ(tool_of_words("FRAISE D16 Z-3", false).flutes, std::nullopt) << "a height";
  EXPECT_EQ(tool_of_words("FRAISE D16 Z3.", false).flutes, std::nullopt) << "a height";
  EXPECT_EQ(tool_of_words(" 1/2\" DIA. 2 FLUTE STUBBY E.M.", true).flutes, 2);
  EXPECT_EQ(tool_of_words(" 1/4\" X 45\xb0 CHAMFER MILL", true).point_angle_deg, 90);
  EXPECT_EQ(tool_of_words(" 1/4\" X 90\xc2\xb0 SPOT DRILL", true).point_angle_deg, 90);
  EXPECT_EQ(tool_of_words(" .2505\" REAMER", true).doubt, "taps and reamers stand as drills: they make holes alone");
  EXPECT_EQ(tool_of_words("|    6. BALL END MILL", true).doubt,
            "the size 6. has no unit in a program in inches; taken as mm");
  EXPECT_EQ(tool_of_words("|    6. BALL END MILL", false).doubt, "");
  EXPECT_EQ(tool_of_words(".505 REAM", false).doubt,
            "the size .505 has no unit in a program in millimetres; taken as inches");
}

TEST(ToolComments, AreFoundAnywhereInAProgram) {
  const auto tools = tools_in_comments(
      SourceText("p.nc",
                 "%\n(T03 D=8. - FLAT END MILL)\n(SETUP)\nT1 M6 (6. BALL END MILL)\nN5 T7 M06 ; 10. DRILL\n"
                 "(T3 2 FLUTES)\nG1 X1. (T4 M6 IS LATER)\n"),
      false);
  ASSERT_EQ(tools.size(), 4u);
  EXPECT_EQ(tools[0].number, 3);
  EXPECT_EQ(tools[0].from, "p.nc:2");
  EXPECT_EQ(tools[0].diameter_mm, 8.0);
  EXPECT_EQ(tools[0].flutes, 2);  // from the second comment
  EXPECT_EQ(tools[1].number, 1);
  EXPECT_EQ(tools[1].type, ToolType::ball);
  EXPECT_EQ(tools[2].number, 7);
  EXPECT_EQ(tools[2].type, ToolType::drill);
  EXPECT_EQ(tools[3].number, 4);
  EXPECT_FALSE(tools[3].type.has_value());
}

TEST(ToolComments, AloneOnALineBelongToTheChangeBelow) {
  const auto tools = tools_in_comments(
      SourceText("p.nc",
                 "( 3\" FACE MILL   )\n( REV. )\nN102 T1\nN103 G91 G28 Z0 M6\nN104 T2 M01\nN105 G1 X1. Y2.\n"
                 "( ROUGH .134 DEEP STEP )\n( 1/4\" DRILL )\nN110 X3.\nN146 T2\nN147 G91 G28 Z0 M06\nN148 T3 M01\n"
                 "( #25 DRILL )\nT5 M6\n"),
      true);
  ASSERT_EQ(tools.size(), 2u);
  EXPECT_EQ(tools[0].number, 1);
  EXPECT_EQ(tools[0].from, "p.nc:1");
  EXPECT_NEAR(*tools[0].diameter_mm, 76.2, 1e-9);
  EXPECT_EQ(tools[1].number, 5);  // the 1/4" drill stands above a motion, so it is not the tool of the change
  EXPECT_NEAR(*tools[1].diameter_mm, 0.1495 * 25.4, 1e-9);
}

/// Without a warning.
std::vector<ToolProposal> read(const std::string& path, bool inch) {
  Diagnostics diagnostics;
  auto out = read_tools(path, inch, diagnostics);
  throw_if_any(diagnostics);
  return out;
}

TEST(ToolTable, OfLinuxCncIsRead) {
  const tests::TempFolder folder;
  const auto path = folder.write(
      "tool.tbl", "; a comment\nT1 P17 X0 Y0 Z0.511 D0.125 I0 J0 Q0 ;1/8 flat end mill\n\nT2 P2 Z+1.5 ;ball 6mm\n");
  const auto tools = read(path, true);
  ASSERT_EQ(tools.size(), 2u);
  EXPECT_NEAR(*tools[0].diameter_mm, 3.175, 1e-9);
  EXPECT_EQ(tools[0].type, ToolType::flat);
  EXPECT_EQ(tools[0].from, path + ":2");
  EXPECT_EQ(tools[1].number, 2);
  EXPECT_EQ(tools[1].type, ToolType::ball);
}

template <class Function>
std::string message_of(Function f, const tests::TempFolder& folder) {
  try {
    f();
  } catch (const InputError& e) {
    return tests::replaced(e.what(), folder.path() + "/", "");
  }
  return "no error";
}

TEST(ToolTable, NamesTheWordThatIsNone) {
  const tests::TempFolder folder;
  const auto path = folder.write("tool.tbl", "T1 P1 D6\nT2 Px D8\n");
  EXPECT_EQ(
      message_of([&] { read(path, false); }, folder),
      "tool.tbl:2:4: error: \"Px\" in a tool table; a letter with a number was expected, as in T1 P1 D6.0 ;remark "
      "[tool-table]\n    T2 Px D8\n       ^");
}

TEST(ToolLibrary, OfFusionIsRead) {
  const tests::TempFolder folder;
  const auto path = folder.write("lib.json", R"({"version": 2, "data": [
    {"description": "1/4 ball", "type": "ball end mill", "unit": "inches", "BMC": "carbide",
     "geometry": {"DC": 0.25, "RE": 0.125, "LCF": 0.75, "LB": 1.5, "SFDM": 0.25, "NOF": 2},
     "post-process": {"number": 9}},
    {"type": "bull nose end mill", "unit": "millimeters", "BMC": "hss",
     "geometry": {"DC": 10, "RE": 1, "NOF": 4}, "post-process": {"number": 2}},
    {"type": "holder"}]})");
  const auto tools = read(path, false);
  ASSERT_EQ(tools.size(), 3u);
  EXPECT_EQ(tools[2].kind, "holder");
  EXPECT_FALSE(tools[2].number.has_value());
  EXPECT_EQ(tools[0].number, 9);
  EXPECT_EQ(tools[0].what, "1/4 ball");
  EXPECT_EQ(tools[0].type, ToolType::ball);
  EXPECT_NEAR(*tools[0].diameter_mm, 6.35, 1e-9);
  EXPECT_NEAR(*tools[0].overhang_mm, 38.1, 1e-9);
  EXPECT_EQ(tools[0].flutes, 2);
  EXPECT_EQ(tools[0].youngs_modulus_GPa, 600);
  EXPECT_EQ(tools[1].corner_radius_mm, 1);
  EXPECT_EQ(tools[1].youngs_modulus_GPa, 210);
  EXPECT_FALSE(tools[1].overhang_mm.has_value());
}

/// A zip file with one entry.
std::string zipped(const tests::TempFolder& folder, const std::string& file, const std::string& entry,
                   const std::string& text) {
  const std::string path = folder / file;
  zip_t* zip = zip_open(path.c_str(), ZIP_CREATE, nullptr);
  zip_source_t* source = zip_source_buffer(zip, text.data(), text.size(), 0);
  EXPECT_GE(zip_file_add(zip, entry.c_str(), source, 0), 0);
  EXPECT_EQ(zip_close(zip), 0);
  return path;
}

TEST(ToolLibrary, ReadsTheZipFileThatFusionExports) {
  const tests::TempFolder folder;
  const std::string text =
      R"({"data": [{"type": "ball end mill", "unit": "millimeters", "description": "6 mm ball", "BMC": "carbide",
          "geometry": {"DC": 6, "NOF": 2, "LB": 40}, "post-process": {"number": 9}}]})";
  const auto packed = read(zipped(folder, "shop.tools", "library/tools.json", text), false),
             plain = read(folder.write("shop.json", text), false);
  ASSERT_EQ(packed.size(), 1u);
  EXPECT_EQ(packed[0].number, 9);
  EXPECT_EQ(packed[0].type, ToolType::ball);
  EXPECT_EQ(packed[0].diameter_mm, plain[0].diameter_mm);
  EXPECT_EQ(packed[0].overhang_mm, 40);
}

TEST(ToolLibrary, SaysWhatIsWrongInAZipFile) {
  const tests::TempFolder folder;
  EXPECT_EQ(message_of([&] { read(zipped(folder, "a.tools", "readme.txt", "{}"), false); }, folder),
            "a.tools: error: is a zip file without a .json file [tool-library]");
  EXPECT_EQ(message_of([&] { read(zipped(folder, "b.tools", "tools.json", "[\n}"), false); }, folder),
            "b.tools/tools.json:2:1: error: this is not JSON; a tool library of Fusion (File, Export, JSON) was "
            "expected [tool-library]\n"
            "    }\n"
            "    ^");
  EXPECT_NE(message_of([&] { read(folder / "none.tools", false); }, folder).find("[file-missing]"), std::string::npos);
}

std::string hsm(const std::string& tools) {
  return "<?xml version=\"1.0\" standalone=\"no\"?>\n<tool-library "
         "xmlns=\"http://www.hsmworks.com/xml/2004/cnc/tool-library\" version=\"14\">\n" +
         tools + "</tool-library>\n";
}

constexpr const char* kHsmTools = R"(
  <tool guid="{1}" id="7" type="flat end mill" unit="millimeters" version="1.5">
    <description>10 mm flat</description>
    <nc number="4" diameter-offset="4" length-offset="4"/>
    <material name="carbide"/>
    <body diameter="10" corner-radius="0" flute-length="22" shoulder-length="24" body-length="32" overall-length="72"
          shaft-diameter="10" number-of-flutes="4"/>
    <holder description="ER20"><section diameter="25.2" length="0"/></holder>
  </tool>
  <tool type="bull nose end mill" unit="inches"><nc number="5"/><material name="hss"/>
    <body diameter="0.5" corner-radius="0.0625" flute-length="1" body-length="2" number-of-flutes="2"/></tool>
  <tool type="tap right hand" unit="millimeters"><nc number="6"/><body diameter="6"/></tool>
  <tool type="ball end mill" unit="millimeters"><body diameter="6"/></tool>
)";

/// As Windows programs write it: little-endian with a byte order mark.
std::string utf16(const std::string& ascii) {
  std::string out = "\xff\xfe";
  for (const char c : ascii) out += std::string{c, '\0'};
  return out;
}

TEST(ToolLibrary, ReadsTheXmlOfHsmWorks) {
  const tests::TempFolder folder;
  for (const std::string& text : {hsm(kHsmTools), utf16(hsm(kHsmTools))}) {
    const auto tools = read(folder.write("shop.hsmlib", text), false);
    ASSERT_EQ(tools.size(), 4u);
    EXPECT_EQ(tools[0].number, 4) << "not the id";
    EXPECT_EQ(tools[0].what, "10 mm flat");
    EXPECT_EQ(tools[0].type, ToolType::flat);
    EXPECT_EQ(tools[0].diameter_mm, 10);
    EXPECT_FALSE(tools[0].corner_radius_mm.has_value());
    EXPECT_EQ(tools[0].flute_length_mm, 22);
    EXPECT_EQ(tools[0].overhang_mm, 32);
    EXPECT_EQ(tools[0].shank_diameter_mm, 10);
    EXPECT_EQ(tools[0].flutes, 4);
    EXPECT_EQ(tools[0].youngs_modulus_GPa, 600);
    EXPECT_EQ(tools[1].type, ToolType::bull);
    EXPECT_NEAR(*tools[1].diameter_mm, 12.7, 1e-9);
    EXPECT_NEAR(*tools[1].corner_radius_mm, 1.5875, 1e-9);
    EXPECT_NEAR(*tools[1].overhang_mm, 50.8, 1e-9);
    EXPECT_EQ(tools[1].youngs_modulus_GPa, 210);
    EXPECT_EQ(tools[2].type, ToolType::drill);
    EXPECT_EQ(tools[2].doubt, "taps and reamers stand as drills: they make holes alone");
    EXPECT_FALSE(tools[3].number.has_value()) << "the ball has no number in the machine";
  }
}

TEST(ToolLibrary, SaysWhatIsWrongInTheXmlOfHsmWorks) {
  const tests::TempFolder folder;
  const auto said = [&](const std::string& text) {
    return message_of([&] { read(folder.write("a.hsmlib", text), false); }, folder);
  };
  EXPECT_EQ(said("<tool"),
            "a.hsmlib: error: this is not XML (Error parsing start element tag); a tool library of HSMWorks (XML with "
            "tool-library) was expected [tool-library]");
  EXPECT_EQ(said("<data/>"),
            "a.hsmlib: error: its root is <data>; a tool library of HSMWorks (XML with tool-library) was expected "
            "[tool-library]");
  EXPECT_EQ(said(hsm("<tool unit=\"feet\"/>")),
            "a.hsmlib: error: tool 1: unit=\"feet\"; millimeters or inches was expected [tool-library]");
  EXPECT_EQ(said(hsm("<tool unit=\"inches\"><nc number=\"1.5\"/></tool>")),
            "a.hsmlib: error: tool 1: nc number=\"1.5\"; a whole number was expected [tool-library]");
  EXPECT_EQ(said(hsm("<tool unit=\"inches\"><nc number=\"1\"/><body diameter=\"1/4\"/></tool>")),
            "a.hsmlib: error: tool 1: body diameter=\"1/4\"; a number was expected [tool-library]");
}

TEST(ToolLibrary, SaysWhatWasExpected) {
  const tests::TempFolder folder;
  const auto broken = folder.write("a.json", "{\"data\": [\n}"), other = folder.write("b.json", "[1]"),
             zip = folder.write("c.tools", "PK");
  EXPECT_EQ(
      message_of([&] { read(broken, false); }, folder),
      "a.json:2:1: error: this is not JSON; a tool library of Fusion (File, Export, JSON) was expected [tool-library]\n"
      "    }\n"
      "    ^");
  EXPECT_EQ(message_of([&] { read(other, false); }, folder),
            "b.json: error: has no list \"data\"; a tool library of Fusion (File, Export, JSON) was expected "
            "[tool-library]");
  EXPECT_EQ(message_of([&] { read(zip, false); }, folder),
            "c.tools: error: is not a zip file; one with a .json file in it was expected [tool-library]");
  EXPECT_NE(message_of([&] { read(folder / "none.json", false); }, folder).find("[file-missing]"), std::string::npos);
}

}  // namespace
}  // namespace camber::machine
