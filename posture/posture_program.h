#pragma once
// From a three-axis finishing program to five axes: chooses a direction of the tool at every point of its path. This is
// the door of posture/.
//
// Overview
//
// All moves of one ball or bull-nose tool come under tool-centre-point control. Where the cutter touches the part, the
// tool is tilted about the centre of its rounding, so that the contact stays; elsewhere about the same point. The text
// is that of the given program with other coordinates, rotary words, and further blocks (repath/post/post_writer.h).
//
// 1. path_points      samples the path: centre of the rounding, normal of the part, way and time.
// 2. directions       lists the directions that the machine reaches within travel, and the cost of going from one to
//                     the next.
// 3. surroundings     gives the room between the tool and part, fixtures and stock, exact for convex pieces and
//                     triangles; stock_obstacle makes the stock an obstacle. clear_directions finds, for each point,
//                     the directions in which a tool of several lengths is clear.
// 4. choose           finds the cheapest path through (point, direction): error share of the deflection (error_share),
//                     lag of the axes (lag_error), rotary motion and time. one_direction does it for 3+2 axes.
// 5. rotary_path      chooses solution and winding of the inverse kinematics over the whole path.
// 6. path_cost        evaluates the result with the machine's axes; posture.cpp writes the program, checks it between
//                     points, bars what is not clear, and starts again at 4.
//
// Frames: points and directions are in the frame of the program's X Y Z with all rotary axes at 0; tool shapes are in
// the tool's frame, origin at the tip. docs/posture.md has the cost, the checks and the figures.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "kinematics/chain.h"
#include "machine/job_file.h"
#include "nc/five_axis_words.h"
#include "nc/move.h"
#include "nc/program_text.h"
#include "nc/write/five_axis_text.h"
#include "posture/choose.h"
#include "posture/surroundings.h"
#include "repath/post/post_processing.h"

namespace camber::posture {

struct PostureRequest {
  const machine::Job* job = nullptr;
  const nc::Program* program = nullptr;
  const nc::Interpretation* moves = nullptr;  ///< read with the machine's rotary axes
  int tool = 0;
  std::vector<double> overhangs_mm{};  ///< descending; empty: the overhang of the job
  double step_mm = 1;                  ///< between the points at which the direction is chosen
  PostureOptions options;
  /// Form in which one direction is written (options.indexed): tip, tilted or dynamic; joints as the tip, for post().
  nc::OneDirection written = nc::OneDirection::tip;
};

struct PostureFigures {
  std::size_t points = 0, contacts = 0;
  std::size_t unclear = 0;  ///< unclear_points()
  double overhang_mm = 0;
  double rotary_motion_deg = 0;
  double mean_angle_rad = 0, max_angle_rad = 0;  ///< angle of tool and normal, weighted by the way
  /// Deflection normal to the part per newton, mean over the way: lateral compliance at the tip times error_share().
  double compliance_um_per_N = 0;
  /// Error that the following errors of the axes leave on the surface: mean magnitude over the way, at the feed that
  /// the rotary axes allow (LagError).
  double lag_um = 0;
  /// Expected form error, mean magnitude over the way: compliance_um_per_N times the force of an edge at the feed per
  /// tooth of the first cut (posture.cpp, kOrdinaryChip_mm), and lag_um.
  double error_um = 0;
};

struct Postured {
  std::string text;  ///< empty: blocked
  std::vector<std::uint32_t> block_of_line;
  PostureFigures figures;
  PostureFigures upright;  ///< figures of the job's tool along Z, without `unclear` and rotary motion
  int tool = 0;
  Vec3 origin_mm = Vec3::Zero();                ///< origin of the work offset, in the machine frame
  std::optional<std::uint32_t> blocked_move{};  ///< the first move at which no direction is clear
  std::optional<std::uint32_t> unclear_move{};  ///< the first one of figures.unclear
  std::vector<PathPoint> points;
  std::vector<Vec3> axes;
  std::vector<Vec3> rotary_rad;
};

/// Errors, at the blocks or the job:
///  [not-ball]       the tool is neither a ball nor a bull-nose cutter;
///  [no-part]        the job has no mesh of the part;
///  [kinematics]     the machine has no rotary axes;
///  [rotary-axis]    the program turns rotary axes already, or is under tool-centre-point control;
///  [not-editable]   a move of the tool that the text does not say alone;
///  [no-moves]       the tool has no moves;
///  [no-frame]       the machine cannot write one direction as asked for.
/// Returns one result for each overhang; none where there are errors.
std::vector<Postured> make_postures(const PostureRequest& request, Diagnostics& diagnostics);

/// Returns the least overhang that is tried: the flutes and one diameter, mm.
double least_overhang_mm(const machine::Tool& tool);

// Writes the frame of an operation at one direction of the tool.

struct WrittenFrame {
  repath::PostFrame frame;
  Vec3 axis = Vec3::UnitZ();  ///< axis that follows from the words as they are written
};

/// The lines of the language for a tilted or a dynamic frame in this direction, the rotary axes back at 0 behind it.
WrittenFrame frame_text(const kinematics::Chain& chain, nc::OneDirection written, const Vec3& axis, int decimals,
                        const nc::FiveAxisText& text);

// Makes the stock an obstacle, as the tool that is to be tilted finds it.

/// Adds the job's stock as it stands before the move `first`: without what the moves before it cut, and with its
/// allowance cut by the whole program. A box, a cylinder and a mesh of which nothing is cut are added as they are (the
/// cylinder as the prism of 48 faces about it); everything else as the faces of voxels, which stand out of the stock by
/// up to 0.7 kStockCell_mm and nowhere back from it (parts of more than about 0.3 m: wider faces). Without [stock]:
/// nothing. Throws InputError: what simulate_motion() and the readers of the stock say.
inline constexpr double kStockCell_mm = 0.5;
void add_stock(const machine::Job& job, const nc::Program& program, const nc::Interpretation& moves, std::size_t first,
               Surroundings& out, Diagnostics& diagnostics);

}  // namespace camber::posture
