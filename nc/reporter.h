#pragma once
// Collects diagnostics of one NC program: each is reported once, with a count, in the order of the file.
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"

namespace camber::nc {

/// Collects what a pass over the program finds. The same complaint in many blocks is kept once, at its first place,
/// with "(and N more like it)". finish() hands everything to the Diagnostics, sorted by place.
class Reporter {
 public:
  Reporter(const SourceText& source, Diagnostics& diagnostics) : source_(&source), diagnostics_(diagnostics) {}

  /// Sets the file that later diagnostics are about. It must outlive finish().
  void set_source(const SourceText& source) { source_ = &source; }

  /// `alike`: what counts as the same complaint; empty: the message itself.
  void error(std::size_t offset, std::string_view check, std::string message, std::string_view alike = {});
  void warning(std::size_t offset, std::string_view check, std::string message, std::string_view alike = {});

  /// Forgets everything that was reported.
  void forget();
  /// True when as many different errors were met as a reader may give: time to stop.
  bool full() const { return errors_ + diagnostics_.errors() >= Diagnostics::kMaxErrors; }
  bool has_errors() const { return errors_ > 0; }

  /// Throws InputError when there are Diagnostics::kMaxErrors errors or more.
  void finish();

 private:
  struct Entry {
    const SourceText* source;
    Severity severity;
    std::size_t offset;
    std::string check, message;
    std::size_t more = 0;
  };
  void add(Severity severity, std::size_t offset, std::string_view check, std::string message, std::string_view alike);

  const SourceText* source_;
  Diagnostics& diagnostics_;
  std::vector<Entry> entries_;
  std::map<std::string, std::size_t, std::less<>> index_;
  std::size_t errors_ = 0;
};

}  // namespace camber::nc
