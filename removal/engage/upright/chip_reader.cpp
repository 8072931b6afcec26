#include "removal/engage/upright/chip_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "removal/engage/upright/level_faces.h"
#include "removal/field/cell.h"

namespace camber::removal::upright {

/// A point in its cell.
struct ChipReader::Cell {
  int at;                      ///< lowest corner, in the tile
  std::array<float, 3> share;  ///< from there to the next voxels
  std::array<float, 8> weight;
  Vec3 corner_mm, point_mm;  ///< the lowest corner and the point
  double up_mm = 0;          ///< of point_mm, from where `share` tells

  Cell(int cell, const std::array<float, 3>& f, const Index3& tile, double voxel_mm) : at(cell), share(f) {
    for (int c = 0; c < 8; ++c) weight[static_cast<std::size_t>(c)] = corner_weight(c, f);
    const Vec3 lowest(tile[0] * Tile::kCore + cell / (Tile::kSide * Tile::kSide),
                      tile[1] * Tile::kCore + cell / Tile::kSide % Tile::kSide,
                      tile[2] * Tile::kCore + cell % Tile::kSide);
    corner_mm = voxel_mm * lowest;
    point_mm = corner_mm + voxel_mm * Vec3(f[0], f[1], f[2]);
  }

  void move_up(double mm) {
    up_mm += mm;
    point_mm.z() += mm;
  }

