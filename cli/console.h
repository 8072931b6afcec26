#pragma once
// What goes to the terminal: diagnostics, in colour where the terminal and the user want it.
#include <span>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/json.h"
#include "cli/global_options.h"

namespace camber::cli {

bool stderr_is_terminal();

/// From now on diagnostics, errors and progress are lines of JSON on stderr, for programs that run this one:
///   {"event": "diagnostic", "severity", "file", "line", "column", "message", "check", "source_line"}
///   {"event": "error", "message"}
///   {"event": "progress", "what", "share", "left_s"}     share: of the step, 0 to 1; left_s: of the step; null:
///   unknown
void write_events();
bool events_wanted();
/// One such line; the other threads' lines stay whole.
void print_event(const Json& event);

/// A terminal, and no NO_COLOR in the environment (https://no-color.org).
bool colour_wanted();

/// The text of to_string; with `colour` the place is bold, "error" red, "warning" magenta and the caret green.
std::string diagnostic_text(const Diagnostic& diagnostic, bool colour);

/// Prints all of them to stderr; with -q only the errors.
void print_diagnostics(std::span<const Diagnostic> diagnostics, const GlobalOptions& options);

/// Settles the messages of a command's readers: prints warnings; throws InputError when there are errors, or
/// (--strict) warnings, which are errors then.
void settle(const Diagnostics& diagnostics, const GlobalOptions& options);
/// The same of warnings.
void settle(const std::vector<Diagnostic>& warnings, const GlobalOptions& options);

/// Prints how [source] of a machine file was read, on stderr; nothing with -q.
void print_translation(std::span<const std::string> translation, const GlobalOptions& options);

/// One line "camber: error: ..." on stderr.
void print_error(const std::string& sentence);

}  // namespace camber::cli
