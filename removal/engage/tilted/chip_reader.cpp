#include "removal/engage/tilted/chip_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vector_clones.h"
#include "removal/engage/upright/level_faces.h"
#include "removal/field/upright/carve_general.h"

namespace camber::removal::tilted {

using upright::BlockBounds;
using upright::PatchLanes;
using upright::TileArena;

namespace {

constexpr float kSolid = std::numeric_limits<float>::infinity();
constexpr std::size_t kFrames = 64;
/// Faces whose normal leans from the axis by less count as square to it; as removal/engage/upright/level_faces.cpp.
constexpr double kSquare = 0.1, kWithin = 1 - 1e-6;

constexpr float kNoChip = -1e30f;

float as_float(double v) { return static_cast<float>(v); }

struct StraightMotion {
  Eigen::Vector3f tip, turn;
};
struct StraightPoints {
  float *x, *y, *z, *cap;
};

/// `least_per_mm2`: caps of no more than this times the square of the motion make no chip.
CAMBER_VECTOR_CLONES
void fill_straight(const upright::PointLanes& p, int from, int count, const StraightMotion& m, float least_per_mm2,
                   const StraightPoints& out) {
  for (int l = 0; l < count; ++l) {
    const int k = from + l;
    const float x = p.x[k], y = p.y[k], z = p.z[k];
    const float mx = m.tip.x() + m.turn.y() * z - m.turn.z() * y, my = m.tip.y() + m.turn.z() * x - m.turn.x() * z,
                mz = m.tip.z() + m.turn.x() * y - m.turn.y() * x;
    const float along = mx * p.nx[k] + my * p.ny[k] + mz * p.nz[k], all2 = mx * mx + my * my + mz * mz;
    const float around = p.cos_phi[k] * my - p.sin_phi[k] * mx, around2 = around * around;
    const float tangential2 = std::max(0.0f, all2 - along * along);
    const float cap = along + 0.5f * (p.k1[k] * std::max(0.0f, tangential2 - around2) + p.k2[k] * around2);
    out.x[l] = x, out.y[l] = y, out.z[l] = z;
    out.cap[l] = cap > least_per_mm2 * all2 ? cap : kNoChip;
  }
}

}  // namespace

/// The voxels around a place.
struct ChipReader::Cell {
  std::int32_t cell = -1;  ///< its lowest voxel in the arena; in tile 0: air
  CellShare share{};

  Cell(const TileArena& arena, const Vec3& place_mm, double voxel_mm) {
    Index3 voxel;
    for (std::size_t a = 0; a < 3; ++a) {
      const double at = place_mm[static_cast<int>(a)] / voxel_mm, base = std::floor(at);
      voxel[a] = static_cast<int>(base);
      share[a] = as_float(at - base);
    }
    cell = cell_of(arena, voxel);
  }
  static std::int32_t cell_of(const TileArena& arena, const Index3& v) {
    constexpr int kBits = 4, kIn = Tile::kCore - 1;
    static_assert(Tile::kCore == 1 << kBits);
    const std::int32_t tile = std::max(0, arena.find(v[0] >> kBits, v[1] >> kBits, v[2] >> kBits));
    return tile * 2 * Tile::kVolume + Tile::offset(v[0] & kIn, v[1] & kIn, v[2] & kIn);
  }
};

ChipReader::ChipReader(const EnvelopeGrid& envelope, const PatchLanes& lanes, std::span<const Stamp> all,
                       std::span<const Stamp> stamps, std::int32_t first_id, double voxel_mm,
                       const DeflectionTable& deflections, const upright::BendMemory& memory, const ReadingRule& rule)
    : envelope_(envelope),
      lanes_(lanes),
      view_(lanes.view()),
      all_(all),
      stamps_(stamps),
      first_id_(first_id),
      voxel_mm_(voxel_mm),
      deflections_(deflections),
      memory_(memory),
      rule_(rule),
      node_step_mm_(deflections.nodes() > 1 ? as_float(deflections.node_height_mm[1]) : 1.0f),
      wall_half_mm_(upright::wall_half_widths_mm(envelope)) {
  for (const auto& ring : envelope.rings)
    max_curved_per_mm_ =
        std::max({max_curved_per_mm_, ring.profile.meridian_curvature_per_mm, ring.profile.parallel_curvature_per_mm});
}

ChipReader::Reading ChipReader::reading_of(std::size_t k) const {
  const auto from = static_cast<std::size_t>(stamps_.data() - all_.data());
  const std::ptrdiff_t before = static_cast<std::ptrdiff_t>(k) - 1;
  const bool first = stamps_[k].first;
  return {k, Frame(stamps_[k].pose), motion_in_tool(all_, from + k),
          first ? 0 : deflections_.largest_lateral_mm(before), first ? 0 : deflections_.largest_axial_mm(before)};
}

/// As BlockKernels::find_blocks, with the motion of the patch's centre.
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
    const Vec3 centre = stamp.frame.in_part(patch.centre_from_tip) / voxel_mm_;
    const Index3 nearest{static_cast<int>(std::lround(centre.x())), static_cast<int>(std::lround(centre.y())),
                         static_cast<int>(std::lround(centre.z()))};
    if (field[Cell::cell_of(arena, nearest)] <= bounds.reach[p] + as_float(slack))
      out.push_back(static_cast<std::int32_t>(p));
  }
}

