#pragma once
// Parts joined as they come, without keeping them all.
#include <cstddef>
#include <vector>

#include "removal/stock_part.h"

namespace camber::removal {

/// What parts cut together, as StockPart(span) of all of them in the order in which they were added. Of n parts at most
/// about log2(n) joined ones are in memory, and each part is joined about as often.
class JoinedParts {
 public:
  void add(StockPart part);
  /// All so far; begins anew.
  StockPart take();

 private:
  struct Group {
    StockPart part;
    std::size_t of = 1;  ///< parts in it
  };
  void join_last_two();

  std::vector<Group> groups_;  ///< in order, each of more parts than the next
};

}  // namespace camber::removal
