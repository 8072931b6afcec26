#pragma once
// Post-processing of programs with rotary axes: tool-centre-point control to joint coordinates, and back.
//
// Every block under tool-centre-point control becomes one or more blocks whose X Y Z are those of the linear axes; the
// rotary axes turn as they were programmed. A block is divided where the tip would leave its path by more than the
// tolerance: the bound of joint_line and what rounding of the words adds. Back: blocks that turn axes, or run with
// turned axes, come under tool-centre-point control, X Y Z become the tip, and are divided by the same bound. Every
// other character of the program stays.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/diagnostics.h"
#include "machine/machine_model.h"
#include "nc/move.h"
#include "nc/program_text.h"

namespace camber::repath {

enum class PostTarget : std::uint8_t { joints, tcp };

/// Blocks at one direction of the tool, in a frame that follows it: neither rotary words nor tool-centre-point control.
struct PostFrame {
  Eigen::Matrix3d frame_from_work = Eigen::Matrix3d::Identity();
  std::vector<std::string> before, behind;  ///< lines that switch it on and off
};

struct PostOptions {
  PostTarget target = PostTarget::joints;
  double tolerance_mm = 0.005;      ///< of the tip, rounding included
  double rapid_tolerance_mm = 0.1;  ///< the same in rapids
  bool inverse_time = false;        ///< G93 in the rewritten feed moves, else as the program has it
  bool one_degree = false;          ///< divide where a rotary axis turns by a degree or more, whatever the tip does
  double retract_mm = 50;           ///< along the tool, where axes turn back
  std::optional<int> decimals{};    ///< of lengths and angles; default: the program's, at least 4
  /// Target tcp, one run of blocks that all have the same direction. post() does not look at it, PostWriter does.
  std::optional<PostFrame> frame{};
};

/// Axes that turn back: to another solution, or by whole turns.
struct TurnBack {
  std::uint32_t move = 0;  ///< before this one
  bool in_air = true;
  Vec3 from_rad = Vec3::Zero(), to_rad = Vec3::Zero();
  double retract_mm = 0;  ///< that travel allowed
};

/// A rewritten part of a move.
struct PostedPiece {
  std::uint32_t line = 0;  ///< 0-based, of the new text
  std::uint32_t move = 0;  ///< of the given program
  double from = 0, to = 1;
};

struct Posted {
  std::string text;
  std::vector<std::uint32_t> block_of_line;  ///< nc::Emission
  std::vector<PostedPiece> pieces;
  std::size_t moves = 0;        ///< rewritten
  std::size_t feed_blocks = 0;  ///< that the feed moves among them became
  std::size_t feed_moves = 0;
  std::size_t one_degree_blocks = 0;  ///< that the one-degree rule gives for the same feed moves
  double tip_bound_mm = 0, rapid_bound_mm = 0;
  double one_degree_bound_mm = 0;  ///< of that rule, feed moves
  double axis_bound_rad = 0;       ///< rounding of the angles, and even turns in the other branch of a nutating head
  std::vector<TurnBack> turns_back;
};

/// `moves`: interpreted with the machine's rotary axes and dialect. Errors at the blocks:
///  [work-offset], [tool-length]  not known, so that joints are not;
///  [not-editable]                a move that must be rewritten and that the text does not say alone;
///  [tolerance]                   the decimals alone use it up;
///  [nothing-to-post]             no move is to be rewritten.
Posted post(const nc::Program& program, const nc::Interpretation& moves, const machine::Machine& machine,
            const PostOptions& options, Diagnostics& diagnostics);

}  // namespace camber::repath
