#pragma once
// Diagnostics as a compiler prints them: file:line:column: error: what, and what was expected [check-name].
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace camber {

enum class Severity { warning, error };

/// line and column are 1-based; line 0 means the file as a whole.
struct SourceLocation {
  std::string file;
  std::size_t line = 0;
  std::size_t column = 0;
};

struct Diagnostic {
  Severity severity = Severity::error;
  SourceLocation location;
  std::string message;      ///< in shop words, with the value and what was expected
  std::string check;        ///< name of the check, printed in brackets
  std::string source_line;  ///< shown below with a caret; empty: not shown
};

/// "file:line:column: error: message [check]" and, where there is one, the source line with a caret.
/// No newline at the end. Control characters and bytes that are no UTF-8 are printed as `?`: they come from the user's
/// file, and a terminal would obey them.
std::string to_string(const Diagnostic& diagnostic);

/// The user's input is wrong. what() holds all diagnostics, one below the other.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Diagnostic> diagnostics);
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

/// Throws an InputError that holds one error about a file as a whole.
[[noreturn]] void fail_on_file(std::string file, std::string message, std::string check);

/// Collects what a reader finds. After `kMaxErrors` errors `add` throws the InputError itself.
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

/// A text file in memory that can tell line and column of an offset.
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
  Diagnostic diagnostic(Severity severity, std::size_t offset, std::string message, std::string check) const;

 private:
  std::string name_;
  std::string text_;
  std::size_t line_count_ = 0;
  /// Offsets of lines 1, 1 + kLinesPerMark ...; the others are counted from there: a program of millions of lines is
  /// asked for few of them.
  std::vector<std::size_t> marks_;
  static constexpr std::size_t kLinesPerMark = 64;
};

}  // namespace camber
