#pragma once
// Samples of the feed model as the library hands them out.
#include <functional>
#include <span>
#include <vector>

#include "camber/feed.h"
#include "feedmodel/timed_path.h"
#include "nc/move.h"

namespace camber::api {

/// A sink for predict_feed that appends to `points`; both must outlive it.
feedmodel::SampleSink points_sink(const nc::Interpretation& moves, std::vector<FeedPoint>& points);

}  // namespace camber::api
