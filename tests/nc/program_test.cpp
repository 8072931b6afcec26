#include "nc/program_text.h"

#include <fmt/format.h>

#include <random>

#include "nc/emit.h"
#include "nc/language.h"
#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

/// "G1 X-0.5": letters and values of a block.
std::string words_text(const Program& p, std::size_t block) {
  std::string out;
  for (const Word& w : p.words_of(block)) out += fmt::format("{}{}{}", out.empty() ? "" : " ", w.letter, w.value);
  return out;
}

std::string words_of_line(const std::string& line) {
  Diagnostics d;
  const Program p = read_program(SourceText("p.nc", line), d);
  EXPECT_TRUE(d.all().empty()) << to_string(d.all().front());
  return words_text(p, 0);
}

std::string complaint(const std::string& text) {
  const Read r = read_text(text);
  return r.messages.empty() ? "" : r.messages.front();
}

TEST(NcReader, SplitsWordsWithoutBlanks) { EXPECT_EQ(words_of_line("N110G0G17G40X1.Y.5"), "N110 G0 G17 G40 X1 Y0.5"); }
TEST(NcReader, TakesLowerCaseBlanksAndTabs) { EXPECT_EQ(words_of_line("g1\tx 1 . 5 y- 2 f 1 00"), "G1 X1.5 Y-2 F100"); }
TEST(NcReader, TakesSignsAndNumbersWithoutDigitsOnOneSide) {
  EXPECT_EQ(words_of_line("X+.5Y-.25Z1.I-0."), "X0.5 Y-0.25 Z1 I-0");
}
TEST(NcReader, TakesNineDecimalsAndMore) {
  EXPECT_EQ(words_of_line("X1.123456789"), "X1.123456789");
  EXPECT_EQ(words_of_line("X0.1234567890123456789012"), "X0.12345678901234568");
}
TEST(NcReader, LeavesOutCommentsOfAllKinds) {
  EXPECT_EQ(words_of_line("G1(a (nested) one)X1(b)[bracket 12.104\" x] Y2 ; Z3 (rest)"), "G1 X1 Y2");
  EXPECT_EQ(words_of_line("X1(\xC3\x9Cmlaut \xB0)"), "X1");
  EXPECT_EQ(words_of_line("G1 X1 (open ( inside)"), "G1 X1");
}
TEST(NcReader, TakesBlockSkipPercentAndProgramNumbers) {
  Diagnostics d;
  const Program p =
      read_program(SourceText("p.nc", "%\r\nO0001(PART)\r\n/ M08\r\n/2G1X1\r\n:12\r\n<NAME>\r\n%\r\n"), d);
  EXPECT_TRUE(d.all().empty());
  ASSERT_EQ(p.blocks.size(), 7u);
  EXPECT_EQ(words_text(p, 1), "O1");
  EXPECT_TRUE(p.blocks[2].skip);
  EXPECT_TRUE(p.blocks[3].skip);
  EXPECT_EQ(words_text(p, 3), "G1 X1");
  EXPECT_EQ(words_text(p, 4), "O12");
  EXPECT_EQ(p.blocks[1].length, 11u);  // without the carriage return
}
TEST(NcReader, KeepsThePlaceOfEveryWord) {
  Diagnostics d;
  const Program p = read_program(SourceText("p.nc", "G1\n  X -1.5Y2\n"), d);
  const auto words = p.words_of(1);
  ASSERT_EQ(words.size(), 2u);
  EXPECT_EQ(words[0].offset, 5u);
  EXPECT_EQ(words[0].value_at, 2u);
  EXPECT_EQ(words[0].length, 6u);
  EXPECT_EQ(words[1].offset, 11u);
}
TEST(NcReader, TakesLongLinesAndAByteOrderMark) {
  EXPECT_EQ(words_of_line("\xEF\xBB\xBFG1" + std::string(100000, ' ') + "X1(" + std::string(100000, 'x') + ")"),
            "G1 X1");
}

TEST(NcReader, RefusesANumberFarBehindItsLetter) {
  EXPECT_EQ(words_of_line("G0 X" + std::string(254, ' ') + "5"), "G0 X5");
  EXPECT_EQ(read_text("G0 X" + std::string(300, ' ') + "5\n").messages,
            std::vector<std::string>{"p.nc:1:4: error: more than 255 blanks between X and its number [word-too-long]"});
}

TEST(NcReader, RefusesAnEmptyFile) {
  EXPECT_EQ(complaint(""), "p.nc: error: the file is empty; an NC program was expected [empty-program]");
  EXPECT_EQ(complaint("\r\n \n"), "p.nc: error: the file is empty; an NC program was expected [empty-program]");
  EXPECT_EQ(complaint("%\n(only a comment)\n"),
            "p.nc: error: the file has no NC words; an NC program was expected [empty-program]");
}
TEST(NcReader, RefusesWhatIsNoNumber) {
  EXPECT_EQ(complaint("G1 XNAN"),
            "p.nc:1:4: error: XNAN is not a number; a number such as X12.5 was expected [not-a-number]");
  EXPECT_EQ(complaint("G1 Xinf"),
            "p.nc:1:4: error: XINF is not a number; a number such as X12.5 was expected [not-a-number]");
  EXPECT_EQ(complaint("G1 X Y2"), "p.nc:1:4: error: X has no number; a number was expected [no-number]");
  EXPECT_EQ(complaint("G1 X-"), "p.nc:1:4: error: X has no number; a number was expected [no-number]");
  EXPECT_EQ(complaint("G0 X1.2.3"),
            "p.nc:1:8: error: `.` is not expected here; a word (a letter and a number) or a comment was expected "
            "[unexpected-character]");
  EXPECT_EQ(complaint("G0 X1\xE4"),
            "p.nc:1:6: error: byte 0xE4 is not expected here; a word (a letter and a number) or a comment was expected "
            "[unexpected-character]");
}
TEST(NcReader, RefusesACommentWithoutAnEnd) {
  EXPECT_EQ(complaint("G0 X1 (no end"), "p.nc:1:7: error: the comment has no closing `)` in its block [comment-open]");
}
/// What is said of a text that is read as ISO whatever it shows.
std::vector<std::string> complaints_as_iso(const std::string& text) {
  std::vector<std::string> out;
  Diagnostics diagnostics;
  try {
    read_program(SourceText("p.nc", text), LanguageId::iso, diagnostics);
  } catch (const InputError& e) {
    for (const Diagnostic& d : e.diagnostics()) out.push_back(headline(d));
  }
  return out;
}

