#include "nc/five_axis_words.h"

#include <algorithm>

#include "nc/dialects.h"

namespace camber::nc {

FiveAxisWords five_axis_words(const Dialect& dialect) {
  const auto row = std::ranges::find(kDialects, dialect.name, &Dialect::name);
  return kFiveAxisWords[static_cast<std::size_t>(row - kDialects.begin())];
}

}  // namespace camber::nc
