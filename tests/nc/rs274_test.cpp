// Our moves against the canonical output of LinuxCNC's interpreter, where `rs274` is on the PATH.
#include <rapidcheck.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "base/units.h"
#include "tests/nc/nc_text.h"
#include "tests/support/random_program.h"
#include "tests/support/temp_folder.h"

namespace camber::nc {
namespace {

struct CanonMove {
  MoveKind kind;
  Vec3 end_mm;
  double unit_mm;
  Vec3 center_mm = Vec3::Zero();  ///< arcs only; along the normal as the end
  int turns = 0;                  ///< arcs only: begun turns, counter-clockwise positive
};

/// Numbers behind the first bracket of a line.
std::vector<double> arguments(const std::string& line) {
  std::vector<double> out;
  std::stringstream in(line.substr(line.find('(') + 1));
  for (std::string item; std::getline(in, item, ',');) out.push_back(std::strtod(item.c_str(), nullptr));
  return out;
}

/// Traverses, feeds and arcs in order, lines without length left out. Arc ends come in the order of the plane.
std::vector<CanonMove> canonical(const std::string& output) {
  std::vector<CanonMove> moves;
  Vec3 at = Vec3::Zero();
  const auto add = [&](MoveKind kind, const Vec3& end_mm, double unit_mm) {
    if (kind == MoveKind::arc || end_mm != at) moves.push_back({kind, end_mm, unit_mm});
    at = end_mm;
  };
  double unit = 1;
  std::string plane = "XY";
  std::stringstream in(output);
  for (std::string line; std::getline(in, line);) {
    const auto a = arguments(line);
    const auto has = [&](const char* name) { return line.find(name) != std::string::npos; };
    if (has("USE_LENGTH_UNITS")) unit = has("INCHES") ? kMmPerInch : 1;
    if (has("SELECT_PLANE")) plane = has("PLANE_XZ") ? "XZ" : has("PLANE_YZ") ? "YZ" : "XY";
    if (has("STRAIGHT_TRAVERSE")) add(MoveKind::rapid, unit * Vec3(a[0], a[1], a[2]), unit);
    if (has("STRAIGHT_FEED")) add(MoveKind::linear, unit * Vec3(a[0], a[1], a[2]), unit);
    if (!has("ARC_FEED")) continue;
    const Vec3 end = plane == "XY"   ? Vec3(a[0], a[1], a[5])
                     : plane == "XZ" ? Vec3(a[1], a[5], a[0])
                                     : Vec3(a[5], a[0], a[1]);
    add(MoveKind::arc, unit * end, unit);
    const Vec3 centre = plane == "XY"   ? Vec3(a[2], a[3], a[5])
                        : plane == "XZ" ? Vec3(a[3], a[5], a[2])
                                        : Vec3(a[5], a[2], a[3]);
    moves.back().center_mm = unit * centre;
    moves.back().turns = static_cast<int>(a[4]);
  }
  return moves;
}

/// Centre and turns; 0.00006 units: rs274 prints four decimals.
std::string compare_arc(const Interpretation& ours, const Move& m, const CanonMove& c) {
  const Arc& arc = ours.arcs[m.arc];
  const Vec3 away = arc.center_mm - c.center_mm;
  const double difference = (away - away.dot(arc.normal) * arc.normal).cwiseAbs().maxCoeff();
  if (difference > 0.00006 * c.unit_mm)
    return fmt::format("line {}: the centres are {:.6f} mm apart", m.block + 1, difference);
  const int turns = static_cast<int>(std::ceil(std::abs(arc.sweep_rad) / (2 * kPi) - 1e-9));
  if (c.turns != (arc.sweep_rad < 0 ? -turns : turns))
    return fmt::format("line {}: {} begun turns, and rs274 has {}", m.block + 1, turns, c.turns);
  return {};
}

bool rs274_present() { return std::system("command -v rs274 >/dev/null 2>&1") == 0; }

/// What rs274 prints; where it fails, a line that says so and no canonical output.
std::string run_rs274(const std::string& text) {
  tests::TempFolder folder;
  folder.write("program.ngc", text);
  // rs274 keeps its variables in the working directory and its tool table in ~/.tool.mmap, which a second one
  // cuts off under the first (bus error): a folder and a home of its own, as tests run side by side.
  const std::string command = "cd '" + folder.path() + "' && HOME=\"$PWD\" rs274 -g program.ngc 2>&1";
  std::string out;
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return out;
  char buffer[4096];
  for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.append(buffer, n);
  return pclose(pipe) == 0 ? out : "rs274 failed: " + out.substr(out.size() > 300 ? out.size() - 300 : 0);
}

/// What was compared by one test; printed at its end.
class Rs274 : public testing::Test {
 protected:
  void TearDown() override {
    if (programs_ == 0) return;
    std::cout << fmt::format(
        "{} programs, {} moves ({} of them arcs) compared with rs274, largest difference {:.6f} mm\n", programs_,
        moves_, arcs_, largest_mm_);
    RecordProperty("programs", std::to_string(programs_));
    RecordProperty("moves", std::to_string(moves_));
    RecordProperty("largest_difference_mm", fmt::format("{:.6f}", largest_mm_));
  }
  /// What is not alike; empty: nothing. Moves without length may be missing on either side.
  std::string compare(const std::string& text);
  /// Returns the largest difference so far, mm.
  double expect_same_moves(const std::string& text) {
    EXPECT_EQ(compare(text), "");
    return largest_mm_;
  }

