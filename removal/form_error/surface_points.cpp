#include "base/stage.h"
#include "removal/field/tile.h"
#include "removal/form_error.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

namespace camber::removal {
namespace {

constexpr int kMargin = 4;         // voxels around a tile for gradients and edges
constexpr double kGrazing = 0.05;  // grid lines that meet the surface at a flatter angle tell nothing
constexpr int kPad = Tile::kCore + 2 * kMargin;

/// Distance, machined distance and stamps of a tile with a margin on all sides.
struct Block {
  std::vector<float> target, machined;
  std::vector<std::int32_t> target_stamp, machined_stamp;
  static std::size_t at(int i, int j, int k) {
    return (static_cast<std::size_t>(i + kMargin) * kPad + static_cast<std::size_t>(j + kMargin)) * kPad +
           static_cast<std::size_t>(k + kMargin);
  }
};

void fill(const Stock& stock, const Index3& tile, std::vector<float>& distance, std::vector<std::int32_t>& stamp) {
  distance.resize(static_cast<std::size_t>(kPad) * kPad * kPad);
  stamp.resize(distance.size());
  stock.read({tile[0] * Tile::kCore - kMargin, tile[1] * Tile::kCore - kMargin, tile[2] * Tile::kCore - kMargin}, kPad,
             distance.data(), stamp.data());
}

Vec3 gradient(const std::vector<float>& d, int i, int j, int k) {
  return {d[Block::at(i + 1, j, k)] - d[Block::at(i - 1, j, k)], d[Block::at(i, j + 1, k)] - d[Block::at(i, j - 1, k)],
          d[Block::at(i, j, k + 1)] - d[Block::at(i, j, k - 1)]};
}

/// The target about a tile between its voxels.
class Around {
 public:
  Around(const Block& b, const Index3& tile, double voxel)
      : b_(b), first_(tile[0] * Tile::kCore, tile[1] * Tile::kCore, tile[2] * Tile::kCore), voxel_(voxel) {}

  /// p is no farther than kMargin - 1 voxels from the tile.
  double distance_mm(const Vec3& p) const {
    const Vec3 g = p / voxel_ - first_;
    const Vec3 low(std::floor(g.x()), std::floor(g.y()), std::floor(g.z())), f = g - low;
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
      const int di = c & 1, dj = c >> 1 & 1, dk = c >> 2;
      const double w = (di ? f.x() : 1 - f.x()) * (dj ? f.y() : 1 - f.y()) * (dk ? f.z() : 1 - f.z());
      const auto at =
          Block::at(static_cast<int>(low.x()) + di, static_cast<int>(low.y()) + dj, static_cast<int>(low.z()) + dk);
      sum += w * static_cast<double>(b_.target[at]);
    }
    return sum;
  }
  /// Stamp of the nearest voxel.
  std::int32_t stamp(const Vec3& p) const {
    const Vec3 g = p / voxel_ - first_;
    return b_.target_stamp[Block::at(static_cast<int>(std::lround(g.x())), static_cast<int>(std::lround(g.y())),
                                     static_cast<int>(std::lround(g.z())))];
  }

 private:
  const Block& b_;
  Vec3 first_;
  double voxel_;
};

/// No voxel near the surface around here was left by the blank.
bool inside_cut(const Block& b, int i, int j, int k, float voxel) {
  for (int di = -1; di <= 1; ++di)
    for (int dj = -1; dj <= 1; ++dj)
      for (int dk = -1; dk <= 1; ++dk) {
        const std::size_t at = Block::at(i + di, j + dj, k + dk);
        if (b.target_stamp[at] == Stock::kUncut && std::abs(b.target[at]) < voxel) return false;
      }
  return true;
}

/// Two even numbers in -0.5 ... 0.5 that belong to a grid edge.
Vec2 scatter_of(const Index3& voxel, int axis) {
  // Source: splitmix64 (Steele, Lea, Flood 2014), as a hash.
  std::uint64_t h = static_cast<std::uint64_t>(axis);
  for (const int v : voxel) {
    h += 0x9e3779b97f4a7c15u + static_cast<std::uint64_t>(static_cast<std::int64_t>(v));
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    h ^= h >> 31;
  }
  constexpr double kPerStep = 1.0 / 4294967296.0;
  return {static_cast<double>(h >> 32) * kPerStep - 0.5, static_cast<double>(h & 0xffffffffu) * kPerStep - 0.5};
}

/// The cutters that the voxels around a grid edge name, and those before and after them that lie deeper between the
/// voxels (a feed below the voxel's size leaves stamps that no voxel names): the target is the largest of their fields.
class NamedCutters {
 public:
  NamedCutters(const Block& b, int i, int j, int k, int axis, const CutterPlaces& places) : places_(places) {
    std::array<int, 3> lo{-1, -1, -1};
    lo[axis] = 0;
    for (int di = lo[0]; di <= 1; ++di)
      for (int dj = lo[1]; dj <= 1; ++dj)
        for (int dk = lo[2]; dk <= 1; ++dk) {
          const std::int32_t id = b.target_stamp[Block::at(i + di, j + dj, k + dk)];
          if (std::find(ids_.begin(), ids_.begin() + count_, id) == ids_.begin() + count_ && places.knows(id))
            ids_[count_++] = id;
        }
  }

