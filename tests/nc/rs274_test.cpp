// Our moves against the canonical output of LinuxCNC's interpreter, where `rs274` is on the PATH.
#include <rapidcheck.h>

#include <fstream>
#include <random>
#include <string_view>

#include "tests/nc/rs274_oracle.h"
#include "tests/support/random_program.h"
#include "tests/support/test_data.h"

namespace camber::nc {
namespace {

TEST_F(Rs274, LinuxCncProgramsMoveAlike) {
  if (!rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  for (const auto& f : tests::data_files("linuxcnc/programs")) {
    if (!f.ends_with(".ngc")) continue;
    SCOPED_TRACE(f);
    expect_same_moves(SourceText::read(f).text());
  }
}

TEST_F(Rs274, BallFinishingOfBoxOp5MovesAlike) {
  if (!rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  std::string text = "G20 G17 G40 G49 G90 G94\n", line;
  std::ifstream in(tests::data_path("nist/box_op5.nc"));
  bool ours = false;
  while (std::getline(in, line)) {
    if (ours && line.find("G28") != std::string::npos) break;
    if (ours) text += line + "\n";
    ours = ours || line.find("T9M6") != std::string::npos;
  }
  EXPECT_LT(expect_same_moves(text + "M2\n"), 0.0015);
}

TEST_F(Rs274, RandomProgramsMoveAlike) {
  if (!rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(-10, 10);
  for (int program = 0; program < 20; ++program) {
    SCOPED_TRACE(program);
    std::string text = "G21 G17 G90 G94 G64 P0.01\nG0 X0 Y0 Z20\nF100 S1000 M3\n";
    for (int i = 0; i < 60; ++i) {
      switch (random() % 8) {
        case 0:
          text += fmt::format("G0 X{:.3f} Z{:.3f}\n", u(random), u(random));
          break;
        case 1:
          text += fmt::format("g1x{:.3f}y{:.3f}\n", u(random), u(random));
          break;
        case 2:
          text += fmt::format("G91 G1 X{:.3f} Z{:.3f} (inc)\nG90\n", u(random), u(random));
          break;
        case 3:
          text += fmt::format("G17 G{} I{:.3f} J{:.3f} P2\n", 2 + random() % 2, u(random), u(random));
          break;
        case 4:
          text += fmt::format("G18 G2 I{:.3f} K{:.3f} Y{:.3f}\nG17\n", u(random), u(random), u(random));
          break;
        case 5:
          text += fmt::format("G19 G3 J{:.3f} K{:.3f}\nG17\n", u(random), u(random));
          break;
        case 6:
          text += fmt::format("G91 G2 X{:.3f} Y1 R-{:.3f}\nG90\n", u(random), 12 + std::abs(u(random)));
          break;
        default:
          text += fmt::format("G20\nG1 X{:.4f}\nG21\n", u(random) / 25);
          break;
      }
    }
    expect_same_moves(text + "M2\n");
  }
}

/// Beside what random numbers make of single blocks: modal repeats, helices, turns (P), planes, units, cycles,
/// spellings.
TEST_F(Rs274, RandomProgramsOfTheCommonSubsetMoveAlike) {
  if (!rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  // rs274 obeys the block skip of its start-up settings, drills along Z only, and has no G9.
  const tests::ProgramOptions common{
      .block_skip = false, .ends_in_blocks = false, .cycles_in_all_planes = false, .dwells = true};
  EXPECT_TRUE(rc::check([&] {
    if (programs_ == 100) return;  // each is a process of its own
    const std::string text = tests::text_of(*tests::random_program(250), common);
    const std::string difference = compare(text);
    RC_ASSERT(difference == "");
  }));
  EXPECT_GT(moves_, 5000u);
}

TEST_F(Rs274, DrillingCyclesMoveAlike) {
  if (!rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  for (const char* cycle : {"G81 X5 Y5 Z-3 R1", "G82 X5 Y5 Z-3 R1 P0.5", "G83 X5 Y5 Z-3 R1 Q1.5",
                            "G73 X5 Y5 Z-3 R1 Q1.5", "G85 X5 Y5 Z-3 R1", "G89 X5 Y5 Z-3 R1 P0.5"})
    for (const char* level : {"G98", "G99"}) {
      SCOPED_TRACE(cycle);
      // G85 and G89 feed out to R and go on in rapid, as Fanuc does; LinuxCNC feeds up to the initial level.
      const bool feeds_out = std::string_view(cycle).starts_with("G85") || std::string_view(cycle).starts_with("G89");
      if (feeds_out && std::string_view(level) == "G98") continue;
      expect_same_moves(fmt::format(
          "G21 G17 G90 G94\nG0 X0 Y0 Z20\nF100 S1000 M3\n{} {}\nX9\nX12 Y3\nG80\nG0 Z20\nM2\n", level, cycle));
    }
}

}  // namespace
}  // namespace camber::nc
