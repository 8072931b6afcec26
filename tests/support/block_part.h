#pragma once
// Parts made of a block: boxes and upright round holes taken away, as closed meshes.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/triangle_mesh.h"
#include "machine/workpiece.h"

namespace camber::tests {

inline machine::Box box(double x0, double y0, double z0, double x1, double y1, double z1) {
  return {{x0, y0, z0}, {x1, y1, z1}};
}

struct BlockHole {
  double x_mm = 0, y_mm = 0, diameter_mm = 0, bottom_mm = 0;
  int facets = 48;
};

struct BlockPart {
  machine::Box block;
  std::vector<machine::Box> pockets;  ///< may reach beyond the block
  /// From where the material ends above it. Its square (the diameter and 1 mm on each side) is free of walls.
  std::vector<BlockHole> holes;
  /// Turns about Z by this before it is cut up, to make walls that are not along the axes.
  double turn_rad = 0;

  /// The volume by adding up its cells and prisms: a second method beside that of the mesh.
  double volume_mm3() const;
  TriangleMesh mesh() const;
};

namespace block_part {

class Cells {
 public:
  explicit Cells(const BlockPart& part) : part_(part) {
    const auto add = [&](const machine::Box& box) {
      for (int a = 0; a < 3; ++a)
        for (const double at : {box.min_mm[a], box.max_mm[a]})
          if (at >= part.block.min_mm[a] && at <= part.block.max_mm[a]) planes_[static_cast<std::size_t>(a)].insert(at);
    };
    add(part.block);
    for (const machine::Box& p : part.pockets) add(p);
    for (const BlockHole& h : part.holes) {
      const double r = h.diameter_mm / 2 + 1;
      planes_[0].insert(h.x_mm - r), planes_[0].insert(h.x_mm + r);
      planes_[1].insert(h.y_mm - r), planes_[1].insert(h.y_mm + r);
      planes_[2].insert(h.bottom_mm);
    }
    for (std::size_t a = 0; a < 3; ++a) at_[a].assign(planes_[a].begin(), planes_[a].end());
  }

  int count(std::size_t axis) const { return static_cast<int>(at_[axis].size()) - 1; }
  double at(std::size_t axis, int i) const { return at_[axis][static_cast<std::size_t>(i)]; }

  bool solid(int x, int y, int z) const {
    if (x < 0 || y < 0 || z < 0 || x >= count(0) || y >= count(1) || z >= count(2)) return false;
    const Vec3 middle(0.5 * (at(0, x) + at(0, x + 1)), 0.5 * (at(1, y) + at(1, y + 1)),
                      0.5 * (at(2, z) + at(2, z + 1)));
    return std::ranges::none_of(part_.pockets, [&](const machine::Box& p) {
      return (middle.array() > p.min_mm.array()).all() && (middle.array() < p.max_mm.array()).all();
    });
  }

  /// The hole in a cell; null: none.
  const BlockHole* hole(int x, int y, int z) const {
    if (!solid(x, y, z)) return nullptr;
    for (const BlockHole& h : part_.holes)
      if (at(0, x) < h.x_mm && at(0, x + 1) > h.x_mm && at(1, y) < h.y_mm && at(1, y + 1) > h.y_mm &&
          at(2, z) >= h.bottom_mm - 1e-9)
        return &h;
    return nullptr;
  }

 private:
  const BlockPart& part_;
  std::array<std::set<double>, 3> planes_;
  std::array<std::vector<double>, 3> at_;
};

inline double polygon_mm2(const BlockHole& h) {
  return 0.5 * h.facets * std::sin(2 * kPi / h.facets) * h.diameter_mm * h.diameter_mm / 4;
}

class Mesher {
 public:
  explicit Mesher(const BlockPart& part) : cells_(part), turn_rad_(part.turn_rad) {}

  TriangleMesh mesh() {
    for (int x = 0; x < cells_.count(0); ++x)
      for (int y = 0; y < cells_.count(1); ++y)
        for (int z = 0; z < cells_.count(2); ++z)
          if (cells_.solid(x, y, z)) faces_of(x, y, z);
    return std::move(out_);
  }

 private:
  void faces_of(int x, int y, int z) {
    const Vec3 a(cells_.at(0, x), cells_.at(1, y), cells_.at(2, z));
    const Vec3 b(cells_.at(0, x + 1), cells_.at(1, y + 1), cells_.at(2, z + 1));
    for (int axis = 0; axis < 3; ++axis)
      for (const int step : {-1, 1}) {
        const int nx = x + (axis == 0 ? step : 0), ny = y + (axis == 1 ? step : 0), nz = z + (axis == 2 ? step : 0);
        const bool beside = cells_.solid(nx, ny, nz);
        if (axis == 2) {
          level(a, b, step, beside, cells_.hole(x, y, z), beside ? cells_.hole(nx, ny, nz) : nullptr);
        } else if (!beside) {
          Vec3 p[4];
          const int u = (axis + 1) % 3, v = (axis + 2) % 3;
          for (int i = 0; i < 4; ++i) {
            p[i][axis] = step < 0 ? a[axis] : b[axis];
            p[i][u] = i == 1 || i == 2 ? b[u] : a[u];
            p[i][v] = i >= 2 ? b[v] : a[v];
          }
          quad(p[0], p[1], p[2], p[3], step < 0);
        }
      }
    if (const BlockHole* h = cells_.hole(x, y, z)) wall(*h, a.z(), b.z());
  }