TEST(NcReader, NamesTheLanguageOfOtherControlsAndStops) {
  EXPECT_EQ(complaints_as_iso("N10 G17\nN20 SUPA G0 Z=_Z_HOME D0\nN30 T=\"MILL\"\n"),
            std::vector<std::string>{
                "p.nc:2:5: error: SUPA belongs to Siemens Sinumerik programs, and this text is read as ISO G code; "
                "--dialect siemens reads it in that language [siemens]"});
  EXPECT_EQ(complaints_as_iso("T=\"MILL\""),
            std::vector<std::string>{
                "p.nc:1:1: error: T= belongs to Siemens Sinumerik programs, and this text is read as ISO G code; "
                "--dialect siemens reads it in that language [siemens]"});
  EXPECT_EQ(complaints_as_iso("BEGIN PGM PART MM"),
            std::vector<std::string>{
                "p.nc:1:1: error: BEGIN belongs to Heidenhain Klartext programs, and this text is read as ISO G code; "
                "--dialect heidenhain reads it in that language [heidenhain]"});
  EXPECT_EQ(complaints_as_iso("N10 G200\nQ200=3.\nQ201=-12.5\n"),
            std::vector<std::string>{
                "p.nc:2:1: error: Q200= is of a cycle in a DIN/ISO program of a Heidenhain control, which is not "
                "supported; the program in Klartext was expected [not-supported]"});
}
TEST(NcReader, TakesMissingNumbersOfMinorWordsAsZeroAndWarns) {
  const Read r = read_text("G21 G99 G82 X1 Y1 Z-1 R1 P F15.04");
  EXPECT_EQ(r.messages.at(0), "p.nc:1:26: warning: P has no number; it is taken as P0 [no-number]");
}
TEST(NcReader, GivesUpAfterTwentyDifferentErrors) {
  std::string text;
  for (int i = 0; i < 100; ++i) text += fmt::format("G1 X1 {}\n", static_cast<char>(0x80 + i % 26));
  EXPECT_EQ(read_text(text).messages.size(), 20u);
}

TEST(NcReader, TextBehindTheEndIsNoProgram) {
  const std::string text = "%\nO1\nG21 G90\nG0 X1\nM30\nprint[\"Hello\"]\nT=\"MILL\" #<\n%\nX[1\n";
  const Read r = read_clean(text);
  EXPECT_EQ(r.moves.moves.size(), 1u);
  EXPECT_EQ(emit(r.program, r.moves, {}, {}), text);
  EXPECT_EQ(read_text("G0 X1\nM02\nprint[\"Hello\"]\n").messages, std::vector<std::string>{});
  // A subprogram behind it is read, and so is everything where GOTO may go there.
  EXPECT_EQ(read_text("G0 X1\nM30\nO7\nprint[\"Hello\"]\nM99\n").messages.size(), 1u);
  EXPECT_EQ(read_text("#1=0\nIF[#1EQ1]GOTO9\nG0 X1\nM30\nN9 print[\"Hello\"]\n").messages.size(), 1u);
  EXPECT_EQ(read_text("G0 X1\nprint[\"Hello\"]\nM30\n").messages.size(), 1u);
}

/// Real-looking text with random bytes in it: any answer but a crash or a hang.
TEST(NcReader, NoTextMakesItCrash) {
  const std::string seed =
      "%\nO1(A)\nN1G20G0G90G54X-1.5Y.5S100M3\nG1Z-1.F10.\nG3X1.Y2.I.5J0P2\nG2R5.X3.\nG91G28Z0.M9\n/G83X1Z-2R1Q.1L3\n"
      "G4P1\nG64P.01Q.1\nG53Z0\nG10L2P1X0\n#1=[2+3]\nIF[#1EQ1]GOTO5\nT=\"A\"\nM30\n%";
  std::mt19937 random(17);
  for (int i = 0; i < 5000; ++i) {
    std::string text = seed;
    for (int k = 0; k < 1 + i % 9; ++k) {
      const std::size_t at = random() % text.size();
      if (random() % 3 == 0)
        text.erase(at, random() % 6);
      else if (random() % 2 == 0)
        text[at] = static_cast<char>(random() % 256);
      else
        text.insert(at, seed, random() % seed.size(), random() % 9);
      if (text.empty()) text = seed;
    }
    const Read r = read_text(text, {});
    for (const Move& m : r.moves.moves) ASSERT_TRUE(m.end_mm.allFinite());
  }
}

TEST(Program, ATextBehindTheFirstPercentIsItsName) {
  for (const char* first : {"%1234", "% PART 7 / SIDE 2", "%O1234", "%", "% (PART)"}) {
    SCOPED_TRACE(first);
    const Read r = read_clean(std::string(first) + "\nG21 G90 G0 X1. Y2. Z3.\nM30\n%\n");
    ASSERT_EQ(r.moves.moves.size(), 1u);
    expect_near_mm(r.moves.moves[0].end_mm, {1, 2, 3});
  }
}

}  // namespace
}  // namespace camber::nc