  /// The target's field as far as the named cutters have made it, and which of them governs.
  struct Governing {
    double value_mm = -std::numeric_limits<double>::infinity();
    std::int32_t id = 0;
  };
  Governing governing(const Vec3& p) const {
    Governing out;
    std::array<std::pair<std::int32_t, std::int32_t>, 18> seen;  // from which of them a search ends where one has ended
    std::size_t searches = 0;
    for (std::size_t n = 0; n < count_; ++n) {
      const std::int32_t from = ids_[n];
      if (std::any_of(seen.begin(), seen.begin() + searches,
                      [&](const auto& s) { return s.first <= from && from <= s.second; }))
        continue;
      const auto [id, depth] = places_.deepest_from(from, p);
      seen[searches++] = {std::min(from, id), std::max(from, id + 1)};
      if (depth > out.value_mm) out = {depth, id};
    }
    return out;
  }

  /// Moves p along a direction onto the surface; the cutter that made it there, nothing where there is none within
  /// `reach`.
  std::optional<std::int32_t> settle(Vec3& p, const Vec3& direction, double reach) const {
    // The field is the largest of convex ones: Newton's steps on the governing one settle at once.
    constexpr int kSteps = 6;
    constexpr double kClose_mm = 1e-5;
    const Vec3 from = p;
    for (int step = 0; step < kSteps && count_ > 0; ++step) {
      const Governing g = governing(p);
      if (std::abs(g.value_mm) < kClose_mm) return g.id;
      const double slope = normal(g.id, p).dot(direction);
      if (std::abs(slope) < kGrazing) return std::nullopt;
      p -= g.value_mm / slope * direction;
      if ((p - from).squaredNorm() > reach * reach) return std::nullopt;
    }
    return std::nullopt;
  }

  /// Outward from the part, where a cutter has made the surface.
  Vec3 normal(std::int32_t id, const Vec3& p) const { return -places_.gradient(id, p); }

 private:
  const CutterPlaces& places_;
  std::array<std::int32_t, 18> ids_{};
  std::size_t count_ = 0;
};

constexpr double kOn_mm = 1e-4;  // as good as on an edge
constexpr double kFace_mm =
    0.15;  // left out along the stock's faces: entry and exit, which a grid knows to half a voxel
constexpr double kEdge_mm =
    0.05;  // left out along edges between two cut surfaces: there the other one's deflection is met

/// Where a smooth piece of surface ends near a point: how far from it, and which way along the surface.
struct End {
  double distance_mm = 0;
  Vec3 direction = Vec3::Zero();
};

/// Ends that are not farther than a voxel; the next row of points, a voxel on, has `beyond` then.
struct Ends {
  std::array<End, 3> list;
  int count = 0;
  bool beyond = false;  ///< the point does not count