  /// The level face between a cell and the next one above or below it.
  void level(const Vec3& a, const Vec3& b, int step, bool beside, const BlockHole* own, const BlockHole* other) {
    const double z = step < 0 ? a.z() : b.z();
    if (!beside) {
      if (own)
        ring(a, b, z, *own, step < 0);
      else
        quad({a.x(), a.y(), z}, {b.x(), a.y(), z}, {b.x(), b.y(), z}, {a.x(), b.y(), z}, step < 0);
    } else if (!own && other && step > 0) {
      disc(*other, z);  // the bottom of the hole in the cell above
    }
  }

  std::vector<Vec3> circle(const BlockHole& h, double z) const {
    std::vector<Vec3> out;
    for (int i = 0; i < h.facets; ++i) {
      const double angle = 2 * kPi * i / h.facets;
      out.emplace_back(h.x_mm + h.diameter_mm / 2 * std::cos(angle), h.y_mm + h.diameter_mm / 2 * std::sin(angle), z);
    }
    return out;
  }

  void wall(const BlockHole& h, double from, double to) {
    const std::vector<Vec3> low = circle(h, from), high = circle(h, to);
    for (std::size_t i = 0; i < low.size(); ++i) {
      const std::size_t n = (i + 1) % low.size();
      quad(low[i], low[n], high[n], high[i], true);
    }
  }

  void disc(const BlockHole& h, double z) {
    const std::vector<Vec3> rim = circle(h, z);
    for (std::size_t i = 1; i + 1 < rim.size(); ++i) triangle(rim[0], rim[i], rim[i + 1]);
  }

  /// A rectangle with a round hole: each facet goes to the corner of its quarter.
  void ring(const Vec3& a, const Vec3& b, double z, const BlockHole& h, bool down) {
    const std::vector<Vec3> rim = circle(h, z);
    const std::array<Vec3, 4> corner{Vec3(b.x(), b.y(), z), Vec3(a.x(), b.y(), z), Vec3(a.x(), a.y(), z),
                                     Vec3(b.x(), a.y(), z)};
    const std::size_t n = rim.size();
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t quarter = 4 * i / n, next = 4 * ((i + 1) % n) / n;
      flat(rim[i], corner[quarter], rim[(i + 1) % n], down);
      if (next != quarter) flat(rim[(i + 1) % n], corner[quarter], corner[next], down);
    }
  }

  void flat(const Vec3& a, const Vec3& b, const Vec3& c, bool down) {
    if (down)
      triangle(a, c, b);
    else
      triangle(a, b, c);
  }

  void quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, bool reverse) {
    flat(a, b, c, reverse);
    flat(a, c, d, reverse);
  }

  void triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    out_.triangles.push_back({point(a), point(b), point(c)});
  }

  std::uint32_t point(const Vec3& at) {
    const Vec3 p(std::cos(turn_rad_) * at.x() - std::sin(turn_rad_) * at.y(),
                 std::sin(turn_rad_) * at.x() + std::cos(turn_rad_) * at.y(), at.z());
    const Eigen::Vector3f f = p.cast<float>();
    const auto [it, fresh] = index_.try_emplace({f.x(), f.y(), f.z()}, static_cast<std::uint32_t>(out_.points.size()));
    if (fresh) out_.points.push_back(f);
    return it->second;
  }

  Cells cells_;
  double turn_rad_;
  TriangleMesh out_;
  std::map<std::array<float, 3>, std::uint32_t> index_;
};

}  // namespace block_part

inline double BlockPart::volume_mm3() const {
  const block_part::Cells cells(*this);
  double sum = 0;
  for (int x = 0; x < cells.count(0); ++x)
    for (int y = 0; y < cells.count(1); ++y)
      for (int z = 0; z < cells.count(2); ++z) {
        if (!cells.solid(x, y, z)) continue;
        const double height = cells.at(2, z + 1) - cells.at(2, z);
        const BlockHole* h = cells.hole(x, y, z);
        sum += height * ((cells.at(0, x + 1) - cells.at(0, x)) * (cells.at(1, y + 1) - cells.at(1, y)) -
                         (h ? block_part::polygon_mm2(*h) : 0));
      }
  return sum;
}

inline TriangleMesh BlockPart::mesh() const { return block_part::Mesher(*this).mesh(); }

/// Binary STL.
inline void write_stl(const TriangleMesh& mesh, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  file << std::string(80, ' ');
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  file.write(reinterpret_cast<const char*>(&count), 4);
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f none = Eigen::Vector3f::Zero();
    file.write(reinterpret_cast<const char*>(none.data()), 12);
    for (const std::uint32_t c : t) file.write(reinterpret_cast<const char*>(mesh.points[c].data()), 12);
    const std::uint16_t end = 0;
    file.write(reinterpret_cast<const char*>(&end), 2);
  }
}

}  // namespace camber::tests