/// As Kernels::read_points, without a deflection.
void ChipReader::straight_points(int from, int count, const Reading& stamp, Points& out) const {
  const auto f = [](const Vec3& v) { return Eigen::Vector3f(v.cast<float>()); };
  fill_straight(view_, from, count, {f(stamp.motion.tip_mm), f(stamp.motion.turn_rad)},
                as_float((1 - rule_.pitches) * max_curved_per_mm_ / 2),
                {out.x.data(), out.y.data(), out.z.data(), out.cap_mm.data()});
}

/// As Kernels::read_points.
void ChipReader::deflected_points(int from, int count, const Reading& stamp, Points& out) const {
  const auto k = static_cast<std::ptrdiff_t>(stamp.k);
  const float *now = deflections_.row(k), *before = stamps_[stamp.k].first ? now : deflections_.row(k - 1);
  const int steps = deflections_.steps, nodes = static_cast<int>(deflections_.nodes());
  for (int l = 0; l < count; ++l) {
    const int lane = from + l;
    const auto at = [&](const float* values) { return static_cast<double>(values[lane]); };
    const Vec3 n(at(view_.nx), at(view_.ny), at(view_.nz));
    Vec3 place(at(view_.x), at(view_.y), at(view_.z)), motion = stamp.motion.at(place);
    const double cosine_phi = at(view_.cos_phi), sine_phi = at(view_.sin_phi), sine = at(view_.sine);
    const int lower = view_.lower[lane], upper = std::min(lower + 1, nodes - 1), step = view_.step[lane];
    const double share = at(view_.upper_fraction);
    const auto node = [&](const float* row, int of_node, int of_step) {
      const float* v = row + 2 * (of_node * steps + of_step);
      return Vec2(static_cast<double>(v[0]), static_cast<double>(v[1]));
    };
    const auto between = [&](const float* row, int of_step) {
      const Vec2 low = node(row, lower, of_step);
      return Vec2(low + share * (node(row, upper, of_step) - low));
    };
    const int next = step + 1 == steps ? 0 : step + 1, last = step == 0 ? steps - 1 : step - 1;
    const Vec2 is = between(now, step), was = between(before, step), change = between(now, next) - between(now, last);
    double by_step = change.dot(n.head<2>());
    Vec3 displaced(is.x(), is.y(), 0), moved(is.x() - was.x(), is.y() - was.y(), 0);
    if (deflections_.axial) {
      const auto axial = [&](const float* row, int s) { return static_cast<double>(deflections_.axial_mm(row, s)); };
      by_step += (axial(now, next) - axial(now, last)) * n.z();
      displaced.z() = axial(now, step);
      moved.z() = axial(now, step) - axial(before, step);
    }
    const double by_angle = envelope_.steps / (4 * kPi) * by_step;
    const double by_height =
        (node(now, upper, step) - node(now, lower, step)).dot(n.head<2>()) / static_cast<double>(node_step_mm_);
    const double around = cosine_phi * motion.y() - sine_phi * motion.x();
    const double up = at(view_.cosine) * (cosine_phi * motion.x() + sine_phi * motion.y()) + sine * motion.z();
    double tilt = 0;
    if (sine >= static_cast<double>(BlockBounds::kLevel)) {
      const double most = kMaxTilt * motion.norm();
      tilt = around * by_angle * at(view_.per_radius) + up * sine * (by_height - envelope_.lag_per_mm * by_angle);
      tilt = std::clamp(tilt, -most, most);
    }
    place += displaced;
    motion += moved;
    const double along = motion.dot(n) - tilt;
    const double tangential2 = std::max(0.0, motion.squaredNorm() - along * along);
    const double sideways = cosine_phi * motion.y() - sine_phi * motion.x(), sideways2 = sideways * sideways;
    const double cap = along + 0.5 * (at(view_.k1) * std::max(0.0, tangential2 - sideways2) + at(view_.k2) * sideways2);
    const auto i = static_cast<std::size_t>(l);
    out.x[i] = as_float(place.x()), out.y[i] = as_float(place.y()), out.z[i] = as_float(place.z());
    out.cap_mm[i] =
        cap > -stamp.reach_mm * n.head<2>().norm() - stamp.axial_reach_mm * std::abs(n.z()) ? as_float(cap) : kNoChip;
  }
}

