#pragma once
// Comments of an NC program as text, with the code beside them; for what CAM systems write there for people.
#include <cstddef>
#include <string>
#include <vector>

#include "base/diagnostics.h"

namespace camber::machine {

/// A line of the program that has a comment: (...), from ; to the end of the line, [...] at the beginning of a line,
/// or a structure line of Klartext (* ...).
struct CommentedLine {
  std::size_t line = 0;  ///< 1-based
  std::string code;      ///< what stands outside of the comments, in upper case
  std::string comment;   ///< without its brackets; of several comments the first
};

/// The code of any line, comments left out, in upper case.
std::string code_of_line(const SourceText& program, std::size_t line);

std::vector<CommentedLine> commented_lines(const SourceText& program);

}  // namespace camber::machine
