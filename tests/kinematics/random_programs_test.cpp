// Programs of random words: the machine goes on from where it is, whatever the frames.
#include <array>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "base/diagnostics.h"
#include "kinematics/control_options.h"
#include "kinematics/machine_moves.h"
#include "kinematics/pose_track.h"
#include "kinematics/program_joints.h"
#include "kinematics/travel_check.h"
#include "nc/emit.h"
#include "nc/interpreter.h"
#include "nc/summary.h"
#include "tests/kinematics/machines.h"

namespace camber::kinematics {
namespace {

using tests::kMachines;
using tests::sample;

constexpr std::array<std::string_view, 56> kWords{
    "G0",  "G1",   "G2",   "G3",    "G4 P1",  "G28",      "G30",     "G53",  "G53.1", "G54",  "G55", "G68.2",
    "G68", "G69",  "G254", "G255",  "G43 H1", "G43.4 H1", "G234 H1", "G49",  "G80",   "G81",  "G83", "G90",
    "G91", "G93",  "G94",  "G92",   "G52",    "G17",      "G18",     "G60",  "M428",  "M429", "X1.", "Y2.",
    "Z3.", "X-5.", "Y0",   "Z50.",  "A10.",   "B30.",     "B0",      "C90.", "C0",    "I1.",  "J2.", "K3.",
    "R2.", "Q1.",  "P1",   "F100.", "F30",    "I30.",     "J45.",    "T1 M6"};
constexpr std::array kDialects{"fanuc", "haas", "linuxcnc", "mazak"};
/// Sums of increments and the way through a frame and back.
constexpr double kJumpMm = 1e-6;
constexpr double kUnlimited = 1e9;

std::string random_program(std::mt19937& random) {
  std::string text = "G54 G0 X0 Y0 Z50.\n";
  for (auto blocks = 3 + random() % 12; blocks > 0; --blocks) {
    switch (random() % 8) {  // so that more than a few programs make sense
      case 0:
        text += "G68.2 X1. Y2. Z3. I30. J25. K-10.\nG53.1\n";
        break;
      case 1:
        text += "G1 X5. Y6. Z7. F500\n";
        break;
      case 2:
        text += "G69\n";
        break;
      default:
        for (auto words = 1 + random() % 4; words > 0; --words)
          text += std::string(kWords.at(random() % kWords.size())) + " ";
        text += "\n";
    }
  }
  return text;
}

struct Counts {
  std::size_t programs = 0, joined = 0, tilted = 0, dynamic = 0, placed = 0, unplaced = 0;
};

/// Where both ends of two moves are known, the second starts where the first ends. An arc after another tool length is
/// where the program has it.
void expect_no_jump(const machine::Machine& machine, const nc::Interpretation& moves, Counts& counts) {
  ProgramJoints joints(machine, moves);
  Joints last;
  bool known = false;
  double length_mm = 0;
  while (!joints.done()) {
    const MoveJoints& now = joints.next();
    const nc::Move& move = moves.moves[joints.index()];
    const double length = moves.state_of(move).tool_length_mm.value_or(0);
    const bool fixed = length != length_mm && move.arc != nc::Move::kNoArc;
    if (known && now.linear_known && now.start_known && !fixed && now.reach == Reach::reached) {
      const Joints start = joints.at(0);
      ASSERT_LE((start.linear_mm - last.linear_mm).norm(), kJumpMm) << "line " << move.block + 1;
      ASSERT_EQ(start.rotary_rad, last.rotary_rad) << "line " << move.block + 1;
      ++counts.joined;
    }
    known = now.linear_known;
    if (known) last = joints.at(1);
    if (move.kind != nc::MoveKind::dwell) length_mm = length;
  }
}

/// Placed moves follow each other without a jump, also around places that are not known.
void expect_no_jump_when_placed(const machine::Machine& machine, const nc::Interpretation& placed, Counts& counts) {
  ProgramJoints joints(machine, placed, MissingOffset::zero);
  Joints last;
  double length_mm = 0;
  bool reached = true;
  for (bool first = true; !joints.done(); first = false) {
    const MoveJoints& now = joints.next();
    const nc::Move& move = placed.moves[joints.index()];
    const double length = placed.state_of(move).tool_length_mm.value_or(0);
    reached = reached && now.reach == Reach::reached;
    if (!reached) return;
    ASSERT_TRUE(now.linear_known && now.start_known) << "line " << move.block + 1;
    const Vec3 start_mm = joints.programmed_mm(joints.at(0));
    ASSERT_LE((start_mm - move.start_mm).norm(), move.kind == nc::MoveKind::dwell ? kUnlimited : kJumpMm);
    if (!first && !(length != length_mm && move.arc != nc::Move::kNoArc)) {
      ASSERT_LE((joints.at(0).linear_mm - last.linear_mm).norm(), kJumpMm) << "line " << move.block + 1;
      counts.unplaced += move.reference;
    }
    last = joints.at(1);
    if (move.kind != nc::MoveKind::dwell) length_mm = length;
  }
}

/// place_moves changes how moves are written, not where the joints are.
void expect_same_joints_when_placed(const machine::Machine& machine, const nc::Interpretation& named, Counts& counts) {
  nc::Interpretation placed = named;
  place_moves(placed, machine);
  expect_no_jump_when_placed(machine, placed, counts);
  ProgramJoints a(machine, named), b(machine, placed);
  while (!a.done()) {
    const MoveJoints of_a = a.next(), of_b = b.next();
    if (!of_a.linear_known || !of_a.start_known) continue;
    const nc::Move& move = placed.moves[a.index()];
    ASSERT_TRUE(of_b.linear_known && of_b.start_known && !move.reference) << "line " << move.block + 1;
    for (const double u : {0.0, 0.4, 1.0}) {
      ASSERT_LE((a.at(u).linear_mm - b.at(u).linear_mm).norm(), kJumpMm) << "line " << move.block + 1 << " at " << u;
      ASSERT_LE((a.at(u).rotary_rad - b.at(u).rotary_rad).norm(), kJumpMm) << "line " << move.block + 1;
    }
    ++counts.placed;
  }
}

void run(int seed, const machine::Machine& machine, Counts& counts) {
  std::mt19937 random(static_cast<unsigned>(seed));
  const std::string text = random_program(random);
  SCOPED_TRACE("seed " + std::to_string(seed) + "\n" + text);
  nc::InterpreterOptions options{.inch = false};
  options.dialect = *nc::dialect_named(kDialects.at(random() % kDialects.size()));
  options.rotary_axes = rotary_options(machine);
  options.tool_offsets[1].length_mm = 80;
  if (seed % 3 != 0) options.work_offsets_mm[54] = Vec3(1, 2, -300);
  Diagnostics found, travel;
  nc::Program program;
  nc::Interpretation moves;
  try {
    program = nc::read_program(SourceText("r.nc", text), found);
    moves = nc::interpret(program, options, found);
    found.throw_if_errors();
    check_travel(machine, program, moves, travel);
  } catch (const InputError&) {
    return;
  }
  EXPECT_EQ(nc::emit(program, moves, {}, {}), text);
  const nc::Summary summary = nc::summarize(program, moves);
  ++counts.programs;
  counts.tilted += summary.tilted_frame;
  counts.dynamic += summary.dynamic_offset;
  expect_no_jump(machine, moves, counts);
  if (travel.errors() == 0) expect_same_joints_when_placed(machine, moves, counts);
  const PoseTrack track = programmed_track(machine, moves);
  for (const PoseSample& s : track.samples) ASSERT_TRUE(s.joints.linear_mm.allFinite() && s.pose.tip_mm.allFinite());
}

TEST(RandomPrograms, TheMachineGoesOnFromWhereItIs) {
  std::vector<machine::Machine> machines;
  for (const char* name : kMachines) machines.push_back(sample(name));
  Counts counts;
  for (std::size_t seed = 0; seed < 12000 && !HasFailure(); ++seed)
    run(static_cast<int>(seed), machines[seed % machines.size()], counts);
  EXPECT_GT(counts.programs, 300U);
  EXPECT_GT(counts.joined, 500U);
  EXPECT_GT(counts.tilted, 200U);
  EXPECT_GT(counts.dynamic, 5U);
  EXPECT_GT(counts.placed, 500U);
  EXPECT_GT(counts.unplaced, 100U);
}

}  // namespace
}  // namespace camber::kinematics
