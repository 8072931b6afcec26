#include "base/diagnostics.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

namespace camber {

std::string to_string(const Diagnostic& d) {
  std::string out = d.location.file;
  if (d.location.line > 0) out += fmt::format(":{}:{}", d.location.line, d.location.column);
  out += fmt::format(": {}: {}", d.severity == Severity::error ? "error" : "warning", d.message);
  if (!d.check.empty()) out += fmt::format(" [{}]", d.check);
  if (!d.source_line.empty() && d.location.column > 0) {
    // Tabs are kept in front of the caret, so that it stands below its word whatever a tab is worth.
    std::string indent;
    const std::size_t before = std::min(d.location.column - 1, d.source_line.size());
    for (std::size_t i = 0; i < before; ++i) indent += d.source_line[i] == '\t' ? '\t' : ' ';
    out += fmt::format("\n    {}\n    {}^", d.source_line, indent);
  }
  return out;
}

namespace {
std::string joined(const std::vector<Diagnostic>& diagnostics) {
  std::string out;
  for (const auto& d : diagnostics) out += (out.empty() ? "" : "\n") + to_string(d);
  return out;
}
}  // namespace

InputError::InputError(std::vector<Diagnostic> diagnostics)
    : std::runtime_error(joined(diagnostics)), diagnostics_(std::move(diagnostics)) {}

void fail_on_file(std::string file, std::string message, std::string check) {
  throw InputError({Diagnostic{Severity::error, {std::move(file), 0, 0}, std::move(message), std::move(check), {}}});
}

void Diagnostics::add(Diagnostic diagnostic) {
  if (diagnostic.severity == Severity::error) ++errors_;
  all_.push_back(std::move(diagnostic));
  if (errors_ >= kMaxErrors) throw InputError(all_);
}

void Diagnostics::throw_if_errors() const {
  if (has_errors()) throw InputError(all_);
}

void Diagnostics::append(const Diagnostics& other) {
  for (const auto& d : other.all_) add(d);
}

SourceText::SourceText(std::string name, std::string text) : name_(std::move(name)), text_(std::move(text)) {
  line_starts_.push_back(0);
  for (std::size_t i = 0; i < text_.size(); ++i)
    if (text_[i] == '\n' && i + 1 < text_.size()) line_starts_.push_back(i + 1);
}

SourceText SourceText::read(const std::string& path) {
  std::error_code ec;
  if (!std::filesystem::exists(path, ec)) fail_on_file(path, "no such file", "file-missing");
  if (std::filesystem::is_directory(path, ec)) fail_on_file(path, "is a folder; a file was expected", "file-unreadable");
  std::ifstream in(path, std::ios::binary);
  if (!in) fail_on_file(path, "cannot be opened for reading", "file-unreadable");
  std::ostringstream buffer;
  buffer << in.rdbuf();
  return SourceText(path, std::move(buffer).str());
}

SourceLocation SourceText::location(std::size_t offset) const {
  offset = std::min(offset, text_.size());
  const auto it = std::upper_bound(line_starts_.begin(), line_starts_.end(), offset);
  const std::size_t line = static_cast<std::size_t>(it - line_starts_.begin());
  if (line == 0) return {name_, 1, offset + 1};
  return {name_, line, offset - line_starts_[line - 1] + 1};
}

std::string_view SourceText::line(std::size_t number) const {
  if (number == 0 || number > line_starts_.size()) return {};
  const std::size_t begin = line_starts_[number - 1];
  std::size_t end = number < line_starts_.size() ? line_starts_[number] : text_.size();
  while (end > begin && (text_[end - 1] == '\n' || text_[end - 1] == '\r')) --end;
  return std::string_view(text_).substr(begin, end - begin);
}

Diagnostic SourceText::diagnostic(Severity severity, std::size_t offset, std::string message, std::string check) const {
  SourceLocation where = location(offset);
  std::string shown(line(where.line));
  if (shown.size() > 200) shown.clear();
  return {severity, std::move(where), std::move(message), std::move(check), std::move(shown)};
}

}  // namespace camber
