// Words, expressions, flow control, cycles and messages of Sinumerik programs.
#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/emit.h"
#include "nc/language.h"
#include "nc/mode_words.h"
#include "nc/siemens/siemens_words.h"
#include "test_paths.h"
#include "tests/nc/siemens_text.h"

namespace camber::nc {
namespace {

using Messages = std::vector<std::string>;

Vec3 last(const Read& r) { return r.moves.moves.empty() ? Vec3(Vec3::Constant(-999)) : r.moves.moves.back().end_mm; }

/// The value of an expression, by a move in X.
double value_of(const std::string& expression) {
  const Read r = read_siemens("DEF REAL VV\nVV=" + expression + "\nG0 X=VV\n");
  EXPECT_EQ(r.messages, Messages{}) << expression;
  return last(r).x();
}

TEST(Siemens, WordsWithoutBlanksInAnyCase) {
  const Read r = read_siemens("t1d1m6\ng0x10y-.5z+2\ng1 f100 X 12.5\n");
  EXPECT_EQ(r.messages, Messages{});
  expect_near_mm(last(r), {12.5, -0.5, 2});
  EXPECT_EQ(r.moves.states.back().tool, 1);
}

TEST(Siemens, DimensionsOfSingleWords) {
  const Read r = read_siemens("G0 X10 Y10 Z10\nX=IC(5) Y=AC(3)\nG91 X1 Y=AC(7) Z=IC(-2)\nG90 X=-2.5EX-1\n");
  EXPECT_EQ(r.messages, Messages{});
  expect_near_mm(r.moves.moves[1].end_mm, {15, 3, 10});
  expect_near_mm(r.moves.moves[2].end_mm, {16, 7, 8});
  expect_near_mm(last(r), {-0.25, 7, 8});
}

TEST(Siemens, ExpressionsFollowThePrioritiesOfTheManual) {
  EXPECT_DOUBLE_EQ(value_of("2+3*4"), 14);
  EXPECT_DOUBLE_EQ(value_of("-2*-3"), 6);
  EXPECT_DOUBLE_EQ(value_of("8/3"), 8.0 / 3);
  EXPECT_DOUBLE_EQ(value_of("7 DIV 2"), 3);
  EXPECT_DOUBLE_EQ(value_of("7 MOD 4"), 3);
  EXPECT_DOUBLE_EQ(value_of("-7 MOD 4"), -3);
  EXPECT_DOUBLE_EQ(value_of("12 B_AND 10"), 8);
  EXPECT_DOUBLE_EQ(value_of("12 B_XOR 10"), 6);
  EXPECT_DOUBLE_EQ(value_of("'H1F'+'B101'"), 36);
  EXPECT_DOUBLE_EQ(value_of("TRUNC(-2.7)"), -2);
  EXPECT_DOUBLE_EQ(value_of("ROUND(2.5)"), 3);
  EXPECT_DOUBLE_EQ(value_of("ROUNDUP(2.1)"), 3);
  EXPECT_DOUBLE_EQ(value_of("POT(3)+SQRT(16)"), 13);
  EXPECT_DOUBLE_EQ(value_of("SIN(30)"), std::sin(kPi / 6));
  EXPECT_DOUBLE_EQ(value_of("SIN(180)+COS(90)"), 0);
  EXPECT_DOUBLE_EQ(value_of("ATAN2(1,-1)"), 135);
  EXPECT_DOUBLE_EQ(value_of("BOUND(-1,1,5)+MINVAL(2,3)+MAXVAL(2,3)"), 6);
  EXPECT_DOUBLE_EQ(value_of("NUMBER(\"1\"<<2.5)"), 12.5);
  EXPECT_DOUBLE_EQ(value_of("STRLEN(\"A\"<<10)"), 3);
  EXPECT_DOUBLE_EQ(value_of("(0.1+0.2==0.3)*5"), 5);  // relative equality
  EXPECT_DOUBLE_EQ(value_of("(NOT 0)+(1 OR 0 AND 0)"), 2);
}

TEST(Siemens, VariablesArraysAndTheirRounding) {
  const Read r = read_siemens(
      "DEF INT NN=2.6, FELD[2,3]=SET(1,2,3,4,5,6)\nDEF STRING[20] NAME=\"A\"\nDEF BOOL "
      "BB\nR[NN]=FELD[1,2]\nBB=17\nNAME=NAME<<\"B\"\n"
      "G0 X=NN Y=R3+BB Z=STRLEN(NAME)\n");
  EXPECT_EQ(r.messages, Messages{});
  expect_near_mm(last(r), {3, 7, 2});
}

/// DEF INT I: the letter is a variable before = and in expressions, and the address before a number.
TEST(Siemens, VariablesOfOneLetter) {
  const Read r = read_siemens(
      "DEF INT I, K=2\nDEF REAL Q[3]\nG17 G0 X0 Y0 Z0 F100\nFOR I=0 TO 2\nQ[I]=I*K+1\nENDFOR\nI=I+K\nX=Q[1] Y=I\n"
      "G2 X13 Y=I I5 J0\nPART(4)\nM30\n%_N_PART_SPF\nPROC PART(REAL A)\nG0 Z=A\nM17\n");
  EXPECT_EQ(r.messages, Messages{});
  expect_near_mm(r.moves.moves.at(1).end_mm, {3, 5, 0});  // I is 3 behind the loop
  expect_near_mm(r.moves.arcs.at(0).center_mm, {8, 5, 0});
  expect_near_mm(last(r), {13, 5, 4});
}

TEST(Siemens, AxesOfTheMachineAtFixedPoints) {
  const Read r = read_siemens("G0 X1 Y2 Z3\nG75 FP=2 X1=0 Z1=0\nG74 Y1=0\n");
  EXPECT_EQ(r.messages, Messages{});
  ASSERT_EQ(r.moves.moves.size(), 3u);
  EXPECT_TRUE(r.moves.moves[1].reference);
  EXPECT_EQ(r.moves.moves[2].reference_axes, 2);
  EXPECT_EQ(
      read_siemens("G0 X1=5\n").messages,
      Messages{"p.mpf:1:4: error: X1=5: X1 is not an axis that Camber knows; X, Y, Z, A, B or C was expected [axis]"});
}

TEST(Siemens, JumpsGoToTheNearestLabelInTheirDirection) {
  const Read r = read_siemens(
      "R1=0\nMA: R1=R1+1\nIF R1==1 GOTOF MA IF R1==9 GOTOF ENDE\nGOTOF ENDE\nMA: R1=R1+10\nIF R1<30 GOTOB MA\nGOTOF "
      "N100\nG0 X1\nN100 G0 X=R1\nENDE:\nM30\nN100 G0 "
      "X99\n");
  expect_near_mm(last(r), {31, 0, 0});
}

TEST(Siemens, LoopsAndBranches) {
  const Read r = read_siemens(
      "DEF INT II\nR1=0\nFOR II=1 TO 3\nR1=R1+II\nENDFOR\nWHILE R1<10\nR1=R1+1\nENDWHILE\nREPEAT\nR1=R1+1\nUNTIL "
      "R1>=12\nLOOP\nR1=R1+1\nIF R1>14 GOTOF RAUS\nENDLOOP\n"
      "RAUS:\nIF R1==15\nG0 X=R1\nELSE\nG0 X99\nENDIF\nCASE(II) OF 1 GOTOF MA 4 GOTOF MB DEFAULT GOTOF MA\nMA: G0 "
      "Y99\nMB: G0 Z=II\n");
  EXPECT_EQ(r.messages, (Messages{}));
  expect_near_mm(last(r), {15, 0, 4});
}

TEST(Siemens, RepeatedParts) {
  const Read r = read_siemens(
      "G0 X0 Y0 Z0\nG91\nMA: X1\nREPEAT MA P=3\nMB: Y1\nMC: Y1\nZ1\nREPEAT MB MC P=2\nREPEATB MB\nG90\nM30\n");
  EXPECT_EQ(r.messages, Messages{});
  expect_near_mm(last(r), {4, 7, 1});
}

TEST(Siemens, SubprogramsWithParameters) {
  const Read r = read_siemens(
      "%_N_MAIN_MPF\n;$PATH=/_N_MPF_DIR\nDEF REAL AA[2], BB=3\nG0 X0 Y0 Z0\nUP(AA,BB,5)\nG0 X=AA[0] Y=AA[1] "
      "Z=BB\nL10(7) P2\nM30\n%_N_UP_SPF\n"
      "PROC UP(VAR REAL FF[2], VAR REAL BB, REAL CC, INT DD=4) SAVE DISPLOF\nG91\nFF[0]=CC+DD "
      "FF[1]=BB\nBB=BB*2\nRET\n%_N_L10_SPF\nPROC L10(REAL WW)\nG1 F100 X=IC(WW)\nM17\n");
  EXPECT_EQ(r.messages, Messages{});
  expect_near_mm(last(r), {23, 3, 6});
}

TEST(Siemens, ModalSubprogramRunsBehindEachMove) {
  const Read r = read_siemens(
      "G0 X0 Y0 Z5\nMCALL TIEF(2)\nX1\nX2\nMCALL\nX3\nM30\n%_N_TIEF_SPF\nPROC TIEF(REAL TT)\nG1 Z=-TT F100\nG0 "
      "Z5\nRET\n");
  EXPECT_EQ(r.messages, Messages{});
  EXPECT_EQ(r.moves.moves.size(), 8U);
  expect_near_mm(last(r), {3, 0, 5});
}

TEST(Siemens, FramesReplaceAddAndReset) {
  const Read r = read_siemens(
      "TRANS X10 Y20\nG0 X1 Y0 Z0\nAROT Z90\nX1 Y0\nASCALE X2 Y2\nX1 Y0\nMIRROR X0\nX1 Y2\nROT RPL=90\nX1 "
      "Y0\nTRANS\nX1 Y0\n");
  EXPECT_EQ(r.messages, Messages{});
  const auto ends = ends_of(r);
  expect_near_mm(ends[0], {11, 20, 0});
  expect_near_mm(ends[1], {10, 21, 0});
  expect_near_mm(ends[2], {10, 22, 0});
  expect_near_mm(ends[3], {-1, 2, 0});
  expect_near_mm(ends[4], {0, 1, 0});
  expect_near_mm(ends[5], {1, 0, 0});
}

TEST(Siemens, ShiftsOfSingleAxes) {
  const Read r = read_siemens(
      "G710\nT1 M6\nTRANS X5 Y5\nG58 X10\nG0 X0 Y0 Z0\nG59 X1 Y2\nG0 X0 Y0 Z0\nG58 Y0\nG0 X0 Y0 Z0\nATRANS X1\nG0 X0 "
      "Y0 "
      "Z0\nTRANS\nG0 X0 Y0 Z0\nM30\n");
  EXPECT_EQ(r.messages, Messages{});
  const Vec3 expected[] = {{10, 5, 0}, {11, 7, 0}, {11, 2, 0}, {12, 2, 0}, {0, 0, 0}};
  ASSERT_EQ(r.moves.moves.size(), std::size(expected));
  for (std::size_t i = 0; i < std::size(expected); ++i) expect_near_mm(r.moves.moves[i].end_mm, expected[i]);
  // Without coordinates, or with a move, a work offset.
  const Read offset = read_siemens("G710\nT1 M6\nG59\nG58 G0 X3 Y0 Z0\nM30\n");
  EXPECT_EQ(offset.messages, Messages{});
  EXPECT_EQ(offset.moves.states.back().work_offset, 58);
  expect_near_mm(last(offset), {3, 0, 0});
}

TEST(Siemens, PositioningAxesAreRapidsOfTheirOwn) {
  const Read r = read_siemens("G710\nT1 M6\nG1 X1 Y0 Z0 F100\nPOS[Z]=20 FA[Z]=900\nPOSA[X]=IC(4) POS[Y]=2\nX9\nM30\n");
  EXPECT_FALSE(r.diagnostics.has_errors()) << r.messages.front();
  ASSERT_EQ(r.moves.moves.size(), 4u);
  EXPECT_EQ(r.moves.moves[1].kind, MoveKind::rapid);
  EXPECT_FALSE(r.moves.moves[1].editable);
  expect_near_mm(r.moves.moves[1].end_mm, {1, 0, 20});
  expect_near_mm(r.moves.moves[2].end_mm, {5, 2, 20});
  EXPECT_EQ(r.moves.moves[3].kind, MoveKind::linear);
  EXPECT_EQ(
      read_siemens("G710\nT1 M6\nG0 X0 Y0 Z0\nG0 X5 POS[Z]=3\n").messages,
      Messages{"p.mpf:4:4: error: X beside POS or POSA, which moves another axis at the same time, is not supported; "
               "a block of its own was expected [not-supported]"});
}

TEST(Siemens, MacrosStandForTheirWords) {
  const Read r = read_siemens(
      "G710\nDEFINE UP AS G0 Z50 ; away\nDEFINE HOME_ALL AS UP X=R1*2\nDEFINE FEED_IN AS F=500\nT1 M6\nG0 X0 Y0 "
      "Z0\nFEED_IN\nN5 "
      "G1 X5\nN6 UP Y3\nR1=4\nHOME_ALL\nM30\n");
  EXPECT_EQ(r.messages, Messages{});
  ASSERT_EQ(r.moves.moves.size(), 4u);
  EXPECT_NEAR(mm_per_min_from_mm_per_s(r.moves.moves[1].feed_mm_per_s), 500, 1e-9);
  expect_near_mm(r.moves.moves[2].end_mm, {5, 3, 50});
  EXPECT_EQ(r.moves.moves[2].kind, MoveKind::rapid);
  EXPECT_FALSE(r.moves.moves[2].editable);
  expect_near_mm(r.moves.moves[3].end_mm, {8, 3, 50});
  EXPECT_EQ(read_siemens("DEFINE ROUND AS ROUND2\nDEFINE ROUND2 AS ROUND\nROUND\n").messages,
            Messages{"p.mpf:2:18: error: the macro ROUND leads to itself [macro]"});
}

TEST(Siemens, SubprogramsByTheirPath) {
  const Read r = read_siemens(
      "%_N_A_MPF\nG710\nT1 M6\nG0 X0 Y0 Z0\nPCALL /_N_WKS_DIR/_N_A_WPD/SUB(3)\nPCALL SUB(4)\nM30\n%_N_SUB_SPF\nPROC "
      "SUB(REAL TO)\nG0 X=TO\nRET\n");
  EXPECT_EQ(r.messages, Messages{});
  ASSERT_EQ(r.moves.moves.size(), 3u);
  EXPECT_EQ(r.moves.moves[1].end_mm.x(), 3);
  EXPECT_EQ(r.moves.moves[2].end_mm.x(), 4);
}

/// Every point of the face lies under a pass of its lowest cut.
void expect_faced(const std::string& cycle, const Vec2& low, const Vec2& high, const std::vector<double>& heights) {
  SCOPED_TRACE(cycle);
  constexpr double kRadius_mm = 10;
  InterpreterOptions options{.inch = false};
  for (int tool = 0; tool < 3; ++tool) options.tool_offsets[tool].radius_mm = kRadius_mm;
  const Read r = read_siemens("G710\nT1 M6\nS1000 M3\n" + cycle + "\nM30\n", options);
  ASSERT_FALSE(r.diagnostics.has_errors()) << r.messages.front();
  std::vector<double> found;
  std::vector<const Move*> passes;
  for (const Move& m : r.moves.moves) {
    if (m.kind != MoveKind::linear) continue;
    EXPECT_EQ(m.start_mm.z(), m.end_mm.z());
    if (found.empty() || std::abs(found.back() - m.end_mm.z()) > 1e-9) found.push_back(m.end_mm.z());
    if (std::abs(m.end_mm.z() - heights.back()) < 1e-9) passes.push_back(&m);
  }
  ASSERT_EQ(found.size(), heights.size());
  for (std::size_t i = 0; i < heights.size(); ++i) EXPECT_NEAR(found[i], heights[i], 1e-9);
  for (double x = low.x(); x <= high.x(); x += 2.5)
    for (double y = low.y(); y <= high.y(); y += 2.5)
      EXPECT_TRUE(std::ranges::any_of(passes,
                                      [&](const Move* m) {
                                        const Vec2 from = m->start_mm.head<2>(), way = Vec2(m->end_mm.head<2>()) - from,
                                                   at(x, y);
                                        const double t = std::clamp((at - from).dot(way) / way.squaredNorm(), 0.0, 1.0);
                                        return (from + t * way - at).norm() <= kRadius_mm + 1e-9;
                                      }))
          << x << " " << y;
  EXPECT_NEAR(r.moves.moves.back().end_mm.z(), 30, 1e-9);
}

TEST(Siemens, FacesAreCutWhole) {
  const Vec2 low(5, -10), high(85, 40);
  expect_faced("CYCLE61(30,2,1,-1,5,-10,80,50,1.5,15,0.2,900,31,0)", low, high, {0.5, -0.8});
  expect_faced("CYCLE61(30,2,1,3,5,-10,85,40,0,75,0,900,11,0,1,11011)", low, high, {-1});
  expect_faced("CYCLE61(30,2,1,-1,5,-10,80,50,1.5,20,0.2,900,42,0)", low, high, {-1});
  expect_faced("CYCLE71(30,2,1,-1,5,-10,80,50,0,2,15,5,0,900,21,5)", low, high, {0, -1});
  expect_faced("CYCLE71(30,2,1,-1,85,40,-80,-50,0,3,0,5,0.5,900,31,5)", low, high, {-0.5});
}

TEST(Siemens, FrameVariables) {
  const Read r = read_siemens("$P_PFRAME=CTRANS(X,10):CROT(Z,90)\nG0 X1 Y0 Z0\n$P_PFRAME=CMIRROR(Y)\nX1 Y1\n");
  EXPECT_EQ(r.messages, Messages{});
  expect_near_mm(r.moves.moves[0].end_mm, {10, 1, 0});
  expect_near_mm(last(r), {1, -1, 0});
}

TEST(Siemens, ArcsInAllTheirForms) {
  const char* const kForms[] = {
      "G3 X0 Y10 I-10 J0",         "G3 X0 Y10 CR=10", "G3 X0 Y10 I=AC(0) J=AC(0)",
      "G3 X0 Y10 AR=90",           "G3 I-10 AR=90",   "CIP X0 Y10 I1=10*COS(45) J1=10*SIN(45)",
      "G111 X0 Y0\nG3 AP=90 RP=10"};
  for (const char* form : kForms) {
    const Read r = read_siemens(std::string("G0 X10 Y0 Z0\nG1 F100\n") + form + "\n");
    EXPECT_EQ(r.messages, Messages{}) << form;
    ASSERT_EQ(r.moves.moves.back().kind, MoveKind::arc) << form;
    expect_near_mm(last(r), {0, 10, 0});
    expect_near_mm(r.moves.arcs.back().center_mm, {0, 0, 0});
    EXPECT_NEAR(r.moves.arcs.back().sweep_rad, kPi / 2, 1e-9) << form;
  }
}

TEST(Siemens, HelixWithTurns) {
  const Read r = read_siemens("G0 X10 Y0 Z0\nG2 X10 Y0 Z-6 I-10 J0 TURN=2 F100\n");
  EXPECT_EQ(r.messages, Messages{});
  EXPECT_NEAR(r.moves.arcs.back().sweep_rad, -6 * kPi, 1e-9);
}

TEST(Siemens, CornersAreRoundedAndChamfered) {
  Read r = read_siemens("G0 X0 Y0 Z0\nG1 X10 RND=2 F100\nY10 CHR=1\nX0 CHF=2\nY0\n");
  EXPECT_EQ(r.messages, Messages{});
  const auto ends = ends_of(r);
  ASSERT_EQ(ends.size(), 8U);
  expect_near_mm(ends[1], {8, 0, 0});
  expect_near_mm(ends[2], {10, 2, 0});
  expect_near_mm(ends[3], {10, 9, 0});
  expect_near_mm(ends[4], {9, 10, 0});
  expect_near_mm(ends[5], {std::sqrt(2), 10, 0});  // the chamfer is 2 mm long
  expect_near_mm(ends[6], {0, 10 - std::sqrt(2), 0});
  r = read_siemens("G0 X0 Y0 Z0\nRNDM=1\nG1 X10 F100\nY10\nRNDM=0\nX0\n");
  EXPECT_EQ(r.messages, Messages{});
  EXPECT_EQ(r.moves.arcs.size(), 2U);
}

TEST(Siemens, RadiusCompensationWithAllowance) {
  InterpreterOptions options{.inch = false};
  options.tool_offsets[1].radius_mm = 4;
  const Read r = read_siemens("T1 M6\nG0 X0 Y-20 Z0\nOFFN=1\nG1 G41 X0 Y0 F100\nX0 Y30\nG40 X-20 Y30\n", options);
  ASSERT_EQ(r.messages.size(), 1U);
  const auto ends = ends_of(r);
  expect_near_mm(ends[1], {-5, 0, 0});
  expect_near_mm(ends[2], {-5, 30, 0});
  expect_near_mm(ends[3], {-20, 30, 0});
}

TEST(Siemens, DrillingCycles) {
  const auto heights = [](const std::string& cycle) {
    const Read r = read_siemens("S1000 M3 F100\nG0 X0 Y0 Z20\n" + cycle + "\n");
    EXPECT_EQ(r.messages, Messages{}) << cycle;
    std::vector<double> out;
    for (std::size_t i = 1; i < r.moves.moves.size(); ++i)
      if (r.moves.moves[i].kind != MoveKind::dwell) out.push_back(r.moves.moves[i].end_mm.z());
    return out;
  };
  EXPECT_EQ(heights("CYCLE81(10,0,2,-5)"), (std::vector<double>{2, -5, 10}));
  EXPECT_EQ(heights("CYCLE82(10,0,2,,7,0.5)"), (std::vector<double>{2, -7, 10}));
  EXPECT_EQ(heights("CYCLE83(10,0,1,-12,,,5,1,,,1,1,,,,,0.5)"),
            (std::vector<double>{1, -5, 1, -4.5, -9, 1, -8.5, -12, 10}));
  EXPECT_EQ(heights("CYCLE83(10,0,1,-6,,,3,0,,,1,0,,,0.2)"), (std::vector<double>{1, -3, -2.8, -6, 10}));
  // Without a distance given, the tool stops ahead of the depth by a fiftieth of that of the hole, at most 7 mm.
  EXPECT_EQ(heights("CYCLE83(10,0,1,-200,,,150,100,,,1,1)"), (std::vector<double>{1, -150, 1, -146, -200, 10}));
  EXPECT_EQ(heights("CYCLE83(10,0,1,-400,,,300,100,,,1,1)"), (std::vector<double>{1, -300, 1, -293, -400, 10}));
  // A factor is at least 0.001, and a stroke that it gives at least MDEP.
  const auto shrinking = heights("CYCLE83(10,0,1,-100.15,,,100,-0.0005,,,1,0,,0.05,0.2)");
  const std::vector<double> expected{1, -100, -99.8, -100.1, -99.9, -100.15, 10};
  ASSERT_EQ(shrinking.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(shrinking[i], expected[i], 1e-9);
  EXPECT_EQ(heights("CYCLE84(10,0,2,-5,,,,,1.25,0,500)"), (std::vector<double>{2, -5, 2, 10}));
  EXPECT_EQ(heights("CYCLE85(10,0,2,-5,,0,80,160)"), (std::vector<double>{2, -5, 2, 10}));
  EXPECT_EQ(heights("CYCLE86(10,0,2,-5,,0,3,-1,0,1,0)"), (std::vector<double>{2, -5, -4, 2, 10}));
}

TEST(Siemens, OneValueFillsAnArray) {
  const Read r = read_siemens("DEF REAL A[3]\nA[0]=REP(4)\nG0 X=A[0] Y=A[2] Z0\nA[1]=SET(7)\nX=A[1] Y=A[2]\n");
  EXPECT_EQ(r.messages, Messages{});
  expect_near_mm(r.moves.moves.at(0).end_mm, {4, 4, 0});
  expect_near_mm(r.moves.moves.at(1).end_mm, {7, 4, 0});
}

TEST(Siemens, ReadsAWorkOffsetByItsNumberAndAxis) {
  const Read r = read_siemens("$P_UIFR[2]=CTRANS(X,10,Y,25)\nG500\nG0 X=$P_UIFR[2,Y,TR] Y=$P_UIFR[2,X,TR] Z0\n");
  EXPECT_EQ(r.messages, Messages{});
  expect_near_mm(r.moves.moves.at(0).end_mm, {25, 10, 0});
}

TEST(Siemens, PatternsOfHoles) {
  const Read r = read_siemens(
      "F100\nG0 X0 Y0 Z20\nMCALL CYCLE81(10,0,2,-5)\nHOLES1(10,0,0,0,10,3)\nHOLES2(0,0,20,0,90,4)\nMCALL\n");
  EXPECT_EQ(r.messages, Messages{});
  std::vector<Vec3> bottoms;
  for (const Move& m : r.moves.moves)
    if (m.end_mm.z() == -5) bottoms.push_back(m.end_mm);
  ASSERT_EQ(bottoms.size(), 7U);
  expect_near_mm(bottoms[2], {30, 0, -5});
  expect_near_mm(bottoms[4], {0, 20, -5});
}

TEST(Siemens, ModesOfTheControl) {
  const Read r =
      read_siemens("G0 X0 Y0 Z0\nCYCLE832(0.02,3,1)\nG64\nG1 X1 F100\nCYCLE832()\nX2\nG641 ADIS=0.1\nX3\nG60\nX4\n");
  EXPECT_EQ(r.messages, Messages{});
  const auto state = [&](std::size_t i) { return r.moves.state_of(r.moves.moves[i]); };
  EXPECT_EQ(state(1).contouring, Contouring::cycle832);
  EXPECT_DOUBLE_EQ(state(1).blend_tolerance_mm, 0.02);
  EXPECT_EQ(state(2).contouring, Contouring::none);
  EXPECT_DOUBLE_EQ(state(3).blend_tolerance_mm, 0.1);
  EXPECT_EQ(state(4).path_control, PathControl::exact_stop);
}

/// The words of a group replace each other; COMPOF and CYCLE832() end theirs.
TEST(Siemens, WordsOfTheDynamicsAreModal) {
  const Read r = read_siemens(
      "G0 X0 Y0 Z0\nSOFT FFWON COMPCAD DYNFINISH G642\nG1 X1 F100\nBRISK DYNROUGH COMPOF G64 G601\nX2\n"
      "CYCLE832(0.01,_FINISH,1)\nX3\nCYCLE832(0.1,_ROUGH,1)\nX4\nCYCLE832()\nX5\n");
  EXPECT_EQ(r.messages, Messages{});
  const auto words = [&](std::size_t i) {
    std::string out;
    for (std::size_t bit = 0; bit < kModeWords.size(); ++bit)
      if ((r.moves.state_of(r.moves.moves.at(i)).mode_words >> bit & 1) != 0)
        out += (out.empty() ? "" : " ") + std::string(kModeWords[bit].name);
    return out;
  };
  EXPECT_EQ(words(0), "");
  EXPECT_EQ(words(1), "dynfinish compcad soft ffwon g642");
  EXPECT_EQ(words(2), "dynrough brisk ffwon g601");
  EXPECT_EQ(words(3), "cycle832_finish dynrough brisk ffwon g601");
  EXPECT_EQ(words(4), "cycle832_rough dynrough brisk ffwon g601");
  EXPECT_EQ(words(5), words(2));
}

TEST(Siemens, ToleranceOfThePathByCtol) {
  const Read r = read_siemens(
      "G64\nG0 X0 Y0 Z0\nCYCLE832(0.01,_FINISH,1)\nG1 X1 F100\nCTOL=0.02\nX2\nCTOL=-1\nX3\n"
      "CYCLE832(0.05,2,1) \nX4\nCYCLE832()\nX5\nCOMPCAD CTOL=0.03\nX6\n");
  EXPECT_EQ(r.messages, Messages{});
  const auto state = [&](std::size_t i) { return r.moves.state_of(r.moves.moves[i]); };
  EXPECT_DOUBLE_EQ(state(1).blend_tolerance_mm, 0.01);
  EXPECT_DOUBLE_EQ(state(2).blend_tolerance_mm, 0.02);
  EXPECT_DOUBLE_EQ(state(3).blend_tolerance_mm, 0.01);
  EXPECT_DOUBLE_EQ(state(5).blend_tolerance_mm, -1);
  EXPECT_DOUBLE_EQ(state(6).blend_tolerance_mm, 0.03);
}

/// _Z_HOME and the like are variables of the machine's maker (GUD), which no program declares.
TEST(Siemens, MachineCoordinatesByAVariableOfTheMachinesMaker) {
  const Read r =
      read_siemens("G0 X1 Y2 Z3\nSUPA G0 Z=_Z_HOME D0\nG53 X=_X_HOME Y=_Y_HOME\nG0 X5 Y6 D1\nZ4\nG1 X7 F100\n");
  EXPECT_EQ(
      r.messages,
      (Messages{"p.mpf:2:9: warning: Z goes to _Z_HOME, a variable that the program does not declare; where it is "
                "afterwards is not known [machine-place]",
                "p.mpf:3:5: warning: X goes to _X_HOME, a variable that the program does not declare; where it is "
                "afterwards is not known [machine-place]",
                "p.mpf:3:15: warning: Y goes to _Y_HOME, a variable that the program does not declare; where it "
                "is afterwards is not known [machine-place]"}));
  expect_near_mm(r.moves.moves.back().start_mm, {5, 6, 4});
  EXPECT_FALSE(r.moves.moves.back().reference);
  EXPECT_EQ(read_siemens("G0 Z=_Z_HOME\n").messages,
            Messages{"p.mpf:1:6: error: _Z_HOME is not declared here; DEF was expected before [variable]"});
}

TEST(Siemens, ToolsByNameHaveNumbersOfTheirOwn) {
  const Read r = read_siemens("T=\"MILL\" M6\nG0 X0 Y0 Z0\nT1\nM6\nX1\nT=\"MILL\"\nM6\nX2\n");
  EXPECT_EQ(r.messages, Messages{});
  EXPECT_EQ(r.moves.state_of(r.moves.moves[0]).tool, 2);
  EXPECT_EQ(r.moves.state_of(r.moves.moves[1]).tool, 1);
  EXPECT_EQ(r.moves.tool_names.at(2), "MILL");
}

TEST(Siemens, StockOfWorkpiece) {
  const Read r = read_siemens("WORKPIECE(,\"\",,\"BOX\",112,0,-15,-15,-10,-40,80,50)\nG0 X0 Y0 Z5\n");
  ASSERT_TRUE(r.moves.stock);
  expect_near_mm(r.moves.stock->min_mm, {-10, -40, -15});
  expect_near_mm(r.moves.stock->max_mm, {80, 50, 0});
}

TEST(Siemens, WrongProgramsGetAMessageAtTheLine) {
  const auto said = [](const std::string& text) { return read_siemens(text).messages; };
  EXPECT_EQ(said("G0 X0 Y0 Z0\nTRAOOF\n"), (Messages{"p.mpf:2:1: error: no subprogram TRAOOF: neither %_N_TRAOOF_SPF "
                                                     "in this file nor TRAOOF.SPF beside it [subprogram]"}));
  EXPECT_EQ(said("PROC CONE(REAL LIFT, REAL STEP)\nONCE:\nG1 X=LIFT F100\nGOTOB ONCE\n"),
            (Messages{"p.mpf:1:16: error: the parameters of this subprogram are given by its call; the program that "
                      "calls it was expected [subprogram]"}));
  EXPECT_EQ(said("println(\"END\")\n"), (Messages{"p.mpf:1:1: error: no subprogram PRINTLN: neither %_N_PRINTLN_SPF in "
                                                  "this file nor PRINTLN.SPF beside it [subprogram]"}));
  EXPECT_EQ(said("G0 X10 Y0 Z0\nG3 X-10 Y0 I10 J0 F100\n"),
            (Messages{"p.mpf:2:1: error: the radius of the arc is 10.0000 mm at its start and 30.0000 mm at its end; a "
                      "difference below 0.05 mm was expected (with the signs of I, J, K turned "
                      "over it would fit: they lead from the start to the centre) [arc-radius]"}));
  EXPECT_EQ(said("G0 X0 Y0 Z0\nSLOT2(5,0,1)\n"),
            (Messages{"p.mpf:2:1: error: SLOT2 (open and circular slots) is not supported; what can stand in its "
                      "place: the moves themselves, G0 to G3, from the CAM system [not-supported]"}));
  EXPECT_EQ(said("E_HEAD(,,,1)\nF_DRILL(1)\n"),
            (Messages{"p.mpf:1:1: error: E_HEAD is a step of a ShopMill work plan, which is not supported; the program "
                      "in G code was expected (and 1 more like it) [not-supported]"}));
  EXPECT_EQ(
      said("G710 T1 D1\nM6\nG0 X0 Y0 Z0\nPOCKET3(5,0,1)\n"),
      (Messages{"p.mpf:4:1: error: POCKET3 needs the radius of tool 1, which nothing gives; the diameter of the cutter "
                "was expected in the job [radius-unknown]"}));
  EXPECT_EQ(said("GOTOF WEITER\n"),
            (Messages{"p.mpf:1:1: error: no label or block number WEITER in this program [jump]"}));
  EXPECT_EQ(said("IF R1==1\nG0 X1\n"), (Messages{"p.mpf:1:1: error: IF has no end; ENDIF was expected [statement]"}));
  EXPECT_EQ(said("G0 X=TIEFE\n"),
            (Messages{"p.mpf:1:6: error: TIEFE is not declared here; DEF was expected before [variable]"}));
  EXPECT_EQ(said("R1=$AA_IM[Z]\nG0 X=R1\n"), (Messages{"p.mpf:2:6: error: X depends on $AA_IM, which is not known "
                                                       "outside the machine; a value was expected [unknown-value]"}));
  EXPECT_EQ(
      said("G0 X10 Y\n"),
      (Messages{"p.mpf:1:8: error: Y has no number; a number, or = and an expression, was expected [no-number]"}));
  EXPECT_EQ(
      said("M5 G1234\n"),
      (Messages{"p.mpf:1:4: error: G1234 is not a G function of a Sinumerik program that Camber knows [unknown-g]"}));
  EXPECT_EQ(said("R1=1/0\n"), (Messages{"p.mpf:1:4: error: a division by zero [expression]"}));
  EXPECT_EQ(said("WHEN TRUE DO POS[X]=10\n"),
            (Messages{"p.mpf:1:1: error: a synchronized action that moves an axis is not supported; the moves as "
                      "blocks of their own were expected [not-supported]"}));
  EXPECT_EQ(
      said("SETAL(65000)\n"),
      (Messages{
          "p.mpf:1:1: error: the program reaches SETAL(65000), an alarm of its own, which stops the machine [alarm]"}));
}

TEST(Siemens, WrongBlocksGetOneMessage) {
  struct Row {
    const char *lines, *message;
  };
  const Row rows[] = {
      {"L1: G1 X1\n", "p.mpf:2:1: error: `L1` is no label; a name that begins with two letters was expected [label]"},
      {"G0 G1 X1\n", "p.mpf:2:4: error: G0 and G1 in one block; one of them was expected [modal-group]"},
      {"G90 G91\nG90\n", "p.mpf:2:5: error: G90 and G91 in one block; one of them was expected [modal-group]"},
      {"G4 F1 X5\n",
       "p.mpf:2:1: error: G4 with X, Y or Z, which it does not move; a block of its own was expected [dwell]"},
      {"G1 X10 RND=20\nY10\n",
       "p.mpf:2:8: warning: RND=20 is made smaller, since a block beside it is too short [corner-word]"},
  };
  for (const Row& row : rows) {
    const Read r = read_siemens("G0 X0 Y0 Z0 F100\n" + std::string(row.lines) + "G1 Z9\n");
    ASSERT_FALSE(r.messages.empty()) << row.lines;
    EXPECT_EQ(r.messages.back(), row.message);
    EXPECT_EQ(last(r).z(), 9) << row.lines;
  }
}

/// FB holds for its block, FRC for its corner; without FRC the corner has the feed of the block that leads away.
TEST(Siemens, ACuttingSpeedIsNoSpindleSpeed) {
  const Read r = read_siemens("G710 T1 D1\nM6\nG0 X0 Y0 Z0 S1200 M3\nG96 S180 LIMS=3000\nG97 S900\nG1 X10 F200 G94\n");
  EXPECT_EQ(
      r.messages,
      (std::vector<std::string>{
          "p.mpf:4:1: warning: under G96 S is a cutting speed, and the spindle speed follows the diameter turned; "
          "S is read without effect until G97 [spindle-speed]",
          "p.mpf:4:10: warning: LIMS (limit of the spindle speed) is read without effect [no-effect]"}));
  EXPECT_EQ(r.moves.state_of(r.moves.moves.back()).spindle_speed_rpm, 900);
  std::size_t of_180 = 0;
  for (const ModalState& s : r.moves.states) of_180 += s.spindle_speed_rpm == 180;
  EXPECT_EQ(of_180, 0u);
}

TEST(Siemens, FeedsOfBlocksAndCorners) {
  const Read r = read_siemens("G1 X0 Y0 Z0 F600\nX10 RND=1\nY10 F1200\nX0 FB=300 RND=1 FRC=60\nY0\nX10 RND=20\nY5\n");
  std::vector<double> feeds;
  for (const Move& m : r.moves.moves) feeds.push_back(std::round(m.feed_mm_per_s * 60e6) / 1e6);
  EXPECT_EQ(feeds, (std::vector<double>{600, 600, 1200, 1200, 300, 60, 1200, 1200, 1200, 1200}));
  const Arc& shrunk = r.moves.arcs.back();  // as large as the shorter block lets it be
  expect_near_mm(shrunk.center_mm, {5, 5, 0}, 1e-6);
}

/// D counts before G41 of its own block; the way in may be short.
TEST(Siemens, TheEdgeOfABlockWithG41AndAShortWayIn) {
  InterpreterOptions options{.inch = false};
  options.tool_offsets[1].radius_mm = 5;
  const std::string start = "T1 M6\nG0 X0 Y0 Z0\nG1 F100 ";
  const Read none = read_siemens(start + "G41 D0 X10\nY20\nG40 X0\n", options);
  EXPECT_EQ(none.messages, Messages{});
  expect_near_mm(none.moves.moves[1].end_mm, {10, 0, 0});
  const Read near = read_siemens(start + "G41 X3\nY20\nG40 X-20\n", options);
  EXPECT_EQ(near.messages.size(), 1u);  // [not-editable]
  expect_near_mm(near.moves.moves[1].end_mm, {-2, 0, 0});
}

/// CYCLE832 rounds corners, where G60 stood before; its names may be added up.
TEST(Siemens, Cycle832EndsExactStop) {
  const Read r = read_siemens(
      "G60 G0 X0 Y0 Z0\nG1 F100\nCYCLE832(0.05,_TOP_SURFACE_SMOOTH_ON+_ORI_FINISH,1)\nX1\nCYCLE832()\nX2\n"
      "CYCLE832(0.05,_FINISH,1)\nG60\nX3\n");
  EXPECT_EQ(r.messages, Messages{});
  std::vector<PathControl> found;
  for (const Move& m : r.moves.moves) found.push_back(r.moves.state_of(m).path_control);
  const auto stop = PathControl::exact_stop;
  EXPECT_EQ(found, (std::vector{stop, PathControl::blend, stop, stop}));
  EXPECT_EQ(r.moves.state_of(r.moves.moves[1]).blend_tolerance_mm, 0.05);
}

TEST(Siemens, AnEndlessLoopIsAnError) {
  InterpreterOptions options{.inch = false};
  options.max_repeated_blocks = 1000;
  for (const char* text : {"MA:\nGOTOB MA\n", "LOOP\nR1=R1+1\nENDLOOP\n", "MA: R1=1\nREPEAT MA P=9999\nGOTOB MA\n"}) {
    const Read r = read_siemens(text, options);
    ASSERT_EQ(r.messages.size(), 1U) << text;
    EXPECT_NE(r.messages[0].find("[endless]"), std::string::npos) << r.messages[0];
  }
}

TEST(Siemens, EditsKeepTheFormOfTheWords) {
  const std::string text =
      "%_N_P_MPF\n;$PATH=/_N_MPF_DIR\nN10 G0 X0 Y0 Z0\nN20 G1 X=10 Y5 F200 ; cut\nN30 X=IC(10)\nN40 G3 X30 Y15 "
      "CR=10\nN50 G2 X40 Y25 I=AC(40) J=AC(15)\nN60 G1 X=R1 Y=3\nN70 M30\n";
  const Read r = read_siemens(text);
  EXPECT_EQ(r.messages, Messages{});
  std::vector<MoveEdit> edits;
  for (std::uint32_t m = 1; m < 6; ++m) {
    MoveEdit edit{.move = m, .end_mm = r.moves.moves[m].end_mm + Vec3(0.1, 0.2, 0)};
    if (r.moves.moves[m].arc != Move::kNoArc)
      edit.center_mm = r.moves.arcs[r.moves.moves[m].arc].center_mm + Vec3(0.1, 0.2, 0);
    edits.push_back(edit);
  }
  edits[0].via = {{Vec3(5, 2.6, 0)}};
  const Emission out = emit_edits(r.program, r.moves, edits, {.header_comment = "changed"});
  EXPECT_EQ(out.text,
            "%_N_P_MPF\n;$PATH=/_N_MPF_DIR\n; changed\nN10 G0 X0 Y0 Z0\nN20 G1 X=5 Y2.6 F200 ; cut\nX10.1 Y5.2\nN30 "
            "X=IC(10)\nN40 G3 X30.1 Y15.2 CR=10\nN50 G2 X40.1 Y25.2 I=AC(40.1) "
            "J=AC(15.2)\nN60 G1 X=R1 Y=3\nN70 M30\n");
  ASSERT_EQ(out.not_made.size(), 1U);
  EXPECT_EQ(out.not_made[0].why, EmitGap::not_in_text);
}

TEST(Siemens, HolesStayWhereTheyAreBehindAnEdit) {
  const std::string text =
      "G0 X0 Y0 Z50\nG1 X5 Y5 F100\nMCALL CYCLE81(20,0,2,-5)\nX10\nX20 Y20\nMCALL\nG1 X30\nG0 Z50\nM30\n";
  const Read r = read_siemens(text);
  const MoveEdit edit{.move = 1, .end_mm = Vec3(5.1, 5.2, 50)};
  EXPECT_EQ(emit(r.program, r.moves, std::span(&edit, 1), {}),
            "G0 X0 Y0 Z50\nG1 X5.1 Y5.2 F100\nMCALL CYCLE81(20,0,2,-5)\nX10 Y5\nX20 Y20\nMCALL\nG1 X30\nG0 Z50\nM30\n");
}

TEST(Siemens, EveryWordStandsInThePage) {
  std::ifstream in(CAMBER_SOURCE_DIR "/docs/reference/siemens-words.md");
  std::set<std::string> documented, known;
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("| ") && !line.starts_with("| word ")) {
      std::istringstream words(line.substr(2, line.find(" |", 2) - 2));
      for (std::string word; words >> word;) documented.insert(word);
    }
  for (const siemens::WordRow& row : siemens::word_rows()) known.insert(std::string(row.name));
  EXPECT_EQ(documented, known);
}

TEST(Siemens, TheSpindleThatTurnsIsTheOneThatCuts) {
  const auto spindle = [](const std::string& lines) {
    const Read r = read_siemens("T1 M6\n" + lines + "\nG0 X0 Y0 Z5\nG1 X10 F100\nM30\n");
    EXPECT_EQ(r.messages, Messages{}) << lines;
    const ModalState& s = r.moves.state_of(r.moves.moves.back());
    return fmt::format("{} {}", static_cast<int>(s.spindle), s.spindle_speed_rpm);
  };
  const std::string clockwise = fmt::format("{} 2000", static_cast<int>(SpindleDirection::clockwise));
  EXPECT_EQ(spindle("S2000 M3"), clockwise);
  EXPECT_EQ(spindle("S1=2000 M1=3"), clockwise);
  EXPECT_EQ(spindle("S3=2000 M3=3"), clockwise);
  EXPECT_EQ(spindle("S3=2000\nM3=3"), clockwise);
  EXPECT_EQ(spindle("SETMS(3)\nS2000 M3"), clockwise);
  EXPECT_EQ(spindle("S2000 M13"), clockwise);
  EXPECT_EQ(spindle("S2000 M3\nM2=4"), clockwise);
}

TEST(Siemens, FunctionsOfTheMachinesMakerAreSaid) {
  EXPECT_EQ(read_siemens("T1 M6\nM333\nG0 X0 Y0 Z5\nM30\n").messages,
            Messages{"p.mpf:2:1: warning: M333 is a function of the machine's maker; what it moves is not known, and "
                     "it is passed over [machine-function]"});
}

TEST(Siemens, ALineOfKlartextDoesNotMakeAnotherLanguageOfAProgramNamedMpf) {
  const auto language = [](const std::string& name, const std::string& text) {
    return std::string(recognize_language(SourceText(name, text)).language->name);
  };
  EXPECT_EQ(language("p.mpf", "G17 G90\nG1 X10 F100\nCT X20 Y10\n"), "siemens");
  EXPECT_EQ(language("p.mpf", "BEGIN PGM A MM\nTOOL CALL 1 Z\nL X+5\n"), "heidenhain");
}

TEST(Siemens, CharactersAndNamesOfFiles) {
  EXPECT_EQ(value_of("'A'"), 65);
  EXPECT_EQ(read_siemens("EXTCALL \"PART.SPF\"\n").messages,
            Messages{"p.mpf:1:1: error: no subprogram PART: neither %_N_PART_SPF in this file nor PART.SPF beside it "
                     "[subprogram]"});
}

}  // namespace
}  // namespace camber::nc
