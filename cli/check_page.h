#pragma once
// The page of camber check: the path as a picture, what the program holds, what was found.
#include <string>

#include "base/diagnostics.h"
#include "cli/check_command.h"
#include "nc/summary.h"
#include "report/path_card.h"

namespace camber::cli {

/// The page's text, UTF-8, self-contained. The same input gives the same bytes.
std::string check_page(const CheckCommand& command, const nc::Summary& summary, const Diagnostics& found,
                       const report::PathPicture& picture);

/// "100 to 400", "400", or "-".
std::string range_text(const nc::Range& range, int decimals);
/// Lowest and highest Z of a tool's cutting moves.
std::string cut_depths_text(const nc::ToolUse& tool);

}  // namespace camber::cli
