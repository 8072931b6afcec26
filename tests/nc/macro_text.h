#pragma once
// Programs with macros in tests: where their moves end.
#include <fmt/format.h>

#include "tests/nc/nc_text.h"

namespace camber::nc {

/// "1 2 3; 4 5 6": X Y Z at the end of each move, four decimals at most.
inline std::string ends_of(const Read& r) {
  std::string out;
  for (const Move& m : r.moves.moves) {
    if (m.kind == MoveKind::dwell) continue;
    const Vec3 e = m.end_mm.unaryExpr([](double v) { return std::round(v * 1e4) / 1e4 + 0.0; });
    out += fmt::format("{}{:g} {:g} {:g}", out.empty() ? "" : "; ", e.x(), e.y(), e.z());
  }
  return out;
}

/// The same as ends_of, with all messages before it.
inline std::string run_text(const std::string& text, const InterpreterOptions& options = as("fanuc")) {
  const Read r = read_text("G0 X0 Y0 Z0\n" + text, options);
  std::string out;
  for (const auto& m : r.messages) out += m + "\n";
  const std::string ends = ends_of(r);
  return out + ends.substr(std::min(ends.size(), std::string("0 0 0; ").size()));
}

inline std::string run_linuxcnc(const std::string& text) { return run_text(text, as("linuxcnc")); }

/// The value that #1=... gives, through an axis word.
inline double value_of(const std::string& expression, std::string_view dialect = "fanuc") {
  const Read r = read_text(fmt::format("#1={}\nG0 X#1 Y0 Z0\n", expression), as(dialect));
  for (const auto& m : r.messages) ADD_FAILURE() << expression << ": " << m;
  return r.moves.moves.empty() ? NAN : r.moves.moves.back().end_mm.x();
}

/// The first thing said of a program.
inline std::string said(const std::string& text, std::string_view dialect = "fanuc") {
  InterpreterOptions options = as(dialect);
  options.max_repeated_blocks = 10000;
  const Read r = read_text(text, options);
  return r.messages.empty() ? "" : r.messages.front();
}

}  // namespace camber::nc
