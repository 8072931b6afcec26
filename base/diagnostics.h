#pragma once
// Collecting diagnostics (camber/diagnostics.h), and the text that they are about.
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "camber/diagnostics.h"

namespace camber {

/// Throws an InputError with one error about a file as a whole.
[[noreturn]] void fail_on_file(std::string file, std::string message, std::string check);

/// Collects the diagnostics of a reader. After `kMaxErrors` errors `add` throws the InputError itself.
class Diagnostics {
 public:
  static constexpr std::size_t kMaxErrors = 20;

  void add(Diagnostic diagnostic);
  bool has_errors() const { return errors_ > 0; }
  const std::vector<Diagnostic>& all() const { return all_; }
  std::size_t errors() const { return errors_; }
  std::size_t warnings() const { return all_.size() - errors_; }
  /// Throws InputError with everything collected when there is at least one error.
  void throw_if_errors() const;
  void append(const Diagnostics& other);

 private:
  std::vector<Diagnostic> all_;
  std::size_t errors_ = 0;
};

/// Implements --strict (warnings are errors). Throws InputError if there is any diagnostic.
void throw_if_any(const Diagnostics& diagnostics);

/// A text file in memory; maps offsets to line and column.
class SourceText {
 public:
  SourceText() = default;
  SourceText(std::string name, std::string text);

  /// Reads the whole file. Throws InputError [file-missing], [file-unreadable].
  static SourceText read(const std::string& path);

  const std::string& name() const { return name_; }
  const std::string& text() const { return text_; }
  SourceLocation location(std::size_t offset) const;
  /// Text of a 1-based line without its line end.
  std::string_view line(std::size_t number) const;
  std::size_t line_count() const { return line_count_; }
  /// The last character of a line: a line feed; in a text whose lines end in a carriage return alone, that.
  char line_end() const { return line_end_; }
  Diagnostic diagnostic(Severity severity, std::size_t offset, std::string message, std::string check) const;

 private:
  std::string name_;
  std::string text_;
  std::size_t line_count_ = 0;
  char line_end_ = '\n';
  std::size_t next_line(std::size_t from) const;
  /// Offsets of lines 1, 1 + kLinesPerMark ...; the others are counted from there: a program of millions of lines is
  /// asked for few of them.
  std::vector<std::size_t> marks_;
  static constexpr std::size_t kLinesPerMark = 64;
};

}  // namespace camber
