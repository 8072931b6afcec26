// Words and settings in which controls differ: numbers without a point, D, additional work offsets, pecks, offsets as
// variables, several blocks in a line, forms of the text.
#include <fmt/format.h>

#include "tests/nc/macro_text.h"

namespace camber::nc {
namespace {

using Messages = std::vector<std::string>;

/// As as(), with nothing said of numbers without a point.
InterpreterOptions control(std::string_view dialect) {
  InterpreterOptions options = as(dialect);
  options.whole_numbers_are_increments.reset();
  return options;
}

double cut_mm(const Read& r) {
  double sum = 0;
  for (const Move& m : r.moves.moves)
    if (m.feed_mm_per_s > 0) sum += length_mm(r.moves, m);
  return sum;
}

// --- numbers without a point

const std::string kWhole =
    "G21 G90 G54\nT1 M6\nS5000 M3\nG0 X50 Y50\nG43 H1 Z50\nG0 Z2\nG1 Z-1 F100\nG4 X2\nG1 X60\nG0 Z50\nM30\n";

TEST(WholeNumbers, AreReadAsUnitsWithAWarningThatNamesTheSetting) {
  const Read r = read_text(kWhole, control("haas"));
  EXPECT_EQ(r.messages,
            Messages{"p.nc:4:4: warning: X50 and 7 further words have no decimal point; X50 is read as 50 mm, but a "
                     "control set to least increments (default to float, setting 162) reads 0.05 mm: "
                     "--least-increments, or [control] whole_numbers in machine.toml, says which [decimal-point]"});
  EXPECT_NEAR(cut_mm(r), 13, 1e-9);
  EXPECT_EQ(r.moves.moves[4].dwell_s, 2);
  EXPECT_NE(read_text(kWhole, control("fanuc")).messages.at(0).find("(decimal point input, parameter 3401#0)"),
            std::string::npos);
  // No control is named.
  EXPECT_EQ(read_text(kWhole, {.inch = false}).messages, Messages{});
  EXPECT_NE(
      read_text("G20\nG0 X0 Y0 Z20000\n", {})
          .messages.at(0)
          .find("(Fanuc: decimal point input, parameter 3401#0; Haas: default to float, setting 162; Mazak EIA: "),
      std::string::npos);
}

TEST(WholeNumbers, AreIncrementsInEveryWordWhereTheControlIsSetSo) {
  InterpreterOptions options = control("fanuc");
  options.whole_numbers_are_increments = true;
  const Read r = read_clean(kWhole, options);
  EXPECT_NEAR(cut_mm(r), 0.013, 1e-9);
  EXPECT_EQ(r.moves.moves[4].dwell_s, 0.002);
  EXPECT_TRUE(r.moves.whole_numbers_are_increments);
  const auto ends = [&](const std::string& text) { return run_text(text, options); };
  EXPECT_EQ(ends("X1000 Y2. Z-500\nG20 X10000 Y1."), "1 2 -0.5; 25.4 25.4 -0.5");
  EXPECT_EQ(ends("#1=5\nX#1 Y[2+1]"), "5 3 0");         // variables count whole units
  EXPECT_EQ(ends("G68 X0 Y0 R90000\nX1000"), "0 1 0");  // angles: 0.001 degrees
  EXPECT_EQ(ends_of(read_text("G0 X0 Y0 Z0\nG16 X1000 Y90000\n", options)), "0 0 0; 0 1 0");
  EXPECT_EQ(ends("G1 X1000 ,R500 F100\nY1000"), "0.5 0 0; 1 0.5 0; 1 1 0");
  EXPECT_EQ(ends("G51 X0 Y0 Z0 P2000\nX1000"), "2 0 0");  // a scale is none of them
  EXPECT_EQ(ends("G91 G81 X1000 Z-1000 R1000 K2 F100"), "0 0 1; 1 0 1; 1 0 0; 1 0 1; 2 0 1; 2 0 0; 2 0 1");
  EXPECT_EQ(read_clean("G20 G90\nG0 X0 Y0 Z0\nG1 X10000 F100\n", options).moves.moves[1].feed_mm_per_s * 60, 25.4);
  EXPECT_EQ(read_clean("G21 G90\nG0 X0 Y0 Z0\nG1 X10000 F100\n", options).moves.moves[1].feed_mm_per_s * 60, 100);
  EXPECT_EQ(read_clean("G0 X0 Y0 Z0\nG4 P500\nG4 U500\n", options).moves.moves[1].dwell_s, 0.5);
  EXPECT_EQ(read_clean("G0 X0 Y0 Z0\nG4 P500\nG4 U500\n", options).moves.moves[2].dwell_s, 0.5);
  EXPECT_EQ(read_clean("G0 X0 Y0 Z0\nG4 X1.5\nG4 X2\n").moves.moves[2].dwell_s, 2);  // units: seconds
}

TEST(WholeNumbers, NothingIsSaidWhereNothingDependsOnThem) {
  EXPECT_EQ(read_text("G21 G90\nG0 X0 Y0 Z0\nG1 X10. F100 S5000\nG4 P500\nX0\nM30\n", control("fanuc")).messages,
            Messages{});
  EXPECT_EQ(read_text("G21 G90\nG0 X0 Y0 Z0\nG1 X10 F100\nM2\n", control("linuxcnc")).messages, Messages{});
  EXPECT_EQ(
      read_text("G21 G90\nG0 X0 Y0 Z0\nG5.1 Q1\n#1=50\nG0 X#1\nG65 P9 A5\nM30\nO9\nM99\n", control("fanuc")).messages,
      Messages{});
}

TEST(WholeNumbers, LargerThanAnyMachineTheyAreIncrements) {
  const Read r = read_text("G20 G90\nG0 X0 Y0 Z1000\nG1 Z-1000 F100\nX20000\nM30\n", control("fanuc"));
  EXPECT_EQ(r.messages,
            Messages{"p.nc:2:10: warning: no coordinate has a decimal point, and as millimetres or inches they would "
                     "lie up to 508000 mm away; they are read as least increments (Z1000 is 0.1 inch), for a control "
                     "set so (decimal point input, parameter 3401#0); else: [control] whole_numbers = \"units\" in "
                     "machine.toml [decimal-point]"});
  EXPECT_NEAR(cut_mm(r), 25.4 * 2.2, 1e-9);
}

// --- D

TEST(ModalD, HoldsUntilTheNextOneInWhateverBlockItStands) {
  const std::string head = "G21 G90 G17\nG10 L12 P1 R5.\nG10 L12 P21 R1.5\nT1 M6\nS8000 M3\nG0 X0. Y-20.\n",
                    tail = "G1 Z-1. F400\nG41 Y-10.\nY20.\nG40 X-20.\nM30\n";
  for (const char* dialect : {"fanuc", "haas", "mazak"})
    for (const char* where :
         {"G43 H1 D21 Z3.\n", "G0 Z3. D21\n", "D21\nG0 Z3.\n", "G40 D21\nG0 Z3.\n", "D21\nG0 Z3.\nT1 M6\nS8000 M3\n"}) {
      const Read r = read_text(head + where + tail, as(dialect));
      const auto at = std::ranges::find_if(r.moves.moves, [](const Move& m) { return m.end_mm.y() == 20; });
      ASSERT_NE(at, r.moves.moves.end()) << where;
      EXPECT_NEAR(at->end_mm.x(), -1.5, 1e-9) << dialect << where;
    }
  const Read off = read_text(head + "G43 H1 D21 Z3.\nD0\n" + tail, as("fanuc"));
  EXPECT_EQ(off.moves.moves[3].end_mm.x(), 0);
  const Read unknown = read_text(head + "G43 H1 D7 Z3.\n" + tail, as("fanuc"));
  EXPECT_NE(unknown.messages.at(0).find("no radius is given for D7;"), std::string::npos) << unknown.messages.at(0);
  EXPECT_EQ(
      read_text(head + "G0 Z3. D21\nG1 Z-1. F400\nG41 Y-10.\nD1\nY20.\nG40 X-20.\nM30\n", as("fanuc")).messages.back(),
      "p.nc:10:1: error: D1 is another radius while G41 is active; G40 was expected before [cutter-radius]");
}

TEST(ModalD, OnLinuxCncBelongsToItsBlock) {
  EXPECT_EQ(said("G43 H1 D2\n", "linuxcnc"),
            "p.nc:1:8: error: D in a block without a code that uses it; G41, G41.1, G42 or G42.1 was expected "
            "[offset-number]");
}

// --- additional work offsets of Haas

TEST(HaasOffsets, G154AndG110ToG129) {
  const std::string inch =
      "O1\nG20 G90 G17\nT1 M6\nS5000 M3\nG154 P2\nG0 X1. Y1. Z.2\nG1 Z-.1 F20.\nX2.\nG110\nG0 X0 Y0\nM30\n";
  EXPECT_NEAR(cut_mm(read_clean(inch, as("haas"))), 33.02, 1e-9);
  EXPECT_NEAR(cut_mm(read_clean(inch)), 33.02, 1e-9);  // G154 shows the dialect
  const std::string known = "G90 G10 L20 P3 X10. Y0 Z0\nG10 L2 P1 X0 Y0 Z0\nG0 X0 Y0 Z0\n";
  EXPECT_EQ(ends_of(read_clean(known + "G54 G0 X1.\nG154 P3 X1.\nG112 X2.\nG54 X1.\n", as("haas"))),
            "0 0 0; 1 0 0; 11 0 0; 12 0 0; 1 0 0");
  EXPECT_EQ(read_text("G154 P100\n", as("haas")).messages,
            Messages{"p.nc:1:6: error: G154 P100 is not a work offset; P1 to P99 was expected [work-offset]"});
  EXPECT_EQ(read_text("G154\n", as("haas")).messages,
            Messages{"p.nc:1:1: error: G154 has no number; P1 to P99 was expected [work-offset]"});
  EXPECT_EQ(read_text("G154 P1\n", as("fanuc")).messages,
            Messages{"p.nc:1:1: error: G154 is the additional work offset of Haas; G54.1 P was expected in a Fanuc "
                     "program (--dialect) [unknown-g]"});
  EXPECT_EQ(work_offset_number("G154P7"), 540007);
  EXPECT_EQ(work_offset_number("G112"), 540003);
  EXPECT_EQ(work_offset_number("G130"), std::nullopt);
}

TEST(HaasPecks, BecomeSmallerByJ) {
  const std::string ends = run_text("G0 Z5.\nG83 Z-10. R0 I5. J2. K1.5 F100.\n", as("haas"));
  // 5, 3, 1.5, and the rest; 0.254 above the last depth.
  EXPECT_EQ(ends,
            "0 0 5; 0 0 0; 0 0 -5; 0 0 0; 0 0 -4.746; 0 0 -8; 0 0 0; 0 0 -7.746; 0 0 -9.5; 0 0 0; 0 0 -9.246; 0 0 -10; "
            "0 0 5");
  EXPECT_EQ(run_text("G0 Z5.\nG73 Z-6. R0 Q2. K4. F100.\n", as("haas")),
            "0 0 5; 0 0 0; 0 0 -2; 0 0 -1.746; 0 0 -4; 0 0 0; 0 0 -3.746; 0 0 -6; 0 0 5");
  EXPECT_EQ(run_text("G0 Z5.\nG83 Z-2. R0 Q2. K3 F100.\n", as("fanuc")),
            "0 0 5; 0 0 0; 0 0 -2; 0 0 5; 0 0 0; 0 0 -2; 0 0 5; 0 0 0; 0 0 -2; 0 0 5");
}

// --- offsets as variables

TEST(OffsetVariables, TakeEffectAndAreRead) {
  const std::string known = "G10 L2 P1 X0 Y0 Z0\nG10 L2 P2 X7. Y2. Z0\nG0 X0 Y0 Z0\n";
  const auto ends = [&](const std::string& text, const char* dialect = "fanuc") {
    return ends_of(read_clean(known + text, as(dialect)));
  };
  EXPECT_EQ(ends("#5241=10.\nG55 X1.\n"), "0 0 0; 11 0 0");
  EXPECT_EQ(ends("X1.\n#5221=10.\nX1.\n"), "0 0 0; 1 0 0; 11 0 0");
  EXPECT_EQ(ends("X#5241 Y#5242\n"), "0 0 0; 7 2 0");
  EXPECT_EQ(ends("#7021=3.\nG54.1 P2 X1. Y0 Z0\n#14021=8.\nX1.\n"), "0 0 0; 4 0 0; 9 0 0");
  EXPECT_EQ(ends("#7021=3.\nG154 P2 X1. Y0 Z0\nX#4014\n", "haas"), "0 0 0; 4 0 0; 157 0 0");
  EXPECT_EQ(ends("G20\n#5241=1.\nG55 X1.\n"), "0 0 0; 50.8 0 0");
  // Relative to what is not known.
  EXPECT_EQ(ends_of(read_text("G0 X0 Y0 Z0\n#5221=#5221+10.\nX1.\n", as("fanuc"))), "0 0 0; 11 0 0");
  const std::string contour = "S100 M3\nG0 X-10. Y-20.\nG1 G41 D3 Y-10. F100.\nX0.\nY10.\nG40 X-20.\n";
  const auto wall = [&](const std::string& set, const char* dialect) {
    const Read r = read_text("G21 G90\nG0 X0 Y0 Z0\n" + set + contour, as(dialect));
    double x = 99;
    for (const Move& m : r.moves.moves)
      if (std::abs(m.end_mm.x() - m.start_mm.x()) < 1e-9 && m.end_mm.y() > 5) x = m.end_mm.x();
    return x;
  };
  EXPECT_NEAR(wall("#13003=2.5\n", "fanuc"), -2.5, 1e-9);
  EXPECT_NEAR(wall("#13003=2.5\n#12003=0.1\n", "fanuc"), -2.6, 1e-9);
  EXPECT_NEAR(wall("#2403=2.5\n", "haas"), -2.5, 1e-9);
  EXPECT_NEAR(wall("#16003=2.5\n", "mazak"), -2.5, 1e-9);
  EXPECT_EQ(run_text("#2403=2.5\nX#2403\n", as("haas")), "2.5 0 0");
}

TEST(OffsetVariables, OfLinuxCncCountWhenTheyAreSelected) {
  const auto ends = [](const std::string& text) {
    return ends_of(read_clean("G10 L2 P1 X0 Y0 Z0\nG10 L2 P2 X7 Y0 Z0\nG54\nG0 X0 Y0 Z0\n" + text, as("linuxcnc")));
  };
  EXPECT_EQ(ends("#5241=10\nG55 X1\n"), "0 0 0; 11 0 0");
  EXPECT_EQ(ends("#5221=10\nX1\nG55 X0\nG54 X1\n"), "0 0 0; 1 0 0; 7 0 0; 11 0 0");
  EXPECT_EQ(ends("X#5241\n"), "0 0 0; 7 0 0");
}

// --- abbreviated words

TEST(AbbreviatedMacroWords, AreThoseOfFanuc) {
  EXPECT_EQ(run_text("#1=0\nWH[#1LT2]DO1\n#1=#1+1\nX#1\nEN1\n"), "1 0 0; 2 0 0");
  EXPECT_EQ(run_text("IF[1EQ1]TH #2=7\nIF[#2EQ7]GO5\nX1\nN5 X#2\n"), "7 0 0");
  EXPECT_EQ(run_text("#1=RO[1.6]\nX#1 Y[FI[2.9]] Z[FU[2.1]]\n"), "2 2 3");
  EXPECT_EQ(run_text("X[SI[30]] Y[CO[60]] Z[TA[45]]\n"), "0.5 0.5 1");
  EXPECT_EQ(run_text("X[SQ[16]] Y[AB[-3]] Z[AT[1]/[1]]\n"), "4 3 45");
  EXPECT_EQ(run_text("#1=6 AN 3\nX#1 Y[5XO1] Z[7MO4]\n"), "2 4 3");
  EXPECT_EQ(said("#1=SI[30]\nG0 X#1\n", "linuxcnc"),
            "p.nc:1:4: error: an abbreviated word; a LinuxCNC control knows it by its full name only [expression]");
}

// --- LinuxCNC

TEST(LinuxCncDwell, TakesPAloneThenMoves) {
  const Read r = read_clean("G21 G90\nG0 X0 Y0 Z0\nS1000 M3\nG1 X10. F100 G4 P0.5\nG1 Y10.\nM2\n", as("linuxcnc"));
  EXPECT_EQ(ends_of(r), "0 0 0; 10 0 0; 10 10 0");
  EXPECT_EQ(r.moves.moves[1].kind, MoveKind::dwell);
  EXPECT_EQ(r.moves.moves[1].dwell_s, 0.5);
  EXPECT_NEAR(cut_mm(r), 20, 1e-9);
  EXPECT_EQ(run_linuxcnc("G1 F100\nG4 P1 X2\n"), "2 0 0");  // by the code in force
  EXPECT_EQ(said("F100\nG2 X2 I1 G4 P0.5\n", "linuxcnc"),
            "p.nc:2:1: error: G4 with an arc (G2, G3), both of which use P; two blocks were expected [modal-group]");
  EXPECT_EQ(said("G4 X1\n", "linuxcnc"), "p.nc:1:1: error: G4 has no time; P with the time was expected [dwell]");
}

TEST(LinuxCncReferencePoints, AreStoredByG28Point1AndG30Point1) {
  EXPECT_EQ(run_linuxcnc("G0 X5 Y6 Z7\nG28.1\nX0 Y0\nG28\n"), "5 6 7; 0 0 7; 5 6 7");
  EXPECT_EQ(run_linuxcnc("G0 X5 Y6 Z7\nG30.1\nX0 Y0\nG30 X0\n"), "5 6 7; 0 0 7; 5 0 7");
  EXPECT_EQ(run_linuxcnc("G0 X5 Y6\nG28.1 X1\nG28\n"), "5 6 0; 1 6 0; 5 6 0");
  const Read r = read_clean("G0 X5 Y6 Z7\nG28.1\nX0 Y0\nG28\n", as("linuxcnc"));
  EXPECT_FALSE(r.moves.moves.back().reference);
  EXPECT_EQ(said("G28.1\n", "fanuc"),
            "p.nc:1:1: error: G28.1 is not a G code of a Fanuc program that Camber knows [unknown-g]");
}

TEST(LinuxCncIsStrict, WhereItsInterpreterIs) {
  for (const char* block : {"G1 G1 X1",  "G0 G1 X1",  "G17 G18",
                            "M3 M4",     "M7 M8",     "M8 M9",
                            "M3 M5",     "M0 M2",     "M48 M49",
                            "G90 G91",   "G54 G55",   "G61 G64",
                            "G4 G10 P1", "G28 G4 P1", "G98 G99",
                            "G43 G49",   "G40 G41",   "G20 G21",
                            "G93 G94",   "M2 M30",    "G81",
                            "G80 X1",    "(a (b) c)", "D1 G1 X1",
                            "H1 G1 X1",  "G1 X1 ,R5", "G10 L2 P1 X1 G1 Y1",
                            "#1=RO[1.5]"})
    EXPECT_NE(said(fmt::format("G0 X0 Y0 Z0\nF100\n{}\nM2\n", block), "linuxcnc").find("error"), std::string::npos)
        << block;
  for (const char* block : {"G90 G90.1", "G80 G1 X1", "G80", "G81 X1 Z-1 R1", "G53 G0 X1", "T1 M6 M3", "G92.1 G1 X1",
                            "G1 X1 ; (a (b) c)", "(a) G1 X1 (b)", "G4 P1 M8", "G17 G40 G49 G54 G64 P0.01 G80 G90 G94"})
    EXPECT_EQ(said(fmt::format("G0 X0 Y0 Z0\nF100\n{}\nM2\n", block), "linuxcnc").find("error"), std::string::npos)
        << block << said(fmt::format("G0 X0 Y0 Z0\nF100\n{}\nM2\n", block), "linuxcnc");
}

// --- forms of the text

TEST(TextForms, ASemicolonEndsABlockWhereTheManualsPrintItSo) {
  EXPECT_EQ(run_text("G0 X1. ; G1 Y2. F100. ; X3. ;\n"), "1 0 0; 1 2 0; 3 2 0");
  EXPECT_EQ(run_text("#1=5. ; X#1 ; #1=#1+1. ; Y#1\n"), "5 0 0; 5 6 0");
  EXPECT_EQ(run_text("#1=0 ; WHILE[#1LT2]DO1 ; #1=#1+1 ; X#1 ; END1 ; Y9.\n"), "1 0 0; 2 0 0; 2 9 0");
  EXPECT_EQ(run_text("M98 P7 ; X2. ;\nM30\nO7\nX1.\nM99\n"), "1 0 0; 2 0 0");
  EXPECT_EQ(run_text("IF[1EQ1]GOTO5 ; X1.\nX2.\nN5 X3.\n"), "3 0 0");
  EXPECT_EQ(run_text("/X1. ; X2.\nX3.\n"), "1 0 0; 2 0 0; 3 0 0");
  // A comment is one, and so is what begins a line.
  EXPECT_EQ(run_text("X1. ; rapid to the start\n; X2.\nX3. ; (T5)\n"), "1 0 0; 3 0 0");
  EXPECT_EQ(run_linuxcnc("X1. ; X2.\nX3."), "1 0 0; 3 0 0");
  const Read r = read_text("G0 X1. Y0 Z0; X2.\n", InterpreterOptions{.inch = false});
  EXPECT_EQ(
      r.messages,
      Messages{"p.nc:1:13: warning: the words behind `;` are read as a further block, as a Fanuc or a Haas control "
               "does; --dialect linuxcnc reads a comment [block-end]"});
  EXPECT_FALSE(r.moves.moves.back().editable);
}

TEST(TextForms, LinesThatEndInACarriageReturnAlone) {
  const Read r = read_text("G21 G90\rG0 X0. Y0. Z0.\rG1 X10. F100\rG1 Q\rM30\r", as("fanuc"), "p.nc");
  EXPECT_EQ(r.program.blocks.size(), 5u);
  EXPECT_EQ(cut_mm(r), 10);
  EXPECT_EQ(r.messages, Messages{"p.nc:4:4: warning: Q has no number; it is taken as Q0 [no-number]"});
  // Carriage returns in a text of line feeds are blanks, as ever.
  EXPECT_EQ(read_text("G0 X0. Y0. Z0.\n\r\rX1.\n\r\r\nX2.\n", as("fanuc")).program.blocks.size(), 4u);
}

TEST(TextForms, LeadersOfTapesAndTextBeforeThePercent) {
  const std::string body = "%\nO1\nG21 G90\nG0 X0. Y0. Z0.\nG1 X10. F100\nM30\n%\n";
  const std::string nul(40, '\0');
  EXPECT_EQ(cut_mm(read_clean(nul + body, as("fanuc"))), 10);
  EXPECT_EQ(cut_mm(read_clean(body + nul, as("fanuc"))), 10);
  EXPECT_EQ(cut_mm(read_clean("\x12\x7f\x7f" + body + "\x14", as("fanuc"))), 10);
  EXPECT_EQ(cut_mm(read_clean(body + std::string(100, '\x1a'), as("fanuc"))), 10);
  EXPECT_EQ(cut_mm(read_clean("(made by X1)\n\n" + body, as("fanuc"))), 10);
  const Read r = read_text("PART 12: BRACKET\nG1 X5 of the old one\n" + body, as("fanuc"));
  EXPECT_EQ(r.messages, Messages{"p.nc:1:1: warning: text before the first % is no part of the program and is not read "
                                 "(and 1 more like it) [before-start]"});
  EXPECT_EQ(cut_mm(r), 10);
  EXPECT_EQ(r.program.blocks.size(), 9u);
  // The % at the end of a program that has none at its start.
  EXPECT_EQ(cut_mm(read_clean("G21 G90\nG0 X0. Y0. Z0.\nG1 X10. F100\nM30\n%\n", as("fanuc"))), 10);
  EXPECT_EQ(cut_mm(read_clean("G21 G90\nG0 X0. Y0. Z0.\nG1 X10. F100\n%\n", as("fanuc"))), 10);
  const Read behind = read_text("G21 G90\nG0 X0. Y0. Z0.\nG1 X10. F100\n%\nX20. what?\n", as("fanuc"));
  EXPECT_EQ(behind.messages,
            Messages{"p.nc:5:1: warning: text behind the % that ends the program is not read [after-end]"});
  EXPECT_EQ(cut_mm(behind), 10);
}

TEST(TextForms, ProgramNamesInPlaceOfNumbers) {
  const std::string body = "G21 G90\nG0 X0. Y0. Z0.\nG1 X10. F100\nM30\n";
  for (const char* name :
       {"OFinal path\n", "O Final path (v2)\n", "O1234 Final path\n", "%\nOBRACKET_A\n", "o12 op 3\n"})
    EXPECT_EQ(cut_mm(read_clean(name + body, as("haas"))), 10) << name;
  const Read r = read_clean("G0 X0. Y0. Z0.\nM98 P1234\nM30\nO1234 my part\nX5.\nM99\n", as("fanuc"));
  expect_near_mm(r.moves.moves.back().end_mm, {5, 0, 0});
}

// --- arcs

TEST(TinyArcs, AreWhatTheyAre) {
  const std::string head = "G21 G90\nG0 X10. Y0. Z0.\n";
  for (const char* arc :
       {"G2 X10. Y0.001 I0. J0. F100\n", "G2 X10. Y0.001 I0. J0.001 F100\n", "G3 X10.001 Y0. I0.001 J0. F100\n",
        "G3 X10. Y0. I0. J0. F100\n", "G2 X10.001 Y0.001 I0.0005 J0.0005 F100\n"}) {
    const Read r = read_clean(head + arc + "G1 X20.\n");
    EXPECT_LT(length_mm(r.moves, r.moves.moves[1]), 0.01) << arc;
  }
  EXPECT_NE(
      read_text(head + "G2 X10. Y1. I0. J0. F100\n").messages.at(0).find("the centre of the arc lies on its start"),
      std::string::npos);
}

TEST(FirstMotion, IsSaidAndKeptWhereItIsDetermined) {
  // The circle is known, its height is not.
  const Read helix = read_text("G21 G90\nG0 X10. Y0.\nG3 X10. Y0. I-10. J0. Z-1. F100\nM30\n");
  EXPECT_EQ(helix.messages, Messages{"p.nc:3:1: warning: G3 before Z was programmed; the tool is assumed to be at Z0 "
                                     "[start-unknown]"});
  EXPECT_FALSE(helix.moves.moves[1].reference);
  EXPECT_NEAR(length_mm(helix.moves, helix.moves.moves[1]), std::hypot(20 * kPi, 1), 1e-9);
  const Read full = read_text("G21 G90\nG3 I-10. J0. Z-1. F100\nM30\n");
  EXPECT_EQ(full.messages.size(), 3u);
  EXPECT_FALSE(full.moves.moves[0].reference);
  const Read line = read_text("G21 G90\nG1 X10. Y0. Z0. F100\nX20.\nM30\n");
  EXPECT_EQ(line.messages, Messages{"p.nc:2:1: warning: G1 to X from a place that the program has not given; the move "
                                    "is ignored for material removal (and 2 more like it) [start-unknown]"});
  EXPECT_TRUE(line.moves.moves[0].reference);
}

TEST(ControlWords, SplinesOfLinuxCncAreRefusedByName) {
  const auto said = [](const std::string& block) {
    return read_text("G0 X0 Y0 Z0\nF100\n" + block + "\nM2\n", as("linuxcnc")).messages;
  };
  using Messages = std::vector<std::string>;
  EXPECT_EQ(said("G5 X10 Y5 I3 J0 P-3 Q0"), Messages{"p.nc:3:1: error: G5 (spline) is not supported [not-read]"});
  EXPECT_EQ(said("G5.1 X20 Y0 I5 J5"), Messages{"p.nc:3:1: error: G5.1 (spline) is not supported [not-read]"});
  EXPECT_EQ(said("G5.2 X1 Y1 P1 L3"), Messages{"p.nc:3:1: error: G5.2 (spline) is not supported [not-read]"});
  EXPECT_EQ(said("G38.3 Z-5"), Messages{"p.nc:3:1: error: G38.3 (probing) is not supported [not-read]"});
  EXPECT_EQ(said("M67 E0 Q1.5"),
            Messages{"p.nc:3:1: warning: M67 is not known; it is assumed to have no effect on the path [unknown-m]"});
}

}  // namespace
}  // namespace camber::nc
