#include "plan/order.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <tuple>

namespace camber::plan {

std::string_view to_string(DivisionPlan plan) {
  switch (plan) {
    case DivisionPlan::yz:
      return "yz";
    case DivisionPlan::zx:
      return "zx";
    case DivisionPlan::largest:
      break;
  }
  return "largest";
}

namespace {

using Column = std::array<int, 2>;  ///< x, y of a cell

/// Cells of one kind that are connected within a layer; with a free-form face also from layer to layer.
struct Region {
  std::vector<Column> columns;  ///< ascending; of a free-form one in its layer
  int from = 0, to = 0;         ///< layers [from, to)
  bool free_form = false;
  std::vector<CellIndex> cells{};  ///< cells of a free-form primitive, ascending
};

bool is_to_go(CellKind kind) {
  return kind == CellKind::clear || kind == CellKind::contoured || kind == CellKind::free_form;
}

/// Without the columns of `seen`.
std::vector<Region> regions_of_layer(const CellGrid& grid, int layer, std::set<Column> seen) {
  std::vector<Region> out;
  for (int x = 0; x < grid.count(0); ++x)
    for (int y = 0; y < grid.count(1); ++y) {
      const CellKind kind = grid.at({x, y, layer}).kind;
      if (!is_to_go(kind) || !seen.insert({x, y}).second) continue;
      Region region{{{x, y}}, layer, layer + 1, kind == CellKind::free_form};
      for (std::size_t i = 0; i < region.columns.size(); ++i)
        for (const auto& [dx, dy] : {Column{1, 0}, Column{-1, 0}, Column{0, 1}, Column{0, -1}}) {
          const CellIndex next{region.columns[i][0] + dx, region.columns[i][1] + dy, layer};
          if (!grid.holds(next) || !is_to_go(grid.at(next).kind)) continue;
          if ((grid.at(next).kind == CellKind::free_form) != region.free_form) continue;
          if (seen.insert({next.x, next.y}).second) region.columns.push_back({next.x, next.y});
        }
      std::ranges::sort(region.columns);
      out.push_back(std::move(region));
    }
  return out;
}

/// Takes all regions with a free-form face that touch this one from below into it: the plane between them is a face of
/// something else, and rows of two operations would meet there.
void add_free_form(Region region, std::vector<Region>& regions) {
  for (const auto& [x, y] : region.columns) region.cells.push_back({x, y, region.from});
  const auto touches = [&](const Region& below) {
    return below.free_form && std::ranges::any_of(region.columns, [&](const Column& c) {
             return std::ranges::binary_search(below.cells, CellIndex{c[0], c[1], region.from - 1});
           });
  };
  std::size_t place = regions.size();
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (!touches(regions[i])) continue;
    place = std::min(place, i);
    region.cells.insert(region.cells.end(), regions[i].cells.begin(), regions[i].cells.end());
    regions[i].cells.clear();
  }
  std::ranges::sort(region.cells);
  if (place == regions.size())
    regions.push_back(std::move(region));
  else
    regions[place] = std::move(region);
  std::erase_if(regions, [](const Region& r) { return r.free_form && r.cells.empty(); });
}

bool goes(const CellGrid& grid, const CellIndex& c) {
  return is_to_go(grid.at(c).kind) && grid.at(c).kind != CellKind::free_form;
}

/// True where a region has the same outline as the one below it, also round what stays in its cells.
bool goes_on(const CellGrid& grid, const Region& below, const Region& above) {
  if (below.free_form || below.columns != above.columns) return false;
  constexpr double kAlike = 0.005;  // of a cell
  const auto stays = [&](const Column& c, int layer) {
    const CellIndex cell{c[0], c[1], layer};
    return grid.at(cell).kind == CellKind::contoured ? grid.at(cell).part_mm3 / grid.volume_mm3(cell) : 0;
  };
  return std::ranges::all_of(below.columns, [&](const Column& c) {
    const bool contoured = grid.at({c[0], c[1], below.to - 1}).kind == CellKind::contoured;
    return contoured == (grid.at({c[0], c[1], above.from}).kind == CellKind::contoured) &&
           std::abs(stays(c, below.to - 1) - stays(c, above.from)) < kAlike;
  });
}

/// Takes a layer that is too thin for a pass of its own into the regions below it, where all of a region goes there
/// too. What is taken is in `taken`.
void take_thin_layer(const CellGrid& grid, int layer, std::vector<Region>& regions, std::set<Column>& taken) {
  for (Region& below : regions) {
    if (below.to != layer || below.free_form) continue;
    const auto goes_above = [&](const Column& c) { return goes(grid, {c[0], c[1], layer}); };
    if (!std::ranges::all_of(below.columns, goes_above)) continue;
    below.to = layer + 1;
    taken.insert(below.columns.begin(), below.columns.end());
  }
}

/// Regions of all layers; alike ones on both sides of a plane are one: the plane is a face of another region.
std::vector<Region> regions_of(const CellGrid& grid, double narrowest_mm) {
  std::vector<Region> out;
  constexpr double kThin = 0.1;  // of the smallest mill
  for (int z = 0; z < grid.count(2); ++z) {
    std::set<Column> taken;
    if (grid.plane_mm(2, z + 1) - grid.plane_mm(2, z) < kThin * narrowest_mm) take_thin_layer(grid, z, out, taken);
    for (Region& region : regions_of_layer(grid, z, taken)) {
      if (region.free_form) {
        add_free_form(std::move(region), out);
        continue;
      }
      const auto below =
          std::ranges::find_if(out, [&](const Region& r) { return r.to == z && goes_on(grid, r, region); });
      if (below != out.end())
        below->to = z + 1;
      else
        out.push_back(std::move(region));
    }
  }
  return out;
}

/// A region on the grid of its own outline's planes: cell (i, j) of it spans columns x[i] to x[i + 1], y[j] to y[j +
/// 1].
struct Outline {
  std::vector<int> x, y;
  std::vector<std::vector<bool>> filled;  ///< [i][j]
};

Outline outline_of(const Region& region) {
  const std::set<Column> in(region.columns.begin(), region.columns.end());
  std::set<int> x, y;
  for (const auto& [cx, cy] : region.columns) {
    if (!in.contains({cx - 1, cy})) x.insert(cx);
    if (!in.contains({cx + 1, cy})) x.insert(cx + 1);
    if (!in.contains({cx, cy - 1})) y.insert(cy);
    if (!in.contains({cx, cy + 1})) y.insert(cy + 1);
  }
  Outline out{{x.begin(), x.end()}, {y.begin(), y.end()}, {}};
  for (std::size_t i = 0; i + 1 < out.x.size(); ++i) {
    out.filled.emplace_back();
    for (std::size_t j = 0; j + 1 < out.y.size(); ++j) out.filled.back().push_back(in.contains({out.x[i], out.y[j]}));
  }
  return out;
}

/// [i0, i1) x [j0, j1) of an outline's cells.
struct Rectangle {
  std::size_t i0 = 0, i1 = 0, j0 = 0, j1 = 0;
};

/// Slabs along one axis, and runs in each of them.
std::vector<Rectangle> slabs(const Outline& outline, bool across_x) {
  std::vector<Rectangle> out;
  const std::size_t ni = outline.x.size() - 1, nj = outline.y.size() - 1;
  const std::size_t outer = across_x ? ni : nj, inner = across_x ? nj : ni;
  for (std::size_t a = 0; a < outer; ++a)
    for (std::size_t b = 0; b < inner;) {
      const auto filled = [&](std::size_t k) { return across_x ? outline.filled[a][k] : outline.filled[k][a]; };
      std::size_t end = b;
      while (end < inner && filled(end)) ++end;
      if (end > b) out.push_back(across_x ? Rectangle{a, a + 1, b, end} : Rectangle{b, end, a, a + 1});
      b = std::max(end, b + 1);
    }
  return out;
}

class LargestRectangles {
 public:
  LargestRectangles(const CellGrid& grid, const Outline& outline) : grid_(grid), outline_(outline) {}

