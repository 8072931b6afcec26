#pragma once
// Options of the commands that read programs, and checks of options.
#include <string>

#include <CLI/CLI.hpp>

#include "camber/program.h"
#include "cli/global_options.h"

namespace camber::cli {

/// --units, --block-skip, --skip-switch
void add_reading_options(CLI::App& command, ReadOptions& read);
/// --dialect, --least-increments
void add_language_options(CLI::App& command, ReadOptions& read);
/// --tool-length 1=80: the length of offset H1.
void add_tool_lengths(CLI::App& command, ReadOptions& read);
/// --work-offset G54=X,Y,Z[,A,B,C]; may be repeated.
void add_work_offsets(CLI::App& command, ReadOptions& read);

/// --tolerance-mm, --output, --report: what every command takes that writes a path anew.
void add_rewriting(CLI::App& command, double& tolerance_mm, std::string& output, std::string& page);

/// "nan" and "inf" are none.
CLI::Validator number_from_to(double min, double max);
/// A length in mm; "nan" is none.
CLI::Validator length_validator();

/// The answer to --effective-config of a command with a machine.
int print_effective_machine(const std::string& path, const GlobalOptions& options);

}  // namespace camber::cli
