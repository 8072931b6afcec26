#pragma once
// The page of camber check: the path as a picture, what the program holds, what was found.
#include <optional>
#include <string>

#include "base/diagnostics.h"
#include "base/triangle_mesh.h"
#include "cli/check_command.h"
#include "kinematics/pose_track.h"
#include "machine/machine.h"
#include "nc/summary.h"
#include "report/path_card.h"

namespace camber::cli {

/// The picture of the page: the path, or, where rotary axes turn, the machine along the program.
struct CheckPicture {
  report::PathPicture path;
  std::optional<machine::Machine> machine{};
  kinematics::PoseTrack track{};
  Vec3 work_origin_mm = Vec3::Zero();  ///< in the machine frame
  bool offset_assumed = false;         ///< the work offset is not known and was taken as zero
  std::optional<TriangleMesh> part{};
  double tool_diameter_mm = 0;  ///< 0: not known
};

/// The page's text, UTF-8, self-contained. The same input gives the same bytes.
std::string check_page(const CheckCommand& command, const nc::Summary& summary, const Diagnostics& found,
                       const CheckPicture& picture);

/// "100 to 400", "400", or "-".
/// Feeds of a tool: mm/min, and degrees/min of moves of rotary axes alone.
std::string feeds_text(const nc::ToolUse& tool);
std::string range_text(const nc::Range& range, int decimals);
/// Lowest and highest Z of a tool's cutting moves.
std::string cut_depths_text(const nc::ToolUse& tool);

}  // namespace camber::cli
