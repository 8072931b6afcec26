#pragma once
#include "tests/nc/nc_text.h"

namespace camber::nc {

/// In the language of Sinumerik controls, in millimetres.
inline Read read_siemens(std::string text, InterpreterOptions options = {.inch = false}) {
  return read_text(std::move(text), options, "p.mpf");
}

/// Lines and arcs only, as "X Y Z" of their ends.
inline std::vector<Vec3> ends_of(const Read& r) {
  std::vector<Vec3> out;
  for (const Move& m : r.moves.moves) out.push_back(m.end_mm);
  return out;
}

}  // namespace camber::nc
