#include "plan/layered_solid.h"

#include <map>

#include "plan/polygon_triangles.h"

namespace camber::plan {

void add_layer(Solid& out, const std::vector<std::vector<Vec2>>& loops, double from_mm, double to_mm) {
  std::map<std::array<double, 3>, std::uint32_t> index;
  const auto point = [&](const Vec2& p, double z) {
    const auto [it, fresh] = index.try_emplace({p.x(), p.y(), z}, static_cast<std::uint32_t>(out.points.size()));
    if (fresh) out.points.emplace_back(p.x(), p.y(), z);
    return it->second;
  };
  std::vector<Vec2> all;
  for (const auto& loop : loops) {
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec2 &a = loop[k], &b = loop[(k + 1) % loop.size()];
      out.triangles.push_back({point(a, from_mm), point(b, from_mm), point(b, to_mm)});
      out.triangles.push_back({point(a, from_mm), point(b, to_mm), point(a, to_mm)});
    }
    all.insert(all.end(), loop.begin(), loop.end());
  }
  for (const auto& [a, b, c] : triangles_of(loops)) {
    out.triangles.push_back({point(all[a], to_mm), point(all[b], to_mm), point(all[c], to_mm)});
    out.triangles.push_back({point(all[a], from_mm), point(all[c], from_mm), point(all[b], from_mm)});
  }
}

}  // namespace camber::plan
