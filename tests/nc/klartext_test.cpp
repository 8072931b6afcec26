// Heidenhain Klartext, word by word.
#include <algorithm>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/emit.h"
#include "nc/language.h"
#include "nc/mode_words.h"
#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

using Messages = std::vector<std::string>;

Read read_lines(const std::string& lines, InterpreterOptions options = {}) {
  return read_text("0 BEGIN PGM P MM\n" + lines + "99 END PGM P MM\n", options, "p.h");
}

/// A tool, a feed and a place, on line 2.
std::string with_start(const std::string& lines) {
  return "1 TOOL CALL 1 Z S1000 F600\n2 L X+0 Y+0 Z+0 R0 FMAX M3\n" + lines;
}

/// End points of the moves behind the start.
std::string ends(const Read& r) {
  std::string out;
  for (std::size_t i = 1; i < r.moves.moves.size(); ++i) {
    const Vec3& p = r.moves.moves[i].end_mm;
    out += fmt::format("{}{:.6g} {:.6g} {:.6g}", out.empty() ? "" : "; ", p.x() + 0.0, p.y() + 0.0, p.z() + 0.0);
  }
  return out;
}

std::string path(const std::string& lines) {
  const Read r = read_lines(with_start(lines));
  EXPECT_EQ(r.messages, Messages{}) << lines;
  return ends(r);
}

Messages said(const std::string& lines) { return read_lines(with_start(lines)).messages; }

// --- the text -------------------------------------------------------------------------------------------------------

TEST(Klartext, IsKnownByItsWordsOrItsName) {
  const auto language = [](const std::string& name, const std::string& text) {
    const RecognizedLanguage found = recognize_language(SourceText(name, text));
    return fmt::format("{}: {}", found.language->name, found.reason);
  };
  EXPECT_EQ(language("p.nc", "0 BEGIN PGM P MM\n"), "heidenhain: BEGIN PGM in line 1");
  EXPECT_EQ(language("p.nc", "( set-up\n(\nN1 BLK FORM 0.1 Z X0\n"), "heidenhain: BLK FORM in line 3");
  EXPECT_EQ(language("p.nc", "L X+10 Y-3 R0 FMAX\n"), "heidenhain: L in line 1");
  EXPECT_EQ(language("p.nc", "FN 0: Q1=+5\n"), "heidenhain: FN in line 1");
  EXPECT_EQ(language("P.H", "X+10 R0 F100\n"), "heidenhain: the name ends in .h");
  EXPECT_EQ(language("p.nc", "(BEGIN PGM)\nG0 X1\nG1 Y2 F100\n"), "iso: no word of another language");
  EXPECT_EQ(language("p.nc", "O1 (CYCL DEF)\nN5 G0 X1 ; TOOL CALL 1\n"), "iso: no word of another language");
}

TEST(Klartext, BlockNumbersBlanksAndSignsAsPeopleWriteThem) {
  EXPECT_EQ(path("3 L X+1.5 Y-.5\n"), "1.5 -0.5 0");
  EXPECT_EQ(path("L X1,5 Y-2,25\n"), "1.5 -2.25 0");
  EXPECT_EQ(path("N3 L X-7. Z 25.000\n"), "-7 0 25");
  EXPECT_EQ(path("3 LX+5Y+6R0F100M8\n"), "5 6 0");
  EXPECT_EQ(path("3 l x+5 iy+2 f max\n"), "5 2 0");
  EXPECT_EQ(path("3 X+5 R0\n4 IY-2 R0\n"), "5 0 0; 5 -2 0");
  EXPECT_EQ(path("3 Q1 = - 7\n4 L X + Q1 Y-Q1 ; text\n5 L Z +Q1;text\n"), "-7 7 0; -7 7 -7");
  EXPECT_EQ(path("3 L X+1 ~\n  Y+2 ; a comment ~\n  Z+3\n"), "1 2 3");
  EXPECT_EQ(path("3 ; a comment that goes on~\nL X+9 is part of it\n4 * - structure\n5 ;; another\n6 L X+1\n"),
            "1 0 0");
}

TEST(Klartext, EncodingsAndTheEndOfAFile) {
  const Read bom = read_text(
      "\xEF\xBB\xBF"
      "0 BEGIN PGM P MM\r\n1 L X+1 Y+0 Z+0 FMAX ;\xFC\r\n2 END PGM P MM\r\n\x03",
      {}, "p.h");
  EXPECT_EQ(bom.messages, Messages{});
  EXPECT_EQ(bom.moves.moves.size(), 1u);
  const Read open = read_text("BEGIN PGM A MM\nL X+1 Y+0 Z+0 FMAX", {}, "p.h");
  EXPECT_EQ(open.messages, Messages{});
  EXPECT_EQ(open.moves.moves.size(), 1u);
}

TEST(Klartext, InchProgramsAndTheirFeeds) {
  const Read r = read_text(
      "0 BEGIN PGM P INCH\n1 TOOL CALL 1 Z S1000\n2 L X+1 Y+0 Z+0 FMAX\n3 L X+2 F10\n4 END PGM P INCH\n", {}, "p.h");
  EXPECT_EQ(r.messages, Messages{});
  EXPECT_NEAR(r.moves.moves[1].end_mm.x(), 2 * kMmPerInch, 1e-12);
  EXPECT_NEAR(r.moves.moves[1].feed_mm_per_s, 10 * kMmPerInch / 60, 1e-12);
}

TEST(Klartext, FeedsOfToolCallOfTheBlockAndRapidForOneBlock) {
  const Read r = read_lines(
      with_start("3 L X+1\n4 L X+2 F100\n5 L X+3 FMAX\n6 L X+4\n7 L X+5 FAUTO\n8 FN 0: Q2=+250\n9 L X+6 FQ2\n"
                 "10 L X+7 FU0.2\n"));
  EXPECT_EQ(r.messages, Messages{});
  std::vector<double> feeds;
  for (const Move& m : r.moves.moves) feeds.push_back(std::round(m.feed_mm_per_s * 60e6) / 1e6);
  EXPECT_EQ(feeds, (std::vector<double>{0, 600, 100, 0, 100, 600, 250, 200}));
}

// --- path -----------------------------------------------------------------------------------------------------------

TEST(Klartext, CirclesAboutTheirCentre) {
  EXPECT_EQ(path("3 CC X+10 Y+0\n4 C X+10 Y+10 DR-\n"), "10 10 0");
  EXPECT_EQ(path("3 CC IX+10 IY+0\n4 C X+20 DR-\n"), "20 0 0");
  const Read full = read_lines(with_start("3 CC X+10 Y+0\n4 C DR+\n"));
  EXPECT_NEAR(full.moves.arcs.at(0).sweep_rad, 2 * kPi, 1e-12);
  const Read yz = read_lines(with_start("3 CC Y+10 Z+0\n4 C Y+20 Z+0 DR+\n"));
  EXPECT_EQ(yz.messages, Messages{});
  expect_near_mm(yz.moves.arcs.at(0).normal, {1, 0, 0});
  EXPECT_NEAR(yz.moves.arcs.at(0).sweep_rad, kPi, 1e-12);
  const Read zx = read_lines(with_start("3 CC X+10 Z+0\n4 C X+20 Z+0 DR-\n"));
  expect_near_mm(zx.moves.arcs.at(0).normal, {0, 1, 0});
  EXPECT_NEAR(zx.moves.arcs.at(0).sweep_rad, -kPi, 1e-12);
}

TEST(Klartext, PolarLinesArcsAndHelices) {
  EXPECT_EQ(path("3 CC X+0 Y+0\n4 LP PR+10 PA+90\n5 LP IPA+90\n6 LP IPR+5 PA+0\n"), "0 10 0; -10 0 0; 15 0 0");
  EXPECT_EQ(path("3 CC X+10 Y+0\n4 CP PA+0 DR-\n5 CP IPA+90 Z-5 DR+\n"), "20 0 0; 10 10 -5");
  const Read helix = read_lines(with_start("3 CC X+10 Y+0\n4 CP IPA-900 IZ-2.5 DR-\n"));
  EXPECT_NEAR(helix.moves.arcs.at(0).sweep_rad, -5 * kPi, 1e-12);
  expect_near_mm(helix.moves.moves[1].end_mm, {20, 0, -2.5});
}

