#pragma once
// LinuxCNC's interpreter as an oracle: what rs274 makes of a program.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/units.h"
#include "tests/nc/macro_text.h"
#include "tests/support/temp_folder.h"

namespace camber::nc {

inline bool rs274_present() {
  static const bool present = std::system("command -v rs274 >/dev/null 2>&1") == 0;
  return present;
}

struct CanonMove {
  MoveKind kind;
  Vec3 end_mm;
  double unit_mm;
  Vec3 center_mm = Vec3::Zero();  ///< arcs only; along the normal as the end
  int turns = 0;                  ///< arcs only: begun turns, counter-clockwise positive
};

/// Numbers behind the first bracket of a line.
inline std::vector<double> arguments(const std::string& line) {
  std::vector<double> out;
  std::stringstream in(line.substr(line.find('(') + 1));
  for (std::string item; std::getline(in, item, ',');) out.push_back(std::strtod(item.c_str(), nullptr));
  return out;
}

/// Traverses, feeds and arcs in order, lines without length left out. Arc ends come in the order of the plane.
inline std::vector<CanonMove> canonical(const std::string& output) {
  std::vector<CanonMove> moves;
  Vec3 at = Vec3::Zero();
  const auto add = [&](MoveKind kind, const Vec3& end_mm, double unit_mm) {
    if (kind == MoveKind::arc || end_mm != at) moves.push_back({kind, end_mm, unit_mm});
    at = end_mm;
  };
  double unit = 1, turn_rad = 0;
  Vec3 g5x = Vec3::Zero(), g92 = Vec3::Zero();
  // What it prints is in the work offset; what we give is in the machine's axes (the tests give all offsets as 0).
  const auto place = [&](const Vec3& p) -> Vec3 {
    const Vec3 q = p + g92;
    const double c = std::cos(turn_rad), d = std::sin(turn_rad);
    return g5x + Vec3(c * q.x() - d * q.y(), d * q.x() + c * q.y(), q.z());
  };
  std::string plane = "XY";
  std::stringstream in(output);
  for (std::string line; std::getline(in, line);) {
    const auto a = arguments(line);
    const auto has = [&](const char* name) { return line.find(name) != std::string::npos; };
    if (has("USE_LENGTH_UNITS")) unit = has("INCHES") ? kMmPerInch : 1;
    if (has("SELECT_PLANE")) plane = has("PLANE_XZ") ? "XZ" : has("PLANE_YZ") ? "YZ" : "XY";
    if (has("SET_G5X_OFFSET")) g5x = unit * Vec3(a[1], a[2], a[3]);
    if (has("SET_G92_OFFSET")) g92 = unit * Vec3(a[0], a[1], a[2]);
    if (has("SET_XY_ROTATION")) turn_rad = a[0] * kPi / 180;
    if (has("STRAIGHT_TRAVERSE")) add(MoveKind::rapid, place(unit * Vec3(a[0], a[1], a[2])), unit);
    if (has("STRAIGHT_FEED")) add(MoveKind::linear, place(unit * Vec3(a[0], a[1], a[2])), unit);
    if (!has("ARC_FEED")) continue;
    const Vec3 end = plane == "XY"   ? Vec3(a[0], a[1], a[5])
                     : plane == "XZ" ? Vec3(a[1], a[5], a[0])
                                     : Vec3(a[5], a[0], a[1]);
    add(MoveKind::arc, place(unit * end), unit);
    const Vec3 centre = plane == "XY"   ? Vec3(a[2], a[3], a[5])
                        : plane == "XZ" ? Vec3(a[3], a[5], a[2])
                                        : Vec3(a[5], a[2], a[3]);
    moves.back().center_mm = place(unit * centre);
    moves.back().turns = static_cast<int>(a[4]);
  }
  return moves;
}

/// Centre and turns.
inline std::string compare_arc(const Interpretation& ours, const Move& m, const CanonMove& c, double tolerance) {
  const Arc& arc = ours.arcs[m.arc];
  const Vec3 away = arc.center_mm - c.center_mm;
  const double difference = (away - away.dot(arc.normal) * arc.normal).cwiseAbs().maxCoeff();
  if (difference > tolerance * c.unit_mm)
    return fmt::format("line {}: the centres are {:.6f} mm apart", m.block + 1, difference);
  const int turns = static_cast<int>(std::ceil(std::abs(arc.sweep_rad) / (2 * kPi) - 1e-9));
  if (c.turns != (arc.sweep_rad < 0 ? -turns : turns))
    return fmt::format("line {}: {} begun turns, and rs274 has {}", m.block + 1, turns, c.turns);
  return {};
}

/// What rs274 prints; where it fails, a line that says so and no canonical output. `files`: subprograms beside the
/// program. rs274 keeps its variables in the working directory and its tool table in ~/.tool.mmap, which a second one
/// cuts off under the first (bus error): a folder and a home of its own, as tests run side by side.
inline std::string run_rs274(const std::string& text, const std::map<std::string, std::string>& files = {}) {
  tests::TempFolder folder;
  folder.write("program.ngc", text);
  for (const auto& [name, content] : files) folder.write(name, content);
  const std::string command = "cd '" + folder.path() + "' && HOME=\"$PWD\" timeout 20 rs274 -g program.ngc 2>&1";
  std::string out;
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return "rs274 failed: it could not be started";
  char buffer[4096];
  for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.append(buffer, n);
  return pclose(pipe) == 0 ? out : "rs274 failed: " + out.substr(out.size() > 300 ? out.size() - 300 : 0);
}

/// Counts of the comparisons of one test; printed at its end.
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
  /// `output`: of rs274, where it was run before. `tolerance`: in units; it prints four decimals.
  std::string compare(const std::string& text, const InterpreterOptions& options = as("linuxcnc"),
                      double tolerance = 0.00006, std::string output = {});
  /// Returns the largest difference so far, mm.
  double expect_same_moves(const std::string& text, const InterpreterOptions& options = as("linuxcnc"),
                           double tolerance = 0.00006, const std::string& output = {}) {
    EXPECT_EQ(compare(text, options, tolerance, output), "") << text;
    return largest_mm_;
  }

