#pragma once
// Fewer points for a picture, without losing the extremes.
#include <cstddef>
#include <span>
#include <vector>

namespace camber::report {

/// Indices, ascending, of at most `max_count` values (rounded up to whole runs): the values are taken in runs of equal
/// length, and of each run the first, the least and the greatest are kept. All indices where there are no more than
/// `max_count`.
std::vector<std::size_t> keep_extremes(std::span<const double> values, std::size_t max_count);

/// The smallest of 1, 1.5, 2, 3, 4, 5, 7.5, 10, 15 ... (or 0.75, 0.5 ...) that is not less than `value`; 1 for zero.
double nice_limit(double value);

}  // namespace camber::report
