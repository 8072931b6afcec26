#include "workpiece/elastic.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <tbb/parallel_for.h>

#include "base/cancel.h"

namespace camber::workpiece {

namespace {

using At = std::array<std::int32_t, 3>;

/// The voxel in which the stock's box begins along an axis.
int first_voxel(const removal::Stock& stock, Eigen::Index axis) {
  return static_cast<int>(std::floor(stock.min_mm()[axis] / stock.voxel_mm() + 0.5 + 1e-6));
}
int lowest_voxel(const removal::Stock& stock) { return first_voxel(stock, 2); }

/// Material, and what is held of it, of one cell.
struct Filling {
  Moments material{}, held{};
};

/// A voxel's material: how much, and where its middle is.
struct VoxelMaterial {
  double fraction = 0;
  Vec3 middle = Vec3::Zero();              ///< from the voxel's own, in voxels
  Vec3 spread = Vec3::Constant(1.0 / 12);  ///< mean square from the middle along x, y and z
};

/// Distances of a cell's voxels with one around them.
class CellVoxels {
 public:
  CellVoxels(const removal::Stock& stock, int voxels) : stock_(stock), side_(voxels + 2) {
    values_.resize(static_cast<std::size_t>(side_ * side_ * side_));
  }
  void read(const removal::Index3& first) {
    stock_.read({first[0] - 1, first[1] - 1, first[2] - 1}, side_, values_.data(), nullptr);
  }
  /// From -1 to the number of voxels.
  double at(int x, int y, int z) const {
    return static_cast<double>(values_[static_cast<std::size_t>(((x + 1) * side_ + y + 1) * side_ + z + 1)]);
  }
  /// Every voxel of the cell is at least so deep in material, or so far from it.
  bool all_within(double mm) const {
    return std::ranges::all_of(values_, [&](float d) { return static_cast<double>(d) <= -mm; });
  }
  bool all_beyond(double mm) const {
    return std::ranges::all_of(values_, [&](float d) { return static_cast<double>(d) >= mm; });
  }
  /// The surface is taken as a plane.
  VoxelMaterial material(int x, int y, int z) const {
    const double h = stock_.voxel_mm(), d = at(x, y, z);
    VoxelMaterial out;
    if (d <= -h || d >= h) return out.fraction = d < 0 ? 1 : 0, out;
    Vec3 n(at(x + 1, y, z) - at(x - 1, y, z), at(x, y + 1, z) - at(x, y - 1, z), at(x, y, z + 1) - at(x, y, z - 1));
    if (n.norm() > 0) n.normalize();
    const double width = std::max(1.0, n.lpNorm<1>());
    out.fraction = std::clamp(0.5 - d / (h * width), 0.0, 1.0);
    out.middle = -n * (1 - out.fraction) / 2;
    out.spread.array() *= 1 - n.array().square() * (1 - out.fraction * out.fraction);
    return out;
  }

 private:
  const removal::Stock& stock_;
  int side_;
  std::vector<float> values_;
};

/// Adds a piece of material at a place in the cell's coordinates.
void add_moments(double volume, const Vec3& place, const Vec3& spread, Moments& out) {
  std::array<std::array<double, 3>, 3> power;
  for (int a = 0; a < 3; ++a) power[static_cast<std::size_t>(a)] = {1, place[a], place[a] * place[a] + spread[a]};
  std::size_t i = 0;
  for (const double x : power[0])
    for (const double y : power[1])
      for (const double z : power[2]) out[i++] += volume * x * y * z;
}

class Filler {
 public:
  Filler(const removal::Stock& stock, const SolidOptions& options, int voxels)
      : stock_(stock), options_(options), voxels_(voxels), lowest_(lowest_voxel(stock)) {}

  /// Filling of the cell that begins with this voxel.
  Filling of(const removal::Index3& first, CellVoxels& distances) const {
    distances.read(first);
    Filling out;
    if (distances.all_beyond(stock_.voxel_mm())) return out;
    const bool whole = distances.all_within(stock_.voxel_mm());
    if (whole) out.material = moments_of_whole_cell();
    const bool near_bottom = options_.bottom && first[2] <= lowest_;
    if (whole && !near_bottom && !options_.held) return out;
    const double width = 2.0 / voxels_;
    if (options_.held) out.material = {};
    for (int x = 0; x < voxels_; ++x)
      for (int y = 0; y < voxels_; ++y)
        for (int z = 0; z < voxels_; ++z) {
          const Vec3 voxel(first[0] + x, first[1] + y, first[2] + z);
          const VoxelMaterial m = whole ? VoxelMaterial{.fraction = 1} : distances.material(x, y, z);
          if (m.fraction <= 0 || held(voxel)) continue;
          const Vec3 place = width * (Vec3(x, y, z) + Vec3::Constant(0.5) + m.middle) - Vec3::Ones();
          const double volume = m.fraction * width * width * width;
          if (!whole || options_.held) add_moments(volume, place, width * width * m.spread, out.material);
          if (near_bottom && first[2] + z == lowest_) {
            const double level = width * (stock_.min_mm().z() / stock_.voxel_mm() - first[2] + 0.5) - 1;
            add_moments(width * width * width, {place.x(), place.y(), level}, Vec3::Zero(), out.held);
          }
          if (options_.held) add_held_sides(voxel, distances, {x, y, z}, out.held);
        }
    return out;
  }

