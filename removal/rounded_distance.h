#pragma once
// The distance of one place to many rounded cylinders (ball, flat, bull-nose), in vectors.
#include <cstddef>

namespace camber::removal {

/// out[k]: from the place to the cutter of flat radius `flat` and corner radius `corner` whose tip is at (x[k], y[k],
/// z[k]); negative inside, mm, in single precision.
void rounded_distances(const float* x, const float* y, const float* z, std::size_t count, float px, float py, float pz,
                       float flat, float corner, float* __restrict out);

}  // namespace camber::removal
