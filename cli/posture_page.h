#pragma once
// The page of camber posture: the machine along the new program, before and after, the table of overhangs.
#include <string>
#include <vector>

#include "api/commands/posture.h"

namespace camber::cli {

/// The page's text, UTF-8, self-contained. The same input gives the same bytes. The last row is the program; with
/// `overhangs` all rows are listed. Requires a last row with a text.
std::string posture_page(const std::vector<api::PosturedProgram>& rows, bool overhangs,
                         const api::PostureCommand& command, const Diagnostics& found);

}  // namespace camber::cli
