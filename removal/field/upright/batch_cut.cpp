#include "removal/field/upright/batch_cut.h"

#include <algorithm>
#include <cmath>

#include "base/vector_clones.h"
#include "removal/field/rounded_cutter.h"
#include "removal/simd/upright_distances.h"

namespace camber::removal::upright {
namespace {

constexpr int kHalf = Tile::kCore / 2;

/// A box of voxels, from the tile's voxel (0, 0, 0), mm; z from 0.
struct Box {
  float x0, x1, y0, y1, top;
};

/// out > 0: the cutter comes within the band of the box; `low`: nothing in the box is as close to it farther down.
CAMBER_VECTOR_CLONES
void test_reach(const float* x, const float* y, const float* z, std::size_t count, Box box, float flat, float corner,
                float band, float* __restrict low, float* __restrict out) {
  for (std::size_t k = 0; k < count; ++k) {
    const float dx = std::max(std::max(box.x0 - x[k], x[k] - box.x1), 0.0f);
    const float dy = std::max(std::max(box.y0 - y[k], y[k] - box.y1), 0.0f);
    const float qx = std::max(std::sqrt(dx * dx + dy * dy) - flat, 0.0f);
    const float qz = std::max(corner - (box.top - z[k]), 0.0f);
    const float reach2 = (corner + band) * (corner + band);
    out[k] = reach2 - (qx * qx + qz * qz);
    low[k] = std::max(z[k] + corner - std::sqrt(std::max(reach2 - qx * qx, 0.0f)), 0.0f);
  }
}

/// True where all columns of a box are within `radius` of an axis.
bool within(const Box& box, float x, float y, float radius) {
  const float dx = std::max(x - box.x0, box.x1 - x), dy = std::max(y - box.y0, box.y1 - y);
  return radius > 0 && dx * dx + dy * dy <= radius * radius;
}

/// Prefers the lower of stamps that leave a place equally deep in air, and then the one whose axis is nearer: others
/// are passed over after it. `rank`: distances of the place, of cutters with a flat bottom.
CAMBER_VECTOR_CLONES
void prefer_covering(const float* x, const float* y, const float* z, std::size_t count, float px, float py, float band,
                     float* __restrict rank) {
  for (std::size_t k = 0; k < count; ++k) {
    const float dx = px - x[k], dy = py - y[k];
    rank[k] = covering_rank(rank[k], z[k], std::sqrt(dx * dx + dy * dy), band);
  }
}

/// out > 0: a stamp may change a voxel of the box after the one at (rx, ry, rz) has. As ColumnCover tests columns;
/// `covered`: the first stamp covers the box.
template <bool ball>
inline void test_after(const float* x, const float* y, const float* z, const float* low, std::size_t count, Box box,
                       float rx, float ry, float rz, float radius, float threshold, bool covered,
                       float* __restrict out) {
  for (std::size_t k = 0; k < count; ++k) {
    const float dx = x[k] - rx, dy = y[k] - ry, dz = z[k] - rz;
    const float mx = 0.5f * (x[k] + rx), my = 0.5f * (y[k] + ry);
    const float flat =
        std::max((box.x0 - mx) * dx, (box.x1 - mx) * dx) + std::max((box.y0 - my) * dy, (box.y1 - my) * dy);
    if constexpr (ball) {
      const float level = (dz > 0 ? box.top : low[k]) - radius;
      const float before = std::min(level - rz, 0.0f), now = std::min(level - z[k], 0.0f);
      out[k] = flat + 0.5f * (before * before - now * now) - threshold;
    } else {
      out[k] = std::max(covered ? -1.0f : flat - threshold, -dz);
    }
  }
}

CAMBER_VECTOR_CLONES
void test_stamps(const float* x, const float* y, const float* z, const float* low, std::size_t count, Box box, float rx,
                 float ry, float rz, float radius, float threshold, bool ball, bool covered, float* __restrict out) {
  if (ball)
    test_after<true>(x, y, z, low, count, box, rx, ry, rz, radius, threshold, covered, out);
  else
    test_after<false>(x, y, z, low, count, box, rx, ry, rz, radius, threshold, covered, out);
}

}  // namespace

BatchCut::BatchCut(const CutterShape& shape, double voxel_mm, double band_mm, double shrink_mm)
    : shape_(shape),
      voxel_(static_cast<float>(voxel_mm)),
      band_(static_cast<float>(band_mm)),
      shrink_(static_cast<float>(shrink_mm)),
      kernels_(kernels()) {}

bool BatchCut::cut(Tile& tile, ColumnCover& cover, std::span<const Stamp> stamps, std::span<const std::int32_t> batch,
                   std::int32_t first_id) {
  x_.clear(), y_.clear(), z_.clear(), id_.clear();
  for (const std::int32_t k : batch) {
    const Eigen::Vector3f tip = cover.from_origin(stamps[static_cast<std::size_t>(k)].pose.tip_mm);
    x_.push_back(tip.x()), y_.push_back(tip.y()), z_.push_back(tip.z());
    id_.push_back(k);
  }
  bool changed = false;
  for (const int i : {0, kHalf})
    for (const int j : {0, kHalf}) {
      Block block{i, i > 0 ? Tile::kSide : i + kHalf, j, j > 0 ? Tile::kSide : j + kHalf, 0};
      for (int l = block.i_from; l < block.i_to; ++l)
        for (int m = block.j_from; m < block.j_to; ++m) block.top_mm = std::max(block.top_mm, cover.tops_mm(l)[m]);
      if (block.top_mm <= 0) continue;
      find_candidates(cover, block, block.top_mm - band_);
      if (!candidates_.empty()) changed |= cut_block(tile, cover, block, first_id);
    }
  return changed;
}

void BatchCut::keep_positive() {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    if (!(margin_[k] > 0)) continue;
    candidates_[kept] = candidates_[k];
    cx_[kept] = cx_[k], cy_[kept] = cy_[k], cz_[kept] = cz_[k], low_[kept] = low_[k];
    ++kept;
  }
  candidates_.resize(kept), cx_.resize(kept), cy_.resize(kept), cz_.resize(kept), low_.resize(kept);
}