TEST(Klartext, TangentArcs) {
  const Read r = read_lines(with_start("3 L X+10\n4 CT X+20 Y+10\n5 CT X+20 Y+30\n"));
  EXPECT_EQ(r.messages, Messages{});
  expect_near_mm(r.moves.arcs.at(0).center_mm, {10, 10, 0});
  EXPECT_NEAR(r.moves.arcs.at(0).sweep_rad, kPi / 2, 1e-12);
  EXPECT_EQ(r.moves.moves[3].kind, MoveKind::linear);  // straight on
  const Read polar = read_lines(with_start("3 L X+10\n4 CC X+0 Y+0\n5 CTP PR+20 PA+90\n"));
  expect_near_mm(polar.moves.moves[2].end_mm, {0, 20, 0});
}

TEST(Klartext, RoundingsAndChamfers) {
  EXPECT_EQ(path("3 L X+10\n4 RND R2\n5 L Y+10\n"), "8 0 0; 10 2 0; 10 10 0");
  EXPECT_EQ(path("3 L X+10\n4 CHF 3\n5 L Y+10\n"), "7 0 0; 10 3 0; 10 10 0");
  const Read r = read_lines(with_start("3 L X+10\n4 RND R2 F50\n5 L Y+10\n"));
  EXPECT_NEAR(r.moves.moves[2].feed_mm_per_s * 60, 50, 1e-9);
  EXPECT_NEAR(r.moves.moves[3].feed_mm_per_s * 60, 600, 1e-9);
}

TEST(Klartext, WaysToAContourAndBack) {
  EXPECT_EQ(path("3 APPR LT X+20 Y+0 LEN5 R0\n4 L X+30\n5 DEP LT LEN4\n"), "15 0 0; 20 0 0; 30 0 0; 34 0 0");
  const auto way = [](const std::string& lines) {
    return ends(read_lines(with_start(lines)));
  };  // the radius is not known
  EXPECT_EQ(way("3 APPR LN X+20 Y+10 LEN5 RL\n4 L X+30\n5 DEP LN LEN4\n"), "20 15 0; 20 10 0; 30 10 0; 30 14 0");
  EXPECT_EQ(way("3 APPR CT X+20 Y+10 CCA180 R5 RR\n4 L X+30\n5 DEP CT CCA90 R3\n"), "20 0 0; 20 10 0; 30 10 0; 33 7 0");
  // Both ends of the arc are tangents: to the line from the start, and to the contour.
  const Read r = read_lines(with_start("3 APPR LCT X+20 Y+10 R5 RL\n4 L X+30\n"));
  const auto& moves = r.moves.moves;
  ASSERT_EQ(moves.size(), 4u);
  expect_near_mm(direction_at(r.moves, moves[1], 1), direction_at(r.moves, moves[2], 0));
  expect_near_mm(direction_at(r.moves, moves[2], 1), direction_at(r.moves, moves[3], 0));
  EXPECT_NEAR((r.moves.arcs.at(0).center_mm - Vec3(20, 15, 0)).norm(), 0, 1e-9);
}

/// To PH as the block before went, except with LCT; from there at the feed of the block.
TEST(Klartext, TheWayToPhGoesAsTheBlockBefore) {
  const auto speeds = [](const std::string& lines) {
    const Read r = read_lines(with_start(lines));
    EXPECT_EQ(r.messages, Messages{}) << lines;
    std::string out;
    for (std::size_t i = 1; i < r.moves.moves.size(); ++i) {
      const Move& move = r.moves.moves[i];
      out += (i > 1 ? " " : "") +
             (move.kind == MoveKind::rapid ? std::string("FMAX") : fmt::format("{:.6g}", move.feed_mm_per_s * 60));
    }
    return out;
  };
  EXPECT_EQ(speeds("3 APPR LT X+20 Y+0 LEN5 R0 F100\n4 L X+30\n"), "FMAX 100 100");
  EXPECT_EQ(speeds("3 L X+5 F400\n4 APPR LT X+20 Y+0 LEN5 R0 F100\n5 L X+30\n"), "400 400 100 100");
  EXPECT_EQ(speeds("3 APPR LCT X+20 Y+10 R5 R0 F100\n4 L X+30\n"), "100 100 100");
}

/// X of the move, behind lines of parameters.
TEST(Klartext, PartsAndPlacesOfTexts) {
  const auto x = [](const std::string& lines) { return path(lines + "9 L X+Q1 R0 F500\n"); };
  const std::string texts = "3 QS1 = \"PART 12.5\"\n4 QS2 = SUBSTR ( SRC_QS1 BEG5 LEN4 )\n";
  EXPECT_EQ(x(texts + "5 Q1 = TONUMB ( SRC_QS2 )\n"), "12.5 0 0");
  EXPECT_EQ(x(texts + "5 Q1 = INSTR ( SRC_QS1 SEA_QS2 BEG2 )\n"), "5 0 0");
  EXPECT_EQ(x(texts + "5 Q1 = INSTR ( SRC_QS2 SEA_QS1 BEG0 )\n"), "4 0 0");  // not in there: the whole length
  EXPECT_EQ(x(texts + "5 Q1 = STRCOMP ( SRC_QS1 SEA_QS2 )\n"), "1 0 0");
  EXPECT_EQ(x(texts + "5 Q1 = STRCOMP ( SRC_QS2 SEA_QS1 )\n"), "-1 0 0");
  EXPECT_EQ(x(texts + "5 QS3 = QS1\n6 Q1 = 3 + STRCOMP ( SRC_QS1 SEA_QS3 )\n"), "3 0 0");
}

TEST(Klartext, FunctionsOfAParameterWithoutABlank) {
  EXPECT_EQ(path("3 Q20 = 30\n4 Q1 = 10*SINQ20 + SQRTQ20 * SQRTQ20\n5 L X+Q1 R0 F500\n"), "35 0 0");
  EXPECT_EQ(path("3 QL2 = 9\n4 Q1 = SQRTQL2 - SQ QL2 + SQQL2\n5 L X+Q1 R0 F500\n"), "3 0 0");
}

/// The tool stays upright: nothing turns, and nothing is said.
TEST(Klartext, UprightToolsAndPlanesTurnNothing) {
  EXPECT_EQ(said("3 PLANE SPATIAL SPA+0 SPB+0 SPC+0 STAY\n4 L A+Q120 C+Q122 R0 FMAX\n5 LN X+1 TX0 TY0 TZ1\n"),
            Messages{});
}

TEST(Klartext, ConditionsOfTextsAndOfWhatIsDefined) {
  const auto jumps = [](const std::string& condition) {
    const std::string way =
        path("3 QS1 = \"ABC\"\n4 Q5 = 1\n5 " + condition + " GOTO LBL 1\n6 L X+5 R0 F500\n7 LBL 1\n8 L Y+7 R0 F500\n");
    return way == "0 7 0";
  };
  EXPECT_TRUE(jumps("FN 9: IF QS1 EQU \"ABC\""));
  EXPECT_FALSE(jumps("FN 9: IF QS1 EQU \"ABD\""));
  EXPECT_TRUE(jumps("FN 10: IF QS1 NE \"ABD\""));
  EXPECT_TRUE(jumps("FN 12: IF QS1 LT \"ABD\""));
  EXPECT_TRUE(jumps("FN 9: IF Q5 IS DEFINED"));
  EXPECT_FALSE(jumps("FN 9: IF Q6 IS DEFINED"));
  EXPECT_TRUE(jumps("FN 9: IF Q6 IS UNDEFINED"));
  EXPECT_FALSE(jumps("FN 9: IF QS1 IS UNDEFINED"));
}

TEST(Klartext, ARepetitionOfALabelBehindItIsSaid) {
  EXPECT_EQ(
      said("3 CALL LBL 1 REP 2\n4 L X+5 R0\n5 LBL 1\n6 L X+7 R0\n"),
      Messages{"p.h:4:3: warning: LBL 1 stands behind its CALL LBL REP: the program goes on there, and the blocks "
               "between are left out; a label before it, or CALL LBL without REP, was expected [label]"});
}

