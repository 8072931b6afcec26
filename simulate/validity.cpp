#include "simulate/validity.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include <tbb/parallel_for.h>

#include "base/tool_pose.h"
#include "removal/cutter.h"

namespace camber::simulate {
namespace {

/// A shift of the path and a chord between the cutters that are looked at lie within it.
constexpr double kTouches_mm = 0.1;
constexpr double kApart = 0.25;  ///< of the radius: between cutters that are looked at

void mark_stretch(const SimulatedProgram& program, const removal::ToolRun& run, double radius_mm, std::size_t stamp,
                  std::vector<bool>& valid) {
  const auto& stamps = program.path.stamps;
  const Vec3 tip = stamps[stamp].pose.tip_mm;
  valid[stamp] = false;
  for (std::size_t k = stamp + 1; k < run.from + run.count; ++k) {
    if (stamps[k].first || (stamps[k].pose.tip_mm - tip).norm() > radius_mm) return;
    valid[k] = false;
  }
}

std::vector<bool> valid_stamps(const machine::Job& job, const SimulatedProgram& program, const CutResult& cut,
                               std::span<const std::uint32_t> unstable) {
  std::vector<std::uint32_t> found = cut.beyond_stamps;
  found.insert(found.end(), unstable.begin(), unstable.end());
  found.insert(found.end(), cut.unsettled_stamps.begin(), cut.unsettled_stamps.end());
  std::ranges::sort(found);
  std::vector<bool> valid(program.path.stamps.size(), true);
  auto next = found.begin();
  for (const removal::ToolRun& run : program.path.runs) {
    const double radius = job.tools.at(run.tool).diameter_mm / 2;
    for (; next != found.end() && *next < run.from + run.count; ++next)
      mark_stretch(program, run, radius, *next, valid);
  }
  return valid;
}

/// The undeflected cutters of invalid passings, by place.
class InvalidCutters {
 public:
  InvalidCutters(const machine::Job& job, const SimulatedProgram& program, const std::vector<bool>& valid) {
    for (const removal::ToolRun& run : program.path.runs)
      cell_mm_ = std::max(cell_mm_, job.tools.at(run.tool).diameter_mm / 2 + kTouches_mm);
    for (const removal::ToolRun& run : program.path.runs)
      if (run.kind == removal::RunKind::milling) add(run, job.tools.at(run.tool), program, valid);
  }

  /// True where one of them that comes after `stamp` touches the point.
  bool touched_after(std::int32_t stamp, const Vec3& point) const {
    const Vec3 at = cell_of(point);
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j)
        for (int l = -1; l <= 1; ++l) {
          const auto cell = cells_.find(key(at + Vec3(i, j, l)));
          if (cell == cells_.end()) continue;
          for (const std::uint32_t c : cell->second)
            if (cutters_[c].stamp > stamp && touches(cutters_[c], point)) return true;
        }
    return false;
  }

 private:
  struct Cutter {
    std::int32_t stamp;
    std::uint32_t shape;
    ToolPose pose;
  };

  Vec3 cell_of(const Vec3& point) const { return (point / cell_mm_).array().floor(); }
  /// Returns one number for the three whole numbers of a cell.
  static std::uint64_t key(const Vec3& cell) {
    constexpr int kBits = 21, kHalf = 1 << (kBits - 1);
    std::uint64_t out = 0;
    for (int a = 0; a < 3; ++a) out = out << kBits | static_cast<std::uint64_t>(std::lround(cell[a]) + kHalf);
    return out;
  }

  bool touches(const Cutter& cutter, const Vec3& point) const {
    const Vec3 local = tool_frame(cutter.pose).transpose() * (point - cutter.pose.tip_mm);
    return shapes_[cutter.shape].distance_mm(local) <= kTouches_mm;
  }

  void add(const removal::ToolRun& run, const machine::Tool& tool, const SimulatedProgram& program,
           const std::vector<bool>& valid) {
    const double apart = kApart * tool.diameter_mm / 2;
    const auto& stamps = program.path.stamps;
    shapes_.push_back(removal::shape_of(tool));
    bool any = false;
    for (std::size_t k = run.from; k < run.from + run.count; ++k) {
      if (valid[k]) {
        any = false;
        continue;
      }
      const bool last = k + 1 == run.from + run.count || valid[k + 1] || stamps[k + 1].first;
      const bool far = !any || stamps[k].first || (stamps[k].pose.tip_mm - cutters_.back().pose.tip_mm).norm() > apart;
      if (!far && !last) {
        cutters_.back().stamp = static_cast<std::int32_t>(k);
        continue;
      }
      put({static_cast<std::int32_t>(k), static_cast<std::uint32_t>(shapes_.size() - 1), stamps[k].pose},
          tool.overhang_mm);
      any = true;
    }
  }

  /// In every cell along its axis.
  void put(const Cutter& cutter, double length_mm) {
    const auto number = static_cast<std::uint32_t>(cutters_.size());
    cutters_.push_back(cutter);
    std::optional<std::uint64_t> before;
    for (double z = 0; z < length_mm + cell_mm_; z += cell_mm_ / 2) {
      const std::uint64_t cell = key(cell_of(cutter.pose.tip_mm + std::min(z, length_mm) * cutter.pose.axis));
      if (cell == before) continue;
      cells_[cell].push_back(number);
      before = cell;
    }
  }

  double cell_mm_ = kTouches_mm;
  std::vector<removal::CutterShape> shapes_;
  std::vector<Cutter> cutters_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

}  // namespace

Validity find_validity(const machine::Job& job, const SimulatedProgram& program, const CutResult& cut,
                       std::span<const std::uint32_t> unstable, std::vector<removal::SurfacePoint>& surface) {
  Validity out;
  if (cut.beyond_stamps.empty() && cut.unsettled_stamps.empty() && unstable.empty()) return out;
  out.stamps = valid_stamps(job, program, cut, unstable);
  for (std::size_t k = 0; k < cut.loads.size(); ++k) {
    if (cut.loads[k].chip_mm3 <= 0 && out.stamps[k]) continue;
    ++out.passings;
    if (!out.stamps[k]) ++out.invalid_passings;
  }
  const InvalidCutters cutters(job, program, out.stamps);
  tbb::parallel_for(std::size_t{0}, surface.size(), [&](std::size_t i) {
    removal::SurfacePoint& p = surface[i];
    const bool made = p.machined_stamp >= 0 && !out.stamps[static_cast<std::size_t>(p.machined_stamp)];
    p.valid = !made && !cutters.touched_after(p.machined_stamp, p.place_mm);
  });
  for (const removal::SurfacePoint& p : surface) {
    out.surface_mm2 += p.area_mm2;
    if (!p.valid) out.invalid_mm2 += p.area_mm2;
  }
  return out;
}

std::vector<std::size_t> lines_of(const SimulatedProgram& program, std::span<const std::uint32_t> stamps) {
  std::vector<std::size_t> lines;
  for (const std::uint32_t k : stamps)
    lines.push_back(program.moves_in_part().moves[program.path.stamps[k].move].block + std::size_t{1});
  std::ranges::sort(lines);
  const auto again = std::ranges::unique(lines);
  lines.erase(again.begin(), again.end());
  return lines;
}

}  // namespace camber::simulate