void BatchCut::find_candidates(const ColumnCover& cover, const Block& b, float z_mm) {
  const auto flat = static_cast<float>(shape_.bottom_length_mm());
  const auto corner = static_cast<float>(shape_.corner_radius_mm), radius = static_cast<float>(shape_.radius_mm);
  const Box box{static_cast<float>(b.i_from) * voxel_, static_cast<float>(b.i_to - 1) * voxel_,
                static_cast<float>(b.j_from) * voxel_, static_cast<float>(b.j_to - 1) * voxel_, b.top_mm};
  cx_ = x_, cy_ = y_, cz_ = z_;
  margin_.resize(x_.size()), low_.resize(x_.size());
  candidates_.resize(x_.size());
  for (std::size_t k = 0; k < candidates_.size(); ++k) candidates_[k] = static_cast<std::int32_t>(k);
  test_reach(cx_.data(), cy_.data(), cz_.data(), cx_.size(), box, flat, corner, band_ - shrink_, low_.data(),
             margin_.data());
  keep_positive();
  const auto covered_radius = static_cast<float>(
      ColumnCover::covered_radius_mm(shape_, static_cast<double>(band_), static_cast<double>(shrink_)));
  const auto after = [&](const Eigen::Vector3f& tip, float deflection_mm) {
    test_stamps(cx_.data(), cy_.data(), cz_.data(), low_.data(), cx_.size(), box, tip.x(), tip.y(), tip.z(), radius,
                -deflection_mm * (radius + band_ + deflection_mm), shape_.ball(),
                within(box, tip.x(), tip.y(), covered_radius - deflection_mm), margin_.data());
  };
  const int i = b.i_from + kHalf / 2, j = b.j_from + kHalf / 2;
  if (const ColumnCover::Remembered r = cover.remembered(i, j); r.known && !candidates_.empty()) {
    after(r.tip, r.deflection_mm);
    keep_positive();
  }
  if (candidates_.size() < 3) return;
  rounded_distances(cx_.data(), cy_.data(), cz_.data(), cx_.size(), static_cast<float>(i) * voxel_,
                    static_cast<float>(j) * voxel_, z_mm, flat, corner, margin_.data());
  if (flat > 0)
    prefer_covering(cx_.data(), cy_.data(), cz_.data(), cx_.size(), static_cast<float>(i) * voxel_,
                    static_cast<float>(j) * voxel_, band_ + shrink_, margin_.data());
  const auto deepest = static_cast<std::size_t>(
      std::min_element(margin_.begin(), margin_.begin() + static_cast<std::ptrdiff_t>(candidates_.size())) -
      margin_.begin());
  after({cx_[deepest], cy_[deepest], cz_[deepest]}, 0);
  margin_[deepest] = 1;
  keep_positive();
}

