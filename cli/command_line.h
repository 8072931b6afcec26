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

/// Adds a subcommand: its options, and the work, which sets `chosen` where it is given. Each is in NAME_command.cpp.
void add_check_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_feed_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_time_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_fit_feed_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_protocol_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_compress_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_resegment_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_post_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_posture_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_init_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_predict_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_compensate_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_adapt_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_study_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_merge_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_copy_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_plan_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_fit_parts_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_fit_force_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_lobes_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_fit_modes_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
void add_ui_command(CLI::App& app, const GlobalOptions& options, Action& chosen);
/// completion, and an example for each of the subcommands that are there; to be called last.
void add_help(CLI::App& app, Action& chosen);

/// The whole program. Returns the exit status; does not throw.
int run(int argc, const char* const* argv);

// Scripts that complete camber's words at a shell's prompt, made from what the command line takes.

/// shell: "bash", "zsh" or "fish". To be loaded by it, or to lie where it looks for completions.
std::string completion_script(const CLI::App& app, const std::string& shell);

}  // namespace camber::cli
