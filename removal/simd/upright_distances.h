#pragma once
// The distance of one place to many rounded cylinders (ball, flat, bull-nose), in vectors.
#include <cstddef>

namespace camber::removal::upright {

/// out[k]: from the place to the cutter of flat radius `flat` and corner radius `corner` whose tip is at (x[k], y[k],
/// z[k]); negative inside, mm, in single precision.
void rounded_distances(const float* x, const float* y, const float* z, std::size_t count, float px, float py, float pz,
                       float flat, float corner, float* __restrict out);

/// A thin disc: around `centre`, `across` to its rim, `thick` from its middle to either face; the unit vector `normal`
/// stands on it.
struct Disc {
  float centre[3], normal[3];
  float across, thick;
};

/// out[k]: no place of the disc is nearer to the cutter than this (these cutters are convex, so their distance is
/// nowhere less than its tangent).
void rounded_distances_to(const float* x, const float* y, const float* z, std::size_t count, const Disc& disc,
                          float flat, float corner, float* __restrict out);

}  // namespace camber::removal::upright
