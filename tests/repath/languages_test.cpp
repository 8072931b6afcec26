// Runs written anew in the words of Heidenhain and Siemens controls.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "repath/compress/compression.h"
#include "repath/resegment/resegmentation.h"
#include "tests/nc/nc_text.h"
#include "tests/support/path_distance.h"
#include "tests/support/temp_folder.h"

namespace camber::repath {
namespace {

std::string read_and_compressed(const std::string& text, const CompressOptions& options = {}) {
  const nc::Read before = nc::read_clean(text);
  const std::string out = compress(before.program, before.moves, options).text;
  EXPECT_LE(tests::hausdorff_mm(before.moves, nc::read_clean(out).moves, 0.01), options.tolerance_mm + 0.0012);
  return out;
}

/// Points of a circle of radius 10 about 0 0 behind the angle 0.
std::string klartext_arc(int first_number, int n) {
  std::string out;
  for (int i = 1; i <= n; ++i)
    out += fmt::format("{} L X{:+.3f} Y{:+.3f}\n", first_number + i - 1, 10 * std::cos(2.0 * i / n),
                       10 * std::sin(2.0 * i / n));
  return out;
}

TEST(CompressKlartext, LinesBecomeACentreAndAnArcAndAllBlocksAreNumberedOn) {
  const std::string head = "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S5000\n2 L X+10 Y+0 Z+0 R0 FMAX M3\n";
  const std::string text = head + "3 L Z-1 F500\n" + klartext_arc(4, 60) + "64 L Z+5 FMAX M30\n65 END PGM A MM\n";
  EXPECT_EQ(read_and_compressed(text), head +
                                           "3 L Z-1.000 F500\n4 CC X+0.000 Y+0.000\n5 C X-4.161 Y+9.093 DR+\n"
                                           "6 L Z+5 FMAX M30\n7 END PGM A MM\n");
}

TEST(CompressKlartext, WithoutNumbersThereAreNone) {
  std::string lines;
  for (int i = 1; i <= 60; ++i)
    lines += fmt::format("L X{:.3f} Y{:.3f}\n", 10 * std::cos(i / 30.0), 10 * std::sin(i / 30.0));
  const std::string head = "BEGIN PGM A MM\nTOOL CALL 1 Z S5000\nL X10 Y0 Z0 R0 FMAX M3\n";
  EXPECT_EQ(read_and_compressed(head + "L Z-1 F500\n" + lines + "L Z5 FMAX\nEND PGM A MM\n"),
            head + "L Z-1.000 F500\nCC X0.000 Y0.000\nC X-4.161 Y9.093 DR+\nL Z5 FMAX\nEND PGM A MM\n");
}

/// The C behind the run turns about the pole that was set before it.
TEST(CompressKlartext, APoleSetBeforeTheRunIsSetAgainBehindIt) {
  const std::string head = "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S5000\n2 L X+10 Y+0 Z+0 R0 FMAX M3\n3 L Z-1 F500\n";
  const std::string text =
      head + "4 CC X-4.161 Y+19.093\n" + klartext_arc(5, 60) + "65 C X-14.161 Y+19.093 DR-\n66 END PGM A MM\n";
  EXPECT_EQ(read_and_compressed(text),
            head +
                "4 CC X-4.161 Y+19.093\n5 CC X+0.000 Y+0.000\n6 C X-4.161 Y+9.093 DR+\n7 CC X-4.161 Y+19.093\n"
                "8 C X-14.161 Y+19.093 DR-\n9 END PGM A MM\n");
}

/// Arcs that follow each other: each is two blocks, and a kink is at the block of the move that begins there.
TEST(CompressKlartext, TheBlockOfAKinkIsThatOfItsMove) {
  int kinks = 0;
  for (int k = 1; k <= 12; ++k) {
    std::string text = "BEGIN PGM A MM\nTOOL CALL 1 Z S5000\nL X+0 Y+0 Z+0 R0 FMAX M3\nL Z-1 F500\n";
    for (int i = 1; i <= 120; ++i)  // a wave whose curvature changes all along
      text += fmt::format("L X{:+.4f} Y{:+.4f}\n", 0.25 * i, (1 + 0.3 * k) * std::sin(0.25 * i / 3));
    const nc::Read before = nc::read_clean(text + "L Z+5 FMAX\nEND PGM A MM\n");
    CompressOptions options;
    options.tolerance_mm = 0.02;
    const Compression out = compress(before.program, before.moves, options);
    if (out.max_kink_rad < 1e-3) continue;
    ++kinks;
    const nc::Read after = nc::read_clean(out.text);
    const auto& moves = after.moves.moves;
    const auto at = std::ranges::find(moves, out.max_kink_block, &nc::Move::block);
    ASSERT_TRUE(at != moves.end() && at != moves.begin()) << out.max_kink_block << "\n" << out.text;
    const double dot = direction_at(after.moves, *(at - 1), 1).dot(direction_at(after.moves, *at, 0));
    EXPECT_NEAR(std::acos(std::clamp(dot, -1.0, 1.0)), out.max_kink_rad, 0.05 * out.max_kink_rad + 2e-4) << out.text;
  }
  EXPECT_GT(kinks, 3);
}

TEST(CompressKlartext, MFunctionsCommentsAndSkippedBlocksEndARun) {
  for (const char* middle :
       {"L M8\n", "; note\n", "/L X+10 Y+0\n", "LBL 3\n", "L IX+0.5\n", "CYCL DEF 32.0 TOLERANCE\n"}) {
    SCOPED_TRACE(middle);
    const std::string head = "BEGIN PGM A MM\nTOOL CALL 1 Z S5000\nL X+10 Y+0 Z+0 R0 FMAX M3\nL Z-1 F500\n";
    std::string lines[2];
    for (int i = 1; i <= 60; ++i)
      lines[i > 30] += fmt::format("L X{:+.3f} Y{:+.3f}\n", 10 * std::cos(i / 30.0), 10 * std::sin(i / 30.0));
    const nc::Read read = nc::read_text(head + lines[0] + middle + lines[1] + "END PGM A MM\n");
    const std::string out = compress(read.program, read.moves, {}).text;
    EXPECT_NE(out.find("DR+\n" + std::string(middle)), std::string::npos) << out;
  }
}

TEST(CompressSiemens, IsWrittenWithCodesThatHold) {
  std::string lines;
  for (int i = 1; i <= 60; ++i)
    lines += fmt::format("N{} X{:.3f} Y{:.3f}\n", 40 + 10 * i, 10 * std::cos(i / 30.0), 10 * std::sin(i / 30.0));
  const std::string head = "%_N_A_MPF\nN10 G17 G71 G90\nN20 T1 M6 D1\nN30 G0 X10 Y0 Z0 S5000 M3\nN40 G1 Z-1 F500\n";
  EXPECT_EQ(read_and_compressed(head + lines + "N650 X0 Y0 ; off\nN660 M30\n"),
            "%_N_A_MPF\nN10 G17 G71 G90\nN20 T1 M6 D1\nN30 G0 X10 Y0 Z0 S5000 M3\nN40 G1 Z-1.000 F500\n"
            "N640 G3 X-4.161 Y9.093 I-10.000 J0.000\nG1\nN650 X0 Y0 ; off\nN660 M30\n");
}

TEST(CompressSiemens, BlocksThatAJumpMayGoToStay) {
  std::string lines;
  for (int i = 1; i <= 60; ++i)
    lines += fmt::format("N{} X{:.3f} Y{:.3f}\n", 40 + 10 * i, 10 * std::cos(i / 30.0), 10 * std::sin(i / 30.0));
  for (const char* jump : {"N25 IF R1==5 GOTOF N300\n", "N25 CASE R1 OF 5 GOTOF N300\n"}) {
    const std::string text = "%_N_A_MPF\nN10 G17 G71 G90\nN20 T1 M6 D1 R1=0\n" + std::string(jump) +
                             "N30 G0 X10 Y0 Z0 S5000 M3\nN40 G1 Z-1 F500\n" + lines + "N650 M30\n";
    const nc::Read read = nc::read_text(text);
    EXPECT_GT(read.moves.moves.size(), 60u) << jump;
    EXPECT_EQ(compress(read.program, read.moves, {}).text, text);
    const nc::Read without = nc::read_text(tests::replaced(text, jump, ""));
    EXPECT_LT(compress(without.program, without.moves, {}).text.size(), 400u);
  }
}

TEST(ResegmentKlartext, LongerBlocksHaveTheirFeed) {
  std::string lines;
  for (int i = 1; i <= 200; ++i)
    lines += fmt::format("{} L X{:+.4f} Y{:+.4f}\n", 3 + i, 50 * std::cos(i / 500.0), 50 * std::sin(i / 500.0));
  const std::string head = "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S5000\n2 L X+50 Y+0 Z+0 R0 FMAX M3\n3 L Z-1 F500\n";
  const nc::Read before = nc::read_clean(head + lines + "204 L Z+5 FMAX\n205 END PGM A MM\n");
  ResegmentOptions options;
  options.tolerance_mm = 0.005;
  options.length_mm = 1;
  options.feed_factor = 0.5;
  const Resegmentation out = resegment(before.program, before.moves, options);
  EXPECT_NE(out.text.find("\n3 L Z-1.0000 F250\n4 L X+49.9"), std::string::npos) << out.text;
  EXPECT_NE(out.text.find(" F250\n"), std::string::npos) << out.text;
  EXPECT_NE(out.text.find(" F500\n"), std::string::npos) << out.text;
  const nc::Read after = nc::read_clean(out.text);
  EXPECT_LT(after.moves.moves.size(), 0.3 * before.moves.moves.size());
  EXPECT_LE(tests::hausdorff_mm(before.moves, after.moves, 0.01), 0.0071);  // measured at points every 0.01 mm
  std::size_t number = 0;
  for (std::size_t at = 0; at < out.text.size(); at = out.text.find('\n', at) + 1)
    EXPECT_EQ(std::stoul(out.text.substr(at, 8)), number++);
}

}  // namespace
}  // namespace camber::repath