  std::vector<Rectangle> find() {
    left_ = outline_.filled;
    std::vector<Rectangle> out;
    while (const auto best = largest()) {
      out.push_back(*best);
      for (std::size_t i = best->i0; i < best->i1; ++i)
        for (std::size_t j = best->j0; j < best->j1; ++j) left_[i][j] = false;
    }
    return out;
  }

 private:
  double x(std::size_t i) const { return grid_.plane_mm(0, outline_.x[i]); }
  double y(std::size_t j) const { return grid_.plane_mm(1, outline_.y[j]); }

  bool better(const Rectangle& a, const Rectangle& b) const {
    constexpr double kEqual = 1e-6;  // planes of a mesh are not exact
    const double wa = x(a.i1) - x(a.i0), ha = y(a.j1) - y(a.j0), wb = x(b.i1) - x(b.i0), hb = y(b.j1) - y(b.j0);
    if (std::abs(wa * ha - wb * hb) > kEqual * (wa * ha + wb * hb)) return wa * ha > wb * hb;
    if (std::abs(wa + ha - wb - hb) > kEqual * (wa + ha)) return wa + ha < wb + hb;
    return std::make_pair(a.i0 + a.i1, a.j0 + a.j1) < std::make_pair(b.i0 + b.i1, b.j0 + b.j1);
  }

