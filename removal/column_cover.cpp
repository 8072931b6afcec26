#include "removal/column_cover.h"

#include <algorithm>
#include <cmath>

#include "removal/vector_clones.h"

namespace camber::removal {
namespace {

/// `reach`: no voxel farther from a ball's centre, or from a cutter's axis, is changed. `low`: nor one below.
struct NewTip {
  float x, y, z, bend, reach, low;
};

/// One line of columns: out > 0 where the stamp may change one. Written without branches, for vectors.
template <bool ball>
inline bool test_line(const float* cx, const float* cy, const float* cz, const float* cbend, const float* top_mm,
                      float px, float voxel, const NewTip& tip, float radius, float* out) {
  const float dx2 = (px - tip.x) * (px - tip.x);
  const float per_reach = 1 / (2 * tip.reach);
  int any = 0;
  for (int j = 0; j < ColumnCover::kLine; ++j) {
    const float py = static_cast<float>(j) * voxel;
    const float dx = tip.x - cx[j], dy = tip.y - cy[j], dz = tip.z - cz[j];
    const float flat = (px - 0.5f * (tip.x + cx[j])) * dx + (py - 0.5f * (tip.y + cy[j])) * dy;
    const float slack = tip.bend + cbend[j];
    const float threshold = -slack * (tip.reach + slack);
    const float highest = top_mm[j] - voxel;
    float lowest = tip.low;
    float margin = std::max(flat - threshold, -dz);
    if constexpr (ball) {
      // A sphere of radius r is at least rho^2 / 2r above its lowest point.
      lowest += (dx2 + (py - tip.y) * (py - tip.y)) * per_reach;
      const float z = dz > 0 ? highest : lowest;
      const float space = flat + (z - radius - 0.5f * (tip.z + cz[j])) * dz - threshold;
      const float below = radius + std::min(tip.z, cz[j]) - highest;
      margin = below >= 0 ? space : margin;
    }
    margin = lowest <= highest ? margin : -1.0f;
    out[j] = margin;
    any |= margin > 0 ? 1 : 0;
  }
  return any != 0;
}

CAMBER_VECTOR_CLONES
bool test_columns(const float* cx, const float* cy, const float* cz, const float* cbend, const float* top_mm, float px,
                  float voxel, NewTip tip, float radius, bool ball, float* __restrict out) {
  return ball ? test_line<true>(cx, cy, cz, cbend, top_mm, px, voxel, tip, radius, out)
              : test_line<false>(cx, cy, cz, cbend, top_mm, px, voxel, tip, radius, out);
}

std::size_t line_at(int column) {
  return static_cast<std::size_t>(column / Tile::kSide * ColumnCover::kLine + column % Tile::kSide);
}

}  // namespace

ColumnCover::ColumnCover(const Tile& tile, const Index3& index, double voxel_mm, double band_mm,
                         const CutterShape& shape, const TipOf& tip_of)
    : voxel_(static_cast<float>(voxel_mm)),
      band_(static_cast<float>(band_mm)),
      radius_(static_cast<float>(shape.radius_mm)),
      ball_(shape.ball()) {
  for (int a = 0; a < 3; ++a) origin_mm_[a] = index[a] * Tile::kCore * voxel_mm;
  x_.fill(kNone), y_.fill(kNone), z_.fill(0), bend_.fill(0), top_mm_.fill(0), top_.fill(Tile::kSide);
  for (int c = 0; c < kColumns; ++c) {
    lower_top(tile, c);
    // The stamp that set the voxel nearest to the surface.
    const float* distance = tile.distance.data() + c * Tile::kSide;
    const std::int32_t* stamp = tile.stamp.data() + c * Tile::kSide;
    float nearest = band_;
    std::int32_t id = Stock::kUncut;
    for (int k = 0; k < Tile::kSide; ++k)
      if (stamp[k] >= 0 && std::abs(distance[k]) < nearest) {
        nearest = std::abs(distance[k]);
        id = stamp[k];
      }
    Vec3 tip;
    double bend = 0;
    const auto at = line_at(c);
    if (id < 0 || !tip_of(id, tip, bend)) continue;
    const Eigen::Vector3f from_origin = (tip - origin_mm_).cast<float>();
    x_[at] = from_origin.x(), y_[at] = from_origin.y(), z_[at] = from_origin.z();
    bend_[at] = static_cast<float>(bend);
  }
}

void ColumnCover::lower_top(const Tile& tile, int column) {
  const float* distance = tile.distance.data() + column * Tile::kSide;
  std::int16_t& top = top_[static_cast<std::size_t>(column)];
  if (top == 0) return;
  while (top > 0 && distance[top - 1] >= band_) --top;
  top_mm_[line_at(column)] = static_cast<float>(top) * voxel_;
  air_columns_ += top == 0;
}

bool ColumnCover::changeable(int i, const Vec3& tip_mm, double bend_mm, std::array<float, kLine>& out) const {
  const Eigen::Vector3f tip = (tip_mm - origin_mm_).cast<float>();
  const auto bend = static_cast<float>(bend_mm);
  const auto at = static_cast<std::size_t>(i * kLine);
  return test_columns(x_.data() + at, y_.data() + at, z_.data() + at, bend_.data() + at, top_mm_.data() + at,
                      static_cast<float>(i) * voxel_, voxel_,
                      {tip.x(), tip.y(), tip.z(), bend, radius_ + band_ + bend, tip.z() - band_ - bend}, radius_, ball_,
                      out.data());
}

bool ColumnCover::changeable_after(const Vec3& before_mm, double before_bend_mm, const Vec3& tip_mm,
                                   double bend_mm) const {
  const double slack = bend_mm + before_bend_mm;
  const double side = voxel_ * Tile::kCore;
  const Vec3 step = tip_mm - before_mm, mid = 0.5 * (tip_mm + before_mm) - origin_mm_;
  const double flat = std::max(-mid.x() * step.x(), (side - mid.x()) * step.x()) +
                      std::max(-mid.y() * step.y(), (side - mid.y()) * step.y());
  const double threshold = -slack * (radius_ + band_ + 2 * slack);
  if (ball_ && side <= radius_ + std::min(tip_mm.z(), before_mm.z()) - origin_mm_.z())
    return flat + (step.z() > 0 ? side - radius_ - mid.z() : -radius_ - mid.z()) * step.z() > threshold;
  return flat > threshold || step.z() < 0;
}

void ColumnCover::cut(const Tile& tile, int i, int j, const Vec3& tip_mm, double bend_mm, bool changed) {
  const int column = i * Tile::kSide + j;
  const std::size_t at = line_at(column);
  if (!changed && x_[at] < kNone) return;
  const Eigen::Vector3f tip = (tip_mm - origin_mm_).cast<float>();
  x_[at] = tip.x(), y_[at] = tip.y(), z_[at] = tip.z();
  bend_[at] = static_cast<float>(bend_mm);
  lower_top(tile, column);
}

}  // namespace camber::removal
