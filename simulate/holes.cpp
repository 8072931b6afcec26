#include "simulate/holes.h"

#include <algorithm>
#include <cassert>

namespace camber::simulate {

CutResult drill(removal::Stock& stock, const machine::Tool& tool, const machine::Material& material,
                std::span<const removal::Stamp> stamps, std::int32_t first_id, CutOptions options) {
  options.coupling = machine::Coupling::rigid;
  options.drilling = true;
  return cut(stock, tool, material, stamps, {}, first_id, options);
}

CutResult tap(removal::Stock& stock, const machine::Tool& tool, std::span<const removal::Stamp> stamps,
              std::int32_t first_id, const CutOptions& options) {
  CutResult result;
  result.loads.resize(stamps.size());
  result.stock_mm3 = sweep(stock, tool, stamps, first_id, 0);
  if (options.progress) options.progress(1);
  return result;
}

HoleStamps::HoleStamps(const removal::StampPath& path) {
  assert(std::ranges::is_sorted(path.runs, {}, &removal::ToolRun::from));
  for (const auto& run : path.runs)
    if (run.kind != removal::RunKind::milling)
      ranges_.emplace_back(static_cast<std::int32_t>(run.from), static_cast<std::int32_t>(run.from + run.count));
}

bool HoleStamps::contains(std::int32_t stamp) const {
  const auto after = std::ranges::upper_bound(ranges_, stamp, {}, &std::pair<std::int32_t, std::int32_t>::first);
  return after != ranges_.begin() && stamp < std::prev(after)->second;
}

double HoleStamps::drop_from(std::vector<removal::SurfacePoint>& surface) const {
  double area = 0;
  if (ranges_.empty()) return area;
  std::erase_if(surface, [&](const removal::SurfacePoint& p) {
    const bool hole = contains(p.target_stamp);
    if (hole) area += p.area_mm2;
    return hole;
  });
  return area;
}

}  // namespace camber::simulate
