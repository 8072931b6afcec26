#pragma once
// Comments as headings: the lines of a program to which a comment applies.
#include <string>
#include <vector>

#include "nc/move.h"
#include "nc/program_text.h"

namespace camber::nc {

/// Returns for each line whether the comment above it matches `pattern`, a regular expression (ECMAScript,
/// case-insensitive). A comment names the lines behind it, up to the next tool change or the next comment; comments on
/// lines behind each other, without a move between them, are one heading. Of a comment its first 400 characters are
/// read.
std::vector<bool> lines_under(const Program& program, const Interpretation& moves, const std::string& pattern);

}  // namespace camber::nc