  std::size_t programs_ = 0, moves_ = 0, arcs_ = 0;
  double largest_mm_ = 0;
};

inline std::string Rs274::compare(const std::string& text, const InterpreterOptions& options, double tolerance,
                                  std::string output) {
  const Read r = read_text(text, options);
  for (const auto& m : r.messages)
    if (m.find("error") != std::string::npos) return m;
  if (output.empty()) output = run_rs274(text);
  if (output.starts_with("rs274 failed")) return output;
  const std::vector<CanonMove> canon = canonical(output);
  ++programs_;
  std::size_t at = 0;
  for (const Move& m : r.moves.moves) {
    if (m.kind == MoveKind::dwell || (m.kind != MoveKind::arc && m.start_mm == m.end_mm)) continue;
    if (at == canon.size()) return fmt::format("rs274 has {} moves only", canon.size());
    const CanonMove& c = canon[at++];
    const double difference = (m.end_mm - c.end_mm).cwiseAbs().maxCoeff();
    const bool alike = m.kind == c.kind && difference <= tolerance * c.unit_mm;
    if (!alike)
      return fmt::format("line {}: {:.6f} {:.6f} {:.6f}, and rs274 has {:.6f} {:.6f} {:.6f}", m.block + 1, m.end_mm.x(),
                         m.end_mm.y(), m.end_mm.z(), c.end_mm.x(), c.end_mm.y(), c.end_mm.z());
    largest_mm_ = std::max(largest_mm_, difference);
    ++moves_;
    if (m.arc == Move::kNoArc) continue;
    ++arcs_;
    if (const std::string other = compare_arc(r.moves, m, c, tolerance); !other.empty()) return other;
  }
  return at == canon.size() ? "" : fmt::format("rs274 has {} moves and we have {}", canon.size(), at);
}

/// Compares the straight moves; returns how many. Moves that are shorter than rs274's four decimals may be missing.
inline std::size_t expect_same_lines(const std::string& text, const std::map<std::string, std::string>& files = {}) {
  tests::TempFolder folder;
  for (const auto& [name, content] : files) folder.write(name, content);
  const std::string output = run_rs274(text, files);
  const std::vector<CanonMove> canon = canonical(output);
  const Read r = read_text(text, as("linuxcnc"), folder / "program.ngc");
  for (const auto& m : r.messages) EXPECT_EQ(m.find("error"), std::string::npos) << m << "\n" << text;
  std::size_t at = 0;
  Vec3 place = Vec3::Zero();
  const auto coarse = [](const Vec3& p) {
    return Vec3(p.unaryExpr([](double v) { return std::round(v * 1e4) / 1e4; }));
  };
  for (const Move& m : r.moves.moves) {
    if (m.kind == MoveKind::dwell || coarse(m.end_mm) == place) continue;
    place = coarse(m.end_mm);
    if (at == canon.size()) {
      ADD_FAILURE() << "rs274 has " << canon.size() << " moves only:\n" << text << output;
      return at;
    }
    const CanonMove& c = canon[at++];
    const bool alike =
        m.kind == c.kind && (m.end_mm - c.end_mm).cwiseAbs().maxCoeff() <= 0.00011 * c.unit_mm;  // four decimals
    EXPECT_TRUE(alike) << "block " << m.block + 1 << ": ours " << m.end_mm.transpose() << ", rs274 "
                       << c.end_mm.transpose() << "\n"
                       << text;
    if (!alike) return at;
  }
  EXPECT_EQ(at, canon.size()) << text << output;
  return at;
}

}  // namespace camber::nc