bool BatchCut::cut_block(Tile& tile, ColumnCover& cover, const Block& b, std::int32_t first_id) {
  std::array<float, ColumnCover::kLine> changeable, tip_x, tip_y, tip_z, search_z;
  std::array<std::int32_t, ColumnCover::kLine> winner;
  LineCut line{};
  line.changeable = changeable.data();
  line.first = b.j_from, line.end = b.j_to;
  line.voxel = voxel_, line.band = band_, line.shrink = shrink_;
  line.flat = static_cast<float>(shape_.bottom_length_mm());
  line.corner = static_cast<float>(shape_.corner_radius_mm);
  LineSearch search{b.j_from,
                    b.j_from > 0 ? ColumnCover::kLine : kHalf,
                    {x_.data(), y_.data(), z_.data()},
                    candidates_.data(),
                    static_cast<int>(candidates_.size()),
                    0,
                    voxel_,
                    search_z.data(),
                    line.flat,
                    line.corner,
                    band_ + shrink_,
                    tip_x.data(),
                    tip_y.data(),
                    tip_z.data(),
                    winner.data()};
  bool changed = false;
  const auto to_line = [&](int i) {
    line.distance = tile.distance.data() + Tile::offset(i, 0, 0);
    line.stamp = tile.stamp.data() + Tile::offset(i, 0, 0);
    line.top = cover.tops(i);
  };
  if (candidates_.size() > 1) {
    for (int i = b.i_from; i < b.i_to; ++i) {
      to_line(i);
      for (int j = b.j_from; i + 1 < b.i_to && j < b.j_to; ++j) {  // comes next, and from far away
        __builtin_prefetch(line.distance + Tile::offset(1, j, kHalf));
        __builtin_prefetch(line.stamp + Tile::offset(1, j, kHalf));
      }
      line.id = first_id;
      search.x = static_cast<float>(i) * voxel_;
      for (int j = search.first; j < search.end; ++j) search_z[j] = cover.tops_mm(i)[j] - band_;
      kernels_.find_winners(search);
      if (cover.changeable_each(i, search.first, search.end, tip_x.data(), tip_y.data(), tip_z.data(), changeable))
        changed |= update(tile, cover, i, kernels_.cut_winners(line, search, id_.data()), tip_x.data(), tip_y.data(),
                          tip_z.data(), 1);
    }
  }
  std::array<float, (kHalf + 1) * ColumnCover::kLine> of_lines;
  for (const std::int32_t c : candidates_) {
    const auto at = static_cast<std::size_t>(c);
    const Eigen::Vector3f tip(x_[at], y_[at], z_[at]);
    std::uint32_t lines = cover.changeable_lines(b.i_from, b.i_to, search.first, search.end, tip, of_lines.data());
    for (int i = b.i_from; lines != 0; ++i, lines >>= 1) {
      if (!(lines & 1u)) continue;
      to_line(i);
      line.changeable = of_lines.data() + (i - b.i_from) * ColumnCover::kLine;
      line.dx = static_cast<float>(i) * voxel_ - tip.x();
      line.dy = -tip.y(), line.z = -tip.z();
      line.lowest = std::max(0, static_cast<int>((tip.z() - band_) / voxel_));
      line.id = first_id + id_[at];
      changed |= update(tile, cover, i, kernels_.cut_line(line), &x_[at], &y_[at], &z_[at], 0);
    }
  }
  return changed;
}

bool BatchCut::update(const Tile& tile, ColumnCover& cover, int i, const LineResult& result, const float* x,
                      const float* y, const float* z, int stride) const {
  for (int j = 0; j < Tile::kSide; ++j)
    if (result.tried >> j & 1u)
      cover.cut(tile, i, j, Eigen::Vector3f(x[j * stride], y[j * stride], z[j * stride]), 0.0f,
                (result.changed >> j & 1u) != 0);
  return result.changed != 0;
}

}  // namespace camber::removal::upright
