#include "removal/joined_parts.h"

#include <array>
#include <utility>

namespace camber::removal {

void JoinedParts::add(StockPart part) {
  groups_.push_back({std::move(part)});
  while (groups_.size() > 1 && groups_[groups_.size() - 2].of == groups_.back().of) join_last_two();
}

StockPart JoinedParts::take() {
  if (groups_.empty()) return {};
  while (groups_.size() > 1) join_last_two();
  StockPart out = std::move(groups_.back().part);
  groups_.clear();
  return out;
}

void JoinedParts::join_last_two() {
  Group& first = groups_[groups_.size() - 2];
  const std::array<const StockPart*, 2> both{&first.part, &groups_.back().part};
  StockPart joined(both);
  first = {std::move(joined), first.of + groups_.back().of};
  groups_.pop_back();
}

}  // namespace camber::removal