TEST(Klartext, TheHscModeOfCycle32AndM120AreModes) {
  const Read r = read_lines(with_start(
      "3 CYCL DEF 32.0 TOLERANCE\n4 CYCL DEF 32.1 T0.03\n5 CYCL DEF 32.2 HSC-MODE:1 TA0.5\n6 L X+1 M120 LA10\n"
      "7 CYCL DEF 32.0 TOLERANCE\n8 CYCL DEF 32.1 T0.01\n9 CYCL DEF 32.2 HSC-MODE:0\n10 L X+2 M120 LA0\n"
      "11 CYCL DEF 32.0 TOLERANCE\n12 CYCL DEF 32.1\n13 L X+3\n"));
  EXPECT_EQ(r.messages, Messages{});
  const auto words = [&](std::size_t i) { return r.moves.state_of(r.moves.moves.at(i)).mode_words; };
  EXPECT_EQ(words(1), mode_word_bit("cycle32_rough") | mode_word_bit("m120"));
  EXPECT_EQ(words(2), mode_word_bit("cycle32_finish"));
  EXPECT_EQ(words(3), 0U);
}

TEST(Klartext, RadiusCompensationWithARadiusOfTheProgram) {
  const Read r = read_lines(
      "1 TOOL DEF 1 L+0 R+2\n2 TOOL CALL 1 Z S1000 F600\n3 L X-10 Y-10 Z+0 R0 FMAX M3\n4 L X+0 Y+0 RL\n"
      "5 L Y+20\n6 L X+20\n7 L Y-10 R0\n");
  EXPECT_EQ(r.messages.size(), 1u);
  expect_near_mm(r.moves.moves[1].end_mm, {-2, 0, 0});
  expect_near_mm(r.moves.moves[2].end_mm, {-2, 20, 0});
  EXPECT_EQ(r.moves.moves[3].kind, MoveKind::arc);  // about the corner
  EXPECT_FALSE(r.moves.moves[2].editable);
}

TEST(Klartext, MachineCoordinatesAndTheEndOfTheTravel) {
  const Read r =
      read_lines(with_start("3 L Z+0 FMAX M91\n4 L X+1 Z+5 FMAX\n5 L M140 MB MAX\n6 L Z+5 FMAX\n7 M140 MB10\n"));
  EXPECT_EQ(r.messages, Messages{});
  const auto& moves = r.moves.moves;
  ASSERT_EQ(moves.size(), 6u);
  for (const std::size_t i : {2u, 4u}) EXPECT_TRUE(moves[i].reference) << i;
  EXPECT_FALSE(moves[5].reference);
  EXPECT_NEAR(moves[5].end_mm.z(), 15, 1e-12);
}

TEST(Klartext, AKnownDatumTellsNoHeightOfMachineCoordinates) {
  InterpreterOptions options;
  options.work_offsets_mm[54] = {100, 50, -300};
  const Read r = read_lines(with_start("3 L X+90 FMAX M91\n4 L Z-1 FMAX M91\n"), options);
  const auto& moves = r.moves.moves;
  ASSERT_EQ(moves.size(), 3u);
  EXPECT_FALSE(moves[1].reference);
  EXPECT_NEAR(moves[1].end_mm.x(), -10, 1e-12);
  EXPECT_TRUE(moves[2].reference);  // the height needs the tool's length
}

// --- flow -----------------------------------------------------------------------------------------------------------

TEST(Klartext, LabelsRepeatsAndSubprograms) {
  EXPECT_EQ(path("3 LBL 1\n4 L IX+1\n5 CALL LBL 1 REP2\n"), "1 0 0; 2 0 0; 3 0 0");
  EXPECT_EQ(path("3 LBL 1\n4 L IX+1\n5 CALL LBL 1 REP 1/1\n6 CALL LBL \"UP\"\n7 CALL LBL \"UP\"\n8 M30\n9 LBL "
                 "\"UP\"\n10 L IZ+1\n11 LBL 0\n"),
            "1 0 0; 2 0 0; 2 0 1; 2 0 2");
  EXPECT_EQ(path("3 FN 0: Q5=+2\n4 LBL 1\n5 L IX+1\n6 CALL LBL 1 REPQ5\n"), "1 0 0; 2 0 0; 3 0 0");
  // A repeat within a repeat counts anew each time.
  EXPECT_EQ(path("3 LBL 1\n4 LBL 2\n5 L IX+1\n6 CALL LBL 2 REP1\n7 L IY+1\n8 CALL LBL 1 REP1\n"),
            "1 0 0; 2 0 0; 2 1 0; 3 1 0; 4 1 0; 4 2 0");
}

TEST(Klartext, JumpsAndFormulas) {
  EXPECT_EQ(path("3 Q1 = 3\n4 LBL 1\n5 L IX+Q1\n6 Q1 = Q1 - 1\n7 FN 11: IF +Q1 GT +0 GOTO LBL 1\n"),
            "3 0 0; 5 0 0; 6 0 0");
  EXPECT_EQ(path("3 Q1 = SQRT 16 + 2 * ( 3 - 1 ) ^ 2\n4 Q2 = SIN 30 + COS ( 60 )\n5 Q3 = INT ( 7.9 ) % 4\n6 L X+Q1 "
                 "Y+Q2 Z+Q3\n"),
            "12 1 3");
}

TEST(Klartext, Functions) {
  EXPECT_EQ(path("3 FN 0:Q1=25\n4 FN1: Q2 = +Q1 + +5\n5 FN 4: Q3 = +Q2 DIV +4\n6 L X+Q1 Y+Q2 Z+Q3\n"), "25 30 7.5");
  EXPECT_EQ(path("3 FN 8: Q1 = +3 LEN +4\n4 FN 13: Q2 = +1 ANG -1\n5 FN 5: Q3 = SQRT +9\n6 L X+Q1 Y+Q2 Z+Q3\n"),
            "5 135 3");
  EXPECT_EQ(path("3 FN 9: IF +1 EQU +1 GOTO LBL \"A\"\n4 L X+9\n5 LBL \"A\"\n6 L X+1\n"), "1 0 0");
}

// --- frames ---------------------------------------------------------------------------------------------------------

TEST(Klartext, FramesOfCycles) {
  EXPECT_EQ(path("3 CYCL DEF 7.0 DATUM SHIFT\n4 CYCL DEF 7.1 X+10\n5 CYCL DEF 7.2 IY+5\n6 L X+1 Y+1\n7 CYCL DEF 7.0\n8 "
                 "CYCL DEF 7.1 X+0\n"
                 "9 CYCL DEF 7.2 Y+0\n10 L X+1 Y+1\n"),
            "11 6 0; 1 1 0");
  EXPECT_EQ(path("3 CYCL DEF 10.0 ROTATION\n4 CYCL DEF 10.1 ROT+90\n5 L X+10\n6 CYCL DEF 10.0\n7 CYCL DEF 10.1 "
                 "IROT+90\n8 L X+10\n"),
            "0 10 0; -10 10 0");
  EXPECT_EQ(path("3 CYCL DEF 8.0 MIRROR\n4 CYCL DEF 8.1 X Y\n5 L X+10 Y+5\n"), "-10 -5 0");
  EXPECT_EQ(path("3 CYCL DEF 11.0 SCALING\n4 CYCL DEF 11.1 SCL 0.5\n5 L X+10 Y+5\n"), "5 2.5 0");
  EXPECT_EQ(path("3 CYCL DEF 26.0 AXIS-SPEC. SCALING\n4 CYCL DEF 26.1 X 2 CCX+5 CCY+0\n5 L X+10 Y+5\n"), "15 5 0");
  EXPECT_EQ(path("3 TRANS DATUM AXIS X+10 Y+2\n4 L X+1 Y+1\n5 TRANS DATUM RESET\n6 L X+1 Y+1\n"), "11 3 0; 1 1 0");
}

TEST(Klartext, ATiltedPlaneIsReadAsItIsProgrammedWithoutKinematics) {
  const Read r = read_lines(
      with_start("3 PLANE SPATIAL SPA+0 SPB+90 SPC+0 STAY SEQ+ TABLE ROT\n4 L X+1 Y+2 Z+3\n5 PLANE RESET STAY\n"));
  EXPECT_EQ(
      r.messages,
      Messages{"p.h:4:3: warning: a tilted plane is read as it is programmed, with the side of the part up that it "
               "machines: where it lies takes a machine file with [kinematics] [tilted-plane]"});
  EXPECT_EQ(ends(r), "1 2 3");
}