  void add(const End& end, double voxel) {
    if (end.distance_mm > voxel + kOn_mm) return;
    if (end.distance_mm <= kOn_mm) beyond = true;
    list[static_cast<std::size_t>(count++)] = end;
  }
};

/// The end of a cut surface at the faces of the stock before any cut.
void add_face(const Stock::Probe& solid, const Vec3& p, const Vec3& normal, double voxel, Ends& ends) {
  const double inside = -solid.distance_mm(p);
  if (inside > voxel + kFace_mm + kOn_mm) return;
  Vec3 out;
  for (int a = 0; a < 3; ++a) {
    const Vec3 step = 0.25 * voxel * Vec3::Unit(a);
    out[a] = solid.distance_mm(p + step) - solid.distance_mm(p - step);
  }
  const double steep = out.norm();
  const Vec3 along = steep > 0 ? Vec3(out / steep - out.dot(normal) / steep * normal) : Vec3(Vec3::Zero());
  constexpr double kParallel = 0.1;
  if (along.norm() > kParallel || inside <= kOn_mm)  // a cut along a face takes nothing
    ends.add({inside / std::max(along.norm(), kParallel) - kFace_mm, along.normalized()}, voxel);
}

double edge_mm(double voxel) { return std::min(kEdge_mm, voxel); }

/// The ends at other cut surfaces: at one that rises from this one, as a floor ends at a wall, and at one that breaks
/// off from it, as two walls meet at a corner.
void add_others(const Around& around, const CutterPlaces& places, const Vec3& p, const Vec3& normal, double voxel,
                Ends& ends) {
  constexpr double kFar = 0.4, kTurned = 0.7;
  const double reach = 1.5 * voxel + edge_mm(voxel);
  const Vec3 across = normal.unitOrthogonal(), other = normal.cross(across);
  std::array<double, 2> most{kFar * voxel, kFar * voxel};  // rising, breaking off
  std::array<Vec3, 2> there;
  for (const Vec3& way : {across, Vec3(-across), other, Vec3(-other)}) {
    const double value = around.distance_mm(p + reach * way);
    const std::size_t i = value < 0 ? 0 : 1;
    if (std::abs(value) > most[i]) most[i] = std::abs(value), there[i] = p + reach * way;
  }
  for (std::size_t i = 0; i < 2; ++i) {
    if (most[i] <= kFar * voxel) continue;
    const double sense = i == 0 ? -1 : 1;
    const std::int32_t id = around.stamp(there[i]);
    if (!places.knows(id)) continue;
    const Vec3 turned = -places.gradient(id, there[i]);
    if (turned.dot(normal) > kTurned) continue;  // the same surface, or a shallow cusp
    const Vec3 along = sense * (turned - turned.dot(normal) * normal), way = along.normalized();
    const double beyond = -sense * places.distance_mm(id, p + reach * way) / along.norm();
    ends.add({reach - beyond - edge_mm(voxel), way}, voxel);
  }
}

/// Another surface is nearer than edge_mm, above or below.
bool at_corner(const Around& around, const NamedCutters& cutters, const CutterPlaces& places, const Vec3& p,
               const Vec3& normal, double voxel) {
  constexpr double kNear = 0.85;
  const double h = edge_mm(voxel);
  const auto value = [&](const Vec3& q) {
    const std::int32_t id = around.stamp(q);
    const double named = cutters.governing(q).value_mm;
    return places.knows(id) ? std::max(named, -places.distance_mm(id, q)) : named;
  };
  return value(p + h * normal) < kNear * h || value(p - h * normal) > -kNear * h;
}

/// Part of a surface that a point stands for. In the open it is what the square about its grid line covers, and the
/// squares together cover the surface once; beside an end that is nearer than a voxel it is a rectangle up to that end,
/// whatever lies between. So all of the surface is counted once, wherever the grid lies.
class Patch {
 public:
  Patch(const Vec3& normal, int axis, double voxel, const Ends& ends) : open_(ends.count == 0) {
    if (open_) {
      constexpr double kFarthest = 0.9;  // voxels; where the line grazes the surface, its square is wider than that
      farthest_ = kFarthest * voxel;
      for (int i = 0; i < 2; ++i) {
        sides_[i] = voxel * Vec3::Unit((axis + 1 + i) % 3);
        sides_[i][axis] = -sides_[i].dot(normal) / normal[axis];
      }
      area_mm2_ = voxel * voxel / std::abs(normal[axis]);
      return;
    }
    const Vec3 across = ends.list[0].direction, other = normal.cross(across);
    Vec2 from(-voxel / 2, -voxel / 2), to(voxel / 2, voxel / 2);
    for (int i = 0; i < ends.count; ++i) {
      const End& end = ends.list[static_cast<std::size_t>(i)];
      const Vec2 way(end.direction.dot(across), end.direction.dot(other));
      const int side = std::abs(way[0]) > std::abs(way[1]) ? 0 : 1;
      if (way[side] > 0)
        to[side] = end.distance_mm;
      else
        from[side] = -end.distance_mm;
    }
    const Vec2 middle = (from + to) / 2, size = to - from;
    middle_ = middle[0] * across + middle[1] * other;
    sides_ = {size[0] * across, size[1] * other};
    area_mm2_ = size.prod();
  }
  /// Area that the point stands for: the points of all three axes cover the surface sum n_a^2 = 1 times.
  double area_mm2(double n_axis) const { return area_mm2_ * std::abs(n_axis) * (open_ ? std::abs(n_axis) : 1.0); }
  /// A place in it, from its point; shares from -0.5 to 0.5.
  Vec3 place(const Vec2& fraction) const {
    const Vec3 at = middle_ + fraction[0] * sides_[0] + fraction[1] * sides_[1];
    const double length = at.norm();
    return open_ && length > farthest_ ? Vec3(farthest_ / length * at) : at;
  }

