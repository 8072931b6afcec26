#pragma once
// The figures of camber post: JSON and text for a terminal.
#include <cstddef>
#include <string>

#include "repath/post.h"
#include "repath/post_deviation.h"

namespace camber::report {

struct PostSummary {
  repath::PostOptions asked;
  repath::Posted posted;
  repath::PostDeviation deviation;  ///< by sampling
  std::size_t blocks_before = 0, blocks_after = 0;
};

/// With a line end.
std::string post_json(const PostSummary& summary);
/// For a terminal.
std::string post_text(const PostSummary& summary);

}  // namespace camber::report