/// Deep points make their chips at once; air makes none. As upright::ChipReader.
void ChipReader::sort_point(const TileArena& arena, const Reading& stamp, int lane, const Vec3& place, float cap,
                            Buffers& b, std::vector<DeflectedChipSample>& out) const {
  const Cell cell(arena, place, voxel_mm_);
  const float field = trilinear(arena.view().distance + cell.cell, cell.share);
  const std::uint32_t p = lanes_.point(lane), ring = p / static_cast<std::uint32_t>(envelope_.steps);
  const float half = wall_half_mm_[ring], air = 0.5f * as_float(voxel_mm_);
  if (field > std::max(air, half)) return;
  const double more = stamp.reach_mm * static_cast<double>(envelope_.rings[ring].sine) +
                      stamp.axial_reach_mm * std::abs(static_cast<double>(envelope_.rings[ring].cosine));
  const float limit = rule_.rigid ? cap : std::max(kBeyondCap * cap, cap + as_float(more));
  const std::array<float, 3> along{envelope_.nx[p], envelope_.ny[p], envelope_.nz[p]};
  if (-field > std::max(limit, half)) {
    out.push_back({{p, cap, true}, -field, cap, along});
    return;
  }
  Shallow shallow{p, 255, cap, limit, kSolid, cell.share, cell.cell, place, 0, 0};
  if (std::abs(field) < half) {
    const auto k = static_cast<std::ptrdiff_t>(stamp.k);
    const auto step = static_cast<int>(p % static_cast<std::uint32_t>(envelope_.steps)) % deflections_.steps;
    if (!place_in_ring(arena, stamp, half, deflections_.axial_mm(deflections_.row(k), step), shallow, b)) return;
    if (-field > limit && shallow.cut_255 == 255) {
      out.push_back({{p, cap, true}, -field, cap, along});
      return;
    }
  }
  const auto tile = static_cast<std::size_t>(cell.cell / (2 * Tile::kVolume));
  if (const float* blank = arena.blank(tile)) {
    const float* lowest = blank + cell.cell % (2 * Tile::kVolume);
    shallow.below_blank_mm = -trilinear(lowest, cell.share);
    if (shallow.up_mm != 0)
      shallow.below_blank_mm -=
          as_float(shallow.up_mm * trilinear_gradient(lowest, cell.share, voxel_mm_).dot(stamp.frame.axis()));
    if (shallow.below_blank_mm <= -kNear_mm) return;
  }
  b.shallow.push_back(shallow);
}

