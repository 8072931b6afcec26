#include "removal/field/upright/column_cover.h"

#include <algorithm>
#include <cmath>

#include "base/vector_clones.h"

namespace camber::removal::upright {
namespace {

/// Places of stamps, one for all columns or one for each. `reach`: no voxel farther from a ball's centre, or from a
/// cutter's axis, is changed; nor one by more than `under` below the tip. `covered`: ColumnCover::covered_radius_mm.
struct NewTips {
  const float *x, *y, *z;
  float deflection, reach, under, axial, covered;
};

/// A line of columns: out > 0 where the stamp may change one. Written without branches, for vectors.
template <bool ball, bool each>
inline bool test_line(const float* cx, const float* cy, const float* cz, const float* cdeflection, const float* top_mm,
                      int first, int end, float px, float voxel, const NewTips& tips, float radius, float* out) {
  const float reach2 = tips.reach * tips.reach;
  const float x = tips.x[0], y = tips.y[0], z = tips.z[0];
  int any = 0;
  for (int j = first; j < end; ++j) {
    const float tx = each ? tips.x[j] : x, ty = each ? tips.y[j] : y, tz = each ? tips.z[j] : z;
    const float py = static_cast<float>(j) * voxel;
    const float dx = tx - cx[j], dy = ty - cy[j], dz = tz - cz[j];
    const float flat = (px - 0.5f * (tx + cx[j])) * dx + (py - 0.5f * (ty + cy[j])) * dy;
    const float slack = tips.deflection + cdeflection[j];
    const float threshold = -slack * (tips.reach + slack);
    const float highest = top_mm[j] - voxel;
    float lowest = tz - tips.under;
    const float left = reach2 - (px - tx) * (px - tx) - (py - ty) * (py - ty);
    float margin;
    if constexpr (!ball) {
      const float of_axis = tips.covered - slack, rx = px - cx[j], ry = py - cy[j];
      const bool covered = of_axis > 0 && rx * rx + ry * ry <= of_axis * of_axis;
      margin = std::max(covered ? -1.0f : flat - threshold, tips.axial - dz);
      margin = left >= 0 ? margin : -1.0f;
    } else {
      // The sphere of all that a stamp may change.
      lowest = tz + radius - std::sqrt(std::max(left, 0.0f));
      // Of two balls on their shanks: half the difference of the squared distances from where the axes begin.
      const float level = (dz > 0 ? highest : lowest) - radius;
      const float before = std::min(level - cz[j], 0.0f), now = std::min(level - tz, 0.0f);
      margin = flat + 0.5f * (before * before - now * now) - threshold;
      margin = left >= 0 ? margin : -1.0f;
    }
    margin = lowest <= highest ? margin : -1.0f;
    out[j] = margin;
    any |= margin > 0 ? 1 : 0;
  }
  return any != 0;
}

CAMBER_VECTOR_CLONES
bool test_columns(const float* cx, const float* cy, const float* cz, const float* cdeflection, const float* top_mm,
                  int first, int end, float px, float voxel, NewTips tips, float radius, bool ball,
                  float* __restrict out) {
  return ball ? test_line<true, false>(cx, cy, cz, cdeflection, top_mm, first, end, px, voxel, tips, radius, out)
              : test_line<false, false>(cx, cy, cz, cdeflection, top_mm, first, end, px, voxel, tips, radius, out);
}

/// test_columns for lines one after the other, kLine values apart; a bit for each.
CAMBER_VECTOR_CLONES
std::uint32_t test_lines(const float* cx, const float* cy, const float* cz, const float* cdeflection,
                         const float* top_mm, int i_from, int i_to, int first, int end, float voxel, NewTips tips,
                         float radius, bool ball, float* __restrict out) {
  constexpr int kLine = ColumnCover::kLine;
  std::uint32_t lines = 0;
  for (int i = i_from; i < i_to; ++i) {
    const int at = i * kLine;
    const float px = static_cast<float>(i) * voxel;
    float* of_line = out + (i - i_from) * kLine;
    const bool any = ball ? test_line<true, false>(cx + at, cy + at, cz + at, cdeflection + at, top_mm + at, first, end,
                                                   px, voxel, tips, radius, of_line)
                          : test_line<false, false>(cx + at, cy + at, cz + at, cdeflection + at, top_mm + at, first,
                                                    end, px, voxel, tips, radius, of_line);
    lines |= static_cast<std::uint32_t>(any) << (i - i_from);
  }
  return lines;
}

CAMBER_VECTOR_CLONES
bool test_columns_each(const float* cx, const float* cy, const float* cz, const float* cdeflection, const float* top_mm,
                       int first, int end, float px, float voxel, NewTips tips, float radius, bool ball,
                       float* __restrict out) {
  return ball ? test_line<true, true>(cx, cy, cz, cdeflection, top_mm, first, end, px, voxel, tips, radius, out)
              : test_line<false, true>(cx, cy, cz, cdeflection, top_mm, first, end, px, voxel, tips, radius, out);
}

std::size_t line_at(int column) {
  return static_cast<std::size_t>(column / Tile::kSide * ColumnCover::kLine + column % Tile::kSide);
}

}  // namespace

/// Under the flat bottom a stamp leaves its height or, near its wall, the distance to that.
double ColumnCover::covered_radius_mm(const CutterShape& shape, double band_mm, double shrink_mm) {
  constexpr double kRounding_mm = 1e-4;
  if (shape.general || shape.ball()) return -1;
  return std::min(shape.bottom_length_mm(), shape.radius_mm - band_mm - shrink_mm) - kRounding_mm;
}

ColumnCover::ColumnCover(const Tile& tile, const Index3& index, double voxel_mm, double band_mm,
                         const CutterShape& shape, const TipOf& tip_of, double shrink_mm)
    : voxel_(static_cast<float>(voxel_mm)),
      band_(static_cast<float>(band_mm)),
      radius_(static_cast<float>(shape.radius_mm)),
      covered_radius_(static_cast<float>(covered_radius_mm(shape, band_mm, shrink_mm))),
      ball_(shape.ball()) {
  for (int a = 0; a < 3; ++a) origin_mm_[a] = index[a] * Tile::kCore * voxel_mm;
  x_.fill(kNone), y_.fill(kNone), z_.fill(0), deflection_.fill(0), top_mm_.fill(-kNone), top_.fill(Tile::kSide);
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
    double deflection = 0;
    const auto at = line_at(c);
    if (id < 0 || !tip_of(id, tip, deflection)) continue;
    const Eigen::Vector3f from_origin = (tip - origin_mm_).cast<float>();
    x_[at] = from_origin.x(), y_[at] = from_origin.y(), z_[at] = from_origin.z();
    deflection_[at] = static_cast<float>(deflection);
  }
}

