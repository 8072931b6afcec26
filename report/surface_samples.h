#pragma once
// The machined surface's points as the page reads them.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <ranges>
#include <utility>
#include <vector>

#include "base/geometry.h"

namespace camber::report {

/// A point of the machined surface with its unit normal and its form error, and the lines that made it.
struct SurfaceSample {
  Vec3 place_mm = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();
  double error_um = 0;            ///< positive: excess material
  double contour_um = 0;          ///< part of error_um due to servo lag and corner rounding
  double error_after_um = 0;      ///< error of the compensated program, where there is one
  double area_mm2 = 1;            ///< weight in scale, histogram and tables; 0 where the model does not hold
  std::uint32_t block = 0;        ///< 1-based line that made the surface here; 0: unknown
  std::uint32_t block_after = 0;  ///< the same in the compensated program
};

/// Points made as they are asked for: there are millions of them. What `at` refers to must outlive the object.
class SurfaceSamples {
 public:
  SurfaceSamples() = default;
  SurfaceSamples(std::size_t count, std::function<SurfaceSample(std::size_t)> at) : count_(count), at_(std::move(at)) {}
  /// Holds them.
  SurfaceSamples(std::vector<SurfaceSample> points)
      : count_(points.size()),
        at_([held = std::make_shared<const std::vector<SurfaceSample>>(std::move(points))](std::size_t i) {
          return (*held)[i];
        }) {}

  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  SurfaceSample operator[](std::size_t i) const { return at_(i); }
  auto all() const { return std::views::iota(std::size_t{0}, count_) | std::views::transform(std::cref(at_)); }

 private:
  std::size_t count_ = 0;
  std::function<SurfaceSample(std::size_t)> at_;
};

}  // namespace camber::report
