#pragma once
// The command line: options, subcommands, and what the program says when something goes wrong.
#include <functional>
#include <string>
#include <vector>

#include "cli/global_options.h"

namespace CLI {
class App;
}

namespace camber::cli {

/// Runs a subcommand once the command line is read; returns the exit status.
using Action = std::function<int()>;

/// Adds the subcommands. The one that is given sets `chosen`.
void add_program_commands(CLI::App& app, const GlobalOptions& options, Action& chosen);  ///< check, feed, fit-feed
void add_force_commands(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_dynamics_commands(CLI::App& app, const GlobalOptions& options, Action& chosen);  ///< lobes, fit-modes
void add_init_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
/// predict, compensate, adapt, study
void add_job_commands(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_ui_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_copy_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
/// completion, and an example for each of the subcommands that are there; to be called last.
void add_help(CLI::App& app, Action& chosen);

/// The whole program. Returns the exit status; does not throw.
int run(int argc, const char* const* argv);

}  // namespace camber::cli
