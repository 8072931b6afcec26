#include "report/surface_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace camber::report {
namespace {

using Cell = std::array<std::int32_t, 3>;

struct Crossing {
  Cell edge{};   ///< lower end of the grid edge
  int axis = 0;  ///< that the edge runs along
};

/// On a grid edge two coordinates are whole; the one farthest from a whole number runs along it.
Crossing crossing_of(const SurfaceSample& s, double grid_mm) {
  Crossing out;
  double farthest = -1;
  for (int a = 0; a < 3; ++a) {
    const double at = s.place_mm[a] / grid_mm, off = std::abs(at - std::round(at));
    out.edge[static_cast<std::size_t>(a)] = static_cast<std::int32_t>(std::lround(at));
    const double rank = off > 1e-6 ? 1 + off : std::abs(s.normal[a]);  // on a corner of the grid the normal decides
    if (rank <= farthest) continue;
    farthest = rank;
    out.axis = a;
  }
  const double at = s.place_mm[out.axis] / grid_mm;
  out.edge[static_cast<std::size_t>(out.axis)] = static_cast<std::int32_t>(std::floor(at));
  return out;
}

std::int32_t floor_fraction(std::int32_t value, std::int32_t by) {
  return value >= 0 ? value / by : -((-value + by - 1) / by);
}

/// The four cells around an edge, in order around it.
std::array<Cell, 4> cells_around(const Crossing& c, std::int32_t factor) {
  const auto b = static_cast<std::size_t>((c.axis + 1) % 3), d = static_cast<std::size_t>((c.axis + 2) % 3);
  std::array<Cell, 4> out{c.edge, c.edge, c.edge, c.edge};
  out[1][b] -= 1;
  out[2][b] -= 1;
  out[2][d] -= 1;
  out[3][d] -= 1;
  for (Cell& cell : out)
    for (auto& v : cell) v = floor_fraction(v, factor);
  return out;
}

constexpr std::uint64_t kNoCell = ~std::uint64_t{0};

/// Cells as numbers in the order of their coordinates: 21 bits each, from the lowest cell on.
class CellKeys {
 public:
  CellKeys(const std::vector<Crossing>& crossings, std::int32_t factor) : factor_(factor) {
    Cell lo = crossings.front().edge;
    for (const Crossing& c : crossings)
      for (std::size_t a = 0; a < 3; ++a) lo[a] = std::min(lo[a], c.edge[a]);
    for (std::size_t a = 0; a < 3; ++a) lowest_[a] = floor_fraction(lo[a] - 1, factor);
  }
  /// Returns the keys of the four cells around an edge.
  std::array<std::uint64_t, 4> around(const Crossing& c) const {
    std::array<std::uint64_t, 4> out{};
    const auto cells = cells_around(c, factor_);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t a = 0; a < 3; ++a)
        out[i] = out[i] << 21 | static_cast<std::uint64_t>(static_cast<std::uint32_t>(cells[i][a] - lowest_[a]));
    return out;
  }

 private:
  std::int32_t factor_;
  Cell lowest_{};
};

void keep_each_once(std::vector<std::uint64_t>& cells) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

std::vector<std::uint64_t> all_cells(const std::vector<Crossing>& crossings, const CellKeys& keys) {
  constexpr std::size_t kRoom = 1 << 16;
  std::vector<std::uint64_t> cells;
  std::size_t full = kRoom;  // each cell is met many times
  std::array<std::uint64_t, 4> before;
  before.fill(kNoCell);
  for (const auto& c : crossings) {
    const auto around = keys.around(c);
    for (const std::uint64_t cell : around)
      if (std::find(before.begin(), before.end(), cell) == before.end()) cells.push_back(cell);
    before = around;
    if (cells.size() < full) continue;
    keep_each_once(cells);
    full = std::max(kRoom, 2 * cells.size());
  }
  keep_each_once(cells);
  return cells;
}

/// Where cells stand in a list in order. Points come tile by tile, so most were asked for a moment ago.
class CellFinder {
 public:
  explicit CellFinder(const std::vector<std::uint64_t>& cells) : cells_(cells) {}
  std::size_t find(std::uint64_t cell) {
    auto& [known, at] = recent_[cell * 0x9e3779b97f4a7c15u >> 52];
    if (known != cell) {
      known = cell;
      at = static_cast<std::size_t>(std::lower_bound(cells_.begin(), cells_.end(), cell) - cells_.begin());
    }
    return at;
  }

