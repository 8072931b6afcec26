#include "removal/engage/upright/block_reader.h"
#include "removal/simd/upright_block_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "removal/field/cell.h"

namespace camber::removal::upright {
namespace {

constexpr float kSolid = std::numeric_limits<float>::infinity();
constexpr int kLanes = EnvelopeBlocks::kLanes;

/// One block in eight, scattered over the envelope.
bool is_glanced(std::uint32_t block) {
  constexpr std::uint32_t kGolden = 2654435769u, kTopBits = 29;
  return block * kGolden >> kTopBits == 0;
}

/// A negative thickness is a distance to the material and is kept.
float without_thinnest(float chip_mm) { return chip_mm > 0 && chip_mm <= kThinnestChip_mm ? 0.0f : chip_mm; }

}  // namespace

BlockReader::GlancedBlocks BlockReader::glanced_blocks(const BlockBounds& all) {
  GlancedBlocks out;
  const auto add = [&](int b) {
    out.block.push_back(b);
    out.x.push_back(all.x[b]), out.y.push_back(all.y[b]), out.z.push_back(all.z[b]);
    out.bottom.push_back(all.bottom[b]), out.reach.push_back(all.reach[b]);
    out.nx.push_back(all.nx[b]), out.ny.push_back(all.ny[b]), out.nz.push_back(all.nz[b]);
    out.spread.push_back(all.spread[b]);
  };
  for (int b = 0; b < all.count; ++b)
    if (is_glanced(static_cast<std::uint32_t>(b))) add(b);
  constexpr float kNowhere = -1e9f;  // a block that fills the last vector moves into nothing
  while (!out.block.empty() && out.block.size() % kLanes != 0) add(out.block.back()), out.spread.back() = kNowhere;
  return out;
}

BlockBounds BlockReader::GlancedBlocks::bounds() const {
  return {static_cast<int>(block.size()),
          x.data(),
          y.data(),
          z.data(),
          bottom.data(),
          reach.data(),
          nx.data(),
          ny.data(),
          nz.data(),
          spread.data()};
}

BlockReader::BlockReader(const EnvelopeGrid& envelope, const EnvelopeBlocks& blocks, StampTips tips,
                         std::int32_t first_id, double voxel_mm, double top_mm, int pitches)
    : envelope_(envelope),
      blocks_(blocks),
      tips_(std::move(tips)),
      first_id_(first_id),
      voxel_mm_(voxel_mm),
      top_mm_(top_mm),
      pitches_(pitches) {
  for (const auto& ring : envelope.rings)
    max_curved_per_mm_ =
        std::max({max_curved_per_mm_, ring.profile.meridian_curvature_per_mm, ring.profile.parallel_curvature_per_mm});
  glanced_ = glanced_blocks(blocks.bounds());
}

void BlockReader::make_room(Buffers& b) const {
  const std::size_t blocks = blocks_.size() + kLanes, points = blocks * kLanes;
  if (b.blocks.size() >= blocks) return;
  b.blocks.resize(blocks), b.hit_block.resize(blocks), b.hit_deep.resize(blocks);
  for (auto* v : {&b.lane, &b.cell, &b.hit, &b.blank_point, &b.blank_lane, &b.blank_cell}) v->resize(points);
  for (auto* v : {&b.hit_thickness, &b.cap, &b.thickness, &b.depth, &b.blank_thickness}) v->resize(points);
  for (std::size_t a = 0; a < 3; ++a) b.share[a].resize(points), b.blank_fraction[a].resize(points);
}

BlockReader::Point BlockReader::point(const Stamp& stamp, int lane) const {
  const std::uint32_t p = blocks_.point(static_cast<std::uint32_t>(lane / kLanes), lane % kLanes);
  return {stamp.pose.tip_mm + Vec3(envelope_.x[p], envelope_.y[p], envelope_.z[p]),
          Vec3(envelope_.nx[p], envelope_.ny[p], envelope_.nz[p])};
}

StampPlace BlockReader::place_of(const TileArena& arena, const Stamp& stamp) const {
  // The most that the curvature of the envelope adds to a chip.
  const double bulge = stamp.feed_per_tooth_mm.squaredNorm() / (2 * std::max(envelope_.shape.corner_radius_mm, 0.1));
  StampPlace place = arena.place_of(stamp, -pitches_ * bulge - 1e-6);
  place.min_cap_mm =
      static_cast<float>((1 - pitches_) * stamp.feed_per_tooth_mm.squaredNorm() * max_curved_per_mm_ / 2);
  return place;
}

std::span<const ChipBlock> BlockReader::read(const TileArena& arena, const Stamp& stamp,
                                             std::span<const std::int32_t> earlier, Buffers& b) const {
  make_room(b);
  const StampPlace place = place_of(arena, stamp);
  BlockBounds bounds = blocks_.bounds();
  bounds.count = std::min(bounds.count, blocks_.up_to(top_mm_ - stamp.pose.tip_mm.z()));
  const int found = block_kernels().find_blocks(bounds, place, arena.view(), b.blocks.data());
  return read_found(arena, stamp, place, found, earlier, b);
}

double BlockReader::glance(const TileArena& arena, const Stamp& stamp, std::span<const std::int32_t> earlier,
                           Buffers& b) const {
  make_room(b);
  const StampPlace place = place_of(arena, stamp);
  const int found = block_kernels().find_blocks(glanced_.bounds(), place, arena.view(), b.blocks.data());
  for (int i = 0; i < found; ++i) {
    std::int32_t& block = b.blocks[static_cast<std::size_t>(i)];
    block = glanced_.block[static_cast<std::size_t>(block)];
  }
  return glance_of(read_found(arena, stamp, place, found, earlier, b));
}

double BlockReader::glance_of(std::span<const ChipBlock> chips) const {
  double sum = 0;
  for (const ChipBlock& chip : chips) {
    if (!is_glanced(chip.block)) continue;
    for (std::size_t l = 0; l < kLanes; ++l)
      sum += static_cast<double>(std::max(0.0f, chip.thickness_mm[l])) * chip.cut_255[l];
  }
  return sum / 255;
}

/// Returns the chips of the first `found` entries of b.blocks.
std::span<const ChipBlock> BlockReader::read_found(const TileArena& arena, const Stamp& stamp, const StampPlace& place,
                                                   int found, std::span<const std::int32_t> earlier, Buffers& b) const {
  const CutterShape& shape = envelope_.shape;
  const BlockKernels& kernels = block_kernels();
  BlockHits hits{0, b.hit_block.data(), b.hit_deep.data(), b.hit_thickness.data()};
  ShallowPoints shallow{0,
                        b.lane.data(),
                        b.cell.data(),
                        b.cap.data(),
                        {b.share[0].data(), b.share[1].data(), b.share[2].data()},
                        b.hit.data()};
  kernels.read_blocks(blocks_.points(), b.blocks.data(), found, place, arena.view(),
                      0.5f * static_cast<float>(voxel_mm_), hits, shallow);
  for (int i = shallow.count; i % kLanes != 0; ++i) shallow.lane[i] = shallow.cell[i] = 0;
  float* thickness = b.thickness.data();
  if (shape.general) {
    thin_general(arena, stamp, shallow, thickness);
  } else {
    kernels.thin_points(blocks_.points(), shallow, arena.view(), tips_.fixed(stamp.pose.tip_mm, first_id_),
                        static_cast<float>(shape.bottom_length_mm()), static_cast<float>(shape.corner_radius_mm),
                        kMinSlope, thickness);
  }
  thin_by_blank(arena, shallow, b);
  const auto after_tooth = [&](int hit, bool after) {
    hits.deep[hit / kLanes] = (hits.deep[hit / kLanes] & ~(1u << hit % kLanes)) | static_cast<std::uint32_t>(after)
                                                                                      << hit % kLanes;
  };
  b.chips.clear();
  for (int h = 0; h < hits.count; ++h) {
    ChipBlock& chip = b.chips.emplace_back(ChipBlock{hits.block[h], 0, 0, {}, {}});
    chip.cut_255.fill(255);
  }
  const auto set_own_surface = [&](int hit) {
    b.chips[static_cast<std::size_t>(hit / kLanes)].own_surface |= static_cast<std::uint16_t>(1u << hit % kLanes);
  };
  for (int h = 0; h < hits.count && !earlier.empty(); ++h)
    for (int l = 0; l < kLanes; ++l) {
      float& deep = hits.thickness[h * kLanes + l];
      if (!(deep > 0)) continue;
      const float depth = thickness_over(earlier, point(stamp, static_cast<int>(hits.block[h]) * kLanes + l));
      after_tooth(h * kLanes + l, depth > kNearCap * deep);
      if (depth < deep) set_own_surface(h * kLanes + l);
      deep = std::min(depth, deep);
    }
  for (int i = 0; i < shallow.count; ++i) {
    float own = thickness[i], depth = b.depth[static_cast<std::size_t>(i)], up_mm = 0;
    if (const float half = blocks_.wall_half_mm(shallow.lane[i]); half > 0) {
      const RingPart part = part_of_ring(arena, stamp, shallow, i);
      const std::uint8_t cut_255 = part.cut_255(static_cast<double>(half));
      if (cut_255 == 0) continue;
      if (cut_255 < 255) {
        b.chips[static_cast<std::size_t>(shallow.hit[i] / kLanes)]
            .cut_255[static_cast<std::size_t>(shallow.hit[i] % kLanes)] = cut_255;
        up_mm = static_cast<float>(part.middle_mm());
        depth = own = thin(arena, shallow.cell[i], raised(point(stamp, shallow.lane[i]), up_mm));
        if (depth > 0) depth = below_blank(arena, shallow, i, up_mm, depth);
      }
    }
    if (depth > 0 && !earlier.empty()) {
      own = std::min(own, thickness_over(earlier, raised(point(stamp, shallow.lane[i]), up_mm)));
      depth = std::min(depth, own);
    }
    if (depth == own) set_own_surface(shallow.hit[i]);
    hits.thickness[shallow.hit[i]] = std::min(depth, shallow.cap[i]);
    if (!(depth > 0)) continue;
    after_tooth(shallow.hit[i], depth > kNearCap * shallow.cap[i]);
  }
  for (int h = 0; h < hits.count; ++h) {
    ChipBlock& chip = b.chips[static_cast<std::size_t>(h)];
    chip.after_tooth = static_cast<std::uint16_t>(hits.deep[h]);
    std::transform(hits.thickness + h * kLanes, hits.thickness + (h + 1) * kLanes, chip.thickness_mm.begin(),
                   without_thinnest);
  }
  return b.chips;
}

BlockReader::Point BlockReader::raised(Point point, float up_mm) {
  point.place_mm.z() += static_cast<double>(up_mm);
  return point;
}

RingPart BlockReader::part_of_ring(const TileArena& arena, const Stamp& stamp, const ShallowPoints& points,
                                   int i) const {
  const int cell = points.cell[i];
  std::optional<BlankCell> blank;
  if (arena.blank(static_cast<std::size_t>(cell / (2 * Tile::kVolume))))
    blank = arena.blank_at(cell, {points.share[0][i], points.share[1][i], points.share[2][i]});
  const Point p = point(stamp, points.lane[i]);
  return part_in_material({blank ? &*blank : nullptr, arena.view().stamp + cell, p.place_mm, p.normal,
                           static_cast<double>(blocks_.wall_half_mm(points.lane[i]))},
                          tips_.view(), first_id_, envelope_.shape);
}

/// Turns thickness into depth: the blank's surface counts as one more field, read trilinearly.
void BlockReader::thin_by_blank(const TileArena& arena, const ShallowPoints& points, Buffers& b) const {
  std::copy_n(b.thickness.begin(), points.count, b.depth.begin());
  int count = 0;
  for (int i = 0; i < points.count; ++i) {
    const auto at = static_cast<std::size_t>(i), to = static_cast<std::size_t>(count);
    if (!(b.thickness[at] > 0)) continue;
    const auto cell = static_cast<std::size_t>(points.cell[i]), tile = cell / (2 * Tile::kVolume);
    if (!arena.blank(tile)) continue;
    if (arena.has_edge(points.cell[i])) {
      b.depth[at] = below_blank(arena, points, i, 0, b.thickness[at]);
      continue;
    }
    b.blank_point[to] = i;
    b.blank_lane[to] = points.lane[i];
    b.blank_cell[to] = static_cast<std::int32_t>(cell - tile * Tile::kVolume);
    for (const int corner : {0, 1, 2, 3}) __builtin_prefetch(arena.blanks() + b.blank_cell[to] + cell_corner(corner));
    for (std::size_t a = 0; a < 3; ++a) b.blank_fraction[a][to] = points.share[a][i];
    b.blank_thickness[to] = b.thickness[at];
    ++count;
  }
  for (int i = count; i % kLanes != 0; ++i)
    b.blank_lane[static_cast<std::size_t>(i)] = b.blank_cell[static_cast<std::size_t>(i)] = 0;
  block_kernels().thin_by_blank(blocks_.points(),
                                {count,
                                 arena.blanks(),
                                 b.blank_lane.data(),
                                 b.blank_cell.data(),
                                 {b.blank_fraction[0].data(), b.blank_fraction[1].data(), b.blank_fraction[2].data()},
                                 static_cast<float>(voxel_mm_),
                                 kMinSlope,
                                 b.blank_thickness.data()});
  for (int i = 0; i < count; ++i)
    b.depth[static_cast<std::size_t>(b.blank_point[static_cast<std::size_t>(i)])] =
        b.blank_thickness[static_cast<std::size_t>(i)];
}

/// The same for one point, and `up_mm` above it.
float BlockReader::below_blank(const TileArena& arena, const ShallowPoints& points, int i, float up_mm,
                               float thinnest) const {
  const int cell = points.cell[i];
  if (!arena.blank(static_cast<std::size_t>(cell / (2 * Tile::kVolume)))) return thinnest;
  const BlankCell blank = arena.blank_at(cell, {points.share[0][i], points.share[1][i], points.share[2][i]});
  const auto distance = static_cast<float>(blank.distance_mm(static_cast<double>(up_mm), Vec3::UnitZ()));
  // A slope is at most 1: what is deeper than the thinnest so far cannot become thinner.
  if (distance >= 0 || -distance >= thinnest) return std::min(thinnest, -distance);
  const auto p = blocks_.point(static_cast<std::uint32_t>(points.lane[i] / kLanes), points.lane[i] % kLanes);
  const Vec3 normal(envelope_.nx[p], envelope_.ny[p], envelope_.nz[p]);
  blank.for_each_face([&](double above, const Vec3& outwards) {
    const auto below = static_cast<float>(-above - static_cast<double>(up_mm) * outwards.z());
    thinnest = std::min(thinnest, below / slope(-outwards.dot(normal)));
  });
  return thinnest;
}

/// Does what BlockKernels::thin_points does, for any cutter profile.
void BlockReader::thin_general(const TileArena& arena, const Stamp& stamp, const ShallowPoints& points,
                               float* out) const {
  for (int i = 0; i < points.count; ++i) out[i] = thin(arena, points.cell[i], point(stamp, points.lane[i]));
}

float BlockReader::thin(const TileArena& arena, int cell, const Point& p) const {
  const std::int32_t* ids = arena.view().stamp + cell;
  const TipView tips = tips_.view();
  float thinnest = kSolid;
  std::int32_t last = -1;
  for (int c = 0; c < 8; ++c) {
    const std::int32_t id = ids[cell_corner(c)] - first_id_;
    if (id < 0 || id == last) continue;
    last = id;
    const Vec3 from_tip = p.place_mm - tips[id];
    const auto depth = static_cast<float>(envelope_.shape.distance_mm(from_tip));
    if (depth < thinnest)
      thinnest = std::min(thinnest, depth / slope(envelope_.shape.gradient(from_tip).dot(p.normal)));
  }
  return thinnest;
}

/// Returns the thickness that stamps which are not in the arena yet leave at a point.
float BlockReader::thickness_over(std::span<const std::int32_t> earlier, const Point& point) const {
  const TipView tips = tips_.view();
  float thinnest = kSolid;
  for (const std::int32_t j : earlier) {
    const Vec3 from_tip = point.place_mm - tips[j];
    const auto depth = static_cast<float>(envelope_.shape.distance_mm(from_tip));
    if (depth < thinnest)
      thinnest = std::min(thinnest, depth / slope(envelope_.shape.gradient(from_tip).dot(point.normal)));
  }
  return thinnest;
}

}  // namespace camber::removal::upright
