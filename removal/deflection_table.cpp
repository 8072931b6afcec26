#include "removal/deflection_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "base/vector_clones.h"

namespace camber::removal {

namespace {

/// The largest sum of squares among `pairs` pairs of values.
CAMBER_VECTOR_CLONES
float largest_square(const float* values, std::size_t pairs) {
  constexpr std::size_t kLanes = 8;
  std::array<float, kLanes> most{};
  std::size_t i = 0;
  for (; i + kLanes <= pairs; i += kLanes)
    for (std::size_t l = 0; l < kLanes; ++l) {
      const float x = values[2 * (i + l)], y = values[2 * (i + l) + 1], square = x * x + y * y;
      most[l] = square > most[l] ? square : most[l];
    }
  for (; i < pairs; ++i)
    most[0] = std::max(most[0], values[2 * i] * values[2 * i] + values[2 * i + 1] * values[2 * i + 1]);
  return *std::max_element(most.begin(), most.end());
}

}  // namespace

double DeflectionTable::largest_lateral_mm(std::ptrdiff_t k) const {
  return std::sqrt(static_cast<double>(largest_square(row(k), lateral_size() / 2)));
}

double DeflectionTable::largest_axial_mm(std::ptrdiff_t k) const {
  float largest = 0;
  for (int m = 0; axial && m < steps; ++m) largest = std::max(largest, std::abs(axial_mm(row(k), m)));
  return static_cast<double>(largest);
}

DeflectionTable DeflectionTable::of_tool_alone() const {
  assert(parts);
  DeflectionTable out(stamps, steps, node_height_mm, axial);
  out.edges_end_mm = edges_end_mm;
  const std::size_t size = out.row_size();
  for (std::ptrdiff_t k = -1; k < static_cast<std::ptrdiff_t>(stamps); ++k)
    std::transform(row(k), row(k) + size, row(k) + size, out.row(k), std::minus<>());
  return out;
}

NodeWeight node_weight(const std::vector<double>& nodes, double height) {
  const int last = static_cast<int>(nodes.size()) - 1;
  if (last < 1 || height <= nodes.front()) return {0, 0, 0};
  if (height >= nodes.back()) return {last, last, 0};
  const double at = (height - nodes[0]) / (nodes[1] - nodes[0]);
  const int lower = std::min(static_cast<int>(at), last - 1);
  return {lower, lower + 1, static_cast<float>(at - lower)};
}

Vec3 DeflectionTable::at(const float* row, double height_mm, double step) const {
  const int before = static_cast<int>(step) % steps, after = (before + 1) % steps;
  const double fraction = step - std::floor(step);
  const NodeWeight w = node_weight(node_height_mm, height_mm);
  Vec2 sum = Vec2::Zero();
  const auto add = [&](int node, int m, double weight) {
    const float* v = row + 2 * (node * steps + m);
    sum += weight * Vec2(v[0], v[1]);
  };
  add(w.lower, before, (1 - w.upper_fraction) * (1 - fraction));
  add(w.lower, after, (1 - w.upper_fraction) * fraction);
  add(w.upper, before, w.upper_fraction * (1 - fraction));
  add(w.upper, after, w.upper_fraction * fraction);
  const double z = axial ? (1 - fraction) * static_cast<double>(axial_mm(row, before)) +
                               fraction * static_cast<double>(axial_mm(row, after))
                         : 0.0;
  return {sum.x(), sum.y(), z};
}

}  // namespace camber::removal
