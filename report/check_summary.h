#pragma once
// The figures of camber check: JSON, text for a terminal, and the page with the path as a picture.
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/triangle_mesh.h"
#include "kinematics/feed_meaning.h"
#include "kinematics/pose_track.h"
#include "machine/machine.h"
#include "nc/summary.h"
#include "report/path_card.h"

namespace camber::report {

struct CheckSummary {
  const nc::Program* text = nullptr;
  nc::Summary program{};
  std::vector<kinematics::FeedMeaningUse> feed_meanings{};  ///< meanings of F in a program that turns rotary axes
  std::optional<double> memory_bytes{};                     ///< that predict needs, about; of a job alone
};

/// With a line end. `found`: in the order of the file.
std::string check_json(const CheckSummary& summary, const Diagnostics& found);

/// For a terminal.
std::string check_text(const CheckSummary& summary, const Diagnostics& found);

/// The picture of the page: the path, or, where rotary axes turn, the machine along the program.
struct CheckPicture {
  PathPicture path;
  std::optional<machine::Machine> machine{};
  kinematics::PoseTrack track{};
  Vec3 work_origin_mm = Vec3::Zero();  ///< in the machine frame
  bool offset_assumed = false;         ///< the work offset is not known and was taken as zero
  std::optional<TriangleMesh> part{};
  double tool_diameter_mm = 0;  ///< 0: not known
};

/// `checked_with`: "with the job J.toml", "on the machine M.toml", or empty. The page's text, UTF-8, self-contained.
/// The same input gives the same bytes.
std::string check_page(const CheckSummary& summary, const std::string& checked_with, const Diagnostics& found,
                       const CheckPicture& picture);

}  // namespace camber::report