 private:
  bool held(const Vec3& voxel) const { return options_.held && options_.held(voxel * stock_.voxel_mm()); }
  /// Held material does not bend: its sides to the rest hold that, and a cell that is held in part bends from there on.
  void add_held_sides(const Vec3& voxel, const CellVoxels& distances, const Eigen::Vector3i& at, Moments& out) const {
    const double width = 2.0 / voxels_;
    for (int axis = 0; axis < 3; ++axis)
      for (const int way : {-1, 1}) {
        Eigen::Vector3i step = Eigen::Vector3i::Zero();
        step[axis] = way;
        const Eigen::Vector3i beside = at + step;
        if (distances.at(beside[0], beside[1], beside[2]) >= 0 || !held(voxel + step.cast<double>())) continue;
        const Vec3 side = width * (at.cast<double>() + Vec3::Constant(0.5) + 0.5 * step.cast<double>()) - Vec3::Ones();
        add_moments(width * width * width, side, Vec3::Zero(), out);
      }
  }

  const removal::Stock& stock_;
  const SolidOptions& options_;
  int voxels_;
  int lowest_;  ///< voxel with material, along z
};

/// Rounded moments, the same for cells that are equally stiff.
std::array<std::int32_t, 54> key_of(const Filling& f) {
  constexpr double kPerUnit = 1e6;
  std::array<std::int32_t, 54> out;
  for (std::size_t i = 0; i < 27; ++i) {
    out[i] = static_cast<std::int32_t>(std::lround(kPerUnit * f.material[i]));
    out[27 + i] = static_cast<std::int32_t>(std::lround(kPerUnit * f.held[i]));
  }
  return out;
}

}  // namespace

void NodeWeights::add(const NodeWeights& other, double share) {
  for (const Weight& w : other.nodes) nodes.push_back({w.node, share * w.weight});
}

Solid::Solid(const removal::Stock& stock, const SolidOptions& options) {
  constexpr double kLeast = 0.04;  // of 8
  const double h = stock.voxel_mm();
  const int voxels = std::max(1, static_cast<int>(std::lround(options.cell_mm / h)));
  cell_mm_ = voxels * h;
  unit_N_per_mm_ = options.youngs_modulus_MPa * cell_mm_ / 2;
  removal::Index3 first;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto e = static_cast<Eigen::Index>(a);
    first[a] = first_voxel(stock, e);
    const int last = static_cast<int>(std::ceil(stock.max_mm()[e] / h - 0.5 - 1e-6));
    size_[a] = (last - first[a]) / voxels + 1;
    origin_mm_[e] = (first[a] - 0.5) * h;
  }
  const auto [nx, ny, nz] = size_;
  cell_at_.assign(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz), -1);
  const Filler filler(stock, options, voxels);
  std::vector<std::vector<std::pair<At, Filling>>> found(static_cast<std::size_t>(nx));
  tbb::parallel_for(0, nx, [&](int x) {
    cancellation_point();
    CellVoxels distances(stock, voxels);
    for (int y = 0; y < ny; ++y)
      for (int z = 0; z < nz; ++z) {
        const Filling f = filler.of({first[0] + x * voxels, first[1] + y * voxels, first[2] + z * voxels}, distances);
        if (f.material[0] > kLeast) found[static_cast<std::size_t>(x)].push_back({{x, y, z}, f});
      }
  });
  double held = 0;
  for (const auto& layer : found)
    for (const auto& [at, f] : layer) held += f.held[0];
  held_mm3_ = held * std::pow(cell_mm_ / 2, 3);
  constexpr double kFirm = 50;  // against the stiffness of a cell
  const double bed = options.fixture_stiffness_N_per_mm
                         ? *options.fixture_stiffness_N_per_mm / (std::max(held, 1e-30) * unit_N_per_mm_)
                         : kFirm * 8;
  const Hexahedron hexahedron(options.poisson_ratio);
  std::map<std::array<std::int32_t, 54>, std::int32_t> kind_of;
  std::vector<bool> holds;
  for (const auto& layer : found) {
    layers_.push_back(cells_.size());
    for (const auto& [at, f] : layer) {
      const auto [kind, is_new] = kind_of.try_emplace(key_of(f), static_cast<std::int32_t>(kinds_.size()));
      if (is_new) {
        kinds_.push_back(hexahedron.stiffness(f.material));
        // A thin held layer holds like a thick one.
        const double share = options.fixture_stiffness_N_per_mm ? 1 : 1 / std::max(f.held[0], 1e-30);
        if (f.held[0] > 0) kinds_.back() += bed * share * Hexahedron::bed(f.held);
      }
      cell_at_[place_of(at)] = static_cast<std::int32_t>(cells_.size());
      holds.push_back(f.held[0] > 0);
      cells_.push_back({{}, kind->second, at});
    }
  }
  layers_.push_back(cells_.size());
  if (held > 0) drop_loose(holds);
  number_nodes();
}

