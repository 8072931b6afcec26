#pragma once
// Diagnostics as a compiler prints them: file:line:column: error: what, and what was expected [check].
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "camber/export.h"

namespace camber {
inline namespace v0 {

enum class Severity { warning, error };

/// line and column are 1-based; line 0 means the file as a whole.
struct CAMBER_API SourceLocation {
  std::string file;
  std::size_t line = 0;
  std::size_t column = 0;
};

struct CAMBER_API Diagnostic {
  Severity severity = Severity::error;
  SourceLocation location;
  std::string message;      ///< with the value and what was expected
  std::string check;        ///< name of the check, printed in brackets; stable
  std::string source_line;  ///< shown below with a caret; empty: not shown
};

/// "file:line:column: error: message [check]" and, where there is one, the source line with a caret.
/// No newline at the end. Control characters and invalid UTF-8 are printed as `?`, because a terminal would interpret
/// them.
CAMBER_API std::string to_string(const Diagnostic& diagnostic);

/// The user's input is wrong. what() contains all diagnostics, one per line.
class CAMBER_API InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Diagnostic> diagnostics);
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

/// The input is valid, but beyond the range of the model, so there are no results.
class CAMBER_API BeyondModel : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The caller asked a running function to stop (run.h).
class CAMBER_API Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("cancelled by the caller") {}
};

}  // namespace v0
}  // namespace camber
