#pragma once
// camber post: programs with rotary axes between tool-centre-point control and joint coordinates.
#include <string>

#include "cli/global_options.h"
#include "nc/interpreter.h"
#include "repath/post.h"

namespace camber::cli {

struct PostArguments {
  std::string program, output;
  std::string machine, job;  ///< one of them
  std::string json;          ///< empty: none
  repath::PostOptions options;
  nc::InterpreterOptions interpreter;
};

/// Throws InputError. Returns kDone.
int run_post(const PostArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
