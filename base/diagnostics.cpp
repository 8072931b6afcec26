#include "base/diagnostics.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "base/folders.h"

namespace camber {

namespace {

bool is_control(unsigned char c) { return c < 0x20 || c == 0x7f; }

/// Bytes of a UTF-8 character at `at`; 0: no such character begins there. Codes that control a terminal (U+0080 to
/// U+009F) are none.
std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0; };
  const unsigned char first = byte(0);
  const std::size_t length = first < 0x80                    ? 1
                             : first >= 0xc2 && first < 0xe0 ? 2
                             : first >= 0xe0 && first < 0xf0 ? 3
                             : first >= 0xf0 && first < 0xf5 ? 4
                                                             : 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0) != 0x80) return 0;
  return first == 0xc2 && byte(1) < 0xa0 ? 0 : length;
}

/// The text without what a terminal would take as a command: each such byte becomes a `?`, so that columns stay.
std::string harmless(std::string_view text, std::string_view kept) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    const bool control = length == 0 || (is_control(static_cast<unsigned char>(text[at])) &&
                                         kept.find(text[at]) == std::string_view::npos);
    if (control)
      out += '?';
    else
      out.append(text, at, length);
    at += control ? 1 : length;
  }
  return out;
}

}  // namespace

std::string v0::to_string(const Diagnostic& d) {
  std::string out = harmless(d.location.file, "");
  if (d.location.line > 0) out += fmt::format(":{}:{}", d.location.line, d.location.column);
  out += fmt::format(": {}: {}", d.severity == Severity::error ? "error" : "warning", harmless(d.message, "\n\t"));
  if (!d.check.empty()) out += fmt::format(" [{}]", d.check);
  if (!d.source_line.empty() && d.location.column > 0) {
    // Tabs are kept in front of the caret, so that it stands below its word whatever a tab is worth.
    std::string indent;
    const std::size_t before = std::min(d.location.column - 1, d.source_line.size());
    for (std::size_t i = 0; i < before; ++i) indent += d.source_line[i] == '\t' ? '\t' : ' ';
    out += fmt::format("\n    {}\n    {}^", harmless(d.source_line, "\t"), indent);
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

void throw_if_any(const Diagnostics& diagnostics) {
  if (diagnostics.all().empty()) return;
  std::vector<Diagnostic> errors = diagnostics.all();
  for (auto& d : errors) d.severity = Severity::error;
  throw InputError(std::move(errors));
}

void Diagnostics::append(const Diagnostics& other) {
  for (const auto& d : other.all_) add(d);
}

namespace {

/// Carriage returns that end a line alone outnumber line feeds in the first part of the text.
char line_end_of(std::string_view text) {
  constexpr std::size_t kSample = 1 << 16;
  const std::string_view part = text.substr(0, kSample);
  std::size_t alone = 0, feeds = 0;
  char before = 0;
  for (std::size_t i = 0; i < part.size(); before = part[i++]) {
    if (part[i] == '\n') ++feeds;
    if (part[i] != '\r' || before == '\n' || before == '\r') continue;
    const char next = i + 1 < part.size() ? part[i + 1] : '\0';
    if (next != '\n' && next != '\r') ++alone;
  }
  return alone > feeds ? '\r' : '\n';
}

constexpr std::size_t kMaxPipeBytes = std::size_t{1} << 30;

/// All that is left of a stream whose length nobody knows (a pipe). Throws InputError beyond a gigabyte: devices such
/// as /dev/zero have no end.
std::string read_to_end(std::istream& in, const std::string& path) {
  std::string out;
  std::array<char, 1 << 16> piece;
  while (in.read(piece.data(), piece.size()), in.gcount() > 0) {
    out.append(piece.data(), static_cast<std::size_t>(in.gcount()));
    if (out.size() > kMaxPipeBytes)
      fail_on_file(path, "does not end after a gigabyte; a file was expected, or a pipe that ends", "file-unreadable");
  }
  return out;
}

}  // namespace

SourceText::SourceText(std::string name, std::string text)
    : name_(std::move(name)), text_(std::move(text)), line_end_(line_end_of(text_)) {
  for (std::size_t at = 0; at != std::string::npos; at = next_line(at))
    if (line_count_++ % kLinesPerMark == 0) marks_.push_back(at);
}

/// Start of the line behind the one that `from` lies in; npos where the text ends before.
std::size_t SourceText::next_line(std::size_t from) const {
  const std::size_t end = text_.find(line_end_, from);
  return end == std::string::npos || end + 1 >= text_.size() ? std::string::npos : end + 1;
}

SourceText SourceText::read(const std::string& path) {
  require_confined(path);
  std::error_code ec;
  if (!std::filesystem::exists(path, ec)) fail_on_file(path, "no such file", "file-missing");
  if (std::filesystem::is_directory(path, ec))
    fail_on_file(path, "is a folder; a file was expected", "file-unreadable");
  std::ifstream in(path, std::ios::binary);
  if (!in) fail_on_file(path, "cannot be opened for reading", "file-unreadable");
  // Half a program is another program.
  const auto refuse_half = [&] {
    if (in.bad())
      fail_on_file(path, "cannot be read to its end: " + std::string(std::strerror(errno)), "file-unreadable");
  };
  const bool has_size = std::filesystem::is_regular_file(path, ec);
  const auto size = has_size ? std::filesystem::file_size(path, ec) : 0;
  std::string text(ec ? 0 : static_cast<std::size_t>(size), '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  refuse_half();
  if (in) text += read_to_end(in, path);  // it has grown meanwhile
  refuse_half();
  return SourceText(path, std::move(text));
}

SourceLocation SourceText::location(std::size_t offset) const {
  if (marks_.empty()) return {name_, 1, 1};
  offset = std::min(offset, text_.size());
  const auto mark = std::upper_bound(marks_.begin(), marks_.end(), offset) - 1;
  std::size_t line = static_cast<std::size_t>(mark - marks_.begin()) * kLinesPerMark + 1, begin = *mark;
  for (std::size_t next = next_line(begin); next <= offset; next = next_line(begin)) {
    begin = next;
    ++line;
  }
  return {name_, line, offset - begin + 1};
}

std::string_view SourceText::line(std::size_t number) const {
  if (number == 0 || number > line_count_) return {};
  std::size_t begin = marks_[(number - 1) / kLinesPerMark];
  for (std::size_t i = (number - 1) % kLinesPerMark; i > 0; --i) begin = next_line(begin);
  std::size_t end = std::min(text_.find(line_end_, begin), text_.size());
  while (end > begin && text_[end - 1] == '\r') --end;
  return std::string_view(text_).substr(begin, end - begin);
}

Diagnostic SourceText::diagnostic(Severity severity, std::size_t offset, std::string message, std::string check) const {
  SourceLocation where = location(offset);
  std::string shown(line(where.line));
  if (shown.size() > 200) shown.clear();
  return {severity, std::move(where), std::move(message), std::move(check), std::move(shown)};
}

}  // namespace camber
