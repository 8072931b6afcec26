// What the program asks of the machine beside moving.
#include "nc/event.h"

#include <gtest/gtest.h>

#include "tests/support/nc_program.h"

namespace camber::nc {
namespace {

using tests::interpreted;

/// "kind value block before_move", events one below the other.
std::string events_of(const std::string& text, const InterpreterOptions& options = {}) {
  static constexpr const char* kNames[] = {"T", "M6", "S", "M3", "M4", "M5", "M19", "M", "B", "M60"};
  std::string out;
  for (const Event& e : interpreted(text, options).events)
    out += std::string(kNames[static_cast<int>(e.kind)]) + " " + std::to_string(static_cast<int>(e.value)) + " " +
           std::to_string(e.block) + " " + std::to_string(e.before_move) + "\n";
  return out;
}

TEST(Events, StandInTheOrderInWhichTheControlActs) {
  EXPECT_EQ(events_of("T3 M6\nG0 X1 S800 M3\nM8\nG1 X2 F100\nM30\n"),
            "T 3 0 0\nM6 3 0 0\nS 800 1 0\nM3 3 1 0\nM 8 2 1\nM 30 4 2\n");
}

TEST(Events, CodesThatActAtTheEndStandBehindTheMotionOfTheirBlock) {
  EXPECT_EQ(events_of("G0 X1 M5\nX2 M9\nX3 M19\nM60\n"), "M5 5 0 1\nM 9 1 2\nM19 19 2 2\nM60 60 3 3\n");
}

TEST(Events, AnIndexTableMakesBAnEvent) {
  InterpreterOptions options;
  options.index_table = true;
  EXPECT_EQ(events_of("G0 B90\nG0 X1\nB180\n", options), "B 90 0 0\nB 180 2 1\n");
  EXPECT_THROW(events_of("G0 B90\n"), InputError);
}

}  // namespace
}  // namespace camber::nc
