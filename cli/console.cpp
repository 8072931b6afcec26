#include "cli/console.h"

#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>
#include <unistd.h>

namespace camber::cli {
namespace {

constexpr std::string_view kRed = "\033[1;31m", kMagenta = "\033[1;35m", kGreen = "\033[1;32m", kBold = "\033[1m",
                           kPlain = "\033[0m";

std::string coloured(std::string_view text, std::string_view colour) {
  return fmt::format("{}{}{}", colour, text, kPlain);
}

bool events = false;

Json event_of(const Diagnostic& d) {
  return {{"event", "diagnostic"},
          {"severity", d.severity == Severity::error ? "error" : "warning"},
          {"file", d.location.file},
          {"line", d.location.line},
          {"column", d.location.column},
          {"message", d.message},
          {"check", d.check},
          {"source_line", d.source_line}};
}

void print_diagnostic(const Diagnostic& d) {
  if (events)
    print_event(event_of(d));
  else
    fmt::print(stderr, "{}\n", diagnostic_text(d, colour_wanted()));
}

}  // namespace

void write_events() { events = true; }
bool events_wanted() { return events; }

void print_event(const Json& event) {
  const std::string line = event.dump() + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);  // holds the stream's lock
  std::fflush(stderr);
}

bool stderr_is_terminal() { return isatty(STDERR_FILENO) != 0; }

bool colour_wanted() {
  const char* no_color = std::getenv("NO_COLOR");
  return stderr_is_terminal() && (no_color == nullptr || *no_color == '\0');
}

std::string diagnostic_text(const Diagnostic& diagnostic, bool colour) {
  std::string text = to_string(diagnostic);
  if (!colour) return text;
  const bool error = diagnostic.severity == Severity::error;
  const std::string_view word = error ? "error:" : "warning:";
  // The caret is the text's last character where there is one.
  if (!diagnostic.source_line.empty() && text.back() == '^') text.replace(text.size() - 1, 1, coloured("^", kGreen));
  const std::size_t at = text.find(word, diagnostic.location.file.size());
  if (at == std::string::npos) return text;
  return coloured(text.substr(0, at), kBold) + coloured(word, error ? kRed : kMagenta) + text.substr(at + word.size());
}

void print_diagnostics(std::span<const Diagnostic> diagnostics, const GlobalOptions& options) {
  for (const auto& d : diagnostics)
    if (!options.quiet || d.severity == Severity::error) print_diagnostic(d);
}

void settle(const Diagnostics& diagnostics, const GlobalOptions& options) {
  diagnostics.throw_if_errors();
  if (options.strict) throw_if_any(diagnostics);
  print_diagnostics(diagnostics.all(), options);
}

void settle(const std::vector<Diagnostic>& warnings, const GlobalOptions& options) {
  Diagnostics collected;
  for (const Diagnostic& d : warnings) collected.add(d);
  settle(collected, options);
}

void print_translation(std::span<const std::string> translation, const GlobalOptions& options) {
  if (options.quiet) return;
  for (const std::string& line : translation) fmt::print(stderr, "{}\n", line);
}

void print_error(const std::string& sentence) {
  if (events) return print_event({{"event", "error"}, {"message", sentence}});
  fmt::print(stderr, "camber: {} {}\n", colour_wanted() ? coloured("error:", kRed) : "error:", sentence);
}

}  // namespace camber::cli
