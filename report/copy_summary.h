#pragma once
// The figures of camber copy: JSON and text for a terminal.
#include <string>
#include <vector>

#include "copymill/copy_milling.h"

namespace camber::report {

std::string copy_json(const copymill::CopyResult& result, double compute_s);

/// The changes of feed and depths, a row each, in order of time.
std::string copy_log_csv(const copymill::CopyResult& result);

/// The same for a terminal, within 100 columns.
std::string copy_text(const copymill::CopyResult& result, double compute_s);

// The page of camber copy: path, feeds and loads over time, changes, figures.

/// Takes the ticks of a run as they come and keeps no more of them than a page can show.
class TickPicture {
 public:
  void add(const copymill::Tick& tick);
  const std::vector<copymill::Tick>& ticks() const { return ticks_; }

 private:
  static constexpr std::size_t kMost = 40000;
  std::vector<copymill::Tick> ticks_;  ///< every stride_-th
  std::size_t stride_ = 1, count_ = 0;
  copymill::Tick greatest_;  ///< tick of the greatest load since the last one kept
};

struct CopyFiles {
  std::string job, part, output;
};
/// The page's text, UTF-8, self-contained. The same data give the same bytes. Does not throw.
std::string copy_page(const copymill::CopyResult& result, const TickPicture& picture, const CopyFiles& files,
                      const std::vector<std::string>& warnings);

}  // namespace camber::report