  std::optional<Rectangle> largest() const {
    std::optional<Rectangle> best;
    const std::size_t ni = left_.size(), nj = left_.empty() ? 0 : left_[0].size();
    for (std::size_t i0 = 0; i0 < ni; ++i0) {
      std::vector<bool> open(nj, true);
      for (std::size_t i1 = i0; i1 < ni; ++i1) {
        for (std::size_t j = 0; j < nj; ++j) open[j] = open[j] && left_[i1][j];
        for (std::size_t j = 0; j < nj;) {
          std::size_t end = j;
          while (end < nj && open[end]) ++end;
          const Rectangle r{i0, i1 + 1, j, end};
          if (end > j && (!best || better(r, *best))) best = r;
          j = std::max(end, j + 1);
        }
      }
    }
    return best;
  }

  const CellGrid& grid_;
  const Outline& outline_;
  std::vector<std::vector<bool>> left_;
};

using Rectangles = std::vector<Rectangle>;  ///< rectangles of one primitive

/// Joins rectangles that are narrower than the smallest mill to one that lies along them.
class SliverJoiner {
 public:
  SliverJoiner(const CellGrid& grid, const Outline& outline, double narrowest_mm)
      : grid_(grid), outline_(outline), least_((1 - 1e-3) * narrowest_mm) {}

  std::vector<Rectangles> joined(const std::vector<Rectangle>& rectangles) const {
    std::vector<Rectangles> out;
    for (const Rectangle& r : rectangles) out.push_back({r});
    while (join_one(out)) {
    }
    return out;
  }

 private:
  double x(std::size_t i) const { return grid_.plane_mm(0, outline_.x[i]); }
  double y(std::size_t j) const { return grid_.plane_mm(1, outline_.y[j]); }

  static Rectangle bounds_of(const Rectangles& group) {
    Rectangle b = group.front();
    for (const Rectangle& r : group)
      b = {std::min(b.i0, r.i0), std::max(b.i1, r.i1), std::min(b.j0, r.j0), std::max(b.j1, r.j1)};
    return b;
  }

  /// Length along which two of them touch.
  double border_mm(const Rectangle& a, const Rectangle& b) const {
    const double along_x = std::min(x(a.i1), x(b.i1)) - std::max(x(a.i0), x(b.i0));
    const double along_y = std::min(y(a.j1), y(b.j1)) - std::max(y(a.j0), y(b.j0));
    if (a.i1 == b.i0 || b.i1 == a.i0) return std::max(along_y, 0.0);
    if (a.j1 == b.j0 || b.j1 == a.j0) return std::max(along_x, 0.0);
    return 0;
  }

  /// The box round both has nothing in it that goes with another primitive.
  bool only_theirs(const Rectangles& a, const Rectangles& b) const {
    Rectangles both = a;
    both.insert(both.end(), b.begin(), b.end());
    const Rectangle box = bounds_of(both);
    for (std::size_t i = box.i0; i < box.i1; ++i)
      for (std::size_t j = box.j0; j < box.j1; ++j)
        if (outline_.filled[i][j] && std::ranges::none_of(both, [&](const Rectangle& r) {
              return i >= r.i0 && i < r.i1 && j >= r.j0 && j < r.j1;
            }))
          return false;
    return true;
  }

