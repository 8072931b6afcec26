#pragma once
// The stamps of a path one by one, for those who do not keep all of them.
#include <cstddef>
#include <functional>

#include "removal/tool_path.h"

namespace camber::removal {

/// A stamp and its number in the path; of `run` the count is not known yet.
using StampSink = std::function<void(const ToolRun& run, std::size_t number, const Stamp& stamp)>;

/// While it lives, a StampBuilder of this thread gives its stamps to `sink`, and keeps none but the last: take() has
/// the runs and rapids. Only one may live in a thread; `sink` must outlive it.
class StampSinkScope {
 public:
  explicit StampSinkScope(const StampSink& sink);
  ~StampSinkScope();
  StampSinkScope(const StampSinkScope&) = delete;
  StampSinkScope& operator=(const StampSinkScope&) = delete;
};

}  // namespace camber::removal
