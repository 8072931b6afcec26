#pragma once
// The work of camber posture: a three-axis finishing program with a direction of the tool at every point.
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "kinematics/pose_track.h"
#include "machine/job.h"
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
};

struct PosturedProgram {
  posture::Postured postured;    ///< without a text where no direction is clear
  double time_s = 0;             ///< of the whole program on the machine
  double given_time_s = 0;       ///< and of the given one
  std::size_t blocked_line = 0;  ///< 1-based; 0: none
  std::size_t unclear_line = 0;  ///< the first of figures.unclear, 1-based; 0: none
  nc::OneDirection written = nc::OneDirection::tip;
};

/// With a step, also with ever less overhang, as long as the tool stays clear: the last one is the shortest that does.
/// Without: one. The first may be blocked, and not be clear. Throws InputError: what make_postures() says, and
/// kinematics::check_travel and simulate::check_machine_collisions of the last new program, at the given blocks.
std::vector<PosturedProgram> posture_programs(const PostureCommand& command, double overhang_step_mm,
                                              Diagnostics& diagnostics);

/// Positions of the machine along the new program.
kinematics::PoseTrack posture_track(const PosturedProgram& program, const PostureCommand& command);

/// For people.
std::string posture_text(const PosturedProgram& program, const PostureCommand& command);
std::string overhang_text(const std::vector<PosturedProgram>& rows);
/// With a line end: the figures of the last row, and with `overhangs` those of all.
std::string posture_json(const std::vector<PosturedProgram>& rows, bool overhangs, const PostureCommand& command);

}  // namespace camber::api
