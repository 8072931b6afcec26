#include "calib/protocol_programs.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "base/units.h"
#include "kinematics/control_options.h"
#include "nc/interpreter.h"
#include "nc/program_text.h"
#include "test_paths.h"

namespace camber::calib {
namespace {

nc::Interpretation read_back(const ProtocolProgram& program, const machine::Machine& machine) {
  Diagnostics diagnostics;
  const auto text = nc::read_program(SourceText(program.name, program.text), diagnostics);
  nc::InterpreterOptions options;
  options.rotary_axes = kinematics::rotary_options(machine);
  auto moves = nc::interpret(text, kinematics::interpreter_options(machine, options), diagnostics);
  EXPECT_TRUE(diagnostics.all().empty()) << program.name << ": " << to_string(diagnostics.all().front());
  return moves;
}

const ProtocolProgram& named(const std::vector<ProtocolProgram>& programs, const std::string& name) {
  for (const ProtocolProgram& p : programs)
    if (p.name == name) return p;
  ADD_FAILURE() << "no " << name;
  return programs.front();
}

machine::Machine machine_of(std::string_view control) {
  machine::Machine m;
  m.control.kind = *machine::control_kind_named(control);
  return m;
}

TEST(Protocol, IsReadWithoutADiagnosticByItsOwnDialect) {
  for (const machine::ControlKind& kind : machine::control_kinds()) {
    SCOPED_TRACE(kind.name);
    machine::Machine machine = machine_of(kind.name);
    machine.path = "machine.toml";
    for (const ProtocolProgram& program : protocol_programs(machine))
      EXPECT_GT(read_back(program, machine).moves.size(), 10u) << program.name;
  }
}

TEST(Protocol, PolygonsAreThoseOfTheKakenReport) {
  const machine::Machine machine = machine_of("fanuc");
  const auto programs = protocol_programs(machine);
  for (const char* name : {"protocol_xy.nc", "protocol_yz.nc", "protocol_zx.nc"}) {
    const ProtocolProgram& program = named(programs, name);
    EXPECT_EQ(program.parts.size(), 7u * 5u * 4u);
    const nc::Interpretation moves = read_back(program, machine);
    for (const ProtocolPart& part : program.parts) {
      const nc::Move* before = nullptr;
      for (const nc::Move& move : moves.moves) {
        const int line = static_cast<int>(move.block) + 1;
        if (line < part.line_first || line > part.line_last) continue;
        EXPECT_NEAR(length_mm(moves, move), part.size_mm, 2e-6);
        EXPECT_NEAR(move.feed_mm_per_s, mm_per_s_from_mm_per_min(part.feed_mm_per_min), 1e-9);
        if (before) {
          const double dot = direction_at(moves, *before, 1).dot(direction_at(moves, move, 0));
          EXPECT_NEAR(deg_from_rad(std::acos(std::clamp(dot, -1.0, 1.0))), part.angle_deg, 0.01);
        }
        before = &move;
      }
      ASSERT_NE(before, nullptr);
      EXPECT_NEAR(before->end_mm.norm(), 0, 1e-4);  // closed
    }
  }
}

TEST(Protocol, SaturationHasEveryChordAndStaysUnderTheTopSpeed) {
  machine::Machine machine = machine_of("fanuc");
  for (machine::Axis& axis : machine.axis) axis.max_velocity_mm_per_s = 50;
  const ProtocolProgram program = named(protocol_programs(machine), "saturation.nc");
  std::set<double> chords;
  for (const ProtocolPart& part : program.parts) {
    chords.insert(part.size_mm);
    EXPECT_DOUBLE_EQ(part.feed_mm_per_min, 3000);
  }
  EXPECT_EQ(chords, (std::set<double>{0.01, 0.02, 0.04, 0.06, 0.1, 0.2, 0.3, 0.5}));
}

/// Each axis alone, within its travel; where blocks overlap once more on the exact path.
TEST(Protocol, RotaryAxesTurnAlone) {
  Diagnostics diagnostics;
  for (const bool overlap : {false, true}) {
    machine::Machine machine =
        machine::read_machine(CAMBER_SOURCE_DIR "/samples/machines/linuxcnc_five_axis.toml", diagnostics);
    machine.control.kind = *machine::control_kind_named(overlap ? "linuxcnc" : "fanuc");
    machine.rotary[0].travel_rad = {rad_from_deg(-100), rad_from_deg(30)};
    const ProtocolProgram program = named(protocol_programs(machine), overlap ? "rotary.ngc" : "rotary.nc");
    EXPECT_EQ(program.parts.size(), overlap ? 2U * 4U * 5U : 2U * 4U * 4U);
    EXPECT_EQ(program.text.find("G61") != std::string::npos, overlap);
    const nc::Interpretation moves = read_back(program, machine);
    EXPECT_EQ(moves.rotary.size(), 4 * program.parts.size());
    for (const nc::RotaryTarget& target : moves.rotary) {
      EXPECT_TRUE(target.end.x() == 0 || target.end.z() == 0);
      EXPECT_GE(target.end.x(), rad_from_deg(-90.001));
      EXPECT_LE(target.end.x(), rad_from_deg(30));
    }
  }
}

TEST(Protocol, PartsListNamesTheLines) {
  const ProtocolProgram program = named(protocol_programs(machine_of("linuxcnc")), "protocol_xy.ngc");
  EXPECT_EQ(parts_csv(program).substr(0, 85),
            "line_first,line_last,angle_deg,feed_mm_min,plane,size_mm\n6,41,10,100,xy,0.5\n44,79,10,");
}

}  // namespace
}  // namespace camber::calib
