#pragma once
// The figures of camber check: JSON, text for a terminal, and the page with the path as a picture.
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/triangle_mesh.h"
#include "feedmodel/cycle_time.h"
#include "kinematics/feed_meaning.h"
#include "kinematics/pose_track.h"
#include "machine/job_file.h"
#include "machine/machine_model.h"
#include "nc/move.h"
#include "nc/program_text.h"
#include "nc/summary.h"
#include "report/html_report.h"
#include "report/path_card.h"
#include "report/path_picture.h"

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

// The set-up sheet: what a setter needs at the machine, as a page that prints on A4.

struct SheetProgram {
  const nc::Program& text;
  const nc::Interpretation& moves;
  const nc::Summary& summary;
  feedmodel::CycleTime time;
};

struct SetupSheet {
  const machine::Job& job;
  std::vector<SheetProgram> programs;  ///< in the order in which they run
  std::vector<std::string> warnings;   ///< warnings of the checks
};

/// Blank and program zero in two views, every tool drawn to one scale with its numbers (length and radius offset as the
/// programs call them, speeds, feeds, depth, time), work offsets, the space that tips move in, limits of the machine
/// beside what the programs ask for, times, and what is assumed. Same input, same bytes: no date.
std::string setup_sheet_html(const SetupSheet& sheet);

// The path of a program as a file of arrays, for pages and programs that draw it: camber check --path.

/// Points that such a file has at most; longer paths are thinned.
constexpr std::size_t kMaxPathPoints = 4'000'000;

/// One line of JSON, padded with blanks to a multiple of four bytes, then the arrays that it names, little endian, each
/// padded to a multiple of four bytes:
///   {"camber_path": 1, "points": N, "origin_mm": [x, y, z], "chord_mm": c, "thinned": false, "in_part": false,
///    "arrays": [["x", "f4"], ["y", "f4"], ["z", "f4"], ["line", "u4"], ["feed_mm_per_min", "f4"], ["tool", "u2"],
///               ["kind", "u1"]]}
/// x, y, z: mm from the origin. line: from 1. feed: NaN on rapids. kind: of the way to the point, 0 start, 1 rapid,
/// 2 line, 3 arc. in_part: of the tip on the part, not X, Y and Z as programmed. `picture` has tools and feeds
/// (program_picture).
std::string path_arrays(const PathPicture& picture, bool in_part = false);

/// Writes them. Throws InputError [file-unwritable].
void write_path_arrays(const std::string& path, const PathPicture& picture, bool in_part = false);

// The page of a program as it is: its path, figures, tools and what was found in it.

struct ProgramPage {
  std::string title, subtitle;
  std::vector<Figure> figures;  ///< the first four are shown large
  PathPicture picture;          ///< without points: the page says that nothing moves
  std::vector<TextTable> tables;
  std::vector<std::string> warnings, notes;
};

/// The page's text, UTF-8, self-contained. The same data give the same bytes. Does not throw.
std::string program_page(const ProgramPage& page);

}  // namespace camber::report