TEST(Klartext, TheBlankIsPlacedInTheOnePlaneThatIsCut) {
  const auto stock = [](const std::string& more) {
    return read_text(
               "0 BEGIN PGM P MM\n1 BLK FORM 0.1 Z X-50 Y-40 Z-30\n2 BLK FORM 0.2 X+50 Y+40 Z+0\n3 TOOL CALL 1 Z S100 "
               "F100\n"
               "4 CYCL DEF 7.0\n5 CYCL DEF 7.1 X+50\n6 PLANE SPATIAL SPA+90 SPB+0 SPC+90 STAY\n7 L X+0 Y+0 Z+1 FMAX\n8 "
               "L Z-1\n" +
                   more,
               {}, "p.h")
        .moves;
  };
  const Interpretation one = stock({});
  ASSERT_TRUE(one.stock);
  expect_near_mm(one.stock->min_mm, {-40, -30, -100});
  expect_near_mm(one.stock->max_mm, {40, 0, 0});
  EXPECT_TRUE(one.moves[0].reference);  // from numbers of another plane
  EXPECT_FALSE(one.moves[1].reference);
  EXPECT_FALSE(stock("9 PLANE RESET STAY\n10 L X+1 Y+1 Z+1 FMAX\n11 L Z-1\n").stock);
}

TEST(Klartext, PlanesOnAMachineWithRotaryAxes) {
  InterpreterOptions options;
  options.rotary_axes = {{.letter = 'B'}, {.letter = 'C'}};
  options.work_offsets_mm[54] = Vec3::Zero();
  options.tool_offsets[1].length_mm = 100;
  const auto end = [&](const std::string& plane) {
    const Read r = read_lines(with_start("3 " + plane + "\n4 L X+1 Y+2 Z+3 R0 FMAX\n"), options);
    EXPECT_EQ(r.messages, Messages{}) << plane;
    const Vec3 p = r.moves.moves.back().end_mm;
    return fmt::format("{:.6g} {:.6g} {:.6g}", p.x() + 0.0, p.y() + 0.0, p.z() + 0.0);
  };
  EXPECT_EQ(end("PLANE SPATIAL SPA+90 SPB+0 SPC+90 TURN FMAX"), "3 1 2");
  EXPECT_EQ(end("PLANE VECTOR BX0 BY1 BZ0 NX1 NY0 NZ0 STAY"), "3 1 2");
  EXPECT_EQ(end("PLANE EULER EULPR+90 EULNU+90 EULROT+0 STAY"), "3 1 2");
  EXPECT_EQ(end("PLANE POINTS P1X+0 P1Y+0 P1Z+0 P2X+0 P2Y+1 P2Z+0 P3X+0 P3Y+0 P3Z+1 STAY"), "3 1 2");
}

TEST(Klartext, TheToleranceOfCycle32IsTheControlsMode) {
  const Read r = read_lines(
      with_start("3 CYCL DEF 32.0 TOLERANCE\n4 CYCL DEF 32.1 T0.03\n5 CYCL DEF 32.2 HSC-MODE:1 TA0.5\n6 L X+1\n"
                 "7 CYCL DEF 32.0 TOLERANCE\n8 CYCL DEF 32.1\n9 L X+2\n"));
  EXPECT_EQ(r.messages, Messages{});
  const ModalState& on = r.moves.state_of(r.moves.moves[1]);
  EXPECT_EQ(on.contouring, Contouring::cycle32);
  EXPECT_EQ(on.blend_tolerance_mm, 0.03);
  EXPECT_EQ(r.moves.state_of(r.moves.moves[2]).contouring, Contouring::none);
}

TEST(Klartext, ABlankMayStandBetweenFAndItsWord) {
  EXPECT_EQ(said("3 TOOL CALL 1 Z S1000 F300\n4 L X+0 Y+0 Z+50 F MAX\n5 L Z-1 F AUTO\n6 CYCL DEF 200 NAME ~\nQ200=2 ~\n"
                 "Q201=-5 ~\nQ206=100 ~\nQ202=5 ~\nQ203=0\n7 CYCL CALL POS X1. Y2. Z0. F MAX M3\n"
                 "8 PATTERN DEF POS1 (X+1 Y+1 Z+0)\n9 CYCL CALL PAT F MAX M3\n"),
            Messages{});
  const Read r = read_lines(with_start("3 TOOL CALL 1 Z S1000 F300\n4 L X+0 Y+0 Z+50 FMAX\n5 L Z-1 F AUTO\n"));
  EXPECT_NEAR(r.moves.moves.back().feed_mm_per_s, 5, 1e-12);
}

/// From a machine coordinate a cycle goes to its clearance height, which is absolute: its holes are where they are.
TEST(Klartext, ACycleFromTheMachinesZDrillsItsHole) {
  const Read r = read_lines(
      with_start("3 L Z-1 R0 FMAX M91\n4 CYCL DEF 200 NAME ~\nQ200=2 ~\nQ201=-5 ~\nQ206=100 ~\nQ202=5 ~\nQ203=0 ~\n"
                 "Q204=50\n5 L X+10 Y+20 R0 FMAX M99\n"));
  EXPECT_EQ(r.messages, Messages{});
  ASSERT_GE(r.moves.moves.size(), 3U);
  const Move& hole = r.moves.moves[r.moves.moves.size() - 3];
  EXPECT_EQ(hole.kind, MoveKind::linear);
  EXPECT_FALSE(hole.reference);
  expect_near_mm(hole.start_mm, {10, 20, 2});
  expect_near_mm(hole.end_mm, {10, 20, -5});
  expect_near_mm(r.moves.moves.back().end_mm, {10, 20, 50});
}

// --- cycles ---------------------------------------------------------------------------------------------------------

std::string cycle(const std::string& q, const std::string& call) {
  std::string lines = "3 L Z+50 FMAX\n4 CYCL DEF " + q.substr(0, q.find(' ')) + " NAME ~\n";
  std::string rest = q.substr(q.find(' ') + 1);
  for (std::size_t at = 0; at < rest.size();) {
    const std::size_t end = std::min(rest.find(' ', at), rest.size());
    lines += "   " + rest.substr(at, end - at) + " ;TEXT" + (end < rest.size() ? " ~\n" : "\n");
    at = end + 1;
  }
  return path(lines + call);
}

TEST(Klartext, DrillingCycles) {
  const std::string place = "5 L X+5 Y+6 FMAX M99\n";
  EXPECT_EQ(cycle("200 Q200=2 Q201=-10 Q206=100 Q202=10 Q210=0 Q203=+1 Q204=20 Q211=0", place),
            "0 0 50; 5 6 50; 5 6 3; 5 6 -9; 5 6 3; 5 6 21");
  EXPECT_EQ(cycle("200 Q200=2 Q201=-10 Q206=100 Q202=5 Q210=0 Q203=+0 Q204=2 Q211=0.5", place),
            "0 0 50; 5 6 50; 5 6 2; 5 6 -5; 5 6 2; 5 6 -3; 5 6 -10; 5 6 -10; 5 6 2");
  EXPECT_EQ(
      cycle("203 Q200=2 Q201=-9 Q206=100 Q202=5 Q210=0 Q203=+0 Q204=2 Q212=1 Q213=3 Q205=1 Q211=0 Q208=0 Q256=0.5",
            place),
      "0 0 50; 5 6 50; 5 6 2; 5 6 -5; 5 6 -4.5; 5 6 -9; 5 6 2");
  EXPECT_EQ(cycle("207 Q200=2 Q201=-9 Q239=1 Q203=+0 Q204=2", place), "0 0 50; 5 6 50; 5 6 2; 5 6 -9; 5 6 2");
  EXPECT_EQ(cycle("200 Q200=2 Q201=-3 Q206=100 Q202=5 Q210=0 Q203=+0 Q204=2 Q211=0",
                  "5 CYCL DEF 220 CIRCLE ~\n Q216=0 ~\n Q217=0 ~\n Q244=20 ~\n Q245=0 ~\n Q246=360 ~\n Q247=0 ~\n "
                  "Q241=2 ~\n Q200=2 ~\n"
                  " Q203=0 ~\n Q204=5 ~\n Q301=1 ~\n Q365=0\n"),
            "0 0 50; 10 0 50; 10 0 2; 10 0 -3; 10 0 2; 10 0 5; -10 0 5; -10 0 2; -10 0 -3; -10 0 2; -10 0 5");
}