void ChipReader::read(const TileArena& arena, const Reading& stamp, std::span<const std::int32_t> patches, Buffers& b,
                      std::vector<DeflectedChipSample>& out) const {
  b.shallow.clear();
  Points points;
  for (const std::int32_t patch : patches) {
    const PatchLanes::Range range = lanes_.range(static_cast<std::uint32_t>(patch));
    for (int from = 0; from < range.count; from += Points::kMost) {
      const int count = std::min(range.count - from, Points::kMost), first = range.from + from;
      if (rule_.rigid)
        straight_points(first, count, stamp, points);
      else
        deflected_points(first, count, stamp, points);
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        if (points.cap_mm[i] == kNoChip) continue;
        const Eigen::Vector3f in_tool(points.x[i], points.y[i], points.z[i]);
        sort_point(arena, stamp, first + static_cast<int>(i), stamp.frame.in_part(in_tool.cast<double>()),
                   points.cap_mm[i], b, out);
      }
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

/// Takes the part of a ring that lies in material between faces square to the axis: the blank's, and the floors that
/// the cutter left before. As upright::part_in_material. False where there is none.
bool ChipReader::place_in_ring(const TileArena& arena, const Reading& stamp, float half_mm, float axial_mm, Shallow& p,
                               Buffers& b) const {
  const auto half = static_cast<double>(half_mm);
  upright::RingPart part{-half, half};
  const Vec3 axis = stamp.frame.axis(), n = stamp.frame.to_part * normal(p.point);
  const auto tile = static_cast<std::size_t>(p.cell / (2 * Tile::kVolume));
  if (const float* blank = arena.blank(tile)) {
    const float* lowest = blank + p.cell % (2 * Tile::kVolume);
    const auto above = static_cast<double>(trilinear(lowest, p.share));
    if (std::abs(above) < kWithin * half) {
      const Vec3 outwards = trilinear_gradient(lowest, p.share, voxel_mm_);
      const double up = outwards.dot(axis);
      if (std::abs(outwards.dot(n)) < kSquare * std::abs(up)) {
        const double face = -above / up;
        if (up > 0)
          part.to_mm = std::min(part.to_mm, face);
        else
          part.from_mm = std::max(part.from_mm, face);
      }
    }
  }
  const std::int32_t* ids = arena.view().stamp + p.cell;
  for (int c = 0; c < 8; ++c) {
    const std::int32_t id = ids[cell_corner(c)] - first_id_;
    if (id < 0) continue;
    const Frame& other = frame(id, b);
    if (other.axis().dot(axis) < 1 - kSquare * kSquare / 2) continue;
    Vec3 from_tip = other.in_tool(p.place_mm);
    from_tip.z() -= static_cast<double>(axial_mm);
    if (std::abs(from_tip.z()) >= kWithin * half || envelope_.shape.gradient(from_tip).z() > -1 + kSquare) continue;
    part.to_mm = std::min(part.to_mm, -from_tip.z());
  }
  p.cut_255 = part.cut_255(half);
  p.up_mm = part.middle_mm();
  p.place_mm += p.up_mm * axis;
  return p.cut_255 > 0;
}

const Frame& ChipReader::frame(std::int32_t stamp, Buffers& b) const {
  if (b.frames.empty()) b.frames.assign(kFrames, {-1, Frame(ToolPose{})});
  auto& [known, frame] = b.frames[static_cast<std::size_t>(stamp) % kFrames];
  if (known != stamp) {
    known = stamp;
    frame = Frame(all_[static_cast<std::size_t>(stamp)].pose);
  }
  return frame;
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

/// The stamps that a cell's corners name, each with the place, the normal and the deflection in its own tool's frame.
/// As upright::ChipReader.
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
    const Frame& other = frame(ids[c], b);
    const Mat3 turn = other.to_part.transpose() * stamp.frame.to_part;
    const Vec3 from_tip = other.in_tool(p.place_mm), n = turn * normal(p.point), by = turn * guess;
    const bool known = memory_.knows(ids[c]);
    b.id[at] = ids[c];
    b.x[at] = as_float(from_tip.x()), b.y[at] = as_float(from_tip.y()), b.z[at] = as_float(from_tip.z());
    b.nx[at] = as_float(n.x()), b.ny[at] = as_float(n.y()), b.nz[at] = as_float(n.z());
    b.guess_x[at] = known ? as_float(by.x()) : 0.0f;
    b.guess_y[at] = known ? as_float(by.y()) : 0.0f;
    b.guess_z[at] = known && deflections_.axial ? as_float(by.z()) : 0.0f;
    b.known[at] = known ? 1.0f : 0.0f;
    b.row[at] = known ? static_cast<std::int32_t>(memory_.at(ids[c]) / 2) : 0;
    b.farther[at] = known ? 0.0f : farther_mm(arena, p, ids[c], other);
  }
}

/// How much farther out than the straight cutter's a stamp's surface lies, by the corners that name it.
float ChipReader::farther_mm(const TileArena& arena, const Shallow& p, std::int32_t id, const Frame& frame) const {
  const float* distance = arena.view().distance + p.cell;
  const std::int32_t* named = arena.view().stamp + p.cell;
  const auto tile = static_cast<std::size_t>(p.cell / (2 * Tile::kVolume));
  const int in_tile = p.cell % (2 * Tile::kVolume);
  const Index3& index = arena.index(tile);
  const Vec3 lowest(index[0] * Tile::kCore + in_tile / (Tile::kSide * Tile::kSide),
                    index[1] * Tile::kCore + in_tile / Tile::kSide % Tile::kSide,
                    index[2] * Tile::kCore + in_tile % Tile::kSide);
  float weight = 0, sum = 0;
  for (int c = 0; c < 8; ++c) {
    if (named[cell_corner(c)] - first_id_ != id) continue;
    const Vec3 corner = voxel_mm_ * (lowest + Vec3(c & 1, c >> 1 & 1, c >> 2 & 1));
    const float difference = distance[cell_corner(c)] + as_float(envelope_.shape.distance_mm(frame.in_tool(corner)));
    const float w = corner_weight(c, p.share) + 1e-6f;
    weight += w;
    sum += w * difference;
  }
  return sum / weight;
}

void ChipReader::thin_pairs(Buffers& b) const {
  // What fills the last vector: anything, of a row that there is.
  for (std::size_t i = b.pairs; i % PatchLanes::kVector != 0; ++i) b.row[i] = 0;
  const auto end = b.known.begin() + static_cast<std::ptrdiff_t>(b.pairs);
  const bool any_known = std::find(b.known.begin(), end, 1.0f) != end;
  const upright::DeflectionRow rows{any_known ? memory_.values() : nullptr,
                                    nullptr,
                                    static_cast<int>(deflections_.nodes()),
                                    deflections_.steps,
                                    node_step_mm_,
                                    deflections_.axial};
  upright::kernels().thin_pairs(
      {static_cast<int>(b.pairs), b.x.data(), b.y.data(), b.z.data(), b.nx.data(), b.ny.data(), b.nz.data(),
       b.guess_x.data(), b.guess_y.data(), b.guess_z.data(), b.known.data(), b.row.data(), b.farther.data(), rows,
       as_float(envelope_.lag_per_mm), as_float(envelope_.steps / (2 * kPi)), b.thickness.data()},
      as_float(envelope_.shape.bottom_length_mm()), as_float(envelope_.shape.corner_radius_mm), kMinSlope);
}

/// As Kernels::thin_pairs, for any cutter.
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

/// As upright::ChipReader.
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
    const float* lowest =
        arena.blank(static_cast<std::size_t>(p.cell / (2 * Tile::kVolume))) + p.cell % (2 * Tile::kVolume);
    const Vec3 outwards = -(stamp.frame.to_part.transpose() * trilinear_gradient(lowest, p.share, voxel_mm_));
    const float mm = p.below_blank_mm / slope(outwards.dot(normal(p.point)));
    if (mm < thinnest) return of_field(mm, outwards, false);
  }
  if (p.first_pair == end_pair) return {kSolid, {}, false};
  const Vec3 from_tip(static_cast<double>(b.x[of]), static_cast<double>(b.y[of]), static_cast<double>(b.z[of]));
  const Vec3 outwards = frame(b.id[of], b).to_part * envelope_.shape.gradient(from_tip);
  return of_field(thinnest, stamp.frame.to_part.transpose() * outwards, true);
}

}  // namespace camber::removal::tilted
