#include "plan/layered_solid.h"

#include <algorithm>
#include <map>

#include "plan/polygon_triangles.h"

namespace camber::plan {
namespace {

using Loops = std::vector<std::vector<Vec2>>;

class Layer {
 public:
  explicit Layer(Solid& out) : out_(out) {}

  void walls(const std::vector<Vec2>& loop, double from, double to) {
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec2 &a = loop[k], &b = loop[(k + 1) % loop.size()];
      out_.triangles.push_back({point(a, from), point(b, from), point(b, to)});
      out_.triangles.push_back({point(a, from), point(b, to), point(a, to)});
    }
  }

  void level(const Loops& loops, double z, bool up) {
    std::vector<Vec2> all;
    for (const auto& loop : loops) all.insert(all.end(), loop.begin(), loop.end());
    for (const auto& [a, b, c] : triangles_of(loops))
      out_.triangles.push_back({point(all[a], z), point(all[up ? b : c], z), point(all[up ? c : b], z)});
  }

 private:
  std::uint32_t point(const Vec2& p, double z) {
    const auto [it, fresh] = index_.try_emplace({p.x(), p.y(), z}, static_cast<std::uint32_t>(out_.points.size()));
    if (fresh) out_.points.emplace_back(p.x(), p.y(), z);
    return it->second;
  }

  Solid& out_;
  std::map<std::array<double, 3>, std::uint32_t> index_;
};

}  // namespace

void add_layer(Solid& out, const Loops& loops, double from_mm, double to_mm, const std::vector<Well>& wells) {
  Layer layer(out);
  for (const auto& loop : loops) layer.walls(loop, from_mm, to_mm);
  Loops top = loops, bottom = loops;
  for (const Well& w : wells) {
    const bool through = w.bottom_mm <= from_mm;
    const double low = std::max(w.bottom_mm, from_mm);
    top.push_back(w.ring);
    layer.walls(w.ring, low, to_mm);
    if (through)
      bottom.push_back(w.ring);
    else
      layer.level({{w.ring.rbegin(), w.ring.rend()}}, low, true);
  }
  layer.level(top, to_mm, true);
  layer.level(bottom, from_mm, false);
}

}  // namespace camber::plan
