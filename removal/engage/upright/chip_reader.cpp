#include "removal/engage/upright/chip_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "removal/engage/upright/level_faces.h"
#include "removal/field/cell.h"
#include "removal/field/upright/carve_general.h"

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
                       const DeflectionTable& deflections, const BendMemory& memory)
    : envelope_(envelope),
      lanes_(lanes),
      view_(lanes.view()),
      all_(all),
      stamps_(stamps),
      first_id_(first_id),
      voxel_mm_(voxel_mm),
      deflections_(deflections),
      memory_(memory),
      node_step_mm_(deflections.nodes() > 1 ? static_cast<float>(deflections.node_height_mm[1]) : 1.0f),
      kernels_(kernels()),
      wall_half_mm_(wall_half_widths_mm(envelope)) {
  places_.reserve(stamps.size());
  for (std::size_t k = 0; k < stamps.size(); ++k) places_.push_back(place_of(k));
}

ChipReader::VoxelPlace ChipReader::place_of(std::size_t k) const {
  const Stamp& stamp = stamps_[k];
  VoxelPlace place{};
  place.view.per_voxel = static_cast<float>(1 / voxel_mm_);
  for (int a = 0; a < 3; ++a) {
    const double at = stamp.pose.tip_mm[a] / voxel_mm_, base = std::floor(at);
    place.view.fraction[a] = static_cast<float>(at - base);
    place.view.feed_mm[a] = static_cast<float>(stamp.feed_per_tooth_mm[a]);
    place.base[static_cast<std::size_t>(a)] = static_cast<int>(base);
  }
  const auto row = static_cast<std::ptrdiff_t>(k);
  place.view.deflection = {deflections_.row(row), stamp.first ? deflections_.row(row) : deflections_.row(row - 1),
                           static_cast<int>(deflections_.nodes()), deflections_.steps, node_step_mm_};
  place.view.lag_per_mm = static_cast<float>(envelope_.lag_per_mm);
  place.view.per_rad = static_cast<float>(envelope_.steps / (4 * kPi));
  place.view.max_tilt_mm = static_cast<float>(kMaxTilt * stamp.feed_per_tooth_mm.norm());
  return place;
}

float ChipReader::reach_mm(std::size_t k) const {
  return stamps_[k].first ? 0.0f : static_cast<float>(deflections_.largest_mm(static_cast<std::ptrdiff_t>(k) - 1));
}

void ChipReader::read(const TileStocks& stocks, const Index3& tile, std::int32_t k, float reach_mm, std::uint32_t patch,
                      std::vector<DeflectedChipSample>& out) const {
  VoxelPlace place = places_[static_cast<std::size_t>(k)];
  place.view.reach_mm = reach_mm;
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
      const float limit = std::max(kBeyondCap * cap, cap + reach_mm);
      const std::uint32_t p = lanes_.point(range.from + from + l);
      const float half = wall_half_mm_[p / static_cast<std::uint32_t>(envelope_.steps)];
      if (field > std::max(air, half)) continue;
      const Vec3 normal(envelope_.nx[p], envelope_.ny[p], envelope_.nz[p]);
      const std::array<float, 2> along{envelope_.nx[p], envelope_.ny[p]};
      if (-field > std::max(limit, half)) {
        out.push_back({{p, cap, true}, -field, cap, along});
        continue;
      }
      Cell cell(reading.cell[l], {reading.fraction[0][l], reading.fraction[1][l], reading.fraction[2][l]}, tile,
                voxel_mm_);
      const Vec2 straight =
          stamps_[static_cast<std::size_t>(k)].pose.tip_mm.head<2>() + Vec2(envelope_.x[p], envelope_.y[p]);
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
      const Depth below = -field > limit && share == 255
                              ? Depth{-field, along}
                              : depth(stocks, cell, normal, cell.point_mm.head<2>() - straight);
      if (below.mm <= -kNear_mm) continue;
      const float most = below.mm > limit ? cap : limit;
      out.push_back(
          {{p, std::min(below.mm, most), below.mm > kNearCap * cap, false, share}, below.mm, most, below.deeper});
    }
  }
}