TEST(Klartext, OldCyclesCountFromWhereTheToolStands) {
  EXPECT_EQ(
      path(
          "3 L Z+2 FMAX\n4 CYCL DEF 1.0 PECKING\n5 CYCL DEF 1.1 DIST2\n6 CYCL DEF 1.2 DEPTH-5\n7 CYCL DEF 1.3 PLNGNG5\n"
          "8 CYCL DEF 1.4 DWELL0\n9 CYCL DEF 1.5 F100\n10 L X+5 FMAX M99\n"),
      "0 0 2; 5 0 2; 5 0 -5; 5 0 2");
}

TEST(Klartext, BoreMillingNeedsTheRadiusOfTheTool) {
  const std::string lines =
      "3 L X+5 Y+5 Z+50 FMAX\n4 CYCL DEF 208 BORE ~\nQ200=1 ~\nQ201=-2 ~\nQ206=100 ~\nQ334=1 ~\nQ203=0 ~\nQ204=10 "
      "~\nQ335=10 ~\nQ342=0 "
      "~\nQ351=1\n5 L X+5 Y+5 FMAX M99\n";
  InterpreterOptions options;
  options.tool_offsets[1].radius_mm = 3;
  const Read r = read_lines(with_start(lines), options);
  EXPECT_EQ(r.messages, Messages{});
  ASSERT_EQ(r.moves.arcs.size(), 2u);
  EXPECT_NEAR(r.moves.arcs[0].sweep_rad, 3 * 2 * kPi, 1e-9);  // from 1 above to 2 below, 1 mm a turn
  EXPECT_EQ(read_lines(with_start(lines)).messages.size(), 1u);
}

TEST(Klartext, PatternsOfPlaces) {
  EXPECT_EQ(cycle("200 Q200=2 Q201=-3 Q206=100 Q202=5 Q210=0 Q203=+0 Q204=2 Q211=0",
                  "5 PATTERN DEF POS1 (X+1 Y+2 Z+0) POS2 (X+3 Y+4 Z+0)\n6 CYCL CALL PAT FMAX M3\n"),
            "0 0 50; 1 2 50; 1 2 2; 1 2 -3; 1 2 2; 3 4 2; 3 4 -3; 3 4 2");
}

/// Ways in which people write words, and where the tool goes by them.
TEST(Klartext, WordsAsPeopleWriteThem) {
  struct Row {
    const char *lines, *ends;
  };
  const std::string old_pocket =
      "L Z+2 FMAX\nTOOL DEF 1 L+0 R+5\nCYCL DEF 4.0 POCKET\nCYCL DEF 4.1 SET UP 2\nCYCL DEF 4.2 DEPTH -4\nCYCL DEF 4.3 "
      "PECKG 4 F80\nCYCL DEF 4.4 X20\nCYCL DEF 4.5 Y12\nCYCL DEF 4.6 F100 DR+\nCYCL CALL\n";
  const Row rows[] = {
      // A ~ too many before a statement.
      {"CYCL DEF 7.0 SHIFT ~\nCYCL DEF 7.1 X+10 ~\nL X+1\n", "11 0 0"},
      {"Q1 = 4 ; text ~\nL X+Q1 ; text ~\nL X+5 ~\nY+2\n", "4 0 0; 5 2 0"},
      {"CYCL DEF 240 C Q200=2 Q343=0 Q201=-1 Q206=90 Q203=0 ~\nQ204=2 ~\nL X+5 FMAX M99\n",
       "5 0 0; 5 0 2; 5 0 -1; 5 0 2"},
      {"Q 2=7\nL X+Q 2\n", "7 0 0"},
      {"DECLARE STRING QS1 = \"ABC\"\nQ1 = STRLEN ( SRC_QS1 )\nL X+Q1\n", "3 0 0"},
      {"QS1 = SYSSTR ( ID10 NR1 )\nQ1 = CFGREAD ( KEY_QS1 TAG_QS1 )\nL X+1\n", "1 0 0"},
      {"FUNCTION DWELL TIME1\nFUNCTION MODE MILL\nL X+1\n", "0 0 0; 1 0 0"},
      {"CC X+10 Y+0\nCP IPA+0 DR+ IZ-5\n", "0 0 -5"},
      {"CYCL DEF 240 C Q200=2 Q343=0 Q201=-1 Q206=90 Q203=0 Q204=2\nCYCL CALL POS IX+3 Y+4 Z+2 FMAX\n",
       "0 0 2; 3 4 2; 3 4 -1; 3 4 2"},
      // The tool comes from the right of the contour: R0 says nothing.
      {"L X-20 Y-20\nAPPR LCT X+0 Y+0 R5 R0\nCR X+10 Y+0 R+5 DR-\n", "-20 -20 0; -1.68082 -3.73939 0; 0 0 0; 10 0 0"},
      {"CYCL DEF 1.0 PECKING\nCYCL DEF 1.1 SET UP 2\nCYCL DEF 1.2 DEPTH -50\nCYCL DEF 1.3 PECKG 30\nCYCL DEF 1.4 DWELL "
       "0\n"
       "CYCL DEF 1.5 F100\nCYCL CALL\n",
       "0 0 -32; 0 0 0; 0 0 -31; 0 0 -52; 0 0 0"},
      {old_pocket.c_str(),
       "0 0 2; 0 0 -4; -4 0 -4; 4 0 -4; 5 0 -4; 5 1 -4; -5 1 -4; -5 -1 -4; 5 -1 -4; 5 0 -4; 0 0 -4; 0 0 2"},
      {"PLANE POINTS P1X+0 P1Y+0 P1Z+0 P2X+1 P2Y+0 P2Z+0 P3X+0 P3Y+1 P3Z+0 STAY\nL X+1\n", "1 0 0"},
  };
  for (const Row& row : rows) EXPECT_EQ(path(row.lines), row.ends) << row.lines;
  const Read two =
      read_text("BEGIN PGM A MM\nL X+1 Y+0 Z+0 FMAX\nEND PGM A MM\nBEGIN PGM B MM\nEND PGM B MM\n", {}, "p.h");
  EXPECT_EQ(two.moves.moves.size(), 1u);
  EXPECT_EQ(two.messages.size(), 1u);
}

TEST(Klartext, TheRetractionOfM140GoesAtItsFeed) {
  const Read r = read_lines(with_start("3 L M140 MB 50 F300\n4 L M140 MB5\n"));
  EXPECT_EQ(r.messages, Messages{});
  ASSERT_EQ(r.moves.moves.size(), 3u);
  EXPECT_EQ(r.moves.moves[1].kind, MoveKind::linear);
  EXPECT_DOUBLE_EQ(r.moves.moves[1].feed_mm_per_s, 5);
  EXPECT_EQ(r.moves.moves[2].kind, MoveKind::rapid);
}

TEST(Klartext, ACuttingSpeedIsTurnedIntoASpeed) {
  const Read r =
      read_lines("1 TOOL DEF 1 L+0 R+5\n2 TOOL CALL 1 Z S( VC = 100 )\n3 L X+0 FMAX\n4 TOOL CALL 1 Z S VC:50\n");
  EXPECT_EQ(r.messages, Messages{});
  EXPECT_NEAR(r.moves.states.front().spindle_speed_rpm, 100e3 / (10 * kPi), 1e-9);
}

/// With MOVE the tip keeps its place on the part; M130 leaves the plane for its block.
TEST(Klartext, PlanesThatMoveAndM130) {
  InterpreterOptions options;
  options.rotary_axes = {{.letter = 'A'}, {.letter = 'C'}};
  const Read r = read_lines(with_start("3 PLANE SPATIAL SPA+90 SPB+0 SPC+0 MOVE DIST50 FMAX\n4 L X+1 Y+2 Z+3 M130\n"
                                       "5 L X+1 Y+2 Z+3\n"),
                            options);
  EXPECT_EQ(r.messages, Messages{});
  ASSERT_EQ(r.moves.moves.size(), 4u);
  EXPECT_EQ(r.moves.moves[1].open_axes, 0);
  EXPECT_EQ(r.moves.state_of(r.moves.moves[1]).tip_control, TipControl::angles);
  expect_near_mm(r.moves.moves[2].end_mm, {1, 2, 3});
  expect_near_mm(r.moves.moves[3].end_mm, {1, -3, 2});
}

// --- wrong programs ------------------------------------------------------------------------------------------------

