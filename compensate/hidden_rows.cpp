#include "compensate/hidden_rows.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace camber::compensate {
namespace {

constexpr double kDetour = 4;        // another row is much farther along the path than across
constexpr double kSameRow_mm = 1.5;  // and at least so far along it

/// Weighted means at the points of a path.
struct Means {
  std::vector<Vec3> sum;
  std::vector<double> weight;

  explicit Means(std::size_t count) : sum(count, Vec3::Zero()), weight(count, 0.0) {}

  void add(const ShiftPath::PointInterval& place, const Vec3& value) {
    add(place.lower, 1 - place.upper_fraction, value);
    add(place.lower + 1, place.upper_fraction, value);
  }
  std::vector<Vec3> take() {
    for (std::size_t i = 0; i < sum.size(); ++i)
      if (weight[i] > 0) sum[i] /= weight[i];
    return std::move(sum);
  }

 private:
  void add(std::size_t point, double by, const Vec3& value) {
    sum[point] += by * value;
    weight[point] += by;
  }
};

}  // namespace

std::vector<Vec3> path_offsets(const ShiftPath& path, const simulate::SimulatedProgram& given,
                               const simulate::SimulatedProgram& emitted, const MoveMap& map) {
  Means means(path.points().size());
  for (const removal::Stamp& stamp : emitted.path.stamps) {
    const MoveMap::MovePlace place = map.given(stamp.move, stamp.fraction);
    if (!path.contains(place.move)) continue;
    means.add(path.find(place.move, place.fraction),
              stamp.pose.tip_mm - given.pose_at(place.move, place.fraction).tip_mm);
  }
  // Where no tooth passing fell between two points, the offset is that of the point before.
  const std::vector<double> weight = means.weight;
  std::vector<Vec3> out = means.take();
  for (const Chain& chain : path.chains())
    for (std::size_t i = chain.from + 1; i < chain.from + chain.count; ++i)
      if (weight[i] <= 0) out[i] = out[i - 1];
  return out;
}

Rows::Rows(const ShiftPath& path) : path_(path), chain_of_(path.points().size()) {
  for (std::size_t c = 0; c < path.chains().size(); ++c)
    std::fill_n(chain_of_.begin() + static_cast<std::ptrdiff_t>(path.chains()[c].from), path.chains()[c].count, c);
}

bool Rows::differ(const ShiftPath::PointInterval& a, const ShiftPath::PointInterval& b) const {
  if (chain_of_[a.lower] != chain_of_[b.lower]) return true;
  const ControlPoint &p = path_.points()[a.lower], &q = path_.points()[b.lower];
  return std::abs(p.along_mm - q.along_mm) > kSameRow_mm + kDetour * (p.place_mm - q.place_mm).norm();
}

}  // namespace camber::compensate
