#include "compensate/hidden_rows.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "removal/tool_path.h"

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
                               const simulate::SimulatedProgram& emitted, const nc::MoveMap& map) {
  Means means(path.points().size());
  for (const removal::Stamp& stamp : emitted.path.stamps) {
    const nc::MoveMap::MovePlace place = map.given(stamp.move, stamp.fraction);
    if (!path.contains(place.move)) continue;
    means.add(path.find(place.move, place.fraction),
              stamp.pose.tip_mm - given.pose_at(place.move, place.fraction).tip_mm);
  }
  // Where no tooth passing fell between two points, the offset is that of the point before.
  const std::vector<double> weight = means.weight;
  std::vector<Vec3> out = means.take();
  for (const ShiftChain& chain : path.chains())
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

std::vector<Vec3> nominal_bending(const machine::Job& job, const simulate::Setup& given,
                                  const std::function<void(double)>& progress) {
  machine::Job rigid = job;
  rigid.simulation.coupling = machine::Coupling::rigid;
  simulate::SimulatedProgram nominal = given.program;
  nominal.path = removal::nominal_path(nominal.moves_in_part(), nominal.selected, nominal.path, nominal.part_path());
  simulate::PredictOptions options;
  options.progress = progress;
  std::vector<Vec3> out;
  for (const simulate::StampLoad& load : given.predictor(rigid, given.target, nominal, options).cut.loads)
    out.push_back(load.contact_deflection_mm);
  return out;
}

double expected_error_mm(const machine::Job& job, const removal::SurfacePoint& point,
                         const ShiftPath::PointInterval& owner, std::span<const Vec3> offsets,
                         std::span<const Vec3> bending) {
  const double bent = point.normal.dot(bending[static_cast<std::size_t>(point.target_stamp)]);
  if (job.compensation.reference == machine::Reference::machine) return bent;
  return bent + point.normal.dot((1 - owner.upper_fraction) * offsets[owner.lower] +
                                 owner.upper_fraction * offsets[owner.lower + 1]);
}

void scale_bending(const ShiftPath& path, const machine::Job& job, const simulate::Setup& given,
                   const Observed& observed, const std::vector<removal::SurfacePoint>& surface,
                   std::vector<Vec3>& bending) {
  const std::vector<Vec3> offsets = path_offsets(path, given.program, given.program, {});
  const std::vector<Vec3> none(bending.size(), Vec3::Zero());
  double products = 0, squares = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Observation& o = observed.points[i];
    if (!observed.compensated[i] || o.foreign || surface[i].target_stamp < 0) continue;
    const double expected = o.normal.dot(bending[static_cast<std::size_t>(surface[i].target_stamp)]);
    const double rest = o.error_mm - expected_error_mm(job, surface[i], o.place, offsets, none);
    products += o.area_mm2 * expected * rest;
    squares += o.area_mm2 * expected * expected;
  }
  const double scale = squares > 0 ? std::clamp(products / squares, 0.0, 1.0) : 1.0;
  for (Vec3& b : bending) b *= scale;
}

std::vector<Observation> expected_errors(const ShiftPath& path, const machine::Job& job, const simulate::Setup& given,
                                         const Observed& observed, const std::vector<removal::SurfacePoint>& surface,
                                         std::span<const Vec3> bending) {
  const std::vector<Vec3> offsets = path_offsets(path, given.program, given.program, {});
  std::vector<Observation> out;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const auto owner = owner_place(path, job, given, surface[i]);
    if (!owner) continue;
    Observation o = observed.points[i];
    set_place(o, surface[i], *owner, path, job, given.program);
    o.error_mm = expected_error_mm(job, surface[i], *owner, offsets, bending);
    o.own = true;
    o.above = false;
    out.push_back(o);
  }
  return out;
}

}  // namespace camber::compensate