TEST(Klartext, WrongProgramsByTheirMessages) {
  const auto one = [](const std::string& line) {
    const Messages all = said("3 " + line + "\n");
    return all.empty() ? std::string() : all.front();
  };
  EXPECT_EQ(one("L X+"), "p.h:4:5: error: X has no number; a number or a Q parameter was expected [no-number]");
  EXPECT_EQ(one("L X+5 FOO"), "p.h:4:9: error: F has no number; a number or a Q parameter was expected [no-number]");
  EXPECT_EQ(
      one("L X+5 K3"),
      "p.h:4:9: error: K3 is no word of a Klartext block; coordinates, R0, F, DR or M were expected [not-a-word]");
  EXPECT_EQ(one("LINE X+5"),
            "p.h:4:3: error: LINE begins no Klartext block that is known; L, C, TOOL CALL, CYCL DEF ... were expected "
            "[not-a-word]");
  EXPECT_EQ(
      one("TCH PROBE 400"),
      "p.h:4:3: error: TCH PROBE (a probing cycle) is not supported; leave out probing, or set the datum that it would "
      "set (CYCL DEF 247) [not-supported]");
  EXPECT_EQ(one("FL X+5"),
            "p.h:4:3: error: FL (free contour programming) is not supported; L, C and CR blocks with end points were "
            "expected "
            "[not-supported]");
  EXPECT_EQ(one("CYCL DEF 254 CIRCULAR SLOT"),
            "p.h:4:3: error: CYCL DEF 254 (a slot or stud) is not supported; the finished path was expected "
            "[not-supported]");
  EXPECT_EQ(one("C X+5 DR+"), "p.h:4:3: error: C without a circle centre; CC was expected before [pole]");
  EXPECT_EQ(one("CR X+10 Y+0 R+3 DR+"),
            "p.h:4:3: error: the end of the arc is 10.0000 mm from its start; with R 3.0000 mm at most 6.0000 mm can "
            "be reached [arc]");
  EXPECT_EQ(one("CALL LBL 7"), "p.h:4:3: error: LBL 7 is not in the program [label]");
  EXPECT_EQ(one("L X+Q7"),
            "p.h:4:6: error: Q7 has no value here; FN 0 or Q7 = was expected before [undefined-parameter]");
  EXPECT_EQ(one("Q1 = 1 / 0"), "p.h:4:10: error: a division by zero [expression]");
  EXPECT_EQ(one("Q1 = FOO 3"),
            "p.h:4:8: error: FOO is no function of a formula; SQ, SQRT, SIN, COS, TAN, ASIN, ACOS, ATAN, LN, LOG, EXP, "
            "NEG, ABS, INT, FRAC or SGN was expected [expression]");
  EXPECT_EQ(one("CALL PGM TNC:\\NONE"),
            "p.h:4:3: warning: CALL PGM TNC:\\NONE: there is no none.h beside the program; what it does is not "
            "known, and it is passed over [program-missing]");
  EXPECT_EQ(one("FN 14: ERROR = 1000"),
            "p.h:4:3: error: the program ends here with error 1000 (FN 14); conditions that do not lead here were "
            "expected [program-error]");
  EXPECT_EQ(one("L X+5 M117\n4 L X+6 M55"),
            "p.h:5:9: warning: M55 is a function of the machine's maker; what it moves is not known, and it is passed "
            "over [machine-function]");
  EXPECT_EQ(
      one("L Z-5 RND R2"),
      "p.h:4:9: error: RND is no word of a Klartext block; coordinates, R0, F, DR or M were expected [not-a-word]");
}

/// One message each, and the block behind is still read.
TEST(Klartext, WrongWordsGetOneMessage) {
  struct Row {
    const char *lines, *message;
  };
  const Row rows[] = {
      {"CYC DEF 200\n",
       "p.h:4:1: error: CYC begins no Klartext block that is known; L, C, TOOL CALL, CYCL DEF ... were "
       "expected [not-a-word]"},
      {"LBL FOO\n",
       "p.h:4:1: error: LBL without a number or a name in quotes; LBL 1 or LBL \"NAME\" was expected [label]"},
      {"Q1 = 5 / 0\n", "p.h:4:8: error: a division by zero [expression]"},
      {"FN 4: Q1 = +5 DIV +0\n", "p.h:4:14: error: a division by zero [expression]"},
      {"CYCL DEF 240 C Q200=2 Q201:-1\nL X+2 M99\n",
       "p.h:4:23: error: Q201:-1 in CYCL DEF 240; Q parameters were expected [not-a-word]"},
      {"PLANE SPATIAL SPX+1 STAY\n", "p.h:4:15: error: SPX+1 in PLANE SPATIAL is not understood [plane]"},
      {"CC X+10 Y+0\nCP IPA+90 DR-\n",
       "p.h:5:1: warning: IPA and DR have different signs; the arc is read with the size of IPA in the sense of DR; "
       "the "
       "same sign was expected [arc-sense]"},
      {"FPOL X+0 Y+0\nFL X+1\nFC DR+ R10\n",
       "p.h:4:1: error: FPOL (free contour programming) is not supported; L, C and CR blocks with end points were "
       "expected "
       "(and 2 more like it) [not-supported]"},
      {"FN 23: Q1 = CDATA Q30\n",
       "p.h:4:1: error: FN 23 and FN 24 (circles through points) are not supported; the centre "
       "was expected in Q parameters [not-supported]"},
      {"FUNCTION RESET FEED DWELL\n", "p.h:4:1: warning: FUNCTION RESET is read without effect [no-effect]"},
  };
  for (const Row& row : rows) {
    const Read r = read_lines(with_start(std::string(row.lines) + "L Z+9\n"));
    EXPECT_EQ(r.messages, Messages{row.message}) << row.lines;
    EXPECT_EQ(r.moves.moves.back().end_mm.z(), 9) << row.lines;
  }
  EXPECT_EQ(said("APPR LN X+20 Y+0 LEN5 R0\nL X+30\n"),
            Messages{"p.h:4:1: warning: APPR LN or CT without RL or RR is read as with RR, as an iTNC 530 goes; later "
                     "controls stop here; RL or RR was expected [approach]"});
}

TEST(Klartext, CentresWithTheWrongSignAreNoticed) {
  EXPECT_EQ(said("3 CC X-10 Y+0\n4 C X+20 Y+0 DR+\n"),
            Messages{"p.h:5:3: error: the radius of the arc is 10.0000 mm at its start and 30.0000 mm at its end; a "
                     "difference below 0.05 mm "
                     "was expected [arc-radius]"});
}

TEST(Klartext, ACircleFromItsOwnCentreIsSaid) {
  EXPECT_EQ(said("3 CC X+0 Y+0\n4 C X+0 Y+0 DR+\n"),
            Messages{"p.h:5:3: warning: a circle from its own centre is no circle; a start beside CC was expected "
                     "[arc-radius]"});
}

TEST(Klartext, AValueOfTheMachineIsRefusedWhereAMoveDependsOnIt) {
  EXPECT_EQ(said("3 FN 18: SYSREAD Q1 = ID270 NR1 IDX1\n4 Q2 = Q1 + 5\n5 L X+1\n"), Messages{});
  EXPECT_EQ(said("3 FN18: SYSREAD Q1 = ID270 NR1 IDX1\n4 Q2 = Q1 + 5\n5 L X+Q2\n"),
            Messages{"p.h:6:5: error: this depends on a parameter whose value is not known: Q1 is read from the "
                     "control (FN 18) in line 4 "
                     "[unknown-parameter]"});
}

TEST(Klartext, EndlessLoopsEnd) {
  InterpreterOptions options;
  options.max_repeated_blocks = 1000;
  EXPECT_EQ(
      read_lines(with_start("3 LBL 1\n4 FN 9: IF +0 EQU +0 GOTO LBL 1\n"), options).messages.front(),
      "p.h:4:3: error: loops and subprograms have run 1000 blocks again; the program seems to have no end [endless]");
}

// --- tools and the blank --------------------------------------------------------------------------------------------

