// How the kinds of control differ along the path: each fact, for every row of the table.
#include "kinematics/control_options.h"

#include <gtest/gtest.h>

#include "feedmodel/corner.h"
#include "feedmodel/path_builder.h"
#include "tests/support/test_program.h"

namespace camber::feedmodel {
namespace {

using machine::ControlKind;

machine::Machine machine_with(const ControlKind& kind) {
  machine::Machine m;
  m.control.kind = kind;
  for (machine::Axis& axis : m.axis) axis.max_velocity_mm_per_s = 1000, axis.acceleration_mm_per_s2 = 500;
  return m;
}

std::vector<Segment> segments_of(const nc::Interpretation& program, const machine::Machine& machine) {
  std::vector<Segment> all;
  build_segments(program, machine, [&](const Segment& s) {
    if (s.length_mm > 0) all.push_back(s);
  });
  return all;
}

TEST(ControlOptions, ReadProgramsInTheControlsDialect) {
  for (const ControlKind& kind : machine::control_kinds()) {
    SCOPED_TRACE(kind.name);
    EXPECT_EQ(kinematics::dialect_of(kind).name, kind.nc_dialect);
    nc::InterpreterOptions given{.inch = true, .skip_slash_blocks = true};
    given.dialect = *nc::dialect_named("linuxcnc");
    const nc::InterpreterOptions options = kinematics::interpreter_options(machine_with(kind), given);
    EXPECT_EQ(options.dialect->name, kind.nc_dialect);
    EXPECT_EQ(options.dwell_p_is_ms, kinematics::dialect_of(kind).dwell_p_is_ms);
    EXPECT_EQ(options.inch, true);
    EXPECT_TRUE(options.skip_slash_blocks);
    EXPECT_EQ(kinematics::interpreter_options(machine_with(kind), std::optional<bool>()).inch, std::nullopt);
  }
}

TEST(ControlKinds, MergeWithinThePOfG64IfTheRowSaysSo) {
  nc::ModalState p, q, none, exact;
  p.path_control = q.path_control = none.path_control = nc::PathControl::blend;
  exact.path_control = nc::PathControl::exact_stop;
  p.blend_tolerance_mm = q.blend_tolerance_mm = 0.02;
  q.merge_tolerance_mm = 0.03;
  for (const ControlKind& kind : machine::control_kinds()) {
    SCOPED_TRACE(kind.name);
    machine::Control control = machine_with(kind).control;
    control.merge_tolerance_mm = 0.005;
    EXPECT_EQ(merge_tolerance_mm(p, control), kind.g64_p_merges ? 0.02 : 0.005);
    EXPECT_EQ(merge_tolerance_mm(q, control), 0.03);
    EXPECT_EQ(merge_tolerance_mm(none, control), 0.005);
    EXPECT_EQ(merge_tolerance_mm(exact, control), 0);
  }
}

TEST(ControlKinds, StopBetweenRapidAndFeedIfTheRowSaysSo) {
  tests::TestProgram straight;
  straight.rapid(10, 0, 0).line(20, 0, 0, 6000).line(30, 0, 0, 6000);
  for (const ControlKind& kind : machine::control_kinds()) {
    SCOPED_TRACE(kind.name);
    machine::Machine machine = machine_with(kind);
    machine.control.corner = {.law = machine::CornerLaw::speed_difference, .speed_difference_mm_per_s = 5};
    machine.cycle.rapid_path = machine::RapidPath::linear;  // a dog-leg rests at its end whatever the row says
    const auto segments = segments_of(straight.program, machine);
    ASSERT_EQ(segments.size(), 3u);
    EXPECT_EQ(segments[1].entry_limit_mm_per_s == 0, kind.stops_between_rapid_and_feed);
    EXPECT_GT(segments[2].entry_limit_mm_per_s, 0);  // feed to feed, all straight on
  }
}

TEST(ControlKinds, AccelerateMoreOnHelicesIfTheRowSaysSo) {
  constexpr double kRadius = 5, kRise = 12, kFraction = 0.3;
  const auto turn = [&](double rise) {
    tests::TestProgram p;
    p.line(10, 0, 0, 60000).arc_xy(10, 0, 5, 0, 2 * kPi, 60000);
    p.program.moves.back().end_mm.z() = rise;
    return p.program;
  };
  // Turning takes R / rho of the acceleration, rho the radius of curvature of a helix that rises kRise in one radian.
  const double used = 1 / (1 + kRise * kRise / (kRadius * kRadius));
  for (const ControlKind& kind : machine::control_kinds()) {
    SCOPED_TRACE(kind.name);
    machine::Machine machine = machine_with(kind);
    machine.control.arc_tangential_fraction = kFraction;
    EXPECT_NEAR(segments_of(turn(0), machine).back().acceleration_mm_per_s2, kFraction * 500, 1e-9);
    const Segment helix = segments_of(turn(kRise), machine).back();
    const double in_plane = 2 * kPi * kRadius / helix.length_mm;  // fraction of the path that lies in the plane
    EXPECT_NEAR(helix.acceleration_mm_per_s2,
                500 / in_plane * (kind.helix_rise_frees_acceleration ? std::sqrt(1 - used * used) : kFraction), 1e-9);
  }
}

}  // namespace
}  // namespace camber::feedmodel
