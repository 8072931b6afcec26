// Subprograms, macro calls, jumps and loops: positions worked out by hand.
#include "tests/nc/macro_text.h"
#include "tests/support/temp_folder.h"

namespace camber::nc {
namespace {

using Messages = std::vector<std::string>;

// --- Fanuc's statements ---------------------------------------------------------------------------------------------

TEST(NcMacro, IfGoesToABlockOrSets) {
  EXPECT_EQ(run_text("#1=3\nIF[#1 EQ 3]GOTO 10\nX1\nN10 X2\nIF [#1 LT 2] GOTO20\nX3\nN20 X4\nM30\n"),
            "2 0 0; 3 0 0; 4 0 0");
  EXPECT_EQ(run_text("#1=3\nIF[#1GT2]THEN#2=7\nIF[#1GT5]THEN #2=8\nX#2\n"), "7 0 0");
  EXPECT_EQ(run_text("#1=3\nIF [#1 EQ 3] THEN X5 Y1\nIF [#1 EQ 4] X9\n"), "5 1 0");
  EXPECT_EQ(run_text("#1=20\nGOTO[#1+10]\nX1\nN20X2\nN30X3\n"), "3 0 0");
  EXPECT_EQ(run_text("#1=2\nIF [#1 EQ 1] THEN\nX1\nELSE\nX2\nENDIF\nX3\n"), "2 0 0; 3 0 0");
}

TEST(NcMacro, GoesToTheNextBlockOfThatNumberElseToTheFirst) {
  EXPECT_EQ(run_text("N5 X1\n#1=#1+1\nIF[#1 LT 3]GOTO5\nX9\n"), "1 0 0; 1 0 0; 1 0 0; 9 0 0");
  EXPECT_EQ(run_text("N5 X1\nGOTO5\nX2\nN5 X3\n"), "1 0 0; 3 0 0");
  EXPECT_EQ(run_text("GOTO 7\n"), "p.nc:2:1: error: there is no block N7 in this program to go to [block-number]\n");
}

TEST(NcMacro, WhileLoopsNest) {
  EXPECT_EQ(run_text("#1=1\nWHILE[#1LE2]DO1\n#2=1\nWHILE [#2 LE 2] DO 2\nX#1 Y#2\n#2=#2+1\nEND2\n#1=#1+1\nEND1\nX9"),
            "1 1 0; 1 2 0; 2 1 0; 2 2 0; 9 2 0");
  EXPECT_EQ(run_text("DO1\n#1=#1+1\nIF[#1GT3]GOTO9\nX#1\nEND1\nN9 Y1"), "1 0 0; 2 0 0; 3 0 0; 3 1 0");
  EXPECT_EQ(run_text("WHILE[1EQ2]DO1\nX1\nEND1\nX2"), "2 0 0");
}

TEST(NcMacro, ValuesOfABlockAreTakenBeforeItSetsAny) {
  EXPECT_EQ(run_linuxcnc("#3=15\n#3=6 G1 X#3 F100\nX#3\n"), "15 0 0; 6 0 0");  // the example of LinuxCNC's manual
}

TEST(NcMacro, SubprogramsWithCounts) {
  const std::string sub = "M30\nO1234\nG91 X1\nG90\nM99\n";
  EXPECT_EQ(run_text("M98 P1234\nY1\n" + sub), "1 0 0; 1 1 0");
  EXPECT_EQ(run_text("M98 P1234 L3\nY1\n" + sub), "1 0 0; 2 0 0; 3 0 0; 3 1 0");
  EXPECT_EQ(run_text("M98 P31234\nY1\n" + sub), "1 0 0; 2 0 0; 3 0 0; 3 1 0");
  EXPECT_EQ(run_text("M98 P0031234\nY1\n" + sub), "1 0 0; 2 0 0; 3 0 0; 3 1 0");
  EXPECT_EQ(run_text("G1 Y5 F100 M98 P1234 L2\n" + sub), "0 5 0; 1 5 0; 2 5 0");  // its move comes first
  EXPECT_EQ(run_text("M98 P1234 L0\nY1\n" + sub), "0 1 0");
  EXPECT_EQ(run_text("#1=1234\nM98 P#1 L[1+1]\n" + sub), "1 0 0; 2 0 0");
  EXPECT_EQ(run_text("M98 P1234\nM30\n:1234\nX1\nM99\n"), "1 0 0");
  EXPECT_EQ(run_text("M98 P1\nY9\nM30\nO1\nX1\nM98 P2 L2\nX5\nM99\nO2\nG91 Y1\nG90\nM99\n"),
            "1 0 0; 1 1 0; 1 2 0; 5 2 0; 5 9 0");
  // Haas: five digits, no count in P.
  EXPECT_EQ(run_text("M98 P31234\n" + sub, as("haas")),
            "p.nc:2:5: error: there is no program O31234 in this file, and no file of that name beside it "
            "[subprogram]\n");
}

TEST(NcMacro, SubprogramSharesTheVariablesOfItsCaller) {
  EXPECT_EQ(run_text("#1=5\nM98 P10\nX#1\nM30\nO10\n#1=#1+1\nM99\n"), "6 0 0");
}

TEST(NcMacro, ReturnsToABlock) {
  EXPECT_EQ(run_text("M98 P10\nX1\nN50 X2\nM30\nO10\nY1\nM99 P50\n"), "0 1 0; 2 1 0");
  EXPECT_EQ(run_text("M98 P10\nM30\nO10\nM99 P50\n"),
            "p.nc:5:5: error: there is no block N50 to return to in the program that called [block-number]\n");
}

TEST(NcMacro, ReturnInTheMainProgram) {
  EXPECT_EQ(run_text("X1\nM99\n"),
            "p.nc:3:1: warning: M99 in the main program starts it again without end; it is read once "
            "[endless-program]\n1 0 0");
  EXPECT_EQ(run_text("M99 P20\nX1\nN20 X2\nM30\n"), "2 0 0");
}

TEST(NcMacro, LocalSubprogramsOfHaas) {
  EXPECT_EQ(run_text("M97 P1000 L2\nY1\nM30\nN1000 G91 X1\nG90\nM99\n", units()), "1 0 0; 2 0 0; 2 1 0");
  EXPECT_EQ(run_text("M97 P7\n"), "p.nc:2:5: error: there is no block N7 in this program to call [block-number]\n");
}

TEST(NcMacro, MacroCallsHaveVariablesOfTheirOwn) {
  EXPECT_EQ(run_text("#1=9 #24=8\nG65 P100 A1 B2 C3 I4 J5 K6 X7. Z-1\nX#1 Y#24\nM30\n"
                     "O100\nG0 X[#1+#2*10+#3*100] Y[#4+#5*10+#6*100] Z[#24+#26]\nX#7 Y1\nM99\n"),
            "321 654 6; 321 1 6; 9 8 6");
  // Every letter of table I.
  EXPECT_EQ(run_text("G65 P1 D7 E8 F9 H11 M13 Q17 R18 S19 T20 U21 V22 W23 Y25\nM30\nO1\n"
                     "X[#7+#8+#9+#11+#13+#17+#18+#19+#20+#21+#22+#23+#25] Y[#10] Z[#12]\nM99"),
            "213 0 0");
  EXPECT_EQ(run_text("G65 P1 L3 A1\nM30\nO1\nG91 X#1\nG90\n#1=#1+1\nM99"), "1 0 0; 2 0 0; 3 0 0");
  EXPECT_EQ(run_text("G65 P1 A#0 B2\nM30\nO1\nX#1 Y#2\nM99"), "0 2 0");
  EXPECT_EQ(run_text("#100=3\nG65 P1\nX#100\nM30\nO1\n#100=#100*2\nM99"), "6 0 0");
  EXPECT_EQ(run_text("G0 X5 G65 P1 A2\nM30\nO1\nY#1\nM99"), "5 0 0; 5 2 0");
}

TEST(NcMacro, ArgumentsOfTableTwo) {
  EXPECT_EQ(run_text("G65 P1 A1 B2 C3 I4 J5 K6 I7 J8 K9 I10\nM30\nO1\n"
                     "X[#1+#2+#3] Y[#4+#5+#6] Z[#7+#8+#9]\nX#10\nM99"),
            "6 15 24; 10 15 24");
  // The manual's mixed example: G65 A1.0 B2.0 I-3.0 I4.0 D5.0 P1000: #7 is 5.0.
  EXPECT_EQ(run_text("G65 A1.0 B2.0 I-3.0 I4.0 D5.0 P1000\nM30\nO1000\nX[#1+#2] Y#4 Z#7\nM99"), "3 -3 5");
}

TEST(NcMacro, ModalCallsFollowEveryMove) {
  EXPECT_EQ(run_text("G66 P1 Z-2\nX1\nM8\nX2\nG67\nX3\nM30\nO1\nG0 Z#26\nZ0\nM99"),
            "1 0 0; 1 0 -2; 1 0 0; 2 0 0; 2 0 -2; 2 0 0; 3 0 0");
  EXPECT_EQ(run_text("G66 P1 L2 A1\nX1\nG67\nM30\nO1\nG91 Y#1\nG90\nM99"), "1 0 0; 1 1 0; 1 2 0");
}

TEST(NcMacro, BlockSkipSwitches) {
  InterpreterOptions options = as("fanuc");
  EXPECT_EQ(run_text("/X1\n/2 X2\n/3X3\n", options), "1 0 0; 2 0 0; 3 0 0");
  options.skip_switches = 1 << 2;
  EXPECT_EQ(run_text("/X1\n/2 X2\n/3X3\n/2#1=5\nX4", options), "1 0 0; 3 0 0; 4 0 0");
  options.skip_switches = 1 << 1 | 1 << 3;
  EXPECT_EQ(run_text("/X1\n/2 X2\n/3X3\n/GOTO5\nX4\nN5", options), "2 0 0; 4 0 0");
  options.skip_slash_blocks = true;
  EXPECT_EQ(run_text("/X1\n/2 X2\n/3X3\nX4", options), "4 0 0");
}

TEST(NcMacro, WholeNumbersMayBeLeastIncrements) {
  InterpreterOptions options = as("fanuc");
  options.whole_numbers_are_increments = true;
  EXPECT_EQ(run_text("X1000 Y2. Z-500\nG20 X10000 Y1.\n", options), "1 2 -0.5; 25.4 25.4 -0.5");
  EXPECT_EQ(run_text("X1000 Y2. Z-500\n"), "1000 2 -500");
  EXPECT_EQ(read_text("G0 X0 Y0 Z0\nG4 X1500\n", options).moves.moves.back().dwell_s, 1.5);
}

// --- variables of the control ---------------------------------------------------------------------------------------

TEST(NcMacro, PositionsAndModalCodes) {
  EXPECT_EQ(run_text("X1 Y2 Z3\nX[#5001+1] Y[#5042*2] Z#5003\n"), "1 2 3; 2 4 3");
  EXPECT_EQ(run_text("G20 X1.\nX[#5001+1]"), "25.4 0 0; 50.8 0 0");
  EXPECT_EQ(run_text("G91 G18 G99 F200 S300\nG90 G0 X#4001 Y#4002 Z#4003\nX#4010 Y#4109 Z#4119\nX#4003 Y#4006"),
            "0 18 91; 99 200 300; 90 21 300");
  EXPECT_EQ(run_text("#10=#4003\nG91 X1\nG#10 X5"), "1 0 0; 5 0 0");  // modes saved and put back
  EXPECT_EQ(run_text("G55\nX#4014\nG54.1 P3\nX#4014 Y#4130"), "55 0 0; 54.1 3 0");
  EXPECT_EQ(run_text("X1\nX#5021\n"),
            "p.nc:3:2: warning: #5021 (machine position) is known only at the machine; the work position is taken "
            "[variable]\n1 0 0; 1 0 0");
  EXPECT_EQ(run_text("X#2001\n"),
            "p.nc:2:2: warning: #2001 (tool offset) is known only at the machine; it is taken as 0 [variable]\n0 0 0");
}

TEST(NcMacro, AlarmsStopAndClocks) {
  EXPECT_EQ(
      run_text("X1\nIF[#1EQ#0]THEN #3000=12(DIAMETER MISSING)\nX2"),
      "p.nc:3:16: error: the program stops here with alarm 3012 (DIAMETER MISSING); the rest is not read [alarm]\n"
      "1 0 0");
  const Read r = read_clean("G0 X1 Y1 Z1\n#3006=1(CHECK)\nX2\n", as("fanuc"));
  EXPECT_TRUE(r.moves.moves[0].exact_stop);
  // A line of 100 mm at F600 takes 10 s, the dwell 2 s, and three variable blocks 3 ms.
  EXPECT_EQ(run_text("#3001=0\nG1 X100 F600\nG4 P2000\n#1=ROUND[#3001/100]\nX#1"), "100 0 0; 120 0 0");
  EXPECT_EQ(run_text("#3001=0\nWHILE[#3001LT500]DO1\nEND1\nX1"), "1 0 0");  // a wait loop ends
}

TEST(NcMacro, SaysWhichVariablesThereAre) {
  EXPECT_EQ(run_text("#50=1"), "p.nc:2:1: error: #50 cannot be set on a fanuc control that Camber knows [variable]\n");
  EXPECT_EQ(run_text("X#50"),
            "p.nc:2:2: error: there is no variable #50 on a fanuc control that Camber knows [variable]\n");
  EXPECT_EQ(run_linuxcnc("#50=1\nX#50"), "1 0 0");
  EXPECT_EQ(run_text("#0=1"), "p.nc:2:1: error: #0 cannot be set [variable]\n");
  EXPECT_EQ(run_text("#1=2.5\n#[#1]=1"),
            "p.nc:3:1: error: #2.5: the number of a variable is not a whole one [variable]\n");
  EXPECT_EQ(run_text("#4001=1"),
            "p.nc:2:1: error: #4001 cannot be set on a fanuc control that Camber knows [variable]\n");
}

TEST(NcMacro, TakesOutputOfVariablesAndProgramNames) {
  EXPECT_EQ(run_text("POPEN\nDPRNT[X#1[53]*END*]\nPCLOS\nX1"), "1 0 0");
  EXPECT_EQ(run_text("O<PART_7>\nX1"), "1 0 0");
}

// --- LinuxCNC's O-words ---------------------------------------------------------------------------------------------

TEST(NcMacro, OWordSubsAndResults) {
  EXPECT_EQ(
      run_linuxcnc("o100 sub\nG0 X#1 Y#2\no100 endsub [#1+#2]\no100 call [3] [4]\nX#<_value> Y#1\nZ#<_value_returned>"),
      "3 4 0; 7 0 0; 7 0 1");
  EXPECT_EQ(run_linuxcnc("o<Move It> sub\no<t> if [#1 LT 0]\no<moveit> return [5]\no<t> endif\nX#1\no<moveit> endsub\n"
                         "o<moveit> call [-1]\nY#<_value>\no<MOVEIT> call [2]\nY#<_value>\n"),
            "0 5 0; 2 5 0; 2 0 0");
  EXPECT_EQ(run_linuxcnc("o1 sub\n#<a>=3\n#<_b>=4\nX#<a>\no1 endsub\n#<a>=1\no1 call\nX#<a> Y#<_b>\n"), "3 0 0; 1 4 0");
  EXPECT_EQ(run_linuxcnc("o7 sub\nX#1\no7 endsub\n#100=7\no#100 call [2]\no[#100] call [3]"), "2 0 0; 3 0 0");
  // Recursion: 1 + 2 + 3 + 4.
  EXPECT_EQ(run_linuxcnc("o1 sub\no2 if [#1 GT 1]\no1 call [#1-1]\n#2=[#1+#<_value>]\no2 else\n#2=1\no2 endif\n"
                         "o1 endsub [#2]\no1 call [4]\nX#<_value>"),
            "10 0 0");
}

TEST(NcMacro, OWordBranches) {
  const char* text =
      "#1={}\no1 if [#1 EQ 1]\nX1\no1 elseif [#1 EQ 2]\nX2\no1 elseif [#1 EQ 3]\nX3\no1 else\nX4\no1 endif\nY1";
  for (int i = 1; i <= 4; ++i)
    EXPECT_EQ(run_linuxcnc(fmt::format(fmt::runtime(text), i)), fmt::format("{0} 0 0; {0} 1 0", i));
}

TEST(NcMacro, OWordLoops) {
  EXPECT_EQ(run_linuxcnc("#1=0\no1 while [#1 LT 3]\n#1=[#1+1]\nX#1\no1 endwhile\nY1"), "1 0 0; 2 0 0; 3 0 0; 3 1 0");
  EXPECT_EQ(run_linuxcnc("#1=5\no1 do\nX#1\n#1=[#1+1]\no1 while [#1 LT 3]\nY1"), "5 0 0; 5 1 0");
  EXPECT_EQ(run_linuxcnc("G91\no1 repeat [3]\nX1\no1 endrepeat\nY1"), "1 0 0; 2 0 0; 3 0 0; 3 1 0");
  EXPECT_EQ(run_linuxcnc("o1 repeat [0]\nX1\no1 endrepeat\nY1"), "0 1 0");
  EXPECT_EQ(run_linuxcnc("G91\no1 repeat [2]\no2 repeat [2]\nX1\no2 endrepeat\no1 endrepeat"),
            "1 0 0; 2 0 0; 3 0 0; 4 0 0");
  EXPECT_EQ(run_linuxcnc("#1=0\no1 while [1]\n#1=[#1+1]\no2 if [#1 EQ 2]\no1 continue\no2 elseif [#1 GT 3]\no1 break\n"
                         "o2 endif\nX#1\no1 endwhile\nY1"),
            "1 0 0; 3 0 0; 3 1 0");
  EXPECT_EQ(run_linuxcnc("#1=0\no1 do\n#1=[#1+1]\no2 if [#1 EQ 2]\no1 continue\no2 endif\nX#1\no1 while [#1 LT 3]"),
            "1 0 0; 3 0 0");
}

TEST(NcMacro, PredefinedNamesOfLinuxCnc) {
  EXPECT_EQ(run_linuxcnc("G21 X1 Y2 Z3\nX[#<_x>+1] Y#5421 Z[#<_z>*2]\nX#<_metric> Y#<_motion_mode> Z#<_absolute>"),
            "1 2 3; 2 2 6; 1 0 1");
  EXPECT_EQ(run_linuxcnc("X[EXISTS[#<a>]]\n#<a>=1\nX[EXISTS[#<a>]] Y[EXISTS[#<_metric>]]"), "0 0 0; 1 1 0");
  EXPECT_EQ(run_linuxcnc("X#<nothing>"),
            "p.nc:2:2: error: #<nothing> was never set; a value was expected before [variable]\n");
  EXPECT_EQ(run_linuxcnc("#<_x>=1"), "p.nc:2:1: error: #<_x> belongs to the control and cannot be set [variable]\n");
}

TEST(NcMacro, TheTextShowsItsDialect) {
  EXPECT_EQ(run_text("#<a>=[5 AND 2]\nX#<a>", {.inch = false}), "1 0 0");
  EXPECT_EQ(run_text("#1=[5 AND 2]\nX[#1+1]", {.inch = false}), "1 0 0");
  EXPECT_EQ(read_text("o1 if [1]\nG4 P2\no1 endif\n", {.inch = false}).moves.moves.back().dwell_s, 2);
  EXPECT_EQ(dialect_named("haas")->name, "haas");
  EXPECT_EQ(dialect_named("bosch"), nullptr);
}

// --- files ----------------------------------------------------------------------------------------------------------

TEST(NcMacro, SubprogramsInFilesOfTheirOwn) {
  const tests::TempFolder folder;
  folder.write("O1234.nc", "%\nO1234\nG91 X1\nG90\nM99\n%\n");
  folder.write("0020.NC", "Y#1\nM99\n");
  folder.write("hole.ngc", "o<hole> sub\nG0 Z-#1\nZ0\no<hole> endsub\n");
  const auto run = [&](const std::string& text, std::string_view dialect) {
    return read_text("G0 X0 Y0 Z0\n" + text, as(dialect), folder / "main.nc");
  };
  const Read r = run("M98 P1234 L2\nG65 P20 A5\nX9\nM30\n", "fanuc");
  EXPECT_EQ(r.messages, Messages{});
  EXPECT_EQ(ends_of(r), "0 0 0; 1 0 0; 2 0 0; 2 5 0; 9 5 0");
  std::vector<std::uint32_t> blocks;
  std::vector<bool> editable;
  for (const Move& m : r.moves.moves) {
    blocks.push_back(m.block);
    editable.push_back(m.editable);
  }
  EXPECT_EQ(blocks, (std::vector<std::uint32_t>{0, 1, 1, 2, 3}));  // the blocks that call
  EXPECT_EQ(editable, (std::vector<bool>{true, false, false, false, true}));
  EXPECT_EQ(ends_of(run("o<hole> call [3]\n", "linuxcnc")), "0 0 0; 0 0 -3; 0 0 0");
  // What is wrong in such a file is told at its own line.
  folder.write("O7.nc", "O7\nG1 X5\nM99\n");
  EXPECT_EQ(run("M98 P7\n", "fanuc").messages,
            Messages{folder / "O7.nc" + ":2:1: error: G1 without a feed; F greater than zero was expected before or in "
                                        "this block [feed-missing]"});
  folder.write("O8.nc", "O8\nG1 X[5\nM99\n");
  EXPECT_EQ(run("M98 P8\n", "fanuc").messages,
            Messages{folder / "O8.nc" + ":2:5: error: the bracket `[` is not closed in its block [expression]"});
  EXPECT_EQ(
      run("o<gone> call\n", "linuxcnc").messages,
      Messages{folder / "main.nc" + ":2:1: error: there is no Ogone SUB in the program, and no file gone.ngc with "
                                    "one beside it [subprogram]"});
}

// --- what does not end ----------------------------------------------------------------------------------------------

TEST(NcMacro, EndlessLoopsAreToldAtTheirLine) {
  const std::string tail = "the loop does not end: 10000 blocks were run again; the rest is not read [endless-loop]";
  EXPECT_EQ(said("G0 X0 Y0 Z0\nWHILE[1EQ1]DO1\nX1\nEND1\n"), "p.nc:2:1: error: " + tail);
  EXPECT_EQ(said("N1 #1=1\nGOTO1\n"), "p.nc:2:1: error: " + tail);
  EXPECT_EQ(said("#1=0\nDO1\n#1=0\nWHILE[#1LT9]DO2\n#1=#1+1\nEND2\nEND1\n"), "p.nc:2:1: error: " + tail);
  EXPECT_EQ(said("WHILE[#1LT3]DO1\n#1=#1+1\nDO2\n#2=1\nEND2\nEND1\n"), "p.nc:3:1: error: " + tail);
  EXPECT_EQ(said("o1 while [1]\no1 endwhile\n", "linuxcnc"), "p.nc:1:1: error: " + tail);
  EXPECT_EQ(said("o1 repeat [1000000]\n#1=1\no1 endrepeat\n", "linuxcnc"), "p.nc:1:1: error: " + tail);
  EXPECT_EQ(said("M98 P1 L99999999\nM30\nO1\n#1=1\nM99\n"), "p.nc:1:1: error: " + tail);
  EXPECT_EQ(said("N1 G0 X1\nM99 P1\n"), "p.nc:2:1: error: " + tail);
  EXPECT_EQ(said("N1 M98 P1\nM30\nO1\nM99 P1\n"), "p.nc:4:1: error: " + tail);
}

TEST(NcMacro, RunawayRecursionIsToldAtTheCall) {
  EXPECT_EQ(said("M98 P1\nM30\nO1\nM98 P1\nM99\n"),
            "p.nc:4:1: error: calls nested deeper than 15 levels; a fanuc control reads no more [call-depth]");
  EXPECT_EQ(said("o1 sub\no1 call\no1 endsub\no1 call\n", "linuxcnc"),
            "p.nc:2:1: error: calls nested deeper than 10 levels; a linuxcnc control reads no more [call-depth]");
}

// --- mistakes -------------------------------------------------------------------------------------------------------

TEST(NcMacro, TellsWhatIsWrongWithStatements) {
  EXPECT_EQ(said("WHILE[1EQ1]\n"),
            "p.nc:1:12: error: WHILE [condition] without DO; WHILE [condition] DO 1 was expected [statement]");
  EXPECT_EQ(said("WHILE[1EQ1]DO1\nG0 X1\n"), "p.nc:1:1: error: DO 1 is not closed; END 1 was expected [statement]");
  EXPECT_EQ(said("G0 X1\nEND1\n"), "p.nc:2:1: error: END 1 closes nothing; DO 1 was expected before it [statement]");
  EXPECT_EQ(
      said("DO1\nDO2\nEND1\nEND2\n"),
      "p.nc:2:1: error: DO 2 is not closed before the end of the enclosing structure; END 2 was expected [statement]");
  EXPECT_EQ(said("IF[1EQ1]\n"),
            "p.nc:1:1: error: IF [condition] with nothing after it; GOTO or THEN was expected [statement]");
  EXPECT_EQ(said("THEN #1=1\n"), "p.nc:1:1: error: THEN without IF; IF [condition] THEN was expected [statement]");
  EXPECT_EQ(said("DO\n"), "p.nc:1:3: error: DO has no number [statement]");
  EXPECT_EQ(said("o1 if [1]\nX1\n"), "p.nc:1:1: error: O1 IF is not closed; O1 ENDIF was expected [statement]");
  EXPECT_EQ(said("o1 if\no1 endif\n"), "p.nc:1:1: error: IF has no [value] [statement]");
  EXPECT_EQ(said("o1 endsub\n"),
            "p.nc:1:1: error: O1 ENDSUB closes nothing; O1 SUB was expected before it [statement]");
  EXPECT_EQ(said("o1 break\n"), "p.nc:1:1: error: O1 BREAK is in no loop of this number [statement]");
  EXPECT_EQ(said("o1 else\n"), "p.nc:1:1: error: O1 ELSE without an IF of its own before it [statement]");
  EXPECT_EQ(said("o1 if [1]\no1 else\no1 else\no1 endif\n"),
            "p.nc:3:1: error: O1 ELSE behind ELSE; ENDIF was expected [statement]");
  EXPECT_EQ(said("G0 X1\nsub\n"),
            "p.nc:2:1: error: SUB without its O number; O100 SUB or O<name> SUB was expected "
            "[statement]");
  EXPECT_EQ(said("o5 call\n"),
            "p.nc:1:1: error: there is no O5 SUB in the program, and no file 5.ngc with one beside it [subprogram]");
}

TEST(NcMacro, TellsWhatIsWrongWithCalls) {
  EXPECT_EQ(said("M98\n"),
            "p.nc:1:1: error: M98 without a number; P with the number of the subprogram was expected [subprogram]");
  EXPECT_EQ(said("G65 A1\n"),
            "p.nc:1:1: error: G65 without a number; P with the number of the subprogram was expected [subprogram]");
  EXPECT_EQ(said("M98 P1000"),
            "p.nc:1:5: error: there is no program O1000 in this file, and no file of that name beside it [subprogram]");
  EXPECT_EQ(said("M98 P1\nM30\nO1\nG0 X1\n"),
            "p.nc:4:1: warning: the subprogram has no end; M99 was expected before [program-end]");
  EXPECT_EQ(said("M98 P1\nG0 X1\nO1\nX1\nM99\n"),
            "p.nc:3:1: warning: the program runs into the next one; it is assumed to end here (M30) [program-end]");
  EXPECT_EQ(said("G65 P1 I1 I2 I3 I4 I5 I6 I7 I8 I9 I10 I11\nM30\nO1\nM99\n"),
            "p.nc:1:39: error: more than ten sets of I, J and K [macro-argument]");
}

TEST(NcMacro, ABlankMayStandBetweenTheSignAndTheName) {
  EXPECT_EQ(run_linuxcnc("# <a b> = 3\nX# <ab> Y[# < a b > + 1]\n# 5 = 7\nZ# 5\n"), "3 4 0; 3 4 7");
  EXPECT_EQ(run_linuxcnc("#<c> = 2\nX[EXISTS[# <c>]]\n"), "1 0 0");
}

TEST(NcMacro, CommentsInBracketsStayComments) {
  EXPECT_EQ(run_text("[VECTRIC #5] G1 X1 [TO 5] F100\n"), "1 0 0");
  EXPECT_EQ(run_text("#1 = 1 ( SELECT [ 1=G54, 2=G55 ] )\nX#1"), "1 0 0");
}

}  // namespace
}  // namespace camber::nc
