// Edits of programs with loops, subprograms and expressions.
#include <random>

#include "nc/emit.h"
#include "tests/nc/macro_text.h"

namespace camber::nc {
namespace {

std::vector<bool> editable_moves(const Read& r) {
  std::vector<bool> out;
  for (const Move& m : r.moves.moves) out.push_back(m.editable);
  return out;
}

/// Every move's end shifted by a quarter in X.
std::string all_shifted(const Read& r) {
  std::vector<MoveEdit> edits;
  for (std::uint32_t m = 0; m < r.moves.moves.size(); ++m)
    edits.push_back({.move = m, .end_mm = r.moves.moves[m].end_mm + Vec3(0.25, 0, 0)});
  return emit(r.program, r.moves, edits, {});
}

TEST(MacroEmit, ASubprogramThatRunsOnceIsEditedWhereItStands) {
  const Read r = read_clean("G0 X0 Y0 Z0\nM98 P7\nG1 X5 F100\nM30\nO7\nG1 X1 F100\nX2\nM99\n", as("fanuc"));
  EXPECT_EQ(editable_moves(r), (std::vector<bool>{true, true, true, true}));
  EXPECT_EQ(all_shifted(r), "G0 X0.25 Y0 Z0\nM98 P7\nG1 X5.25 F100\nM30\nO7\nG1 X1.25 F100\nX2.25\nM99\n");
}

TEST(MacroEmit, LoopsRepeatedSubprogramsAndExpressionsStayAsTheyAre) {
  const std::string text =
      "G0 X0 Y0 Z0\nG1 X1 F100\n#1=3\nX#1\nX[2+2] F#1\nWHILE[#1GT1]DO1\nX9\n#1=#1-1\nEND1\nM98 P7 L2\nX5\nM30\nO7\nY1\n"
      "Y0\nM99\n";
  const Read r = read_clean(text, as("fanuc"));
  EXPECT_EQ(editable_moves(r),
            (std::vector<bool>{true, true, false, false, false, false, false, false, false, false, true}));
  std::string wanted = text;
  wanted.replace(wanted.find("X0 "), 3, "X0.25 ");
  wanted.replace(wanted.find("X1 F"), 4, "X1.25 F");
  wanted.replace(wanted.find("X5\n"), 3, "X5.25\n");
  EXPECT_EQ(all_shifted(r), wanted);
  EXPECT_EQ(emit(r.program, r.moves, {}, {}), text);

  Diagnostics diagnostics;
  warn_of_uneditable(r.program, r.moves, std::vector<bool>(r.moves.moves.size(), true), diagnostics);
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(headline(diagnostics.all()[0]),
            "p.nc:4:1: warning: 8 cutting moves from here on are made by a loop, an expression, a corner word, a line "
            "of several blocks, numbers in least increments, or a subprogram that is called more than once or is in "
            "another file; the text has no words of their own, so they stay unchanged [not-editable]");
}

TEST(MacroEmit, CyclesAreNoWarningAndWholeIncrementsAreNotEdited) {
  const Read r = read_clean("G0 X0 Y0 Z5.\nG81 X1. Y1. Z-1. R1. F100\nG80\nX2.\n", as("fanuc"));
  Diagnostics diagnostics;
  warn_of_uneditable(r.program, r.moves, std::vector<bool>(r.moves.moves.size(), true), diagnostics);
  EXPECT_TRUE(diagnostics.all().empty());
  InterpreterOptions options = as("fanuc");
  options.whole_numbers_are_increments = true;
  EXPECT_EQ(editable_moves(read_clean("G0 X0 Y0 Z0\nX1000\nX2.\n", options)), (std::vector<bool>{true, false, true}));
}

TEST(MacroEmit, ALineBroughtBackBehindALoop) {
  // The edit before the loop shifts X; the loop moves Y by increments; the line behind names Y only.
  const Read r = read_clean("G0 X0 Y0 Z0\nG1 X1 F100\nG91\no1 repeat [2]\nY1\no1 endrepeat\nG90\nY5\n", as("linuxcnc"));
  EXPECT_EQ(emit(r.program, r.moves, std::vector<MoveEdit>{{.move = 1, .end_mm = Vec3(1.25, 0, 0)}}, {}),
            "G0 X0 Y0 Z0\nG1 X1.25 F100\nG91\no1 repeat [2]\nY1\no1 endrepeat\nG90\nX1 Y5\n");
}

/// Real-looking macros with random bytes in them: any answer but a crash or a hang.
TEST(MacroEmit, NoTextMakesItCrash) {
  const std::string seed =
      "O1\nG21 G0 X0 Y0 Z0 F100\n#1=[2+3]*SIN[#2]\nWHILE[#1LT9]DO1\nG1X#1Y[#5001+1]\n#1=#1+1\nEND1\nIF[#1EQ1]GOTO5\n"
      "IF[#1NE#0]THEN#2=ATAN[1]/[2]\nN5G65P2A1I2J3I4\nG66P2\nX1\nG67\nM98P2L2\nM97P5\no3 if [EXISTS[#<a>]]\no3 else\n"
      "#<_b>=1\no3 endif\no4 repeat [2]\no4 break\no4 endrepeat\no<s> sub\no<s> endsub [1]\no<s> call [1][2]\nM30\nO2\n"
      "/2X[#1]\n#3000=1(X)\nM99\n";
  std::mt19937 random(23);
  for (int i = 0; i < 4000; ++i) {
    std::string text = seed;
    for (int k = 0; k < 1 + i % 12; ++k) {
      const std::size_t at = random() % text.size(), from = random() % seed.size();
      if (random() % 3 == 0)
        text.erase(at, random() % 9);
      else if (random() % 3 == 0)
        text[at] = static_cast<char>(random() % 256);
      else
        text.insert(at, seed, from, random() % 14);
      if (text.empty()) text = seed;
    }
    InterpreterOptions options = as(i % 2 == 0 ? "fanuc" : "linuxcnc");
    options.max_repeated_blocks = 300;
    const Read r = read_text(text, options);
    for (const Move& m : r.moves.moves) ASSERT_TRUE(m.end_mm.allFinite());
    if (!r.moves.moves.empty()) all_shifted(r);
  }
}

}  // namespace
}  // namespace camber::nc