 private:
  const std::vector<std::uint64_t>& cells_;
  std::vector<std::pair<std::uint64_t, std::size_t>> recent_ = std::vector(4096, std::pair(kNoCell, std::size_t{0}));
};

void add_to(SurfaceSample& vertex, const SurfaceSample& s, bool first) {
  vertex.place_mm += s.place_mm;
  vertex.normal += s.normal;
  if (first || std::abs(s.error_um) > std::abs(vertex.error_um)) {
    vertex.error_um = s.error_um;
    vertex.contour_um = s.contour_um;
    vertex.block = s.block;
  }
  if (first || std::abs(s.error_after_um) > std::abs(vertex.error_after_um)) {
    vertex.error_after_um = s.error_after_um;
    vertex.block_after = s.block_after;
  }
}

/// Without indices that repeat; false where fewer than three are left.
bool tidy(std::array<std::uint32_t, 4>& quad) {
  const auto end = std::unique(quad.begin(), quad.end());
  auto count = static_cast<std::size_t>(end - quad.begin());
  if (count > 1 && quad[count - 1] == quad[0]) --count;
  if (count < 3 || (count == 4 && (quad[0] == quad[2] || quad[1] == quad[3]))) return false;
  if (count == 3) quad[3] = quad[0];
  return true;
}

}  // namespace

SurfaceMesh surface_mesh(const SurfaceSamples& samples, double grid_mm, std::size_t max_vertices) {
  SurfaceMesh mesh;
  if (samples.empty()) return mesh;
  std::vector<Crossing> crossings;
  crossings.reserve(samples.size());
  for (const SurfaceSample& s : samples.all()) crossings.push_back(crossing_of(s, grid_mm));
  // A grid edge that the surface crosses belongs to four cells, and a cell that it passes has four such edges or six.
  constexpr double kFewest = 0.5;  // cells for a crossing, with room
  const auto most = static_cast<double>(std::max<std::size_t>(1, max_vertices));
  const double crossed = static_cast<double>(crossings.size());
  auto factor = std::max(std::int32_t{1}, static_cast<std::int32_t>(std::sqrt(kFewest * crossed / most)));
  std::vector<std::uint64_t> cells = all_cells(crossings, {crossings, factor});
  while (static_cast<double>(cells.size()) > most) {
    const double over = std::sqrt(static_cast<double>(cells.size()) / most);
    factor = std::max(factor + 1, static_cast<std::int32_t>(std::floor(factor * over)));
    cells = all_cells(crossings, {crossings, factor});
  }

  mesh.cell_mm = factor * grid_mm;
  SurfaceSample nothing;
  nothing.normal = Vec3::Zero();
  mesh.vertices.assign(cells.size(), nothing);
  std::vector<std::uint32_t> points(cells.size(), 0);
  const CellKeys keys(crossings, factor);
  CellFinder finder(cells);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::array<std::uint32_t, 4> quad{};
    const SurfaceSample sample = samples[i];
    const auto around = keys.around(crossings[i]);
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t v = finder.find(around[k]);
      quad[k] = static_cast<std::uint32_t>(v);
      if (std::find(quad.begin(), quad.begin() + static_cast<std::ptrdiff_t>(k), quad[k]) !=
          quad.begin() + static_cast<std::ptrdiff_t>(k))
        continue;
      add_to(mesh.vertices[v], sample, points[v] == 0);
      ++points[v];
    }
    if (tidy(quad)) mesh.quads.push_back(quad);
  }
  std::sort(mesh.quads.begin(), mesh.quads.end());  // neighbours deflate well
  for (std::size_t v = 0; v < cells.size(); ++v) {
    SurfaceSample& vertex = mesh.vertices[v];
    vertex.place_mm /= points[v];
    vertex.normal = vertex.normal.norm() > 0 ? Vec3(vertex.normal.normalized()) : Vec3(Vec3::UnitZ());
  }
  return mesh;
}

}  // namespace camber::report
