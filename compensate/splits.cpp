#include "compensate/splits.h"

#include <algorithm>

namespace camber::compensate {

Splits::Splits(const ShiftPath& path) : kept_(path.ends_of_moves()) {}

std::size_t Splits::add_strays(const ShiftPath& path, double tolerance_mm) {
  const auto before = std::count(kept_.begin(), kept_.end(), true);
  path.keep_strays(tolerance_mm, kept_);
  return static_cast<std::size_t>(std::count(kept_.begin(), kept_.end(), true) - before);
}

ThinPath::ThinPath(const ShiftPath& whole, const std::vector<bool>& kept)
    : path_(whole.thinned(kept)), of_point_(whole.points().size()) {
  const auto& points = whole.points();
  for (const ShiftChain& c : whole.chains()) {
    std::size_t last = c.from;
    for (std::size_t i = c.from; i < c.from + c.count; ++i) {
      if (!kept[i]) continue;
      const double from = points[last].along_mm, length = points[i].along_mm - from;
      for (std::size_t k = last + 1; k < i; ++k)
        of_point_[k] = {point_.size() - 1, length > 0 ? (points[k].along_mm - from) / length : 0.0};
      // The last point of a chain has no upper neighbour: it is the upper end of the piece before.
      of_point_[i] = {point_.size(), 0.0};
      point_.push_back(i);
      last = i;
    }
    if (c.count > 1) of_point_[last] = {point_.size() - 2, 1.0};
  }
}

std::vector<Observation> ThinPath::places_of(std::span<const Observation> observations) const {
  std::vector<Observation> out(observations.begin(), observations.end());
  for (Observation& o : out) {
    // Both ends of a piece of the whole path lie in one piece of this one.
    const ShiftPath::PointInterval from = of_point_[o.place.lower], to = of_point_[o.place.lower + 1];
    const double end = to.lower == from.lower ? to.upper_fraction : 1.0;
    o.place = {from.lower, from.upper_fraction + o.place.upper_fraction * (end - from.upper_fraction)};
  }
  return out;
}

std::vector<double> ThinPath::greatest_of(std::span<const double> values) const {
  std::vector<double> out;
  out.reserve(point_.size());
  for (std::size_t k = 0; k < point_.size(); ++k) {
    const std::size_t end = k + 1 < point_.size() ? point_[k + 1] : values.size();
    out.push_back(*std::max_element(values.begin() + static_cast<std::ptrdiff_t>(point_[k]),
                                    values.begin() + static_cast<std::ptrdiff_t>(end)));
  }
  return out;
}

void ThinPath::take_shifts(const ShiftPath& whole) {
  for (std::size_t k = 0; k < point_.size(); ++k) path_.points()[k].shift_mm = whole.points()[point_[k]].shift_mm;
}

void ThinPath::give_shifts(ShiftPath& whole) const {
  for (std::size_t i = 0; i < of_point_.size(); ++i) whole.points()[i].shift_mm = path_.shift_at(of_point_[i]);
}

}  // namespace camber::compensate