  std::size_t programs_ = 0, moves_ = 0, arcs_ = 0;
  double largest_mm_ = 0;
};

std::string Rs274::compare(const std::string& text) {
  const Read r = read_text(text, {});
  for (const auto& m : r.messages)
    if (m.find("error") != std::string::npos) return m;
  const std::string output = run_rs274(text);
  if (output.starts_with("rs274 failed")) return output;
  const std::vector<CanonMove> canon = canonical(output);
  ++programs_;
  std::size_t at = 0;
  for (const Move& m : r.moves.moves) {
    if (m.kind == MoveKind::dwell || (m.kind != MoveKind::arc && m.start_mm == m.end_mm)) continue;
    if (at == canon.size()) return fmt::format("rs274 has {} moves only", canon.size());
    const CanonMove& c = canon[at++];
    const double difference = (m.end_mm - c.end_mm).cwiseAbs().maxCoeff();
    const bool alike = m.kind == c.kind && difference <= 0.00006 * c.unit_mm;  // it prints four decimals
    if (!alike)
      return fmt::format("line {}: {:.6f} {:.6f} {:.6f}, and rs274 has {:.6f} {:.6f} {:.6f}", m.block + 1, m.end_mm.x(),
                         m.end_mm.y(), m.end_mm.z(), c.end_mm.x(), c.end_mm.y(), c.end_mm.z());
    largest_mm_ = std::max(largest_mm_, difference);
    ++moves_;
    if (m.arc == Move::kNoArc) continue;
    ++arcs_;
    if (const std::string other = compare_arc(r.moves, m, c); !other.empty()) return other;
  }
  return at == canon.size() ? "" : fmt::format("rs274 has {} moves and we have {}", canon.size(), at);
}

TEST_F(Rs274, LinuxCncProgramsMoveAlike) {
  if (!rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  const auto files = shared_files("linuxcnc/programs");
  if (files.empty()) GTEST_SKIP() << "no shared data at " << CAMBER_SHARED_DATA_DIR;
  for (const auto& f : files) {
    if (!f.ends_with(".ngc")) continue;
    SCOPED_TRACE(f);
    expect_same_moves(SourceText::read(f).text());
  }
}

TEST_F(Rs274, BallFinishingOfBoxOp5MovesAlike) {
  if (!rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  const std::string path = shared_file("nist/box_op5.nc");
  if (path.empty()) GTEST_SKIP() << "no shared data at " << CAMBER_SHARED_DATA_DIR;
  std::string text = "G20 G17 G40 G49 G90 G94\n", line;
  std::ifstream in(path);
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
