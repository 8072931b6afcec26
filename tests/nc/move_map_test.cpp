#include "nc/move_map.h"

#include <cmath>

#include <gtest/gtest.h>

#include "nc/emit.h"
#include "nc/interpreter.h"

namespace camber::nc {
namespace {

struct MappedText {
  Program text;
  Interpretation moves;
  explicit MappedText(const std::string& program) {
    Diagnostics diagnostics;
    text = read_program(SourceText("p.nc", program), diagnostics);
    moves = interpret(text, {}, diagnostics);
    EXPECT_FALSE(diagnostics.has_errors());
  }
};

TEST(MoveMap, FindsTheGivenMoveBehindSplitBlocksAndAHeader) {
  const MappedText given("%\nO0001\nG21 G90\nG1 X10. F100\nX20.\nX30.\n%\n");
  EmitOptions options;
  options.header_comment = "ONE\nTWO";
  std::vector<MoveEdit> edits(1);
  edits[0].move = 1;
  edits[0].via = {{Vec3(12.5, 0, 1)}};
  edits[0].end_mm = Vec3(20, 0, 0);
  const Emission emission = emit_edits(given.text, given.moves, edits, options);
  EXPECT_EQ(emission.text, "%\nO0001\n(ONE)\n(TWO)\nG21 G90\nG1 X10. F100\nX12.5 Z1.\nX20. Z0.\nX30.\n%\n");
  const MappedText emitted(emission.text);
  ASSERT_EQ(emitted.moves.moves.size(), 4u);
  const MoveMap map(given.moves, emitted.moves, emission.block_of_line);
  EXPECT_EQ(map.given(0, 0.5).move, 0u);
  EXPECT_EQ(map.given(1, 1).move, 1u);
  EXPECT_EQ(map.given(2, 1).move, 1u);
  EXPECT_EQ(map.given(3, 0).move, 2u);
  const double first = std::hypot(2.5, 1), second = std::hypot(7.5, 1);
  EXPECT_NEAR(map.given(1, 1).fraction, first / (first + second), 1e-9);
  EXPECT_NEAR(map.given(2, 0).fraction, first / (first + second), 1e-9);
  EXPECT_NEAR(map.given(2, 1).fraction, 1, 1e-9);
  EXPECT_NEAR(map.given(3, 0.25).fraction, 0.25, 1e-9);
}

TEST(MoveMap, WithoutAnEmissionIsTheProgramItself) {
  const MoveMap map;
  EXPECT_EQ(map.given(7, 0.3).move, 7u);
  EXPECT_DOUBLE_EQ(map.given(7, 0.3).fraction, 0.3);
}

}  // namespace
}  // namespace camber::nc
