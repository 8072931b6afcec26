#include "repath/post/post_processing.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/units.h"
#include "kinematics/feed_meaning.h"
#include "kinematics/travel_check.h"
#include "repath/path_deviation.h"
#include "tests/kinematics/machines.h"
#include "tests/repath/five_axis_program.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_data.h"

namespace camber::repath {
namespace {

using kinematics::tests::sample;

using Read = tests::FiveAxisProgram;
using tests::read_five_axes;

Posted posted(const Read& given, const machine::Machine& machine, const PostOptions& options = {}) {
  Diagnostics diagnostics;
  Posted out = post(given.program, given.moves, machine, options, diagnostics);
  diagnostics.throw_if_errors();
  return out;
}

std::string text_of(const std::string& text, const machine::Machine& machine, const PostOptions& options = {}) {
  return posted(read_five_axes(text, machine), machine, options).text;
}

std::string said(const std::string& text, const machine::Machine& machine, const PostOptions& options = {}) {
  Diagnostics diagnostics;
  const Read given = read_five_axes(text, machine);
  post(given.program, given.moves, machine, options, diagnostics);
  std::string out;
  for (Diagnostic d : diagnostics.all()) {
    d.source_line.clear();
    out += to_string(d) + "\n";
  }
  return out;
}

/// Seconds that F asks for, of every line and arc.
double commanded_s(const Read& r, const machine::Machine& machine) {
  kinematics::ProgramJoints joints(machine, r.moves);
  double sum = 0;
  while (!joints.done()) {
    const kinematics::MoveJoints now = joints.next();
    const nc::Move& m = r.moves.moves[joints.index()];
    if (m.kind != nc::MoveKind::linear && m.kind != nc::MoveKind::arc) continue;
    const Vec3 turn = now.end_rad - now.start_rad;
    const double linear = nc::length_mm(r.moves, m), length = linear < 1e-9 ? deg_from_rad(turn.norm()) : linear;
    if (length > 0) sum += length / kinematics::feed_along_path(r.moves, m, turn, now.g93_time_s, machine.control);
  }
  return sum;
}

std::vector<std::string> five_axis_programs() {
  std::vector<std::string> out;
  for (const std::string& path : tests::data_files("linuxcnc5/programs"))
    if (path.ends_with(".ngc")) out.push_back(path);
  return out;
}

machine::Machine fanuc_table() {
  machine::Machine machine = sample("table_bc");
  Diagnostics diagnostics;
  machine.control = machine::read_machine(CAMBER_SOURCE_DIR "/samples/12-five-axis/machine.toml", diagnostics).control;
  return machine;
}

constexpr const char* kHead = "G21 G17 G90 G94\nG54\nT1 M6\nG0\n";

// --- text

TEST(Post, ChangesNothingButTheWordsOfPlacesAndCodes) {
  const machine::Machine machine = fanuc_table();
  const std::string text = std::string(kHead) +
                           "N10 G43.4 H1 X0. Y0. Z50. (above)\n"
                           "N20 G1 X10. F600 M8 (cut)\n"
                           "(a comment)\n"
                           "N30 B0.5 C0.25 F500. M9\n"
                           "N40 G49\n"
                           "N50 G0 G53 Z0.\n"
                           "M30\n";
  EXPECT_EQ(text_of(text, machine), std::string(kHead) +
                                        "N10 G43 H1 X0. Y0. Z50. B0. C0. (above)\n"
                                        "N20 G1 X10. F600 M8 (cut)\n"
                                        "(a comment)\n"
                                        "N30 B0.5 C0.25 X8.2329 Z49.9922 F1657.8 M9\n"
                                        "N40 G49\n"
                                        "N50 G0 G53 Z0.\n"
                                        "M30\n");
}

TEST(Post, MovesWordsThatActAtTheEndToTheLastBlock) {
  const machine::Machine machine = fanuc_table();
  const std::string text =
      text_of(std::string(kHead) + "G43.4 H1 X0. Y0. Z50.\nG1 X10. B4. F600 M9 (cut)\nG49\nM30\n", machine);
  EXPECT_EQ(text.find("M9 (cut)"), std::string::npos);
  EXPECT_NE(text.find(" (cut)\n"), std::string::npos);
  EXPECT_NE(text.find(" M9\nG49\n"), std::string::npos);
}

TEST(Post, GivesTheFeedBackToBlocksThatRelyOnIt) {
  const machine::Machine machine = fanuc_table();
  const std::string text =
      text_of(std::string(kHead) + "G43.4 H1 X0. Y0. Z50.\nG1 X10. F600\nB4.\nG49\nG1 X20. Y0. Z60.\nM30\n", machine);
  EXPECT_NE(text.find("\nF600\nG49\nG1 X20."), std::string::npos) << text;
}

TEST(Post, WritesInverseTimeAndGoesBackToTheModeOfTheProgram) {
  const machine::Machine machine = fanuc_table();
  const std::string text =
      text_of(std::string(kHead) + "G43.4 H1 X0. Y0. Z50.\nG1 X10. F600\nX20.\nG49\nG1 X20. Y0. Z60.\nM30\n", machine,
              {.inverse_time = true});
  EXPECT_EQ(text, std::string(kHead) +
                      "G43 H1 X0. Y0. Z50. B0. C0.\n"
                      "G93\nG1 X10. F60\nX20. F60\nG94 F600\n"
                      "G49\nG1 X20. Y0. Z60.\nM30\n");
}

TEST(Post, BackToTheTipSwitchesControlOnAndOff) {
  const machine::Machine machine = fanuc_table();
  const std::string text =
      text_of(std::string(kHead) + "G43 H1\nG0 X0. Y0. Z50. B0. C0.\nG0 B0.5\nG1 X1. F600\nG0 B0.\nG0 Z60.\nM30\n",
              machine, {.target = PostTarget::tcp});
  EXPECT_NE(text.find("Z50. B0. C0.\nG43.4 H1\nG0 B0.5 X"), std::string::npos) << text;
  EXPECT_NE(text.find("\nG43 H1\nG0 Z60.\nM30\n"), std::string::npos) << text;
}

TEST(Post, WritesIncrementsInG91) {
  const machine::Machine machine = fanuc_table();
  const std::string head = std::string(kHead) + "G43.4 H1 X0. Y0. Z50. B10. C0.\nG1 F600\n";
  const Read absolute = read_five_axes(head + "X10. C20.\nX20. C40.\nG49\nG53 Z0\nM30\n", machine);
  const Read steps = read_five_axes(head + "G91 X10. C20.\nX10. C20.\nG90 G49\nG53 Z0\nM30\n", machine);
  const Read a = read_five_axes(posted(absolute, machine).text, machine),
             b = read_five_axes(posted(steps, machine).text, machine);
  ASSERT_EQ(a.moves.moves.size(), b.moves.moves.size());
  for (std::size_t i = 0; i < a.moves.moves.size(); ++i)
    EXPECT_LT((a.moves.moves[i].end_mm - b.moves.moves[i].end_mm).norm(), 1e-9) << i;
}

TEST(Post, FollowsArcs) {
  const machine::Machine machine = fanuc_table();
  const Read given =
      read_five_axes(std::string(kHead) +
                         "G43.4 H1 X0. Y0. Z50. B10. C0.\nG1 F600 X10.\nG2 X30. I10. C45.\nG3 X30. I-10. B20.\n"
                         "G1 X40.\nG49\nG53 Z0\nM30\n",
                     machine);
  for (const PostTarget target : {PostTarget::joints, PostTarget::tcp}) {
    const Posted first = posted(given, machine);
    const Read from = target == PostTarget::joints ? given : read_five_axes(first.text, machine);
    const Posted out = target == PostTarget::joints ? first : posted(from, machine, {.target = target});
    const PostDeviation d = post_deviation(from.moves, read_five_axes(out.text, machine).moves, machine, out, 32);
    EXPECT_GT(d.samples, 1000U);
    EXPECT_LE(d.tip_mm, out.tip_bound_mm);
    EXPECT_LE(out.tip_bound_mm, 0.005);
  }
}

// --- there and back

/// Joints with four decimals, back with three: the numbers of the program.
TEST(Post, ThereAndBackGivesTheSamePosesOnRealPrograms) {
  auto programs = five_axis_programs();
  ASSERT_FALSE(programs.empty());
  programs.emplace_back(CAMBER_SOURCE_DIR "/samples/12-five-axis/dome.nc");
  Diagnostics diagnostics;
  const machine::Machine dome =
      machine::read_machine(CAMBER_SOURCE_DIR "/samples/12-five-axis/machine.toml", diagnostics);
  const machine::Machine linuxcnc = sample("table_ac_linuxcnc");
  for (const std::string& path : programs) {
    SCOPED_TRACE(path);
    const machine::Machine& machine = path.ends_with("dome.nc") ? dome : linuxcnc;
    const Read given =
        read_five_axes(tests::file_text(tests::data_path("linuxcnc5/programs/tcp_singular_g64.ngc")), machine);
    const bool to_joints = std::any_of(given.moves.states.begin(), given.moves.states.end(),
                                       [](const auto& s) { return s.tip_control != nc::TipControl::off; });
    const PostTarget there = to_joints ? PostTarget::joints : PostTarget::tcp,
                     back = to_joints ? PostTarget::tcp : PostTarget::joints;
    const Posted out = posted(given, machine, {.target = there});
    const Read middle = read_five_axes(out.text, machine);
    const Posted home = posted(middle, machine, {.target = back, .decimals = 3});
    const Read again = read_five_axes(home.text, machine);
    const PostDeviation first = post_deviation(given.moves, middle.moves, machine, out, 16);
    const PostDeviation second = post_deviation(middle.moves, again.moves, machine, home, 16);
    EXPECT_LE(first.tip_mm, out.tip_bound_mm);
    EXPECT_LE(out.tip_bound_mm, 0.005);
    EXPECT_LE(first.rapid_tip_mm, out.rapid_bound_mm);
    EXPECT_LE(first.axis_rad, out.axis_bound_rad);
    EXPECT_LE(second.tip_mm, home.tip_bound_mm);
    EXPECT_LE(second.axis_rad, home.axis_bound_rad);
    const Read exact = read_five_axes(posted(given, machine, {.target = there, .inverse_time = true}).text, machine);
    EXPECT_NEAR(commanded_s(middle, machine), commanded_s(given, machine), 1e-4 * commanded_s(given, machine));
    EXPECT_NEAR(commanded_s(exact, machine), commanded_s(given, machine), 1e-4 * commanded_s(given, machine));

    // The ends of the blocks that the program has itself.
    kinematics::ProgramJoints a(machine, given.moves), b(machine, again.moves);
    std::vector<std::uint32_t> given_block(home.block_of_line.size());
    for (std::size_t i = 0; i < home.block_of_line.size(); ++i)
      given_block[i] = out.block_of_line[home.block_of_line[i]];
    std::vector<Vec3> tip(given.program.blocks.size(), Vec3::Constant(NAN)), axis = tip;
    while (!b.done()) {
      b.next();
      if (const auto pose = b.pose_at(1)) {
        const std::uint32_t block = given_block[again.moves.moves[b.index()].block];
        tip[block] = pose->tip_mm;
        axis[block] = pose->axis;
      }
    }
    std::size_t compared = 0;
    while (!a.done()) {
      a.next();
      const nc::Move& m = given.moves.moves[a.index()];
      const auto pose = a.pose_at(1);
      if (!pose || m.kind == nc::MoveKind::dwell || m.reference_axes != 0 || !tip[m.block].allFinite()) continue;
      ++compared;
      // Half of the last of three decimals, in three words; of the angles in two.
      EXPECT_LE((pose->tip_mm - tip[m.block]).norm(), 0.0005 * std::sqrt(3.0)) << "line " << m.block + 1;
      EXPECT_LE((pose->axis - axis[m.block]).norm(), rad_from_deg(0.001)) << "line " << m.block + 1;
    }
    EXPECT_GT(compared, 30U);
  }
}

// --- blocks

/// Over the pole: a third of the blocks of the one-degree rule, and within the tolerance.
TEST(Post, NeedsFewerBlocksThanTheOneDegreeRuleThroughThePole) {
  const machine::Machine machine = sample("table_ac_linuxcnc");
  const Read given =
      read_five_axes(tests::file_text(tests::data_path("linuxcnc5/programs/tcp_singular_g64.ngc")), machine);
  const Posted ours = posted(given, machine), rule = posted(given, machine, {.one_degree = true});
  EXPECT_LE(2 * ours.feed_blocks, ours.one_degree_blocks);
  EXPECT_EQ(rule.feed_blocks, ours.one_degree_blocks);
  EXPECT_NEAR(rule.tip_bound_mm, ours.one_degree_bound_mm, 2e-4);
  const PostDeviation d = post_deviation(given.moves, read_five_axes(rule.text, machine).moves, machine, rule, 16);
  EXPECT_LE(d.tip_mm, rule.tip_bound_mm);
}

// --- pole, winding, travel

constexpr const char* kOverThePole =
    "G21 G17 G90 G94 G0\nG10 L2 P1 X0. Y0. Z-320.\nG10 L10 P1 R120.\nG54\nT1 M6\n"
    "G43.5 H1 X0. Y-20. Z20. I0 J-0.3 K1\nG1 Z0. F1000 I0 J-0.3 K1\nY-10. J-0.15 K1\nY0.5 J0.01 K1\n"
    "Y10. J0.15 K1\nY20. J0.3 K1\nG0 Z30. J0.3 K1\nG49\nG53 Z0\nM30\n";

machine::Machine trunnion(double from_deg, double to_deg, double turn_deg) {
  Diagnostics diagnostics;
  machine::Machine machine = machine::read_machine(CAMBER_SOURCE_DIR "/samples/12-five-axis/machine.toml", diagnostics);
  machine.rotary[0].travel_rad = {rad_from_deg(from_deg), rad_from_deg(to_deg)};
  machine.rotary[2].travel_rad = {rad_from_deg(-turn_deg), rad_from_deg(turn_deg)};
  return machine;
}

void expect_within_travel(const Read& made, const machine::Machine& machine) {
  Diagnostics diagnostics;
  kinematics::check_travel(machine, made.program, made.moves, diagnostics);
  EXPECT_FALSE(diagnostics.has_errors()) << to_string(diagnostics.all().front());
}

TEST(Post, CrossesThePoleWithoutAJumpWhereTheMachineCan) {
  const machine::Machine machine = trunnion(-30, 110, 360);
  const Read given = read_five_axes(kOverThePole, machine);
  const Posted out = posted(given, machine);
  EXPECT_TRUE(out.turns_back.empty());
  const Read made = read_five_axes(out.text, machine);
  kinematics::ProgramJoints joints(machine, made.moves);
  while (!joints.done()) {
    const auto& now = joints.next();
    if (made.moves.moves[joints.index()].kind != nc::MoveKind::linear) continue;
    EXPECT_LT((now.end_rad - now.start_rad).lpNorm<Eigen::Infinity>(), rad_from_deg(5));
  }
  expect_within_travel(made, machine);
}

TEST(Post, TurnsAtThePoleOffThePartWhereTheMachineCannot) {
  const machine::Machine machine = trunnion(0, 110, 360);
  const Read given = read_five_axes(kOverThePole, machine);
  const Posted out = posted(given, machine);
  ASSERT_EQ(out.turns_back.size(), 1U);
  const TurnBack& back = out.turns_back.front();
  EXPECT_FALSE(back.in_air);  // the cut goes on through the pole
  EXPECT_EQ(back.retract_mm, 50);
  EXPECT_NEAR(std::abs(back.to_rad.z() - back.from_rad.z()), kPi, 1e-9);
  EXPECT_NEAR(back.to_rad.x(), 0, 1e-9);
  const Read made = read_five_axes(out.text, machine);
  expect_within_travel(made, machine);
  const PostDeviation d = post_deviation(given.moves, made.moves, machine, out, 16);
  EXPECT_LE(d.tip_mm, out.tip_bound_mm);
  EXPECT_LE(d.axis_rad, out.axis_bound_rad);
}

/// Five passes of half a turn each the same way round; between them the tool is lifted. C has 400 degrees either way.
TEST(Post, TurnsBackInAirBeforeTravelEnds) {
  const machine::Machine machine = trunnion(-30, 110, 400);
  std::string text = std::string(kHead) + "G10 L2 P1 X0. Y0. Z-320.\nG43.4 H1 X20. Y0. Z30. A20. C0.\n";
  for (int pass = 0; pass < 5; ++pass) {
    const int c = 180 * pass;
    text += "G0 X20. Y" + std::to_string(pass) + ". Z30.\nG1 Z0. F500\n";
    for (int k = 1; k <= 18; ++k) text += "X" + std::to_string(20 - k) + ". C" + std::to_string(c + 10 * k) + ".\n";
    text += "G0 Z30.\n";
  }
  text += "G49\nG53 Z0\nM30\n";
  const Read given = read_five_axes(text, machine);
  Diagnostics before;
  kinematics::check_travel(machine, given.program, given.moves, before);
  EXPECT_TRUE(before.has_errors());
  const Posted out = posted(given, machine);
  ASSERT_FALSE(out.turns_back.empty());
  EXPECT_LE(out.turns_back.size(), 2U);
  for (const TurnBack& back : out.turns_back) EXPECT_TRUE(back.in_air);
  expect_within_travel(read_five_axes(out.text, machine), machine);
}

TEST(Post, RunsTheWholeProgramOnTheOtherBranchWhereTheFirstIsOutOfTravel) {
  const machine::Machine machine = trunnion(-110, 0, 360);
  const Read given =
      read_five_axes(std::string(kHead) +
                         "G10 L2 P1 X0. Y0. Z-320.\nG43.4 H1 X20. Y0. Z30. A20. C0.\nG1 Z0. F500\nX10. A15. C10.\nG49\n"
                         "G53 Z0\nM30\n",
                     machine);
  const Posted out = posted(given, machine);
  const Read made = read_five_axes(out.text, machine);
  expect_within_travel(made, machine);
  const PostDeviation d = post_deviation(given.moves, made.moves, machine, out, 16);
  EXPECT_LE(d.tip_mm, out.tip_bound_mm);
  EXPECT_LE(d.axis_rad, out.axis_bound_rad);
}

// --- what is refused

TEST(Post, SaysWhatItCannotRewrite) {
  const machine::Machine machine = fanuc_table();
  const std::string on = std::string(kHead) + "G43.4 H1 X0. Y0. Z50.\n";
  EXPECT_EQ(said(std::string(kHead) + "G0 X1.\nM30\n", machine),
            "p.nc:1:1: error: no move is under tool-centre-point control; G43.4, G43.5, G234 or M428 was expected "
            "[nothing-to-post]\n");
  EXPECT_EQ(
      said(std::string(kHead) + "G0 X1.\nM30\n", machine, {.target = PostTarget::tcp}),
      "p.nc:1:1: error: no move runs with turned rotary axes outside tool-centre-point control and tilted frames; "
      "A, B or C was expected [nothing-to-post]\n");
  EXPECT_EQ(
      said(on + "G1 X[5.+5.] B10. F600\nG49\nM30\n", machine),
      "p.nc:6:1: error: this move is made by a loop, a subprogram that is called more than once, an expression or "
      "a cycle, so that its coordinates cannot be rewritten; a block with numbers of its own was expected "
      "[not-editable]\n");
  EXPECT_EQ(
      said(on + "G1 X5. B10. F600\nG49\nM30\n", machine, {.decimals = 1}),
      "p.nc:5:1: error: rounding of the words to 1 decimals moves the tip by up to 0.15 mm, of a tolerance of 0.1 "
      "mm; more decimals or a larger tolerance were expected [tolerance]\n");
  EXPECT_EQ(
      said("G21 G17 G90 G94 G0\nG55\nT1 M6\nG43.4 H1 X0. Y0. Z50.\nM30\n", machine),
      "p.nc:4:1: error: the work offset is not known, so that joints are not; --work-offset or G10 L2 was expected "
      "[work-offset]\n");
  EXPECT_EQ(said(std::string(kHead) + "G43.4 H7 X0. Y0. Z50.\nM30\n", machine),
            "p.nc:5:1: error: the tool length of this move is not known; --tool-length or G10 L1 was expected "
            "[tool-length]\n");
}

}  // namespace
}  // namespace camber::repath
