#include "removal/height_map.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

namespace camber::removal {
namespace {

constexpr std::size_t kBlock = 16;  // cells along a side
constexpr float kBeside = std::numeric_limits<float>::infinity();

}  // namespace

CutterBottom::CutterBottom(const CutterShape& shape, double shrink_mm)
    : radius_(shape.radius_mm - shrink_mm),
      corner_(std::max(0.0, shape.corner_radius_mm - shrink_mm)),
      rise_(shrink_mm) {
  assert(radius_ > 0);
  if (!shape.general) return;
  constexpr std::size_t kPoints = 512;
  for (std::size_t i = 0; i <= kPoints; ++i) {
    const double r = radius_ * static_cast<double>(i) / kPoints;
    const double height = shape.profile.height_at_radius_mm(std::min(r + shrink_mm, shape.radius_mm));
    table_.push_back(static_cast<float>(height));
  }
}

void CutterBottom::row(double first_x, double step, double y, std::size_t count, float* out) const {
  const auto x0 = static_cast<float>(first_x), dx = static_cast<float>(step), y2 = static_cast<float>(y * y);
  const auto r2 = static_cast<float>(radius_ * radius_), rise = static_cast<float>(rise_);
  if (!table_.empty()) {
    const auto per_mm = static_cast<float>(static_cast<double>(table_.size() - 1) / radius_);
    for (std::size_t i = 0; i < count; ++i) {
      const float x = x0 + dx * static_cast<float>(i), d2 = x * x + y2;
      out[i] = d2 <= r2 ? rise + table_[static_cast<std::size_t>(std::sqrt(d2) * per_mm)] : kBeside;
    }
    return;
  }
  const auto c = static_cast<float>(corner_), c2 = c * c, flat = static_cast<float>(radius_ - corner_);
  for (std::size_t i = 0; i < count; ++i) {
    const float x = x0 + dx * static_cast<float>(i), d2 = x * x + y2;
    const float around = std::max(0.0F, std::sqrt(d2) - flat);
    const float height = rise + c - std::sqrt(std::max(0.0F, c2 - around * around));
    out[i] = d2 <= r2 ? height : kBeside;
  }
}

double CutterBottom::step_mm(double tolerance) const { return std::sqrt(8 * radius_ * tolerance); }

void HeightMap::take_size(const Vec3& min_mm, const Vec3& max_mm, double cell_mm) {
  lo_ = min_mm;
  hi_ = max_mm;
  cell_ = cell_mm;
  const auto count = [&](int axis) {
    return static_cast<std::size_t>(std::max(1.0, std::ceil((hi_[axis] - lo_[axis]) / cell_ - 1e-6)));
  };
  columns_ = count(0);
  rows_ = count(1);
}

HeightMap::HeightMap(const Vec3& min_mm, const Vec3& max_mm, double cell_mm) {
  take_size(min_mm, max_mm, cell_mm);
  height_.assign(columns_ * rows_, static_cast<float>(hi_.z()));
  block_top_.assign(blocks_per_row() * ((rows_ + kBlock - 1) / kBlock), static_cast<float>(hi_.z()));
}

HeightMap::HeightMap(const TriangleMesh& mesh, double cell_mm) {
  Vec3 lo = mesh.points.front().cast<double>(), hi = lo;
  for (const auto& p : mesh.points) {
    lo = lo.cwiseMin(p.cast<double>());
    hi = hi.cwiseMax(p.cast<double>());
  }
  take_size(lo, hi, cell_mm);
  height_.assign(columns_ * rows_, static_cast<float>(lo.z()));
  block_top_.assign(blocks_per_row() * ((rows_ + kBlock - 1) / kBlock), static_cast<float>(hi.z()));
  std::vector<std::uint8_t> undersides(height_.size(), 0);
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points[t[0]].cast<double>(), b = mesh.points[t[1]].cast<double>(),
               c = mesh.points[t[2]].cast<double>();
    const Vec3 low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    const double area = (b.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (b.y() - a.y());
    if (area == 0) continue;
    const Range x = cells(low.x(), high.x(), 0), y = cells(low.y(), high.y(), 1);
    for (std::size_t j = y.from; j < y.to; ++j)
      for (std::size_t i = x.from; i < x.to; ++i) {
        const Vec2 p = centre(i, j);
        const double u = ((p.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (p.y() - a.y())) / area;
        const double v = ((b.x() - a.x()) * (p.y() - a.y()) - (p.x() - a.x()) * (b.y() - a.y())) / area;
        // Half open, so that a place on an edge belongs to one of its triangles.
        if (u < 0 || v < 0 || u + v >= 1) continue;
        const double z = a.z() + u * (b.z() - a.z()) + v * (c.z() - a.z());
        float& h = height_[j * columns_ + i];
        h = std::max(h, static_cast<float>(z));
        if (area < 0 && undersides[j * columns_ + i] < 255) ++undersides[j * columns_ + i];
      }
  }
  constexpr double kEdges = 0.005;  // of the cells: places on edges that count twice
  const auto more = std::ranges::count_if(undersides, [](std::uint8_t n) { return n > 1; });
  undercut_ = static_cast<double>(more) > kEdges * static_cast<double>(undersides.size());
}

std::size_t HeightMap::blocks_per_row() const { return (columns_ + kBlock - 1) / kBlock; }

HeightMap::Range HeightMap::cells(double from_mm, double to_mm, int axis) const {
  const auto count = static_cast<double>(axis == 0 ? columns_ : rows_);
  // Cells whose centres lie between.
  const double first = std::ceil((from_mm - lo_[axis]) / cell_ - 0.5),
               end = std::floor((to_mm - lo_[axis]) / cell_ + 0.5);
  const auto from = static_cast<std::size_t>(std::clamp(first, 0.0, count));
  return {from, std::max(from, static_cast<std::size_t>(std::clamp(end, 0.0, count)))};
}

void HeightMap::keep_cylinder(const Vec2& middle, double radius) {
  for (std::size_t j = 0; j < rows_; ++j)
    for (std::size_t i = 0; i < columns_; ++i)
      if ((centre(i, j) - middle).norm() > radius) height_[j * columns_ + i] = static_cast<float>(lo_.z());
}

double HeightMap::volume_mm3() const {
  double sum = 0;
  for (const float h : height_) sum += static_cast<double>(h) - lo_.z();
  return sum * cell_ * cell_;
}

double HeightMap::cut_area_mm2() const {
  double area = 0;
  for (std::size_t j = 0; j < rows_; ++j)
    for (std::size_t i = 0; i < columns_; ++i) {
      const double h = at(i, j), dx = at(std::min(i + 1, columns_ - 1), j) - h,
                   dy = at(i, std::min(j + 1, rows_ - 1)) - h;
      if (h >= hi_.z() && dx == 0 && dy == 0) continue;
      const double flat = h < hi_.z() ? cell_ : 0;
      area += cell_ * std::sqrt(flat * flat + dx * dx + dy * dy);
    }
  return area;
}

HeightMap::Cut HeightMap::cut(const CutterBottom& cutter, const Vec3& tip) {
  Cut out;
  if (tip.z() >= hi_.z()) return out;
  const double r = cutter.radius_mm();
  const Range x = cells(tip.x() - r, tip.x() + r, 0), y = cells(tip.y() - r, tip.y() + r, 1);
  const std::size_t count = x.to - x.from;
  if (count == 0) return out;
  thread_local std::vector<float> bottom;
  bottom.resize(count);
  const auto z = static_cast<float>(tip.z()), floor = static_cast<float>(lo_.z());
  float deepest = 0, highest = z;
  double volume = 0, cells_cut = 0;
  for (std::size_t j = y.from; j < y.to; ++j) {
    const Vec2 first = centre(x.from, j) - tip.head<2>();
    cutter.row(first.x(), cell_, first.y(), count, bottom.data());
    float* row = height_.data() + j * columns_ + x.from;
    float lowered = 0, number = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const float h = row[i], to = std::max(floor, z + bottom[i]), by = h - to;
      const bool cuts = by > 0;
      lowered += cuts ? by : 0.0F;
      number += cuts ? 1.0F : 0.0F;
      deepest = std::max(deepest, by);
      highest = std::max(highest, cuts ? h : highest);
      row[i] = cuts ? to : h;
    }
    volume += static_cast<double>(lowered);
    cells_cut += static_cast<double>(number);
  }
  out.volume_mm3 = volume * cell_ * cell_;
  out.area_mm2 = cells_cut * cell_ * cell_;
  out.deepest_mm = static_cast<double>(deepest);
  out.above_tip_mm = static_cast<double>(highest) - tip.z();
  return out;
}

std::optional<Vec3> HeightMap::touch(const CutterBottom& cutter, const Vec3& tip) const {
  const double r = cutter.radius_mm();
  if (tip.z() >= hi_.z() || !touch_disc(tip.head<2>(), r, tip.z())) return std::nullopt;
  const Range x = cells(tip.x() - r, tip.x() + r, 0), y = cells(tip.y() - r, tip.y() + r, 1);
  std::vector<float> bottom(x.to - x.from);
  const auto z = static_cast<float>(tip.z());
  for (std::size_t j = y.from; j < y.to; ++j) {
    const Vec2 first = centre(x.from, j) - tip.head<2>();
    cutter.row(first.x(), cell_, first.y(), bottom.size(), bottom.data());
    const float* row = height_.data() + j * columns_ + x.from;
    for (std::size_t i = 0; i < bottom.size(); ++i)
      if (row[i] > z + bottom[i]) {
        const Vec2 place = centre(x.from + i, j);
        return Vec3(place.x(), place.y(), static_cast<double>(z + bottom[i]));
      }
  }
  return std::nullopt;
}

double HeightMap::block_top(std::size_t column, std::size_t row, double z) const {
  float& top = block_top_[row * blocks_per_row() + column];
  if (static_cast<double>(top) <= z) return top;
  float now = static_cast<float>(lo_.z());
  for (std::size_t j = row * kBlock; j < std::min(rows_, (row + 1) * kBlock); ++j)
    for (std::size_t i = column * kBlock; i < std::min(columns_, (column + 1) * kBlock); ++i)
      now = std::max(now, height_[j * columns_ + i]);
  return top = now;
}

std::optional<Vec3> HeightMap::touch_disc(const Vec2& axis, double radius, double z) const {
  if (z >= hi_.z()) return std::nullopt;
  const Range x = cells(axis.x() - radius, axis.x() + radius, 0), y = cells(axis.y() - radius, axis.y() + radius, 1);
  if (x.from >= x.to || y.from >= y.to) return std::nullopt;
  for (std::size_t bj = y.from / kBlock; bj <= (y.to - 1) / kBlock; ++bj)
    for (std::size_t bi = x.from / kBlock; bi <= (x.to - 1) / kBlock; ++bi) {
      if (block_top(bi, bj, z) <= z) continue;
      const std::size_t j1 = std::min(y.to, (bj + 1) * kBlock), i1 = std::min(x.to, (bi + 1) * kBlock);
      for (std::size_t j = std::max(y.from, bj * kBlock); j < j1; ++j)
        for (std::size_t i = std::max(x.from, bi * kBlock); i < i1; ++i)
          if (at(i, j) > z && (centre(i, j) - axis).norm() < radius) return Vec3(centre(i, j).x(), centre(i, j).y(), z);
    }
  return std::nullopt;
}

}  // namespace camber::removal
