#pragma once
// The work of camber posture: a three-axis finishing program with a direction of the tool at every point.
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "kinematics/pose_track.h"
#include "machine/job_file.h"
#include "nc/interpreter.h"
#include "nc/program.h"
#include "posture/posture.h"

namespace camber::api {

struct PostureCommand {
  const nc::Program* text = nullptr;
  std::string output;  ///< name of the new program in messages
  const machine::Job* job = nullptr;
  nc::InterpreterOptions interpreter;
  std::optional<int> tool{};  ///< default: the only one of the job
  double step_mm = 1;
  posture::PostureOptions options;
  std::optional<nc::OneDirection> written{};  ///< options.indexed; default: that of the control
  double overhang_step_mm = 0;                ///< greater than zero: shorter overhangs, too
  bool least_error = false;                   ///< take the overhang of the least expected error instead of the shortest
};

struct PosturedProgram {
  posture::Postured postured;    ///< without a text where no direction is clear
  double time_s = 0;             ///< machine time of the whole program
  double given_time_s = 0;       ///< and of the given one
  std::size_t blocked_line = 0;  ///< 1-based; 0: none
  std::size_t unclear_line = 0;  ///< the first of figures.unclear, 1-based; 0: none
  nc::OneDirection written = nc::OneDirection::tip;
};

/// With a step the rows of a table, with ever less overhang as long as the tool stays clear; without: one.
struct PosturedOverhangs {
  std::vector<PosturedProgram> rows;  ///< the first may be blocked, and not be clear
  std::size_t chosen = 0;             ///< whose program is written

  const PosturedProgram& program() const { return rows[chosen]; }
};

/// Throws InputError: what make_postures() says, and kinematics::check_travel and simulate::check_machine_collisions of
/// the chosen program, at the given blocks.
PosturedOverhangs posture_programs(const PostureCommand& command, Diagnostics& diagnostics);

/// Positions of the machine along the new program.
kinematics::PoseTrack posture_track(const PosturedProgram& program, const PostureCommand& command);

/// For people.
std::string posture_text(const PosturedProgram& program, const PostureCommand& command);
/// Text about the row that is written, and whether another row has the least expected error or is shorter.
std::string overhang_text(const PosturedOverhangs& overhangs);
/// With a line end: the figures of the row that is written, and where overhangs were asked for those of all.
std::string posture_json(const PosturedOverhangs& overhangs, const PostureCommand& command);

}  // namespace camber::api
