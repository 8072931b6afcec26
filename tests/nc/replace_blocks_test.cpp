// Stretches of blocks become other lines; everything else stays byte for byte.
#include <array>

#include <gtest/gtest.h>

#include "nc/emit.h"
#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

TEST(ReplaceBlocks, KeepsLineEndsAndTheRest) {
  const Read r = read_text("%\r\nG21 ( one )\r\nG1 X1. F9\r\nX2.\r\nX3.");
  EXPECT_EQ(replace_blocks(r.program, {}), r.program.source.text());
  const std::array two{BlockReplacement{1, 1, {"G21", "G90"}}, BlockReplacement{3, 4, {"X4."}}};
  EXPECT_EQ(replace_blocks(r.program, two), "%\r\nG21\r\nG90\r\nG1 X1. F9\r\nX4.");
  const std::array last{BlockReplacement{4, 4, {"X4.", "X5."}}};
  EXPECT_EQ(replace_blocks(r.program, last), "%\r\nG21 ( one )\r\nG1 X1. F9\r\nX2.\r\nX4.\r\nX5.");
}

}  // namespace
}  // namespace camber::nc