 private:
  bool open_;
  double farthest_ = 0, area_mm2_ = 0;
  Vec3 middle_ = Vec3::Zero();
  std::array<Vec3, 2> sides_;
};

/// Puts a point of the trilinear surface along its grid line onto the cutters that made it, and aside: rows and feed
/// marks that are in step with the grid would else be met at the same places of every cusp. `undetermined` where the
/// cutters tell no place: the point is left as it was. `beyond`: so near an edge that a deflection of the other surface
/// takes it off.
enum class Sharpened { yes, undetermined, beyond };
Sharpened sharpen(SurfacePoint& p, int axis, const NamedCutters& cutters, const CutterPlaces& places,
                  const Around& around, const Stock::Probe* solid, const Vec2& scatter, double voxel) {
  constexpr double kSame = 0.9;  // between normals a voxel apart on one smooth surface
  SurfacePoint q = p;
  auto cutter = cutters.settle(q.place_mm, Vec3::Unit(axis), voxel);
  if (!cutter) {
    q.place_mm = p.place_mm;
    cutter = cutters.settle(q.place_mm, p.normal, voxel);
  }
  if (!cutter) return Sharpened::undetermined;
  q.normal = cutters.normal(*cutter, q.place_mm);
  if (std::abs(q.normal[axis]) <= kGrazing) return Sharpened::beyond;
  Ends ends;
  if (solid) add_face(*solid, q.place_mm, q.normal, voxel, ends);
  add_others(around, places, q.place_mm, q.normal, voxel, ends);
  if (ends.beyond) return Sharpened::beyond;
  const Patch patch(q.normal, axis, voxel, ends);
  q.area_mm2 = patch.area_mm2(q.normal[axis]);
  Vec3 place = q.place_mm + patch.place(scatter);
  if (const auto there = cutters.settle(place, q.normal, 0.5 * voxel))
    if (const Vec3 n = cutters.normal(*there, place); n.dot(q.normal) > kSame) {
      q.place_mm = place;
      q.normal = n;
    }
  if (at_corner(around, cutters, places, q.place_mm, q.normal, voxel)) return Sharpened::beyond;
  p = q;
  return Sharpened::yes;
}

/// `places`, `machined`, `solid`: null: not needed.
void collect(const Stock* machined, const Stock& target, const CutterPlaces* places, const Stock* solid,
             const Index3& tile, std::vector<SurfacePoint>& out, double& cut_mm2) {
  if (!target.is_cut(tile)) return;
  std::optional<Stock::Probe> faces;
  if (solid) faces.emplace(*solid);
  Block b;
  fill(target, tile, b.target, b.target_stamp);
  if (machined) fill(*machined, tile, b.machined, b.machined_stamp);
  const double voxel = target.voxel_mm();
  const Around around(b, tile, voxel);
  for (int i = 0; i < Tile::kCore; ++i)
    for (int j = 0; j < Tile::kCore; ++j)
      for (int k = 0; k < Tile::kCore; ++k) {
        const std::size_t here = Block::at(i, j, k);
        const float t0 = b.target[here];
        if (std::abs(t0) > 2 * voxel) continue;
        for (int a = 0; a < 3; ++a) {
          const int ni = i + (a == 0), nj = j + (a == 1), nk = k + (a == 2);
          const std::size_t next = Block::at(ni, nj, nk);
          const float t1 = b.target[next];
          if ((t0 < 0) == (t1 < 0)) continue;
          const double u = t0 / (static_cast<double>(t0) - t1);
          const Vec3 g = (1 - u) * gradient(b.target, i, j, k) + u * gradient(b.target, ni, nj, nk);
          const bool both_cut = b.target_stamp[here] != Stock::kUncut && b.target_stamp[next] != Stock::kUncut;
          if (b.target_stamp[t0 < 0 ? next : here] != Stock::kUncut)
            cut_mm2 += voxel * voxel * std::abs(g.normalized()[a]);
          const bool inner = both_cut && inside_cut(b, i, j, k, static_cast<float>(voxel)) &&
                             inside_cut(b, ni, nj, nk, static_cast<float>(voxel));
          if (!inner && (!faces || b.target_stamp[t0 < 0 ? next : here] == Stock::kUncut)) continue;
          SurfacePoint p;
          p.normal = g.normalized();
          const Index3 at{tile[0] * Tile::kCore + i, tile[1] * Tile::kCore + j, tile[2] * Tile::kCore + k};
          p.place_mm = voxel * Vec3(at[0], at[1], at[2]);
          p.place_mm[a] += voxel * u;
          p.crossing_mm = p.place_mm;
          p.area_mm2 = voxel * voxel * std::abs(p.normal[a]);
          const Sharpened sharp = places ? sharpen(p, a, NamedCutters(b, i, j, k, a, *places), *places, around,
                                                   faces ? &*faces : nullptr, scatter_of(at, a), voxel)
                                         : Sharpened::undetermined;
          if (sharp == Sharpened::beyond || (sharp == Sharpened::undetermined && !inner)) continue;
          if (std::abs(p.normal[a]) <= kGrazing) continue;
          if (machined) p.error_mm = -((1 - u) * b.machined[here] + u * b.machined[next]);
          p.target_stamp = b.target_stamp[u < 0.5 ? here : next];
          if (machined) p.machined_stamp = b.machined_stamp[u < 0.5 ? here : next];
          out.push_back(p);
        }
      }
}

}  // namespace

