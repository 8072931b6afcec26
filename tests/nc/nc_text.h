#pragma once
// Short programs in tests, and what is said of them.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "nc/interpreter.h"

namespace camber::nc {

struct Read {
  Program program;
  Interpretation moves;
  Diagnostics diagnostics;
  std::vector<std::string> messages;  ///< one line each, without the source line
};

inline std::string headline(const Diagnostic& d) {
  Diagnostic short_one = d;
  short_one.source_line.clear();
  return to_string(short_one);
}

/// Millimetres, and numbers without a point count them.
inline InterpreterOptions units() {
  InterpreterOptions options{.inch = false};
  options.whole_numbers_are_increments = false;
  return options;
}

inline InterpreterOptions as(std::string_view dialect) {
  InterpreterOptions options = units();
  options.dialect = *dialect_named(dialect);
  return options;
}

/// Reads and interprets; an InputError thrown on the way ends up in `messages` like the rest.
inline Read read_text(std::string text, const InterpreterOptions& options = units(), std::string name = "p.nc") {
  Read r;
  std::vector<Diagnostic> found;
  try {
    r.program = read_program(SourceText(std::move(name), std::move(text)), r.diagnostics);
    r.moves = interpret(r.program, options, r.diagnostics);
    found = r.diagnostics.all();
  } catch (const InputError& e) {
    found = e.diagnostics();
  }
  for (const auto& d : found) r.messages.push_back(headline(d));
  return r;
}

/// Reads a program that nothing is said of.
inline Read read_clean(std::string text, const InterpreterOptions& options = units()) {
  Read r = read_text(std::move(text), options);
  EXPECT_EQ(r.messages, std::vector<std::string>{});
  return r;
}

inline void expect_near_mm(const Vec3& actual, const Vec3& expected, double tolerance_mm = 1e-9) {
  EXPECT_LE((actual - expected).cwiseAbs().maxCoeff(), tolerance_mm)
      << "actual " << actual.transpose() << ", expected " << expected.transpose();
}

}  // namespace camber::nc