/// Thickness of the stock below a point, against the normal, from the fields that meet in its cell (see
/// removal/engagement.h): the thinnest of distance / slope, where slope is how fast a field falls along the normal.
ChipReader::Depth ChipReader::depth(const TileStocks& stocks, const Cell& cell, const Vec3& normal,
                                    const Vec2& deflection) const {
  constexpr float kSolid = std::numeric_limits<float>::infinity();
  float below_blank = stocks.blank ? -cell.trilinear(stocks.blank) : kSolid;
  if (stocks.blank && cell.up_mm != 0)
    below_blank -= static_cast<float>(cell.up_mm * cell.gradient(stocks.blank, voxel_mm_).z());
  if (below_blank <= -kNear_mm) return {below_blank, {}};
  CornerLanes corners;
  for (int a = 0; a < 3; ++a) corners.normal[a] = static_cast<float>(normal[a]);
  corners.guess[0] = static_cast<float>(deflection.x()), corners.guess[1] = static_cast<float>(deflection.y());
  place_corners(stocks, cell, corners);
  const bool any = std::any_of(corners.valid, corners.valid + 8, [](float v) { return v > 0; });
  const auto of_field = [&](float mm, const Vec3& outwards) {
    const double fall = static_cast<double>(slope(outwards.dot(normal)));
    return Depth{mm, {static_cast<float>(outwards.x() / fall), static_cast<float>(outwards.y() / fall)}};
  };
  Thinnest thinnest{kSolid, 0};
  if (any)
    thinnest = envelope_.shape.general
                   ? thinnest_general(corners)
                   : kernels_.thinnest(corners, static_cast<float>(envelope_.shape.bottom_length_mm()),
                                       static_cast<float>(envelope_.shape.corner_radius_mm), kMinSlope);
  // A slope is at most 1: what is deeper than the thinnest so far cannot become thinner.
  if (below_blank < std::max(0.0f, thinnest.mm)) {
    const Vec3 outwards = -cell.gradient(stocks.blank, voxel_mm_);
    const float mm = below_blank / slope(outwards.dot(normal));
    if (mm < thinnest.mm) return of_field(mm, outwards);
  }
  if (!any) return {kSolid, {}};
  const auto c = static_cast<std::size_t>(thinnest.corner);
  return of_field(thinnest.mm,
                  envelope_.shape.gradient(-Vec3(corners.tip[0][c], corners.tip[1][c], corners.tip[2][c])));
}

/// The stamps that a cell's corners name, with their deflections where they are known. Of the others each has the mean
/// difference between the field and the straight cutter's, weighted as the corners.
void ChipReader::place_corners(const TileStocks& stocks, const Cell& cell, CornerLanes& corners) const {
  std::array<std::int32_t, 8> ids;
  std::array<float, 8> difference{};
  bool all_known = true;
  corners.rows = {};
  corners.lag_per_mm = static_cast<float>(envelope_.lag_per_mm);
  corners.steps_per_rad = static_cast<float>(envelope_.steps / (2 * kPi));
  for (std::size_t c = 0; c < 8; ++c) {
    const auto voxel = static_cast<std::size_t>(cell.at + cell_corner(static_cast<int>(c)));
    ids[c] = stocks.now->stamp[voxel] - first_id_;
    const bool valid = ids[c] >= 0, known = valid && memory_.knows(ids[c]);
    const Vec3 tip = valid ? Vec3(all_[static_cast<std::size_t>(ids[c])].pose.tip_mm - cell.point_mm) : Vec3::Zero();
    for (int a = 0; a < 3; ++a) corners.tip[a][c] = static_cast<float>(tip[a]);
    corners.valid[c] = valid ? 1.0f : 0.0f;
    corners.known[c] = known ? 1.0f : 0.0f;
    corners.row[c] = known ? static_cast<std::int32_t>(memory_.at(ids[c]) / 2) : 0;
    corners.deflection[c] = 0;
    if (known)
      corners.rows = {memory_.values(), nullptr, static_cast<int>(deflections_.nodes()), deflections_.steps,
                      node_step_mm_};
    if (!valid || known) continue;
    all_known = false;
    const Vec3 at = cell.corner_mm - cell.point_mm + voxel_mm_ * Vec3(c & 1, c >> 1 & 1, c >> 2 & 1);
    difference[c] = stocks.now->distance[voxel] + static_cast<float>(envelope_.shape.distance_mm(at - tip));
  }
  if (all_known) return;
  for (std::size_t c = 0; c < 8; ++c) {
    if (!(corners.valid[c] > corners.known[c])) continue;
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

/// As Kernels::thinnest, for any cutter.
Thinnest ChipReader::thinnest_general(CornerLanes& corners) const {
  Thinnest thinnest{std::numeric_limits<float>::infinity(), 0};
  const Vec3 normal(corners.normal[0], corners.normal[1], corners.normal[2]);
  std::int32_t last = -1;
  for (std::size_t c = 0; c < 8; ++c) {
    if (!(corners.valid[c] > 0)) continue;
    Vec3 from_tip = -Vec3(corners.tip[0][c], corners.tip[1][c], corners.tip[2][c]);
    if (corners.known[c] > 0) {
      if (corners.row[c] == last) continue;
      last = corners.row[c];
      const Vec2 guess(corners.guess[0], corners.guess[1]);
      from_tip.head<2>() -=
          settled_deflection(envelope_, deflections_, memory_.values() + 2 * corners.row[c], from_tip, guess);
      for (int a = 0; a < 2; ++a) corners.tip[a][c] = static_cast<float>(-from_tip[a]);
    }
    const auto depth = static_cast<float>(envelope_.shape.distance_mm(from_tip)) - corners.deflection[c];
    if (depth >= thinnest.mm) continue;
    const float along = depth / slope(envelope_.shape.gradient(from_tip).dot(normal));
    if (along < thinnest.mm) thinnest = {along, static_cast<int>(c)};
  }
  return thinnest;
}

}  // namespace camber::removal::upright
