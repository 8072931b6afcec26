#pragma once
// The work of camber posture: a three-axis finishing program with a direction of the tool at every point.
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
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
};

struct PosturedProgram {
  posture::Postured postured;    ///< without a text where no direction is clear
  double time_s = 0;             ///< of the whole program on the machine
  std::size_t blocked_line = 0;  ///< 1-based; 0: none
};

/// Throws InputError: what make_postures() says, and kinematics::check_travel of the new program, at the given blocks.
PosturedProgram posture_program(const PostureCommand& command, Diagnostics& diagnostics);

/// The same with ever less overhang, as long as the tool stays clear; the last one is the shortest that does. Empty:
/// not even the given overhang does.
std::vector<PosturedProgram> overhangs(const PostureCommand& command, double step_mm, Diagnostics& diagnostics);

/// For people.
std::string posture_text(const PosturedProgram& program, const PostureCommand& command);
std::string overhang_text(const std::vector<PosturedProgram>& rows);
/// With a line end. `rows`: of overhangs(); empty: not asked for.
std::string posture_json(const PosturedProgram& program, const std::vector<PosturedProgram>& rows,
                         const PostureCommand& command);

}  // namespace camber::api
