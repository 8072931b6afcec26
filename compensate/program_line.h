#pragma once
// A line of the given program and of the emitted one.
#include <cstddef>

namespace camber::compensate {

/// A line of the given program, 1-based, and the one that it became; 0: unknown.
struct ProgramLine {
  std::size_t given = 0, emitted = 0;
  bool operator==(const ProgramLine&) const = default;
};

}  // namespace camber::compensate
