#include "removal/engage/upright/chip_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "removal/engage/upright/level_faces.h"
#include "removal/field/upright/carve.h"
#include "removal/simd/upright_block_kernels.h"

namespace camber::removal::upright {
namespace {

constexpr float kSolid = std::numeric_limits<float>::infinity();

}  // namespace

ChipReader::ChipReader(const EngagedRun& run, const PatchLanes& lanes, std::span<const Stamp> stamps,
                       const DeflectionTable& deflections, const BendMemory& memory)
    : envelope_(run.envelope),
      lanes_(lanes),
      view_(lanes.view()),
      all_(run.stamps),
      stamps_(stamps),
      first_id_(run.first_id),
      voxel_mm_(run.stock.voxel_mm()),
      deflections_(deflections),
      memory_(memory),
      node_step_mm_(deflections.nodes() > 1 ? static_cast<float>(deflections.node_height_mm[1]) : 1.0f),
      kernels_(kernels()),
      wall_half_mm_(wall_half_widths_mm(run.envelope)) {}

/// Returns the chip that a point of stamp k may take beyond its motion bound, mm: the stamp before left the surface
/// there at another rotation step, with another deflection.
float ChipReader::reach_mm(std::size_t k) const {
  return stamps_[k].first ? 0.0f
                          : static_cast<float>(deflections_.largest_lateral_mm(static_cast<std::ptrdiff_t>(k) - 1));
}

float ChipReader::axial_reach_mm(std::size_t k) const {
  return stamps_[k].first ? 0.0f
                          : static_cast<float>(deflections_.largest_axial_mm(static_cast<std::ptrdiff_t>(k) - 1));
}

void ChipReader::find_patches(const TileArena& arena, const Reading& at, std::vector<std::int32_t>& out) const {
  const Stamp& stamp = stamps_[at.k];
  const auto row = static_cast<std::ptrdiff_t>(at.k);
  const std::ptrdiff_t before = stamp.first ? row : row - 1;
  const double moved = deflections_.largest_mm(row);
  StampPlace place = arena.place_of(stamp, -1e-6);
  place.lateral_mm = static_cast<float>(deflections_.largest_lateral_mm(row) + deflections_.largest_lateral_mm(before));
  place.axial_mm = static_cast<float>(deflections_.largest_axial_mm(row) + deflections_.largest_axial_mm(before));
  place.tilt_mm = static_cast<float>(kMaxTilt * stamp.feed_per_tooth_mm.norm());
  place.slack_mm = static_cast<float>(moved + 1e-3 * voxel_mm_);
  const BlockBounds bounds = lanes_.bounds();
  out.resize(static_cast<std::size_t>(bounds.count));
  out.resize(static_cast<std::size_t>(block_kernels().find_blocks(bounds, place, arena.view(), out.data())));
}

StampBend ChipReader::bend_of(std::size_t k) const {
  const Stamp& stamp = stamps_[k];
  const auto row = static_cast<std::ptrdiff_t>(k);
  return {{deflections_.row(row), stamp.first ? deflections_.row(row) : deflections_.row(row - 1),
           static_cast<int>(deflections_.nodes()), deflections_.steps, node_step_mm_, deflections_.axial},
          static_cast<float>(envelope_.lag_per_mm),
          static_cast<float>(envelope_.steps / (4 * kPi)),
          static_cast<float>(kMaxTilt * stamp.feed_per_tooth_mm.norm()),
          reach_mm(k),
          axial_reach_mm(k)};
}

void ChipReader::read(const TileArena& arena, const Reading& at, std::span<const std::int32_t> patches, Buffers& b,
                      std::vector<DeflectedChipSample>& out) const {
  const StampPlace place = arena.place_of(stamps_[at.k], 0);
  const StampBend bend = bend_of(at.k);
  const ArenaView tiles = arena.view();
  b.shallow.clear();
  LaneReading reading;
  for (const std::int32_t patch : patches) {
    const PatchLanes::Range range = lanes_.range(static_cast<std::uint32_t>(patch));
    for (int from = 0; from < range.count; from += LaneReading::kMax) {
      const int count = std::min(range.count - from, LaneReading::kMax);
      const int whole = (count + PatchLanes::kVector - 1) / PatchLanes::kVector * PatchLanes::kVector;
      kernels_.read_points(view_, range.from + from, whole, place, bend, tiles, reading);
      sort_points(arena, at, reading, range.from + from, count, bend, b, out);
    }
  }
  make_room(b);
  for (Shallow& point : b.shallow) add_pairs(arena, stamps_[at.k], point, b);
  if (envelope_.shape.general)
    thin_general(b);
  else
    thin_pairs(b);
  for (std::size_t i = 0; i < b.shallow.size(); ++i) {
    const Shallow& p = b.shallow[i];
    const Depth below = depth(arena, p, i + 1 < b.shallow.size() ? b.shallow[i + 1].first_pair : b.pairs, b);
    if (below.mm <= -kNear_mm) continue;
    const float most = below.mm > p.limit_mm ? p.cap_mm : p.limit_mm;
    out.push_back({{p.point, std::min(below.mm, most), below.mm > kNearCap * p.cap_mm, false, p.cut_255},
                   below.mm,
                   most,
                   below.deeper});
  }
}

/// Sorts points by what the field shows: deep points give their chips at once, points in air none, the rest are listed
/// as shallow.
void ChipReader::sort_points(const TileArena& arena, const Reading& at, const LaneReading& reading, int first_lane,
                             int count, const StampBend& bend, Buffers& b,
                             std::vector<DeflectedChipSample>& out) const {
  const float* row = deflections_.row(static_cast<std::ptrdiff_t>(at.k));
  const float air = 0.5f * static_cast<float>(voxel_mm_);
  for (int l = 0; l < count; ++l) {
    if (reading.cell[l] < 0) continue;
    // The trilinear field is never below the ridge, apart from curvature. It is therefore enough to find what is in air
    // and what is deeper than the chip.
    const float field = reading.field[l], cap = reading.cap[l];
    const std::uint32_t p = lanes_.point(first_lane + l), ring = p / static_cast<std::uint32_t>(envelope_.steps);
    const float half = wall_half_mm_[ring];
    if (field > std::max(air, half)) continue;
    const float limit =
        at.sharp ? cap
                 : std::max(kBeyondCap * cap, cap + bend.reach_mm * envelope_.rings[ring].sine +
                                                  bend.axial_reach_mm * std::abs(envelope_.rings[ring].cosine));
    const std::array<float, 3> along{envelope_.nx[p], envelope_.ny[p], envelope_.nz[p]};
    if (-field > std::max(limit, half)) {
      out.push_back({{p, cap, true}, -field, cap, along});
      continue;
    }
    Shallow point{p, 255, cap, limit, kSolid, {}, reading.cell[l], 0, 0};
    for (std::size_t a = 0; a < 3; ++a) point.share[a] = reading.fraction[a][l];
    if (std::abs(field) < half) {
      const auto step = static_cast<int>(p % static_cast<std::uint32_t>(envelope_.steps)) % deflections_.steps;
      if (!place_in_ring(arena, half, deflections_.axial_mm(row, step), point)) continue;
      if (-field > limit && point.cut_255 == 255) {
        out.push_back({{p, cap, true}, -field, cap, along});
        continue;
      }
    }
    const auto tile = static_cast<std::size_t>(point.cell / (2 * Tile::kVolume));
    if (arena.blank(tile)) {
      point.below_blank_mm =
          -static_cast<float>(arena.blank_at(point.cell, point.share).distance_mm(point.up_mm, Vec3::UnitZ()));
      if (point.below_blank_mm <= -kNear_mm) continue;
    }
    b.shallow.push_back(point);
  }
}

/// A shallow point and the cell around it.
struct ChipReader::Place {
  std::size_t tile;
  int in_tile;  ///< the cell's lowest voxel
  Vec3 corner_mm, point_mm;