TEST(Klartext, ToolsByNumberByNameAndParts) {
  const Read r = read_text(
      "0 BEGIN PGM P MM\n1 BLK FORM 0.1 Z X-10 Y-20 Z-30\n2 BLK FORM 0.2 X+10 Y+20 IZ+30\n3 TOOL CALL \"BALL 6\" Z "
      "S100\n"
      "4 L X+0 Y+0 Z+0 FMAX\n5 TOOL CALL 2 Z S200 DL+0.1 DR-0.05\n6 TOOL CALL S300\n7 TOOL CALL Z S400\n8 TOOL CALL "
      "\"BALL 6\"\n"
      "9 L X+1 FMAX\n10 END PGM P MM\n",
      {}, "p.h");
  EXPECT_EQ(r.messages, Messages{});
  EXPECT_EQ(r.moves.tool_names, (std::map<int, std::string>{{1, "BALL 6"}}));
  EXPECT_EQ(r.moves.state_of(r.moves.moves.back()).tool, 1);
  EXPECT_EQ(r.moves.state_of(r.moves.moves.back()).spindle_speed_rpm, 400);
  ASSERT_TRUE(r.moves.stock);
  expect_near_mm(r.moves.stock->min_mm, {-10, -20, -30});
  expect_near_mm(r.moves.stock->max_mm, {10, 20, 0});
}

// --- emission -------------------------------------------------------------------------------------------------------

std::string edited(const std::string& lines, const std::vector<MoveEdit>& edits) {
  const Read r = read_lines(with_start(lines));
  const std::string text = emit(r.program, r.moves, edits, {.decimals_mm = 3});
  const Read again = read_text(text, {}, "p.h");
  EXPECT_FALSE(again.diagnostics.has_errors()) << text;
  const std::size_t begin = text.find("\n3 ") + 1;
  return text.substr(begin, text.find("99 END") - begin);
}

TEST(KlartextEmission, KeepsNumberLayoutAndSigns) {
  EXPECT_EQ(edited("3 L  X+10.000  Y-5  R0 F500 M8 ; text\n", {{.move = 1, .end_mm = Vec3(10.5, 5, 0)}}),
            "3 L  X+10.500  Y+5.000  R0 F500 M8 ; text\n");
  EXPECT_EQ(edited("3 L X+10\n4 L Y+5\n", {{.move = 1, .end_mm = Vec3(10, 0.25, 0)}}), "3 L X+10 Y+0.25\n4 L Y+5\n");
  EXPECT_EQ(edited("3 L X+10\n4 L X+20 Y+5\n", {{.move = 1, .feed_mm_per_s = 5}}),
            "3 L X+10 F300\n4 L X+20 Y+5 F600\n");
  EXPECT_EQ(edited("3 L IX+10\n4 L IX+10\n", {{.move = 1, .end_mm = Vec3(10.5, 0, 0)}}), "3 L IX+10.5\n4 L IX+9.5\n");
}

TEST(KlartextEmission, DecimalCommasStay) {
  EXPECT_EQ(edited("3 L X10,5 Y3,25\n4 L X1,5 Y2,5\n", {{.move = 1, .end_mm = Vec3(10.75, 3, 1.5)}}),
            "3 L X10,75 Y3 Z1,5\n4 L X1,5 Y2,5 Z0\n");
}

TEST(KlartextEmission, PiecesAreNumberedOn) {
  EXPECT_EQ(edited("3 L X+10 F500 M5\n4 L X+20\n", {{.move = 1, .via = {{.point_mm = Vec3(4, 0.5, 0)}}}}),
            "3 L X+4 Y+0.5 F500\n4 L X+10 Y+0 M5\n4 L X+20\n");
}

TEST(KlartextEmission, ACircleGetsACentreOfItsOwn) {
  EXPECT_EQ(edited("3 CC X+10 Y+0\n4 C X+20 Y+0 DR-\n5 C X+0 Y+0 DR-\n",
                   {{.move = 1, .end_mm = Vec3(20.2, 0, 0), .center_mm = Vec3(10.1, 0, 0)},
                    {.move = 2, .end_mm = Vec3(0, 0, 0), .center_mm = Vec3(10.1, 0, 0)}}),
            "3 CC X+10 Y+0\n4 CC X+10.1 Y+0\n4 C X+20.2 Y+0 DR-\n5 CC X+10.1 Y+0\n5 C X+0 Y+0 DR-\n");
}

TEST(KlartextEmission, ARadiusStaysARadius) {
  EXPECT_EQ(
      edited("3 CR X+20 Y+0 R+12 DR-\n", {{.move = 1, .end_mm = Vec3(20.2, 0, 0), .center_mm = Vec3(10.1, -6.6, 0)}})
          .find("3 CR X+20.2 Y+0 R+12."),
      0u);
}

TEST(Klartext, WordsThatABlockDoesNotHaveAreErrors) {
  const auto one = [](const std::string& line) {
    const Messages all = said(line + "\n");
    return all.empty() ? std::string() : all.front();
  };
  EXPECT_EQ(one("L PR+10 PA+30"), "p.h:4:3: error: PR has no meaning in a block that begins with L [not-a-word]");
  EXPECT_EQ(one("L X+10 R+5"), "p.h:4:8: error: R has no meaning in a block that begins with L [not-a-word]");
  EXPECT_EQ(one("L X+10 DR+"), "p.h:4:8: error: DR has no meaning in a block that begins with L [not-a-word]");
  EXPECT_EQ(one("L X+10 LEN15"), "p.h:4:8: error: LEN has no meaning in a block that begins with L [not-a-word]");
  EXPECT_EQ(one("L X+10 NX+0"), "p.h:4:8: error: NX has no meaning in a block that begins with L [not-a-word]");
  EXPECT_EQ(one("L X+10 TZ+1"), "p.h:4:8: error: TZ has no meaning in a block that begins with L [not-a-word]");
  EXPECT_EQ(one("CC X+0 Y+0 F100"), "p.h:4:12: error: F has no meaning in a block that begins with CC [not-a-word]");
  EXPECT_EQ(one("CR X+5 Y+5 R+9 PR+3 DR+"),
            "p.h:4:16: error: PR has no meaning in a block that begins with CR [not-a-word]");
  EXPECT_EQ(one("L X+10 F100 F200"), "p.h:4:13: error: F stands twice in the block; once was expected [repeated-word]");
  EXPECT_EQ(one("CYCL DEF 200 Q200=2 XX=3"),
            "p.h:4:21: error: XX=3 in CYCL DEF 200; Q parameters were expected [not-a-word]");
  EXPECT_EQ(one("CYCL DEF 32.1 TOLERANCE"),
            "p.h:4:16: error: CYCL DEF 32.1 without a number; T0.02 or nothing was expected [tolerance]");
  EXPECT_EQ(one("CYCL DEF 32.2 HSCMODE 1"),
            "p.h:4:15: error: HSCMODE in CYCL DEF 32.2; HSC-MODE:0, HSC-MODE:1 or TA was expected [tolerance]");
  EXPECT_EQ(one("FUNCTION MODE TURN"),
            "p.h:4:1: error: FUNCTION MODE (turning) is not supported; milling blocks were expected [not-supported]");
  EXPECT_EQ(one("POLARKIN OFF"),
            "p.h:4:1: error: POLARKIN (polar kinematics) is not supported; X, Y and Z were expected [not-supported]");
  EXPECT_EQ(one("FUNCTION LIFTOFF TCS Z+0.5"), "p.h:4:1: warning: FUNCTION LIFTOFF is read without effect [no-effect]");
}

TEST(Klartext, FeedsPerToothAndPerTurn) {
  const auto feed = [](const std::string& lines) {
    const Read r = read_lines(with_start(lines));
    EXPECT_FALSE(r.diagnostics.has_errors()) << lines << r.messages.front();
    return mm_per_min_from_mm_per_s(r.moves.moves.back().feed_mm_per_s);
  };
  EXPECT_NEAR(feed("L X+5 FU0.2\n"), 200, 1e-9);
  EXPECT_NEAR(feed("L X+5 FZ0.1\n"), 200, 1e-9);
  EXPECT_NEAR(feed("TOOL CALL 2 Z FU0.3 S2000\nL X+5\n"), 600, 1e-9);
  EXPECT_NEAR(feed("TOOL CALL 2 Z S2000 FZ0.05\nL X+5 FAUTO\n"), 200, 1e-9);
  EXPECT_NEAR(feed("L X+5 F0.2 M136\n"), 200, 1e-9);
  EXPECT_NEAR(feed("L X+5 F0.2 M136\nL X+9 F300 M137\n"), 300, 1e-9);
  EXPECT_EQ(said("L X+5 FZ0.1\n"),
            Messages{"p.h:4:1: warning: FZ needs the number of teeth of tool 1, which stands in the tool table of the "
                     "control; 2 are assumed [teeth-unknown]"});
}