  bool join_one(std::vector<Rectangles>& groups) const {
    for (std::size_t s = 0; s < groups.size(); ++s) {
      const Rectangle box = bounds_of(groups[s]);
      const double w = x(box.i1) - x(box.i0), h = y(box.j1) - y(box.j0);
      if (std::min(w, h) >= least_) continue;
      double longest = 0.5 * std::max(w, h);  // a slot that opens with its end is a slot
      std::size_t to = s;
      for (std::size_t g = 0; g < groups.size(); ++g) {
        if (g == s) continue;
        double border = 0;
        for (const Rectangle& a : groups[s])
          for (const Rectangle& b : groups[g]) border += border_mm(a, b);
        if (border > longest && only_theirs(groups[s], groups[g])) longest = border, to = g;
      }
      if (to == s) continue;
      groups[to].insert(groups[to].end(), groups[s].begin(), groups[s].end());
      groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(s));
      return true;
    }
    return false;
  }

  const CellGrid& grid_;
  const Outline& outline_;
  double least_;
};

std::vector<Rectangles> rectangles_of(const RemovalVolume& removal, const Outline& outline, DivisionPlan plan) {
  const SliverJoiner joiner(removal.grid, outline, removal.narrowest_mm);
  if (plan != DivisionPlan::largest) return joiner.joined(slabs(outline, plan == DivisionPlan::yz));
  std::vector<Rectangles> best = joiner.joined(LargestRectangles(removal.grid, outline).find());
  for (const bool across_x : {true, false}) {
    std::vector<Rectangles> other = joiner.joined(slabs(outline, across_x));
    if (other.size() < best.size()) best = std::move(other);
  }
  return best;
}

VolumePrimitive primitive_of(const CellGrid& grid, std::vector<CellIndex> cells) {
  VolumePrimitive out;
  SolidBounds bounds;
  std::ranges::sort(cells);
  for (const CellIndex& c : cells) {
    const GridCell& cell = grid.at(c);
    out.volume_mm3 += cell.removal_mm3();
    out.free_form = out.free_form || cell.kind == CellKind::free_form;
    out.contoured = out.contoured || cell.kind == CellKind::contoured;
    constexpr double kOverhang = 0.01;  // of the free-form area
    out.overhang = out.overhang || cell.overhang_mm2 > kOverhang * cell.free_form_mm2;
    bounds.add(grid.low_mm(c));
    bounds.add(grid.high_mm(c));
  }
  out.min_mm = bounds.min_mm, out.max_mm = bounds.max_mm;
  out.cells = std::move(cells);
  return out;
}

std::vector<CellIndex> cells_of(const Region& region, const Outline& outline, const Rectangles& rectangles) {
  std::vector<CellIndex> cells;
  for (const Rectangle& r : rectangles)
    for (int x = outline.x[r.i0]; x < outline.x[r.i1]; ++x)
      for (int y = outline.y[r.j0]; y < outline.y[r.j1]; ++y)
        for (int z = region.from; z < region.to; ++z) cells.push_back({x, y, z});
  return cells;
}

void add_boxes(const RemovalVolume& removal, const Region& region, DivisionPlan plan,
               std::vector<VolumePrimitive>& out) {
  if (region.free_form) {
    out.push_back(primitive_of(removal.grid, region.cells));
    return;
  }
  const Outline outline = outline_of(region);
  for (const Rectangles& r : rectangles_of(removal, outline, plan))
    out.push_back(primitive_of(removal.grid, cells_of(region, outline, r)));
}

VolumePrimitive primitive_of(const Hole& hole, std::size_t number) {
  VolumePrimitive out;
  out.is_hole = true;
  out.hole = number;
  out.volume_mm3 = hole.volume_mm3;
  const double r = hole.diameter_mm / 2;
  out.min_mm = {hole.centre_mm.x() - r, hole.centre_mm.y() - r, hole.tip_mm};
  out.max_mm = {hole.centre_mm.x() + r, hole.centre_mm.y() + r, hole.top_mm};
  return out;
}

}  // namespace

std::vector<VolumePrimitive> divide(const RemovalVolume& removal, DivisionPlan plan) {
  std::vector<VolumePrimitive> out;
  for (const Region& region : regions_of(removal.grid, removal.narrowest_mm)) add_boxes(removal, region, plan, out);
  for (std::size_t h = 0; h < removal.holes.size(); ++h) out.push_back(primitive_of(removal.holes[h], h));
  return out;
}

}  // namespace camber::plan