  Place(const TileArena& arena, const Shallow& p, double voxel_mm)
      : tile(static_cast<std::size_t>(p.cell / (2 * Tile::kVolume))), in_tile(p.cell % (2 * Tile::kVolume)) {
    const Index3& index = arena.index(tile);
    const Vec3 lowest(index[0] * Tile::kCore + in_tile / (Tile::kSide * Tile::kSide),
                      index[1] * Tile::kCore + in_tile / Tile::kSide % Tile::kSide,
                      index[2] * Tile::kCore + in_tile % Tile::kSide);
    corner_mm = voxel_mm * lowest;
    point_mm = corner_mm + voxel_mm * Vec3(p.share[0], p.share[1], p.share[2]);
    point_mm.z() += p.up_mm;
  }
};

/// Sets the part of a ring that lies in material; returns false where there is none. Floors that the tool left before
/// count as displaced along its axis by `axial_mm`, the present axial deflection.
bool ChipReader::place_in_ring(const TileArena& arena, float half_mm, float axial_mm, Shallow& p) const {
  const Place place(arena, p, voxel_mm_);
  std::optional<BlankCell> blank;
  if (arena.blank(place.tile)) blank = arena.blank_at(p.cell, p.share);
  const auto half = static_cast<double>(half_mm);
  const RingPart part = part_in_material({blank ? &*blank : nullptr, arena.view().stamp + p.cell, place.point_mm,
                                          normal(p.point), half, static_cast<double>(axial_mm)},
                                         all_, first_id_, envelope_.shape);
  p.cut_255 = part.cut_255(half);
  p.up_mm = part.middle_mm();
  return p.cut_255 > 0;
}

void ChipReader::make_room(Buffers& b) {
  const std::size_t most = 8 * b.shallow.size() + PatchLanes::kVector;
  b.pairs = 0;
  if (b.x.size() >= most) return;
  for (auto* v :
       {&b.x, &b.y, &b.z, &b.nx, &b.ny, &b.nz, &b.guess_x, &b.guess_y, &b.known, &b.farther, &b.thickness, &b.guess_z})
    v->resize(most);
  b.row.resize(most);
}

/// Lists the stamps that a cell's corners name, with their deflections where those are known. Each of the others gets
/// the mean difference between the field and that of the undeflected cutter, weighted by corner.
void ChipReader::add_pairs(const TileArena& arena, const Stamp& stamp, Shallow& p, Buffers& b) const {
  p.first_pair = b.pairs;
  const Place place(arena, p, voxel_mm_);
  const std::int32_t* named = arena.view().stamp + p.cell;
  Vec3 guess = place.point_mm - stamp.pose.tip_mm -
               Vec3(static_cast<double>(envelope_.x[p.point]), static_cast<double>(envelope_.y[p.point]),
                    static_cast<double>(envelope_.z[p.point]) + p.up_mm);
  if (!deflections_.axial) guess.z() = 0;
  std::array<std::int32_t, 8> ids;
  for (std::size_t c = 0; c < 8; ++c) ids[c] = named[cell_corner(static_cast<int>(c))] - first_id_;
  for (std::size_t c = 0; c < 8; ++c) {
    if (ids[c] < 0 || (c > 0 && ids[c] == ids[c - 1]) ||
        std::find(ids.begin(), ids.begin() + c, ids[c]) != ids.begin() + c)
      continue;
    const std::size_t at = b.pairs++;
    const Vec3 from_tip = place.point_mm - all_[static_cast<std::size_t>(ids[c])].pose.tip_mm;
    const bool known = memory_.knows(ids[c]);
    b.x[at] = static_cast<float>(from_tip.x());
    b.y[at] = static_cast<float>(from_tip.y());
    b.z[at] = static_cast<float>(from_tip.z());
    b.nx[at] = envelope_.nx[p.point], b.ny[at] = envelope_.ny[p.point], b.nz[at] = envelope_.nz[p.point];
    b.guess_x[at] = known ? static_cast<float>(guess.x()) : 0.0f;
    b.guess_y[at] = known ? static_cast<float>(guess.y()) : 0.0f;
    b.guess_z[at] = known ? static_cast<float>(guess.z()) : 0.0f;
    b.known[at] = known ? 1.0f : 0.0f;
    b.row[at] = known ? static_cast<std::int32_t>(memory_.at(ids[c]) / 2) : 0;
    b.farther[at] = known ? 0.0f : farther_mm(arena, p, place, ids, ids[c]);
  }
}

/// Returns how much farther out a stamp's surface lies than that of the undeflected cutter, from the corners that name
/// it.
float ChipReader::farther_mm(const TileArena& arena, const Shallow& p, const Place& place,
                             const std::array<std::int32_t, 8>& ids, std::int32_t id) const {
  const float* distance = arena.view().distance + p.cell;
  const Vec3& tip = all_[static_cast<std::size_t>(id)].pose.tip_mm;
  float weight = 0, sum = 0;
  for (int c = 0; c < 8; ++c) {
    if (ids[static_cast<std::size_t>(c)] != id) continue;
    const Vec3 corner = place.corner_mm + voxel_mm_ * Vec3(c & 1, c >> 1 & 1, c >> 2 & 1);
    const float difference = distance[cell_corner(c)] + static_cast<float>(envelope_.shape.distance_mm(corner - tip));
    const float w = corner_weight(c, p.share) + 1e-6f;
    weight += w;
    sum += w * difference;
  }
  return sum / weight;
}

void ChipReader::thin_pairs(Buffers& b) const {
  const int count = static_cast<int>(b.pairs);
  // The last vector is filled up with any values of an existing row.
  for (std::size_t i = b.pairs; i % PatchLanes::kVector != 0; ++i) b.row[i] = 0;
  const bool any_known = std::find(b.known.begin(), b.known.begin() + count, 1.0f) != b.known.begin() + count;
  const DeflectionRow rows{any_known ? memory_.values() : nullptr,
                           nullptr,
                           static_cast<int>(deflections_.nodes()),
                           deflections_.steps,
                           node_step_mm_,
                           deflections_.axial};
  kernels_.thin_pairs(
      {count, b.x.data(), b.y.data(), b.z.data(), b.nx.data(), b.ny.data(), b.nz.data(), b.guess_x.data(),
       b.guess_y.data(), b.guess_z.data(), b.known.data(), b.row.data(), b.farther.data(), rows,
       static_cast<float>(envelope_.lag_per_mm), static_cast<float>(envelope_.steps / (2 * kPi)), b.thickness.data()},
      static_cast<float>(envelope_.shape.bottom_length_mm()), static_cast<float>(envelope_.shape.corner_radius_mm),
      kMinSlope);
}

/// Does what Kernels::thin_pairs does, for any cutter profile.
void ChipReader::thin_general(Buffers& b) const {
  for (std::size_t i = 0; i < b.pairs; ++i) {
    Vec3 from_tip(b.x[i], b.y[i], b.z[i]);
    if (b.known[i] > 0) {
      const Vec3 guess(b.guess_x[i], b.guess_y[i], b.guess_z[i]);
      from_tip -= settled_deflection(envelope_, deflections_, memory_.values() + 2 * b.row[i], from_tip, guess);
      b.x[i] = static_cast<float>(from_tip.x()), b.y[i] = static_cast<float>(from_tip.y());
      b.z[i] = static_cast<float>(from_tip.z());
    }
    const auto depth = static_cast<float>(envelope_.shape.distance_mm(from_tip)) - b.farther[i];
    b.thickness[i] = depth / slope(envelope_.shape.gradient(from_tip).dot(Vec3(b.nx[i], b.ny[i], b.nz[i])));
  }
}

/// Thickness of the stock below a point, against the normal, from the fields that meet in its cell (see
/// removal/engagement.h): the thinnest of distance / slope, where slope is how fast a field falls along the normal.
ChipReader::Depth ChipReader::depth(const TileArena& arena, const Shallow& p, std::size_t end_pair,
                                    const Buffers& b) const {
  const auto of_field = [&](float mm, const Vec3& outwards) {
    const auto fall = static_cast<double>(slope(outwards.dot(normal(p.point))));
    return Depth{mm,
                 {static_cast<float>(outwards.x() / fall), static_cast<float>(outwards.y() / fall),
                  static_cast<float>(outwards.z() / fall)}};
  };
  float thinnest = kSolid;
  std::size_t of = p.first_pair;
  for (std::size_t i = p.first_pair; i < end_pair; ++i)
    if (b.thickness[i] < thinnest) thinnest = b.thickness[i], of = i;
  // A slope is at most 1: what is deeper than the thinnest so far cannot become thinner.
  if (p.below_blank_mm < std::max(0.0f, thinnest)) {
    float mm = thinnest;
    Vec3 into = Vec3::Zero();
    arena.blank_at(p.cell, p.share).for_each_face([&](double above, const Vec3& outwards) {
      const double below = -above - p.up_mm * outwards.z();
      const float thickness = static_cast<float>(below) / slope(-outwards.dot(normal(p.point)));
      if (thickness < mm) mm = thickness, into = -outwards;
    });
    if (mm < thinnest) return of_field(mm, into);
  }
  if (p.first_pair == end_pair) return {kSolid, {}};
  return of_field(thinnest, envelope_.shape.gradient(Vec3(b.x[of], b.y[of], b.z[of])));
}

}  // namespace camber::removal::upright
