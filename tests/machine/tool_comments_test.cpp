// What CAM systems write of tools and blanks into the comments of a program.
#include <gtest/gtest.h>

#include "machine/program_comments.h"
#include "machine/tool_proposal.h"

namespace camber::machine {
namespace {

struct CommentCase {
  const char* program;
  bool inch;
  int number;
  std::optional<ToolType> type;
  std::optional<double> diameter_mm;
};

void expect_tool(const CommentCase& c) {
  const auto tools = tools_in_comments(SourceText("p.nc", c.program), c.inch);
  ASSERT_EQ(tools.size(), 1u) << c.program;
  EXPECT_EQ(tools[0].number, c.number) << c.program;
  EXPECT_EQ(tools[0].type, c.type) << c.program;
  ASSERT_EQ(tools[0].diameter_mm.has_value(), c.diameter_mm.has_value()) << c.program;
  if (c.diameter_mm) {
    EXPECT_NEAR(*tools[0].diameter_mm, *c.diameter_mm, 1e-9) << c.program;
  }
}

constexpr const char* kCut = "\nS1000 M3\nG0 X0 Y0\nG1 X9 F100\n";

TEST(ToolComments, OfEachCamSystem) {
  const std::optional<double> none;
  const CommentCase cases[] = {
      // FreeCAD: the record of its tool, of each shape.
      {"(@FC|TOOL|number=1|name=endmill 6x17|type=Endmill|diameter=6|shankdiameter=6|flutelength=17)\nT1 M6", false, 1,
       ToolType::flat, 6.0},
      {"(@FC|TOOL|number=2|type=Ballend|diameter=0.25 in)\nT2 M6", false, 2, ToolType::ball, 6.35},
      {"(@FC|TOOL|number=2|type=Bullnose|diameter=8|torusradius=1)\nT2 M6", false, 2, ToolType::bull, 8.0},
      {"(@FC|TOOL|number=3|type=Drill|diameter=5|tipangle=118)\nT3 M6", false, 3, ToolType::drill, 5.0},
      {"(@FC|TOOL|number=4|type=Vbit|diameter=12.7|cuttingedgeangle=60)\nT4 M6", false, 4, ToolType::chamfer, 12.7},
      // FreeCAD: labels after the change, or the change itself in a comment (grbl).
      {"M6 T2\nG43 H2\nM3 S10000\n(3.18mm_endmill001)\n(Compensated Tool Path. Diameter: 3.18)\nG0 X0 Y0", false, 2,
       ToolType::flat, 3.18},
      {"(TC: 12.7 V90deg Q009)\n(Begin toolchange)\n( M6 T13.0 )\nM3 S10000", false, 0, ToolType::chamfer, 12.7},
      {"(TC: 1/4\" Endmill)\n( M6 T4 )", false, 0, ToolType::flat, 6.35},
      // Vectric.
      {"(Tool=#51692 90 V GROOVE 1/4 DIAMETER 1/4 SHANK)\nT1 M6", false, 1, ToolType::chamfer, 6.35},
      {"(Tools used in this file: )\n(1 = End Mill {6 mm})\nT1 M6", false, 1, ToolType::flat, 6.0},
      {"(T2 = End Mill {0.5 inches})\nT2 M6", false, 2, ToolType::flat, 12.7},
      {"(2 = V-Bit {90 deg 32 mm})\nT2 M6", false, 2, ToolType::chamfer, 32.0},
      {"(201 = Ball Nose {3 mm})\nT201 M6", false, 201, ToolType::ball, 3.0},
      {" [TOOL LIST]\n [2 = downcut router .125 leather]\n T2 [ GET TOOL NUMBER 2 ]", true, 2, ToolType::flat, 3.175},
      // CutViewer, CamBam, Carbide Create: beside the change, above it, or after it.
      {"M05\n(TOOL/MILL,6.35, 0.00, 19.05, 0.00)\nM6T201", false, 201, ToolType::flat, 6.35},
      {"M6T202 (TOOL/MILL,6.35, 3.17, 19.05, 0.00)", false, 202, ToolType::ball, 6.35},
      {"( TOOL/MILL,16.0,0.0,0.0,0 )", false, 0, ToolType::flat, 16.0},
      {"(TOOL/MILL,0.03, 0.00, 10.00, 45.00)\nM6T301", false, 301, ToolType::chamfer, 20.03},
      {"(TOOL/DRILL,5,118,30)\nT9 M6", false, 9, ToolType::drill, 5.0},
      {"( T1 : 6.0 )\nT1 M6", false, 1, std::nullopt, 6.0},
      // Fusion, HSMWorks: a post that lists its only tool and writes no T.
      {"(T12  D=12 CR=0 - flat end mill)\nG21", false, 0, ToolType::flat, 12.0},
      {"(T5 D=10 CR=1 TAPER=0deg - ZMIN=-3 - bullnose end mill)\nN10 T5 M06", false, 5, ToolType::bull, 10.0},
      // Mastercam: the tool's number within the comment.
      {"( 1/16 FLAT ENDMILL TOOL - 1 DIA. OFF. - 1 LEN. - 1 DIA. - .0625)\nN60T1M6", true, 1, ToolType::flat,
       0.0625 * 25.4},
      {"( TOOL - 6 2\"  MITSUBISHI FACE MILL    DIA. OFF. - 6  LEN. - 6  DIA. - 2. )\nT6 M6", true, 6, ToolType::flat,
       50.8},
      // NX and shops' own habits.
      {"(TOOL NAME : MILL_D10R1)\nT3 M6", false, 3, ToolType::bull, 10.0},
      {"(ENTFRAESER_D8_N_90GRAD)\nT3 M6", false, 3, ToolType::chamfer, 8.0},
      {"T1 M6 (FREZA D10)", false, 1, ToolType::flat, 10.0},
      {"T4 M6 (KUGELFRAESER D6 R3)", false, 4, ToolType::ball, 6.0},
      {"(BALL R3)\nT7 M6 (BALL R3)", false, 7, ToolType::ball, 6.0},
      {"( Tool #6 \"Micro mill\" / Diameter 0.8 mm )\nT6 M6", false, 6, ToolType::flat, 0.8},
      {"; tool#=1 flute=6 len=20 unit=metric\nT1 M6", false, 1, std::nullopt, 6.0},
      {"(No. 1: end mill 3mm)\nM06 T1", false, 1, ToolType::flat, 3.0},
  };
  for (CommentCase c : cases) {
    const std::string program = std::string(c.program) + kCut;
    c.program = program.c_str();
    expect_tool(c);
  }
}

TEST(ToolComments, SayMoreThanTypeAndDiameter) {
  const auto only = [](const std::string& comment) {
    return tools_in_comments(SourceText("p.nc", "T1 M6 (" + comment + ")\nG1 X1\n"), false).at(0);
  };
  const ToolProposal freecad =
      only("@FC|TOOL|number=1|name=endmill 6x17|type=Endmill|diameter=6|shankdiameter=6|flutelength=17|length=50");
  EXPECT_EQ(freecad.flute_length_mm, 17);
  EXPECT_EQ(freecad.shank_diameter_mm, 6);
  EXPECT_EQ(freecad.from, "p.nc:1");
  const ToolProposal groove = only("Tool=#51692 90 V GROOVE 1/4 DIAMETER 1/4 SHANK");
  EXPECT_EQ(groove.point_angle_deg, 90);
  EXPECT_EQ(groove.shank_diameter_mm, 6.35);
  EXPECT_EQ(only("TOOL/MILL,6.35,0.5,19.05,0.00").corner_radius_mm, 0.5);
  EXPECT_EQ(only("TOOL/MILL,6.35,0.5,19.05,0.00").flute_length_mm, 19.05);
  EXPECT_EQ(only("60 DEG V-BIT 12 MM").point_angle_deg, 60);
  EXPECT_EQ(only("30DEG V-BIT 6 MM").point_angle_deg, 30);
  const ToolProposal shop = only("10MM 4FL CARBIDE ENDMILL STICKOUT 35 LOC 22");
  EXPECT_EQ(shop.diameter_mm, 10);
  EXPECT_EQ(shop.overhang_mm, 35);
  EXPECT_EQ(shop.flute_length_mm, 22);
  EXPECT_EQ(shop.flutes, 4);
  EXPECT_EQ(shop.youngs_modulus_GPa, 600);
}

TEST(ToolComments, SeveralToolsThatTheProgramNeverCallsAreADoubt) {
  const auto tools = tools_in_comments(
      SourceText("p.nc", "(T1 D=6. - FLAT END MILL)\n(T2 D=3. - BALL END MILL)\nG21 S1000 M3\nG1 X9 F100\n"), false);
  ASSERT_EQ(tools.size(), 1u);
  EXPECT_EQ(tools[0].number, 0);
  EXPECT_EQ(tools[0].diameter_mm, 6);
}

void expect_box(const char* program, bool inch, const Vec3& low, const Vec3& high) {
  const auto stock = stock_in_comments(SourceText("p.nc", program), inch);
  ASSERT_TRUE(stock && stock->box) << program;
  EXPECT_LT((stock->box->min_mm - low).norm(), 1e-9) << program << stock->box->min_mm.transpose();
  EXPECT_LT((stock->box->max_mm - high).norm(), 1e-9) << program << stock->box->max_mm.transpose();
}

TEST(StockComments, GiveABox) {
  expect_box("(STOCK/BLOCK,100.00, 80.00, 12.00,0.00, 0.00, 12.00)\n", false, {0, 0, -12}, {100, 80, 0});
  expect_box("(STOCK/BLOCK,100,80,12,50,40,0)\n", false, {-50, -40, 0}, {50, 40, 12});
  expect_box("(STOCK/BLOCK,4,2,.5,0,0,.5)\n", true, {0, 0, -12.7}, {101.6, 50.8, 0});
  expect_box("(stockMin:0.00mm, 0.00mm, -18.00mm)\n(stockMax:762.00mm, 600.00mm, 0.00mm)\n", true, {0, 0, -18},
             {762, 600, 0});
  expect_box("( Min Extents: X= -10.000, Y= -20.000, Z= -5.000)\n( Max Extents: X= 10.000, Y= 20.000, Z= 0.000)\n",
             false, {-10, -20, -5}, {10, 20, 0});
}

TEST(StockComments, GiveASizeAndWhereTheZeroIs) {
  const auto vectric = stock_in_comments(
      SourceText("p.nc",
                 "( Material Size)\n( X= 457.200, Y= 304.800, Z= 19.050)\n(XYZ Origin=Center - Material Surface)\n"),
      false);
  ASSERT_TRUE(vectric && vectric->size_mm);
  EXPECT_EQ(*vectric->size_mm, Vec3(457.2, 304.8, 19.05));
  EXPECT_EQ(vectric->zero_on_table, false);
  EXPECT_EQ(vectric->zero_in_centre, true);
  EXPECT_EQ(vectric->from, "p.nc:2");
  const auto camaster = stock_in_comments(
      SourceText("p.nc", " [MATERIAL size: 12.104\" x 12.588\" x 0.170\"]\n [Z Zero Position: Table Surface]\n"), true);
  ASSERT_TRUE(camaster && camaster->size_mm);
  EXPECT_NEAR(camaster->size_mm->x(), 12.104 * 25.4, 1e-9);
  EXPECT_NEAR(camaster->size_mm->z(), 0.170 * 25.4, 1e-9);
  EXPECT_EQ(camaster->zero_on_table, true);
  const auto shop = stock_in_comments(SourceText("p.nc", "(STOCK SIZE 100 X 50 X 20)\n"), false);
  ASSERT_TRUE(shop && shop->size_mm);
  EXPECT_EQ(*shop->size_mm, Vec3(100, 50, 20));
  EXPECT_FALSE(stock_in_comments(SourceText("p.nc", "(STOCK TO LEAVE 0.5)\n(MATERIAL ALUMINIUM)\n(T1 D=6.)\n"), false));
}

TEST(ToolComments, OfMessagesOfSinumerikPrograms) {
  expect_tool({"N30 T1 D1\nN40 MSG(\"FRAISE DIAMETRE 100\")\nN50 M6", false, 1, ToolType::flat, 100.0});
  expect_tool({"T4 D1\nM6\nMSG(\"FRESA DIAMETRO 16\")", false, 4, ToolType::flat, 16.0});
  expect_tool({"T2 D1\nMSG (\" END MILL D12 \")\nM6", false, 2, ToolType::flat, 12.0});
}

TEST(ToolComments, OfKlartextPrograms) {
  const std::string cut = "\n3 L X+0 Y+0 Z+0 FMAX\n4 L X+9 F100\n";
  const auto expect = [&](const std::string& lines, int number, std::optional<ToolType> type, double diameter_mm) {
    expect_tool({(lines + cut).c_str(), false, number, type, diameter_mm});
  };
  expect("1 ; T9938026 | FRA-SP0140 / DM=2 CR=1 TL=145\n2 TOOL CALL \"GB02\" Z S17950", 1, ToolType::ball, 2);
  expect("1 * - TOOL: T77 | FRA / DM=5.7 CR=0 TL=85\n2 TOOL CALL 12 Z S900", 12, ToolType::flat, 5.7);
  expect("1 ;(D=6.00 R=0.50 F=15.00 L=35.00)\nTOOL CALL  5 Z S4500", 5, ToolType::bull, 6);
  expect("1 ;  #11 D=12 - ZMIN=-22.5 - flat end mill\n2 TOOL CALL 11 Z S5000", 11, ToolType::flat, 12);
  expect("(     T01 TC1: KL+087.000 KR020.000 NZ06\nBEGIN PGM 1 MM\nN3 TOOL CALL 1 Z S1800", 1, std::nullopt, 40);
}

}  // namespace
}  // namespace camber::machine