/// By their sides: what hangs on an edge falls.
void Solid::drop_loose(const std::vector<bool>& holds) {
  std::vector<bool> hangs = holds;
  std::vector<std::size_t> next;
  for (std::size_t i = 0; i < cells_.size(); ++i)
    if (hangs[i]) next.push_back(i);
  while (!next.empty()) {
    const At at = cells_[next.back()].at;
    next.pop_back();
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int way : {-1, 1}) {
        At beside = at;
        beside[axis] += way;
        const std::int32_t i = cell_at(beside);
        if (i < 0 || hangs[static_cast<std::size_t>(i)]) continue;
        hangs[static_cast<std::size_t>(i)] = true;
        next.push_back(static_cast<std::size_t>(i));
      }
  }
  std::vector<Cell> kept;
  std::vector<std::size_t> layers;
  for (std::size_t l = 0; l + 1 < layers_.size(); ++l) {
    layers.push_back(kept.size());
    for (std::size_t i = layers_[l]; i < layers_[l + 1]; ++i) {
      std::int32_t& at = cell_at_[place_of(cells_[i].at)];
      at = hangs[i] ? static_cast<std::int32_t>(kept.size()) : -1;
      if (hangs[i]) kept.push_back(cells_[i]);
    }
  }
  layers.push_back(kept.size());
  cells_ = std::move(kept);
  layers_ = std::move(layers);
}

std::size_t Solid::place_of(const At& at) const {
  return (static_cast<std::size_t>(at[0]) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(at[1])) *
             static_cast<std::size_t>(size_[2]) +
         static_cast<std::size_t>(at[2]);
}

void Solid::number_nodes() {
  const std::size_t ny = static_cast<std::size_t>(size_[1]) + 1, nz = static_cast<std::size_t>(size_[2]) + 1;
  std::vector<std::int32_t> number((static_cast<std::size_t>(size_[0]) + 1) * ny * nz, -1);
  const auto place = [&](const Cell& c, std::size_t n) {
    return (static_cast<std::size_t>(c.at[0]) + (n & 1)) * ny * nz +
           (static_cast<std::size_t>(c.at[1]) + (n >> 1 & 1)) * nz + static_cast<std::size_t>(c.at[2]) + (n >> 2);
  };
  for (const Cell& c : cells_)
    for (std::size_t n = 0; n < 8; ++n) number[place(c, n)] = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = static_cast<std::int32_t>(node_at_.size());
    node_at_.push_back({static_cast<std::int32_t>(i / (ny * nz)), static_cast<std::int32_t>(i / nz % ny),
                        static_cast<std::int32_t>(i % nz)});
  }
  for (Cell& c : cells_)
    for (std::size_t n = 0; n < 8; ++n) c.node[n] = number[place(c, n)];
}

Vec3 Solid::node_mm(std::size_t node) const {
  const At& at = node_at_[node];
  return origin_mm_ + cell_mm_ * Vec3(at[0], at[1], at[2]);
}

std::int32_t Solid::cell_at(const At& at) const {
  for (std::size_t a = 0; a < 3; ++a)
    if (at[a] < 0 || at[a] >= size_[a]) return -1;
  return cell_at_[place_of(at)];
}

NodeWeights Solid::at(const Vec3& point) const {
  const Vec3 in_cells = (point - origin_mm_) / cell_mm_;
  At around;
  for (std::size_t a = 0; a < 3; ++a)
    around[a] = static_cast<std::int32_t>(std::floor(in_cells[static_cast<Eigen::Index>(a)]));
  std::int32_t nearest = -1;
  double least = 0;
  constexpr int kReach = 2;
  for (int x = -kReach; x <= kReach; ++x)
    for (int y = -kReach; y <= kReach; ++y)
      for (int z = -kReach; z <= kReach; ++z) {
        const At at{around[0] + x, around[1] + y, around[2] + z};
        const std::int32_t cell = cell_at(at);
        if (cell < 0) continue;
        const Vec3 low(at[0], at[1], at[2]);
        const double away = (in_cells - in_cells.cwiseMax(low).cwiseMin(low + Vec3::Ones())).norm();
        if (nearest < 0 || away < least) nearest = cell, least = away;
      }
  NodeWeights out;
  if (nearest < 0) return out;
  const Cell& cell = cells_[static_cast<std::size_t>(nearest)];
  const Vec3 place = (2 * (in_cells - Vec3(cell.at[0], cell.at[1], cell.at[2])) - Vec3::Ones())
                         .cwiseMax(-Vec3::Ones())
                         .cwiseMin(Vec3::Ones());
  const auto shape = shape_functions(place);
  for (std::size_t n = 0; n < 8; ++n) out.nodes.push_back({cell.node[n], shape[n]});
  return out;
}

}  // namespace camber::workpiece
