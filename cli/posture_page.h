#pragma once
// The page of camber posture: the machine along the new program, before and after, the table of overhangs.
#include <string>
#include <vector>

#include "api/commands/posture.h"

namespace camber::cli {

/// The page's text, UTF-8, self-contained. The same input gives the same bytes. All rows are listed, where there are
/// several. Requires a chosen row with a text.
std::string posture_page(const api::PosturedOverhangs& overhangs, const api::PostureCommand& command,
                         const Diagnostics& found);

}  // namespace camber::cli