TEST(Klartext, FeedsOfCyclesMayBeWords) {
  const auto down_and_out = [](const std::string& in, const std::string& out) {
    const Read r =
        read_lines(with_start("CYCL DEF 201 REAMING ~\nQ200=2 ~\nQ201=-5 ;DEPTH ~\nQ206=" + in +
                              " ;IN ~\nQ211=+0 ~\nQ208=" + out + " ;OUT ~\nQ203=+0 ~\nQ204=+5\nCYCL CALL M8\n"));
    EXPECT_FALSE(r.diagnostics.has_errors()) << in << r.messages.front();
    std::string feeds;
    for (const Move& m : r.moves.moves)
      if (m.start_mm.z() == -5 || m.end_mm.z() == -5)
        feeds +=
            m.kind == MoveKind::rapid ? " rapid" : fmt::format(" {:.6g}", mm_per_min_from_mm_per_s(m.feed_mm_per_s));
    return feeds;
  };
  EXPECT_EQ(down_and_out("+150", " MAX"), " 150 rapid");
  EXPECT_EQ(down_and_out(" AUTO", "+99"), " 600 99");
  EXPECT_EQ(down_and_out("FAUTO", "FMAX"), " 600 rapid");
  EXPECT_EQ(down_and_out("FU0.2", "FZ0.3"), " 200 600");
  EXPECT_EQ(
      said("CYCL DEF 200 ~\nQ200= LOW ~\nQ201=-5\n"),
      Messages{"p.h:5:7: error: LOW is no function of a formula; SQ, SQRT, SIN, COS, TAN, ASIN, ACOS, ATAN, LN, LOG, "
               "EXP, NEG, ABS, INT, FRAC or SGN was expected [expression]"});
}

TEST(Klartext, QuestionsThatWereNotAnsweredLeaveWhatWasBefore) {
  EXPECT_EQ(path("L X+5 R F M\nL Y+5 R0 F M8\nL Z-1 R F MAX M\nR0 F MAX\n"), "5 0 0; 5 5 0; 5 5 -1");
  const Read r =
      read_lines(with_start("L X+5 R F300 M\nL Y+5 R F M\nF M\nCYCL DEF 200 ~\nQ200=2 ~\nQ201=-5 ~\nQ206=150 "
                            "~\nQ202=5 ~\nQ203=0\nR0 F MAX M99\nCYCL CALL F M\n"));
  EXPECT_EQ(r.messages, Messages{});
  EXPECT_NEAR(mm_per_min_from_mm_per_s(r.moves.moves[2].feed_mm_per_s), 300, 1e-9);
  EXPECT_EQ(std::ranges::count_if(r.moves.moves, [](const Move& m) { return m.end_mm.z() == -5; }), 2);
  EXPECT_EQ(said("L X+5 FAMX\n"), Messages{"p.h:4:7: error: F has no number; a number or a Q parameter was expected "
                                           "[no-number]"});
  EXPECT_EQ(said("CR X+5 Y+5 R DR+\n"), (Messages{"p.h:4:12: error: R has no number; a number or a Q parameter was "
                                                  "expected [no-number]",
                                                  "p.h:4:1: error: CR without a radius; R was expected [arc]"}));
}

TEST(Klartext, FormsOfOlderControlsAndPosts) {
  // REP without a number is a call.
  EXPECT_EQ(path("CALL LBL 1 REP\nL Y+9\nM30\nLBL 1\nL IX+5\nLBL 0\n"), "5 0 0; 5 9 0");
  EXPECT_EQ(path("CYCL DEF9 .0 DWELL\nCYCL DEF9.1 DWELL2\nL X+1\n"), "0 0 0; 1 0 0");
  const Read inch = read_text("0010 BEGIN PGM 100 IN\n0020 L X1. Y0.0 Z.5 F MAX\n0030 END PGM 100 IN\n", {}, "p.h");
  EXPECT_EQ(inch.messages, Messages{});
  expect_near_mm(inch.moves.moves.back().end_mm, {25.4, 0, 12.7});
  EXPECT_EQ(said("CALL LBL QS5\n"),
            Messages{"p.h:4:10: error: QS5 has no text here; a name was expected before [undefined-parameter]"});
}

TEST(Klartext, PlacesOfAPatternMayBeStepsFromTheOneBefore) {
  const auto places = [](const std::string& pattern) {
    const Read r = read_lines(with_start("PATTERN DEF " + pattern +
                                         "\nCYCL DEF 200 ~\nQ200=2 ~\nQ201=-5 ~\nQ206=150 ~\nQ202=5\n"
                                         "CYCL CALL PAT\n"));
    if (!r.messages.empty()) return r.messages.front();
    std::string out;
    for (const Move& m : r.moves.moves)
      if (m.end_mm.z() == -5) out += fmt::format("{:g} {:g};", m.end_mm.x(), m.end_mm.y());
    return out;
  };
  EXPECT_EQ(places("POS1( X+25 Y+33.5 Z+0 ) ~\nPOS2( X+15 IY+6.5 Z+0 ) ~\nPOS3( IX-5 IY-10 Z+0 )"),
            "25 33.5;15 40;10 30;");
  EXPECT_EQ(places("POS1( IX+25 Y+1 Z+0 )"),
            "p.h:4:19: error: IX in the first place of PATTERN DEF; X and Y were expected [cycle]");
  EXPECT_EQ(places("POS1( X+25 W+1 )"), "p.h:4:24: error: W+1 in PATTERN DEF; X, Y or Z was expected [cycle]");
}

TEST(Klartext, TheControlKnowsTheToolThatIsGiven) {
  const std::string lines =
      "TOOL DEF 7 L+20 R+4\nFN 0: Q11 = +7\nTOOL CALL Q11 Z S1000\n"
      "FN 18: SYSREAD Q1 = ID50 NR2 IDXQ11\nFN 18: SYSREAD Q2 = ID50 NR1 IDX7\n"
      "FN 18: SYSREAD Q3 = ID20 NR1\nL X+Q1 Y+Q2 Z+Q3 FMAX\n";
  EXPECT_EQ(path(lines), "4 20 7");
  EXPECT_EQ(
      said("FN 18: SYSREAD Q1 = ID50 NR2 IDX3\nL X+Q1\n"),
      Messages{"p.h:5:3: error: this depends on a parameter whose value is not known: Q1 is read from the control "
               "(FN 18) in line 4 [unknown-parameter]"});
}

TEST(Klartext, CallsOfARefusedCycleAreNotASecondError) {
  EXPECT_EQ(said("CYCL DEF 254 SLOT Q215=0\nL X+5 FMAX M99\n"),
            Messages{"p.h:4:1: error: CYCL DEF 254 (a slot or stud) is not supported; the finished path was "
                     "expected [not-supported]"});
  EXPECT_EQ(said("CYCL DEF 392 NAME Q1=0\nL X+5 FMAX M99\n"),
            Messages{"p.h:4:1: warning: CYCL DEF 392 is a cycle of the machine's maker; what it does is not known, and "
                     "it is passed over [machine-cycle]"});
}

TEST(Klartext, FunctionDwellWaits) {
  EXPECT_NEAR(read_lines(with_start("FUNCTION DWELL TIME2.5\n")).moves.moves.back().dwell_s, 2.5, 1e-12);
  EXPECT_NEAR(read_lines(with_start("FUNCTION DWELL REV10\n")).moves.moves.back().dwell_s, 0.6, 1e-12);
  EXPECT_EQ(said("FUNCTION DWELL 3\n"),
            Messages{"p.h:4:16: error: FUNCTION DWELL without TIME or REV; TIME10 was expected [dwell]"});
}

TEST(Klartext, TextBehindTheEndIsSaid) {
  EXPECT_EQ(read_text("BEGIN PGM P MM\nL X+1 Y+1 Z+1 FMAX\nEND PGM P MM\n; comment\nL X+9 FMAX\n", {}, "p.h").messages,
            Messages{"p.h:5:1: warning: text behind END PGM is no part of the program and is not read [after-end]"});
}

TEST(Klartext, AnArcAtRapidTakesTheFeedBefore) {
  const Read r = read_lines(with_start("L X+10 Y+0\nCR X+20 Y+0 R+5 DR+ FMAX\n"));
  EXPECT_EQ(r.messages, Messages{"p.h:5:1: warning: an arc with FMAX is read with the F before it [arc-at-rapid]"});
  EXPECT_NEAR(r.moves.moves.back().feed_mm_per_s, 10, 1e-12);
}

}  // namespace
}  // namespace camber::nc
