#pragma once
// LinuxCNC's interpreter as an oracle: what rs274 makes of a program.
#include <cstdio>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "base/units.h"
#include "tests/nc/macro_text.h"
#include "tests/support/temp_folder.h"

namespace camber::nc {

inline bool rs274_present() {
  static const bool present = std::system("command -v rs274 >/dev/null 2>&1") == 0;
  return present;
}

struct CanonLine {
  MoveKind kind;
  Vec3 end_mm;
  double unit_mm;
};

/// Straight moves in order, lines without length left out; `failed` where rs274 gives up. `files`: subprograms beside
/// the program. Each run has a folder and a home of its own (rs274 keeps variables and its tool table there).
inline std::vector<CanonLine> rs274_lines(const std::string& text, const std::map<std::string, std::string>& files,
                                          std::string& output) {
  tests::TempFolder folder;
  folder.write("program.ngc", text);
  for (const auto& [name, content] : files) folder.write(name, content);
  const std::string command = "cd '" + folder.path() + "' && HOME=\"$PWD\" timeout 20 rs274 -g program.ngc 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  output.clear();
  char buffer[4096];
  for (std::size_t n; pipe && (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) output.append(buffer, n);
  if (pipe) pclose(pipe);
  std::vector<CanonLine> lines;
  Vec3 at = Vec3::Zero();
  double unit = 1;
  std::stringstream in(output);
  for (std::string line; std::getline(in, line);) {
    if (line.find("USE_LENGTH_UNITS") != std::string::npos)
      unit = line.find("INCHES") != std::string::npos ? kMmPerInch : 1;
    const bool rapid = line.find("STRAIGHT_TRAVERSE(") != std::string::npos;
    if (!rapid && line.find("STRAIGHT_FEED(") == std::string::npos) continue;
    Vec3 end;
    if (std::sscanf(line.c_str() + line.find('('), "(%lf, %lf, %lf", &end[0], &end[1], &end[2]) != 3) continue;
    end *= unit;
    if (end != at) lines.push_back({rapid ? MoveKind::rapid : MoveKind::linear, end, unit});
    at = end;
  }
  return lines;
}

/// Compares the straight moves; returns how many. Moves that are shorter than rs274's four decimals may be missing.
inline std::size_t expect_same_lines(const std::string& text, const std::map<std::string, std::string>& files = {}) {
  tests::TempFolder folder;
  for (const auto& [name, content] : files) folder.write(name, content);
  std::string output;
  const std::vector<CanonLine> canon = rs274_lines(text, files, output);
  const Read r = read_text(text, as(ControlKind::linuxcnc), folder / "program.ngc");
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
    const CanonLine& c = canon[at++];
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