  float trilinear(const float* tile) const { return removal::trilinear(tile + at, share); }
  Vec3 gradient(const float* tile, double voxel_mm) const { return trilinear_gradient(tile + at, share, voxel_mm); }
};

ChipReader::ChipReader(const EnvelopeGrid& envelope, const PatchLanes& lanes, std::span<const Stamp> all,
                       std::span<const Stamp> stamps, std::int32_t first_id, double voxel_mm,
                       const DeflectionTable& deflections)
    : envelope_(envelope),
      lanes_(lanes),
      view_(lanes.view()),
      all_(all),
      stamps_(stamps),
      first_id_(first_id),
      voxel_mm_(voxel_mm),
      deflections_(deflections),
      kernels_(kernels()),
      wall_half_mm_(wall_half_widths_mm(envelope)) {
  places_.reserve(stamps.size());
  for (std::size_t k = 0; k < stamps.size(); ++k) places_.push_back(place_of(k));
}

ChipReader::Place ChipReader::place_of(std::size_t k) const {
  const Stamp& stamp = stamps_[k];
  Place place{};
  place.view.per_voxel = static_cast<float>(1 / voxel_mm_);
  for (int a = 0; a < 3; ++a) {
    const double at = stamp.pose.tip_mm[a] / voxel_mm_, base = std::floor(at);
    place.view.fraction[a] = static_cast<float>(at - base);
    place.view.feed_mm[a] = static_cast<float>(stamp.feed_per_tooth_mm[a]);
    place.base[static_cast<std::size_t>(a)] = static_cast<int>(base);
  }
  const auto row = static_cast<std::ptrdiff_t>(k);
  place.view.deflection = {deflections_.row(row), stamp.first ? deflections_.row(row) : deflections_.row(row - 1),
                           static_cast<int>(deflections_.nodes()), deflections_.steps,
                           deflections_.nodes() > 1 ? static_cast<float>(deflections_.node_height_mm[1]) : 1.0f};
  place.view.lag_per_mm = static_cast<float>(envelope_.lag_per_mm);
  place.view.per_rad = static_cast<float>(envelope_.steps / (4 * kPi));
  place.view.max_tilt_mm = static_cast<float>(kMaxTilt * stamp.feed_per_tooth_mm.norm());
  return place;
}

void ChipReader::read(const TileStocks& stocks, const Index3& tile, std::int32_t k, std::uint32_t patch,
                      std::vector<DeflectedChipSample>& out) const {
  const Place& place = places_[static_cast<std::size_t>(k)];
  TileView tile_view{stocks.now->distance.data(), {}};
  for (std::size_t a = 0; a < 3; ++a) tile_view.from[a] = tile[a] * Tile::kCore - place.base[a];
  const float air = 0.5f * static_cast<float>(voxel_mm_);
  const PatchLanes::Range range = lanes_.range(patch);
  LaneReading reading;
  for (int from = 0; from < range.count; from += LaneReading::kMax) {
    const int count = std::min(range.count - from, LaneReading::kMax);
    const int whole = (count + PatchLanes::kVector - 1) / PatchLanes::kVector * PatchLanes::kVector;
    kernels_.read_points(view_, range.from + from, whole, place.view, tile_view, reading);
    for (int l = 0; l < count; ++l) {
      if (reading.cell[l] < 0) continue;
      // The trilinear field is never below the ridge's, but for curvature: so it tells what is in air, and what is
      // deeper than the chip.
      const float field = reading.field[l], cap = reading.cap[l];
      const std::uint32_t p = lanes_.point(range.from + from + l);
      const float half = wall_half_mm_[p / static_cast<std::uint32_t>(envelope_.steps)];
      if (field > std::max(air, half)) continue;
      const Vec3 normal(envelope_.nx[p], envelope_.ny[p], envelope_.nz[p]);
      const std::array<float, 2> along{envelope_.nx[p], envelope_.ny[p]};
      if (-field > std::max(cap, half)) {
        out.push_back({{p, cap, true}, -field, cap, along});
        continue;
      }
      Cell cell(reading.cell[l], {reading.fraction[0][l], reading.fraction[1][l], reading.fraction[2][l]}, tile,
                voxel_mm_);
      std::uint8_t share = 255;
      if (std::abs(field) < half) {
        const RingPart part =
            part_in_material({stocks.blank ? stocks.blank + cell.at : nullptr, stocks.now->stamp.data() + cell.at,
                              cell.share, cell.point_mm, normal, static_cast<double>(half)},
                             all_, first_id_, envelope_.shape, voxel_mm_);
        share = part.cut_255(static_cast<double>(half));
        if (share == 0) continue;
        cell.move_up(part.middle_mm());
      }
      const Depth below = -field > cap && share == 255 ? Depth{-field, along} : depth(stocks, cell, normal);
      if (below.mm > -kNear_mm)
        out.push_back(
            {{p, std::min(below.mm, cap), below.mm > kNearCap * cap, false, share}, below.mm, cap, below.deeper});
    }
  }
}

/// Thickness of the stock below a point, against the normal, from the fields that meet in its cell (see
/// removal/engagement.h): the thinnest of distance / slope, where slope is how fast a field falls along the normal.
ChipReader::Depth ChipReader::depth(const TileStocks& stocks, const Cell& cell, const Vec3& normal) const {
  constexpr float kSolid = std::numeric_limits<float>::infinity();
  float below_blank = stocks.blank ? -cell.trilinear(stocks.blank) : kSolid;
  if (stocks.blank && cell.up_mm != 0)
    below_blank -= static_cast<float>(cell.up_mm * cell.gradient(stocks.blank, voxel_mm_).z());
  if (below_blank <= -kNear_mm) return {below_blank, {}};
  CornerLanes corners;
  std::array<std::int32_t, 8> ids;
  std::array<Vec3, 8> tip;
  bool any = false;
  for (std::size_t c = 0; c < 8; ++c) {
    ids[c] = stocks.now->stamp[static_cast<std::size_t>(cell.at + cell_corner(static_cast<int>(c)))] - first_id_;
    corners.valid[c] = ids[c] >= 0 ? 1.0f : 0.0f;
    tip[c] = ids[c] >= 0 ? Vec3(all_[static_cast<std::size_t>(ids[c])].pose.tip_mm - cell.point_mm) : Vec3::Zero();
    for (int a = 0; a < 3; ++a) corners.tip[a][c] = static_cast<float>(tip[c][a]);
    corners.deflection[c] = 0;
    any |= ids[c] >= 0;
  }
  for (int a = 0; a < 3; ++a) corners.normal[a] = static_cast<float>(normal[a]);
  if (any) {
    // For each stamp the mean difference between the field and the straight cutter's, weighted as the corners.
    std::array<float, 8> difference;
    for (std::size_t c = 0; c < 8; ++c) {
      if (ids[c] < 0) continue;
      const Vec3 at = cell.corner_mm - cell.point_mm + voxel_mm_ * Vec3(c & 1, c >> 1 & 1, c >> 2 & 1);
      difference[c] = stocks.now->distance[static_cast<std::size_t>(cell.at + cell_corner(static_cast<int>(c)))] +
                      static_cast<float>(envelope_.shape.distance_mm(at - tip[c]));
    }
    for (std::size_t c = 0; c < 8; ++c) {
      if (ids[c] < 0) continue;
      float weight = 0, deflection = 0;
      for (std::size_t o = 0; o < 8; ++o) {
        if (ids[o] != ids[c]) continue;
        const float w = cell.weight[o] + 1e-6f;
        weight += w;
        deflection += w * difference[o];
      }
      corners.deflection[c] = deflection / weight;
    }
  }
  const auto of_field = [&](float mm, const Vec3& outwards) {
    const double fall = static_cast<double>(slope(outwards.dot(normal)));
    return Depth{mm, {static_cast<float>(outwards.x() / fall), static_cast<float>(outwards.y() / fall)}};
  };
  Thinnest thinnest{kSolid, 0};
  if (any)
    thinnest = envelope_.shape.general
                   ? thinnest_general(normal, tip, corners)
                   : kernels_.thinnest(corners, static_cast<float>(envelope_.shape.bottom_length_mm()),
                                       static_cast<float>(envelope_.shape.corner_radius_mm), kMinSlope);
  // A slope is at most 1: what is deeper than the thinnest so far cannot become thinner.
  if (below_blank < std::max(0.0f, thinnest.mm)) {
    const Vec3 outwards = -cell.gradient(stocks.blank, voxel_mm_);
    const float mm = below_blank / slope(outwards.dot(normal));
    if (mm < thinnest.mm) return of_field(mm, outwards);
  }
  if (!any) return {kSolid, {}};
  return of_field(thinnest.mm, envelope_.shape.gradient(-tip[static_cast<std::size_t>(thinnest.corner)]));
}

/// As Kernels::thinnest, for any cutter.
Thinnest ChipReader::thinnest_general(const Vec3& normal, const std::array<Vec3, 8>& tip,
                                      const CornerLanes& corners) const {
  Thinnest thinnest{std::numeric_limits<float>::infinity(), 0};
  for (std::size_t c = 0; c < 8; ++c) {
    if (!(corners.valid[c] > 0) || (c > 0 && corners.valid[c - 1] > 0 && tip[c] == tip[c - 1])) continue;
    const auto depth = static_cast<float>(envelope_.shape.distance_mm(-tip[c])) - corners.deflection[c];
    if (depth >= thinnest.mm) continue;
    const float along = depth / slope(envelope_.shape.gradient(-tip[c]).dot(normal));
    if (along < thinnest.mm) thinnest = {along, static_cast<int>(c)};
  }
  return thinnest;
}

}  // namespace camber::removal::upright
