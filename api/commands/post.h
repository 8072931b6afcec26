#pragma once
// The work of camber post: a program with rotary axes between tool-centre-point control and joint coordinates.
#include <optional>
#include <string>

#include "base/diagnostics.h"
#include "machine/job_file.h"
#include "machine/machine.h"
#include "nc/interpreter.h"
#include "nc/program.h"
#include "repath/post.h"
#include "repath/post_deviation.h"

namespace camber::api {

struct PostRequest {
  const nc::Program* text = nullptr;
  std::string output;  ///< name of the new program in messages
  const machine::Machine* machine = nullptr;
  const machine::Job* job = nullptr;  ///< also looks for collisions with the bodies of its machine; null: does not
  nc::InterpreterOptions interpreter;
  repath::PostOptions options;
};

struct PostedProgram {
  repath::Posted posted;
  repath::PostDeviation deviation;  ///< by sampling
  std::size_t blocks_before = 0, blocks_after = 0;
};

/// Throws InputError: what post() says of the program, and of the new one, at the blocks that it came from, what
/// kinematics::check_travel and check_machine_collisions say. Such a program is not to be written.
PostedProgram post_program(const PostRequest& request, Diagnostics& diagnostics);

/// For people.
std::string post_text(const PostedProgram& program);
/// With a line end.
std::string post_json(const PostedProgram& program, const PostRequest& request);

}  // namespace camber::api
