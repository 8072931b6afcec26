#include "nc/reporter.h"

#include <algorithm>

#include <fmt/format.h>

namespace camber::nc {

void Reporter::error(std::size_t offset, std::string_view check, std::string message, std::string_view alike) {
  add(Severity::error, offset, check, std::move(message), alike);
}

void Reporter::warning(std::size_t offset, std::string_view check, std::string message, std::string_view alike) {
  add(Severity::warning, offset, check, std::move(message), alike);
}

void Reporter::add(Severity severity, std::size_t offset, std::string_view check, std::string message,
                   std::string_view alike) {
  const std::string key = fmt::format("{}/{}/{}/{}", severity == Severity::error ? 'e' : 'w', check,
                                      alike.empty() ? message : alike, source_->name());
  if (const auto found = index_.find(key); found != index_.end()) {
    ++entries_[found->second].more;
    return;
  }
  if (severity == Severity::error) {
    if (full()) return;
    ++errors_;
  }
  index_.emplace(key, entries_.size());
  entries_.push_back({source_, severity, offset, std::string(check), std::move(message)});
}

void Reporter::forget() {
  entries_.clear();
  index_.clear();
  errors_ = 0;
}

void Reporter::finish() {
  std::stable_sort(entries_.begin(), entries_.end(),
                   [](const Entry& a, const Entry& b) { return a.offset < b.offset; });
  const std::vector<Entry> entries = std::move(entries_);
  forget();
  for (const Entry& e : entries) {
    const std::string more = e.more > 0 ? fmt::format(" (and {} more like it)", e.more) : "";
    diagnostics_.add(e.source->diagnostic(e.severity, e.offset, e.message + more, e.check));
  }
}

}  // namespace camber::nc
