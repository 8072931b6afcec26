#include "compensate/outcome.h"

#include <gtest/gtest.h>

#include "nc/interpreter.h"

namespace camber::compensate {
namespace {

TEST(NotEmitted, OneWarningForEachKindWithItsLines) {
  std::string text = "G21 G0X0Y0Z5.\nG99G81X1.Z-3.R1.F100\nX2.\nG80\n";
  for (int i = 0; i < 10; ++i) text += "G4P1.\n";
  Diagnostics diagnostics;
  const nc::Program program = nc::read_program(SourceText("p.nc", text), diagnostics);
  const nc::Interpretation moves = nc::interpret(program, {}, diagnostics);
  std::vector<nc::MoveEdit> edits;
  for (std::uint32_t m = 1; m < moves.moves.size(); ++m)
    edits.push_back({.move = m, .end_mm = moves.moves[m].end_mm + Vec3(0.1, 0, 0)});
  const nc::Emission emission = nc::emit_edits(program, moves, edits, {});
  EXPECT_EQ(emission.text, text);
  ASSERT_TRUE(diagnostics.all().empty());
  warn_of_not_emitted(program, moves, emission.not_made, diagnostics);
  ASSERT_EQ(diagnostics.all().size(), 2u);
  EXPECT_EQ(to_string(diagnostics.all()[0]),
            "p.nc:2:1: warning: shifts are not written where the move belongs to a drilling cycle: lines 2, 3 "
            "[not-emitted]\n    G99G81X1.Z-3.R1.F100\n    ^");
  EXPECT_EQ(to_string(diagnostics.all()[1]),
            "p.nc:5:1: warning: shifts are not written where the move belongs to a dwell: lines 5, 6, 7, 8, 9, 10, 11, "
            "12 and 2 more [not-emitted]\n    G4P1.\n    ^");
}

}  // namespace
}  // namespace camber::compensate
