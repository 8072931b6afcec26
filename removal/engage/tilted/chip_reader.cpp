#include "removal/engage/tilted/chip_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "removal/engage/upright/level_faces.h"
#include "removal/field/cell.h"
#include "removal/field/upright/carve.h"

namespace camber::removal::tilted {

using upright::BlockBounds;
using upright::PatchLanes;
using upright::TileArena;

namespace {

constexpr float kSolid = std::numeric_limits<float>::infinity();
constexpr std::size_t kFrames = 64;  ///< frames of other stamps that are kept; a power of two
/// Faces whose normal leans from the axis by less count as square to it (the same limit as in upright/level_faces.cpp).
constexpr double kSquare = 0.1, kWithin = 1 - 1e-6;

float as_float(double v) { return static_cast<float>(v); }

/// The number in the arena of the tile that holds a voxel.
std::size_t tile_of(std::int32_t cell) { return static_cast<std::size_t>(cell / (2 * Tile::kVolume)); }
int in_tile(std::int32_t cell) { return cell % (2 * Tile::kVolume); }

/// Returns the voxel of the arena nearest to a place; an air voxel where no tile is loaded.
std::int32_t nearest_voxel(const TileArena& arena, const Vec3& place_mm, double voxel_mm) {
  constexpr int kBits = 4, kIn = Tile::kCore - 1;
  static_assert(Tile::kCore == 1 << kBits);
  std::array<int, 3> v;
  for (int a = 0; a < 3; ++a) v[static_cast<std::size_t>(a)] = static_cast<int>(std::lround(place_mm[a] / voxel_mm));
  const std::int32_t tile = std::max(0, arena.find(v[0] >> kBits, v[1] >> kBits, v[2] >> kBits));
  return tile * 2 * Tile::kVolume + Tile::offset(v[0] & kIn, v[1] & kIn, v[2] & kIn);
}

/// The lowest voxel of a cell.
Vec3 corner_mm(const TileArena& arena, std::int32_t cell, double voxel_mm) {
  const Index3& index = arena.index(tile_of(cell));
  const int at = in_tile(cell);
  return voxel_mm * Vec3(index[0] * Tile::kCore + at / (Tile::kSide * Tile::kSide),
                         index[1] * Tile::kCore + at / Tile::kSide % Tile::kSide,
                         index[2] * Tile::kCore + at % Tile::kSide);
}

Vec3 vec(const CellShare& share) {
  return {static_cast<double>(share[0]), static_cast<double>(share[1]), static_cast<double>(share[2])};
}

}  // namespace

ChipReader::ChipReader(const EngagedRun& run, const upright::PatchLanes& lanes, std::span<const Stamp> stamps,
                       const DeflectionTable& deflections, const upright::BendMemory& memory, const ReadingRule& rule)
    : envelope_(run.envelope),
      lanes_(lanes),
      view_(lanes.view()),
      all_(run.stamps),
      stamps_(stamps),
      first_id_(run.first_id),
      voxel_mm_(run.stock.voxel_mm()),
      deflections_(deflections),
      memory_(memory),
      rule_(rule),
      kernels_(upright::kernels()),
      node_step_mm_(deflections.nodes() > 1 ? as_float(deflections.node_height_mm[1]) : 1.0f),
      wall_half_mm_(upright::wall_half_widths_mm(run.envelope)) {
  for (const auto& ring : run.envelope.rings)
    max_curved_per_mm_ =
        std::max({max_curved_per_mm_, ring.profile.meridian_curvature_per_mm, ring.profile.parallel_curvature_per_mm});
}

ChipReader::Reading ChipReader::reading_of(std::size_t k, bool sharp) const {
  const auto from = static_cast<std::size_t>(stamps_.data() - all_.data());
  const std::ptrdiff_t before = static_cast<std::ptrdiff_t>(k) - 1;
  const bool first = stamps_[k].first;
  return {k,
          from + k,
          StampFrame(stamps_[k].pose),
          motion_in_tool(all_, from + k),
          first ? 0 : deflections_.largest_lateral_mm(before),
          first ? 0 : deflections_.largest_axial_mm(before),
          sharp || rule_.rigid};
}

/// Does what BlockKernels::find_blocks does, with the motion of the patch's centre.
void ChipReader::find_patches(const TileArena& arena, const Reading& stamp, std::vector<std::int32_t>& out) const {
  const auto row = static_cast<std::ptrdiff_t>(stamp.k);
  const std::ptrdiff_t before = stamps_[stamp.k].first ? row : row - 1;
  const double lateral_mm = deflections_.largest_lateral_mm(row) + deflections_.largest_lateral_mm(before);
  const double axial_mm = deflections_.largest_axial_mm(row) + deflections_.largest_axial_mm(before);
  const double slack = deflections_.largest_mm(row) + 1e-3 * voxel_mm_;
  const BlockBounds bounds = lanes_.bounds();
  const float* field = arena.view().distance;
  out.clear();
  for (std::size_t p = 0; p < envelope_.patches.size(); ++p) {
    const EnvelopeGrid::Patch& patch = envelope_.patches[p];
    const Vec3 motion = stamp.motion.at(patch.centre_from_tip);
    const double turned = stamp.motion.turn_rad.norm() * patch.radius_mm, way = motion.norm() + turned;
    const double most = way + lateral_mm + axial_mm;
    double into = motion.dot(patch.normal) + way * patch.normal_spread + turned +
                  lateral_mm * static_cast<double>(bounds.lateral[p]) + axial_mm +
                  0.5 * rule_.pitches * most * most * static_cast<double>(bounds.curvature[p]);
    if (bounds.lateral[p] >= BlockBounds::kLevel) into += kMaxTilt * way * (rule_.rigid ? 0 : 1);
    if (!(into > -1e-6)) continue;
    const Vec3 centre = stamp.frame.in_part(patch.centre_from_tip);
    if (field[nearest_voxel(arena, centre, voxel_mm_)] <= bounds.reach[p] + as_float(slack))
      out.push_back(static_cast<std::int32_t>(p));
  }
}

upright::TiltedPlace ChipReader::place_of(const TileArena& arena, const Reading& stamp) const {
  upright::TiltedPlace out{};
  out.tip = arena.place_of(stamps_[stamp.k], 0);
  for (int a = 0; a < 3; ++a) {
    out.tip.feed_mm[a] = as_float(stamp.motion.tip_mm[a]);
    out.turn_rad[a] = as_float(stamp.motion.turn_rad[a]);
    for (int b = 0; b < 3; ++b) out.voxels[a][b] = as_float(stamp.frame.to_part(a, b) / voxel_mm_);
  }
  out.max_tilt = as_float(kMaxTilt);
  out.min_cap_per_mm = rule_.rigid ? as_float((1 - rule_.pitches) * max_curved_per_mm_ / 2) : 0.0f;
  return out;
}

upright::StampBend ChipReader::bend_of(const Reading& stamp) const {
  if (rule_.rigid) return {};
  const auto k = static_cast<std::ptrdiff_t>(stamp.k);
  return {{deflections_.row(k), stamps_[stamp.k].first ? deflections_.row(k) : deflections_.row(k - 1),
           static_cast<int>(deflections_.nodes()), deflections_.steps, node_step_mm_, deflections_.axial},
          as_float(envelope_.lag_per_mm),
          as_float(envelope_.steps / (4 * kPi)),
          0,
          as_float(stamp.reach_mm),
          as_float(stamp.axial_reach_mm)};
}

/// Sorts points by what the field shows: deep points give their chips at once, points in air none, the rest are listed
/// as shallow (as in upright::ChipReader).
void ChipReader::sort_points(const TileArena& arena, const Reading& stamp, const upright::LaneReading& reading,
                             int first_lane, int count, Buffers& b, std::vector<DeflectedChipSample>& out) const {
  const auto row = static_cast<std::ptrdiff_t>(stamp.k);
  const float air = 0.5f * as_float(voxel_mm_), reach = as_float(stamp.reach_mm),
              axial_reach = as_float(stamp.axial_reach_mm);
  for (int l = 0; l < count; ++l) {
    if (reading.cell[l] < 0) continue;
    const float field = reading.field[l], cap = reading.cap[l];
    const std::uint32_t p = lanes_.point(first_lane + l), ring = p / static_cast<std::uint32_t>(envelope_.steps);
    if (rule_.rigid && cap > 0 && cap <= kThinnestChip_mm) continue;
    const float half = wall_half_mm_[ring];
    if (field > std::max(air, half)) continue;
    const float more = reach * envelope_.rings[ring].sine + axial_reach * std::abs(envelope_.rings[ring].cosine);
    const float limit = stamp.sharp ? cap : std::max(kBeyondCap * cap, cap + more);
    const std::array<float, 3> along{envelope_.nx[p], envelope_.ny[p], envelope_.nz[p]};
    if (-field > std::max(limit, half)) {
      out.push_back({{p, cap, true}, -field, cap, along});
      continue;
    }
    const std::int32_t cell = reading.cell[l];
    const CellShare share{reading.fraction[0][l], reading.fraction[1][l], reading.fraction[2][l]};
    const Vec3 place = corner_mm(arena, cell, voxel_mm_) + voxel_mm_ * vec(share);
    Shallow shallow{p, 255, cap, limit, kSolid, share, cell, place, 0, 0};
    if (std::abs(field) < half) {
      const auto step = static_cast<int>(p % static_cast<std::uint32_t>(envelope_.steps)) % deflections_.steps;
      if (!place_in_ring(arena, stamp, half, deflections_.axial_mm(deflections_.row(row), step), shallow, b)) continue;
      if (-field > limit && shallow.cut_255 == 255) {
        out.push_back({{p, cap, true}, -field, cap, along});
        continue;
      }
    }
    if (reach_below_blank(arena, stamp, shallow)) b.shallow.push_back(shallow);
  }
}

/// Sets how far the point lies below the blank's surface. Returns false far outside of it.
bool ChipReader::reach_below_blank(const TileArena& arena, const Reading& stamp, Shallow& p) const {
  if (!arena.blank(tile_of(p.cell))) return true;
  p.below_blank_mm = -as_float(arena.blank_at(p.cell, p.share).distance_mm(p.up_mm, stamp.frame.axis()));
  return p.below_blank_mm > -kNear_mm;
}

void ChipReader::read(const TileArena& arena, const Reading& stamp, std::span<const std::int32_t> patches, Buffers& b,
                      std::vector<DeflectedChipSample>& out) const {
  const upright::TiltedPlace place = place_of(arena, stamp);
  const upright::StampBend bend = bend_of(stamp);
  const upright::ArenaView tiles = arena.view();
  b.shallow.clear();
  upright::LaneReading reading;
  for (const std::int32_t patch : patches) {
    const PatchLanes::Range range = lanes_.range(static_cast<std::uint32_t>(patch));
    for (int from = 0; from < range.count; from += upright::LaneReading::kMax) {
      const int count = std::min(range.count - from, upright::LaneReading::kMax);
      const int whole = (count + PatchLanes::kVector - 1) / PatchLanes::kVector * PatchLanes::kVector;
      kernels_.read_tilted_points(view_, range.from + from, whole, place, bend, tiles, reading);
      sort_points(arena, stamp, reading, range.from + from, count, b, out);
    }
  }
  make_room(b);
  for (Shallow& point : b.shallow) add_pairs(arena, stamp, point, b);
  if (envelope_.shape.general)
    thin_general(b);
  else
    thin_pairs(b);
  for (std::size_t i = 0; i < b.shallow.size(); ++i) {
    const Shallow& p = b.shallow[i];
    const Depth below = depth(arena, stamp, p, i + 1 < b.shallow.size() ? b.shallow[i + 1].first_pair : b.pairs, b);
    if (below.mm <= -kNear_mm) continue;
    const float most = below.mm > p.limit_mm ? p.cap_mm : p.limit_mm;
    out.push_back({{p.point, std::min(below.mm, most), below.mm > kNearCap * p.cap_mm, below.own_surface, p.cut_255},
                   below.mm,
                   most,
                   below.deeper});
  }
}

/// Sets the part of a ring that lies in material between faces square to the axis: those of the blank, and the floors
/// that the cutter left before (as upright::part_in_material). Returns false where there is none.
bool ChipReader::place_in_ring(const TileArena& arena, const Reading& stamp, float half_mm, float axial_mm, Shallow& p,
                               Buffers& b) const {
  const auto half = static_cast<double>(half_mm);
  upright::RingPart part{-half, half};
  const Vec3 axis = stamp.frame.axis(), n = stamp.frame.to_part * normal(p.point);
  if (arena.blank(tile_of(p.cell)))
    arena.blank_at(p.cell, p.share).for_each_face([&](double above, const Vec3& outwards) {
      const double up = outwards.dot(axis);
      if (std::abs(above) < kWithin * half && std::abs(outwards.dot(n)) < kSquare * std::abs(up))
        part.cut_by(-above / up, up > 0);
    });
  const std::int32_t* ids = arena.view().stamp + p.cell;
  for (int c = 0; c < 8; ++c) {
    const std::int32_t id = ids[cell_corner(c)] - first_id_;
    if (id < 0) continue;
    const StampFrame& left = other(id, b).frame;
    if (left.axis().dot(axis) < 1 - kSquare * kSquare / 2) continue;
    Vec3 from_tip = left.in_tool(p.place_mm);
    from_tip.z() -= static_cast<double>(axial_mm);
    if (std::abs(from_tip.z()) >= kWithin * half || envelope_.shape.gradient(from_tip).z() > -1 + kSquare) continue;
    part.to_mm = std::min(part.to_mm, -from_tip.z());
  }
  p.cut_255 = part.cut_255(half);
  p.up_mm = part.middle_mm();
  p.place_mm += p.up_mm * axis;
  return p.cut_255 > 0;
}

ChipReader::OtherStamp& ChipReader::other(std::int32_t stamp, Buffers& b) const {
  if (b.others.empty()) b.others.resize(kFrames);
  OtherStamp& out = b.others[static_cast<std::size_t>(stamp) % kFrames];
  if (out.stamp != stamp) out = {stamp, StampFrame(all_[static_cast<std::size_t>(stamp)].pose)};
  return out;
}

const Mat3& ChipReader::turn_to(const Reading& from, OtherStamp& to) {
  if (to.turned_from != from.number) {
    to.turned_from = from.number;
    to.turn = to.frame.to_part.transpose() * from.frame.to_part;
  }
  return to.turn;
}

void ChipReader::make_room(Buffers& b) {
  const std::size_t most = 8 * b.shallow.size() + PatchLanes::kVector;
  b.pairs = 0;
  if (b.x.size() >= most) return;
  for (auto* v :
       {&b.x, &b.y, &b.z, &b.nx, &b.ny, &b.nz, &b.guess_x, &b.guess_y, &b.guess_z, &b.known, &b.farther, &b.thickness})
    v->resize(most);
  b.row.resize(most), b.id.resize(most);
}

/// Lists the stamps that a cell's corners name, each with place, normal and deflection in its own tool's frame (as in
/// upright::ChipReader).
void ChipReader::add_pairs(const TileArena& arena, const Reading& stamp, Shallow& p, Buffers& b) const {
  p.first_pair = b.pairs;
  const std::int32_t* named = arena.view().stamp + p.cell;
  const Vec3 point(static_cast<double>(envelope_.x[p.point]), static_cast<double>(envelope_.y[p.point]),
                   static_cast<double>(envelope_.z[p.point]) + p.up_mm);
  Vec3 guess = stamp.frame.in_tool(p.place_mm) - point;
  if (!deflections_.axial) guess.z() = 0;
  std::array<std::int32_t, 8> ids;
  for (std::size_t c = 0; c < 8; ++c) ids[c] = named[cell_corner(static_cast<int>(c))] - first_id_;
  for (std::size_t c = 0; c < 8; ++c) {
    if (ids[c] < 0 || std::find(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(c), ids[c]) !=
                          ids.begin() + static_cast<std::ptrdiff_t>(c))
      continue;
    const std::size_t at = b.pairs++;
    OtherStamp& left = other(ids[c], b);
    const Mat3& turn = turn_to(stamp, left);
    const Vec3 from_tip = left.frame.in_tool(p.place_mm), n = turn * normal(p.point), by = turn * guess;
    const bool known = memory_.knows(ids[c]);
    b.id[at] = ids[c];
    b.x[at] = as_float(from_tip.x()), b.y[at] = as_float(from_tip.y()), b.z[at] = as_float(from_tip.z());
    b.nx[at] = as_float(n.x()), b.ny[at] = as_float(n.y()), b.nz[at] = as_float(n.z());
    b.guess_x[at] = known ? as_float(by.x()) : 0.0f;
    b.guess_y[at] = known ? as_float(by.y()) : 0.0f;
    b.guess_z[at] = known && deflections_.axial ? as_float(by.z()) : 0.0f;
    b.known[at] = known ? 1.0f : 0.0f;
    b.row[at] = known ? static_cast<std::int32_t>(memory_.at(ids[c]) / 2) : 0;
    b.farther[at] = known ? 0.0f : farther_mm(arena, p, ids[c], left.frame);
  }
}

/// Returns how much farther out a stamp's surface lies than that of the undeflected cutter, from the corners that name
/// it.
float ChipReader::farther_mm(const TileArena& arena, const Shallow& p, std::int32_t id, const StampFrame& frame) const {
  const float* distance = arena.view().distance + p.cell;
  const std::int32_t* named = arena.view().stamp + p.cell;
  const Vec3 lowest = corner_mm(arena, p.cell, voxel_mm_);
  float weight = 0, sum = 0;
  for (int c = 0; c < 8; ++c) {
    if (named[cell_corner(c)] - first_id_ != id) continue;
    const Vec3 corner = lowest + voxel_mm_ * Vec3(c & 1, c >> 1 & 1, c >> 2 & 1);
    const float difference = distance[cell_corner(c)] + as_float(envelope_.shape.distance_mm(frame.in_tool(corner)));
    const float w = corner_weight(c, p.share) + 1e-6f;
    weight += w;
    sum += w * difference;
  }
  return sum / weight;
}

void ChipReader::thin_pairs(Buffers& b) const {
  // The last vector is filled up with any values of an existing row.
  for (std::size_t i = b.pairs; i % PatchLanes::kVector != 0; ++i) b.row[i] = 0;
  const auto end = b.known.begin() + static_cast<std::ptrdiff_t>(b.pairs);
  const bool any_known = std::find(b.known.begin(), end, 1.0f) != end;
  const upright::DeflectionRow rows{any_known ? memory_.values() : nullptr,
                                    nullptr,
                                    static_cast<int>(deflections_.nodes()),
                                    deflections_.steps,
                                    node_step_mm_,
                                    deflections_.axial};
  kernels_.thin_pairs(
      {static_cast<int>(b.pairs), b.x.data(), b.y.data(), b.z.data(), b.nx.data(), b.ny.data(), b.nz.data(),
       b.guess_x.data(), b.guess_y.data(), b.guess_z.data(), b.known.data(), b.row.data(), b.farther.data(), rows,
       as_float(envelope_.lag_per_mm), as_float(envelope_.steps / (2 * kPi)), b.thickness.data()},
      as_float(envelope_.shape.bottom_length_mm()), as_float(envelope_.shape.corner_radius_mm), kMinSlope);
}

/// Does what Kernels::thin_pairs does, for any cutter profile.
void ChipReader::thin_general(Buffers& b) const {
  for (std::size_t i = 0; i < b.pairs; ++i) {
    const auto vec = [&](const auto& x, const auto& y, const auto& z) {
      return Vec3(static_cast<double>(x[i]), static_cast<double>(y[i]), static_cast<double>(z[i]));
    };
    Vec3 from_tip = vec(b.x, b.y, b.z);
    if (b.known[i] > 0) {
      from_tip -= upright::settled_deflection(envelope_, deflections_, memory_.values() + 2 * b.row[i], from_tip,
                                              vec(b.guess_x, b.guess_y, b.guess_z));
      b.x[i] = as_float(from_tip.x()), b.y[i] = as_float(from_tip.y()), b.z[i] = as_float(from_tip.z());
    }
    const float depth = as_float(envelope_.shape.distance_mm(from_tip)) - b.farther[i];
    b.thickness[i] = depth / slope(envelope_.shape.gradient(from_tip).dot(vec(b.nx, b.ny, b.nz)));
  }
}

/// Returns the depth of a point, as upright::ChipReader::depth does.
ChipReader::Depth ChipReader::depth(const TileArena& arena, const Reading& stamp, const Shallow& p,
                                    std::size_t end_pair, Buffers& b) const {
  const auto of_field = [&](float mm, const Vec3& outwards_in_tool, bool own_surface) {
    const auto fall = static_cast<double>(slope(outwards_in_tool.dot(normal(p.point))));
    return Depth{mm,
                 {as_float(outwards_in_tool.x() / fall), as_float(outwards_in_tool.y() / fall),
                  as_float(outwards_in_tool.z() / fall)},
                 own_surface && rule_.rigid};
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
      const Vec3 inwards = -(stamp.frame.to_part.transpose() * outwards);
      const double below = -above - p.up_mm * outwards.dot(stamp.frame.axis());
      const float thickness = as_float(below) / slope(inwards.dot(normal(p.point)));
      if (thickness < mm) mm = thickness, into = inwards;
    });
    if (mm < thinnest) return of_field(mm, into, false);
  }
  if (p.first_pair == end_pair) return {kSolid, {}, false};
  const Vec3 from_tip(static_cast<double>(b.x[of]), static_cast<double>(b.y[of]), static_cast<double>(b.z[of]));
  const Vec3 outwards = other(b.id[of], b).frame.to_part * envelope_.shape.gradient(from_tip);
  return of_field(thinnest, stamp.frame.to_part.transpose() * outwards, true);
}

}  // namespace camber::removal::tilted
