#pragma once
// The command line: options, subcommands, and what the program says when something goes wrong.
#include <functional>

#include "cli/global_options.h"

namespace CLI {
class App;
}

namespace camber::cli {

/// What a subcommand does once the command line is read; returns the exit status.
using Action = std::function<int()>;

/// Adds the subcommands. The one that is given sets `chosen`.
void add_program_commands(CLI::App& app, const GlobalOptions& options, Action& chosen);  ///< check, feed, fit-feed
void add_job_commands(CLI::App& app, const GlobalOptions& options, Action& chosen);      ///< predict, compensate

/// Throws InputError [file-unwritable] when the folder that `path` lies in does not exist: said before the work,
/// not after it. An empty path is fine.
void require_folder_of(const std::string& path);

/// The whole program. Returns the exit status; does not throw.
int run(int argc, const char* const* argv);

}  // namespace camber::cli