namespace {

std::vector<std::vector<SurfacePoint>> by_tile(const Stock* machined, const Stock& target, const CutterPlaces* places,
                                               const Stock* solid, double* unseen_mm2) {
  const std::vector<Index3> tiles = target.surface_tiles();
  std::vector<std::vector<SurfacePoint>> parts(tiles.size());
  std::vector<double> cut_mm2(tiles.size(), 0.0);
  Stage stage("placing points on the surface", tiles.size());
  tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) {
    stage.advance();
    collect(machined, target, places, solid, tiles[i], parts[i], cut_mm2[i]);
    parts[i].shrink_to_fit();
  });
  if (!unseen_mm2) return parts;
  double unseen = std::accumulate(cut_mm2.begin(), cut_mm2.end(), 0.0);
  for (const auto& part : parts)
    for (const SurfacePoint& p : part) unseen -= p.area_mm2;
  *unseen_mm2 = std::max(0.0, unseen);
  return parts;
}

}  // namespace

std::vector<SurfacePoint> compare_surfaces(const Stock& machined, const Stock& target) {
  assert(machined.voxel_mm() == target.voxel_mm());
  std::vector<SurfacePoint> points;
  for (const auto& part : by_tile(&machined, target, nullptr, nullptr, nullptr))
    points.insert(points.end(), part.begin(), part.end());
  return points;
}

std::vector<std::vector<SurfacePoint>> surface_points(const Stock& target, const CutterPlaces& places,
                                                      const Stock* solid, double* unseen_mm2) {
  return by_tile(nullptr, target, &places, solid, unseen_mm2);
}

}  // namespace camber::removal
