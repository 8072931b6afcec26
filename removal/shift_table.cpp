#include "removal/shift_table.h"

#include <algorithm>
#include <cmath>

namespace camber::removal {

double ShiftTable::largest_mm(std::ptrdiff_t k) const {
  const float* r = row(k);
  float largest = 0;
  for (std::size_t i = 0; i < row_size(); i += 2) largest = std::max(largest, r[i] * r[i] + r[i + 1] * r[i + 1]);
  return std::sqrt(static_cast<double>(largest));
}

NodeWeight node_weight(const std::vector<double>& nodes, double height) {
  const int last = static_cast<int>(nodes.size()) - 1;
  if (last < 1 || height <= nodes.front()) return {0, 0, 0};
  if (height >= nodes.back()) return {last, last, 0};
  const double at = (height - nodes[0]) / (nodes[1] - nodes[0]);
  const int lower = std::min(static_cast<int>(at), last - 1);
  return {lower, lower + 1, static_cast<float>(at - lower)};
}

}  // namespace camber::removal
