#pragma once
// Summary of a planned program: times and numbers of blocks.
#include "feedmodel/plan.h"
#include "feedmodel/timed_path.h"

namespace camber::feedmodel {

/// Summed up from segments in order.
class FeedSum {
 public:
  explicit FeedSum(const nc::Interpretation& program);
  void add(const SegmentTime& time);
  const FeedSummary& summary() const { return summary_; }

 private:
  FeedSummary summary_;
};

}  // namespace camber::feedmodel
