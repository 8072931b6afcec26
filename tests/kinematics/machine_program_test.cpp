// A program on one machine: what of it is read, and its moves in each frame.
#include "kinematics/machine_program.h"

#include <string>

#include <gtest/gtest.h>

#include "kinematics/control_options.h"
#include "kinematics/machine_moves.h"
#include "kinematics/offset_check.h"
#include "tests/kinematics/machines.h"

namespace camber::kinematics {
namespace {

constexpr const char* kOffsets = "G21 G90 G94\nG10 L2 P1 X10 Y-20 Z-50\nG10 L1 P1 R90\nT1 M6\nG54\n";

MachineProgram opened(const std::string& text, RotaryWords rotary = RotaryWords::where_named) {
  Diagnostics found;
  MachineProgram out = open_program(SourceText("p.nc", text), tests::sample("table_bc"), {.rotary = rotary}, found);
  EXPECT_FALSE(found.has_errors());
  return out;
}

TEST(ReadingOptions, OnAMachineOfAClassAToolIsAsLongAsItStandsOut) {
  machine::Job job;
  job.machine.path = "preset:any";
  job.tools[4].overhang_mm = 40;
  job.tools[4].holder = {{.length_mm = 35}, {.length_mm = 60}};
  EXPECT_EQ(reading_of(job).tool_offsets.at(4).length_mm, 135);
}

TEST(EmitOptions, DecimalsFollowTheLeastIncrement) {
  machine::Control control;
  const nc::EmitOptions own = decimals_for(control, {});
  EXPECT_EQ(own.decimals_mm, 3);
  EXPECT_EQ(own.decimals_inch, 4);
  control.least_increment_mm = 0.00001;
  EXPECT_EQ(decimals_for(control, {}).decimals_mm, 5);
  EXPECT_EQ(decimals_for(control, {}).decimals_inch, 6);
}

TEST(MachineProgram, MovesOfThreeAxesAreTheSameInEveryFrame) {
  const MachineProgram program = opened(std::string(kOffsets) + "G0 X0 Y0 Z100\nG1 X5 F100\n");
  EXPECT_FALSE(program.turns());
  EXPECT_EQ(program.part_path(), nullptr);
  EXPECT_EQ(&program.moves_in_part(), &program.commanded());
  EXPECT_EQ(&program.moves_in_program(), &program.commanded());
  EXPECT_EQ(&program.moves_of_axes(), &program.commanded());
}

TEST(MachineProgram, AxesThatStayAtZeroDoNotTurn) {
  const std::string text = std::string(kOffsets) + "G43.4 H1\nG0 X0 Y0 Z100 B0 C0\nG1 X5 F100\n";
  EXPECT_FALSE(opened(text).turns());
  EXPECT_TRUE(opened(text, RotaryWords::always).turns());
}

TEST(MachineProgram, EveryViewIsMadeOnceAndCopiesShareIt) {
  const MachineProgram program = opened(std::string(kOffsets) + "G43 H1\nG0 X0 Y0 Z100 B0 C0\nG1 X5 B30 F100\n");
  ASSERT_TRUE(program.turns());
  const MachineProgram copy = program;
  EXPECT_EQ(&program.moves_in_part(), &copy.moves_in_part());
  EXPECT_EQ(&program.moves_of_axes(), &copy.moves_of_axes());
  EXPECT_EQ(program.part_path(), copy.part_path());
  const auto last = static_cast<std::uint32_t>(program.commanded().moves.size() - 1);
  EXPECT_EQ(program.pose_at(last, 1).tip_mm, program.moves_in_part().moves[last].end_mm);
  EXPECT_NE(program.moves_in_part().moves[last].end_mm, program.moves_in_program().moves[last].end_mm);
}

TEST(MachineProgram, AToolLengthIsAskedForWhereTheToolIsOnThePart) {
  const MachineProgram program =
      opened("G21 G90 G94\nG10 L2 P1 X10 Y-20 Z-50\nG54\nT2 M6\nG43 H2\nG0 X0 Y0 Z100\nG1 B30 F100\n");
  Diagnostics times;
  check_offsets(program.text(), program.commanded(), Asked::times, times);
  EXPECT_TRUE(times.all().empty());
  EXPECT_FALSE(offsets_known(program.commanded()));
  Diagnostics part;
  EXPECT_THROW(check_on_part(program, part), InputError);
  ASSERT_EQ(part.all().size(), 1u);
  EXPECT_EQ(part.all()[0].check, "tool-length");
}

}  // namespace
}  // namespace camber::kinematics