void ColumnCover::lower_top(const Tile& tile, int column) {
  const float* distance = tile.distance.data() + column * Tile::kSide;
  std::int16_t& top = top_[static_cast<std::size_t>(column)];
  if (top == 0) return;
  while (top > 0 && distance[top - 1] >= band_) --top;
  top_mm_[line_at(column)] = top > 0 ? static_cast<float>(top) * voxel_ : -kNone;
  air_columns_ += top == 0;
}

bool ColumnCover::changeable(int i, int first, int end, const Eigen::Vector3f& tip, float deflection,
                             std::array<float, kLine>& out) const {
  const auto at = static_cast<std::size_t>(i * kLine);
  return test_columns(x_.data() + at, y_.data() + at, z_.data() + at, deflection_.data() + at, top_mm_.data() + at,
                      first, end, static_cast<float>(i) * voxel_, voxel_,
                      {&tip.x(), &tip.y(), &tip.z(), deflection, radius_ + band_ + deflection, band_ + deflection,
                       axial_slack_, covered_radius_},
                      radius_, ball_, out.data());
}

std::uint32_t ColumnCover::changeable_lines(int i_from, int i_to, int first, int end, const Eigen::Vector3f& tip,
                                            float* out) const {
  return test_lines(x_.data(), y_.data(), z_.data(), deflection_.data(), top_mm_.data(), i_from, i_to, first, end,
                    voxel_, {&tip.x(), &tip.y(), &tip.z(), 0, radius_ + band_, band_, axial_slack_, covered_radius_},
                    radius_, ball_, out);
}

bool ColumnCover::changeable_each(int i, int first, int end, const float* x, const float* y, const float* z,
                                  std::array<float, kLine>& out) const {
  const auto at = static_cast<std::size_t>(i * kLine);
  return test_columns_each(x_.data() + at, y_.data() + at, z_.data() + at, deflection_.data() + at, top_mm_.data() + at,
                           first, end, static_cast<float>(i) * voxel_, voxel_,
                           {x, y, z, 0.0f, radius_ + band_, band_, axial_slack_, covered_radius_}, radius_, ball_,
                           out.data());
}

bool ColumnCover::changeable_after(const Vec3& before_mm, double before_deflection_mm, const Vec3& tip_mm,
                                   double deflection_mm) const {
  const double slack = deflection_mm + before_deflection_mm;
  const double side = voxel_ * Tile::kCore;
  const Vec3 step = tip_mm - before_mm, mid = 0.5 * (tip_mm + before_mm) - origin_mm_;
  const double flat = std::max(-mid.x() * step.x(), (side - mid.x()) * step.x()) +
                      std::max(-mid.y() * step.y(), (side - mid.y()) * step.y());
  const double threshold = -slack * (radius_ + band_ + 2 * slack);
  if (ball_) {
    const double level = (step.z() > 0 ? side : 0) + origin_mm_.z() - radius_;
    const double before = std::min(level - before_mm.z(), 0.0), now = std::min(level - tip_mm.z(), 0.0);
    return flat + 0.5 * (before * before - now * now) > threshold;
  }
  if (step.z() < static_cast<double>(axial_slack_)) return true;
  const Vec3 corner = before_mm - origin_mm_;  // how far the axis is from the tile's farthest
  const double farthest = std::hypot(std::max(corner.x(), side - corner.x()), std::max(corner.y(), side - corner.y()));
  return flat > threshold && farthest + slack > static_cast<double>(covered_radius_);
}

/// True where a stamp that has changed nothing passes over more others than the one that column (i, j) remembers.
bool ColumnCover::covers_more(int i, int j, const Eigen::Vector3f& tip, float deflection_mm) const {
  const std::size_t at = static_cast<std::size_t>(i * kLine + j);
  if (ball_ || tip.z() > z_[at] || deflection_mm > deflection_[at]) return false;
  const Eigen::Vector2f column(static_cast<float>(i) * voxel_, static_cast<float>(j) * voxel_);
  return (column - tip.head<2>()).squaredNorm() < (column - Eigen::Vector2f(x_[at], y_[at])).squaredNorm();
}

void ColumnCover::cut(const Tile& tile, int i, int j, const Eigen::Vector3f& tip, float deflection_mm, bool changed) {
  const int column = i * Tile::kSide + j;
  const std::size_t at = line_at(column);
  if (!changed && x_[at] < kNone && !covers_more(i, j, tip, deflection_mm)) return;
  x_[at] = tip.x(), y_[at] = tip.y(), z_[at] = tip.z();
  deflection_[at] = deflection_mm;
  lower_top(tile, column);
}

}  // namespace camber::removal::upright
