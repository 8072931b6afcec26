#pragma once
// The command lines that camber ui runs: the commands that anybody types, with their own checks and messages.
#include <map>
#include <string>
#include <vector>

#include "ui/folder.h"

namespace camber::ui {

/// Options of a request by name, as the command line has them without the dashes ("time-budget").
using Options = std::map<std::string, std::string, std::less<>>;

/// A command line, and what it writes.
struct Command {
  std::vector<std::string> arguments;  ///< behind the executable; files relative to the served folder
  std::string program{};               ///< the new program; empty: none
  std::string report{}, figures{};     ///< page and JSON; empty: none
};

/// Names of the commands that work on a job: predict, compensate, adapt, feed, time, compress, fit-feed.
const std::vector<std::string>& run_names();

/// The folder of a command's results.
std::string results_of(std::string_view job, std::string_view command);

/// Throws Refused 400 for a command or an option that is none of these, or a file that is missing.
Command run_command(const Folder& folder, const JobSummary& job, const std::string& name, const Options& options);

/// camber check of a job, or of a program alone. Figures and the job's set-up sheet or the program's path go to
/// `scratch` with `stem` as the beginning of their names.
Command check_command(const JobSummary& job, const std::string& scratch, const std::string& stem);
Command check_program_command(const std::string& program, const Options& options, const std::string& scratch,
                              const std::string& stem);

/// camber init; options: machine, material, units, tools (a file).
Command init_command(const Folder& folder, const std::string& program, const std::string& job, const Options& options);

/// Whether a job can be read, no more: what is quick enough for every key that somebody presses.
Command read_command(const std::string& job);

}  // namespace camber::ui
