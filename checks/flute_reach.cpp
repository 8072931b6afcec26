#include "checks/flute_reach.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/stage.h"
#include "checks/material_distance.h"
#include "checks/swept_stock.h"
#include "checks/tool_outline.h"
#include "machine/assumptions.h"
#include "removal/cutter.h"
#include "removal/engagement.h"

namespace camber::checks {
namespace {

constexpr double kStep_mm = 0.5;  // along the path, and on the cylinder above the flutes

double radius_at(const machine::Tool& tool, double height_mm) {
  const removal::CutterShape shape = removal::shape_of(tool);
  return shape.profile.at(shape.profile.length_to_height_mm(height_mm)).radius_mm;
}

/// Where a tool's flutes end.
struct FluteEnd {
  explicit FluteEnd(const machine::Tool& tool)
      : height_mm(cutter_end_mm(tool)), radius_mm(radius_at(tool, height_mm)) {}

  double height_mm, radius_mm;

  /// Whether they end below the stock's top here, beside or in the stock.
  bool near(const Vec3& tip, const removal::Stock& stock) const {
    const Vec3 &lo = stock.min_mm(), &hi = stock.max_mm();
    const bool beside = (tip.head<2>().array() + radius_mm <= lo.head<2>().array()).any() ||
                        (tip.head<2>().array() - radius_mm >= hi.head<2>().array()).any();
    return !beside && tip.z() + height_mm + stock.voxel_mm() < hi.z();
  }
};

/// One tool's cylinder above its flutes against a stock. `distance`: of the stock or of one that had more.
class UpperCylinder {
 public:
  UpperCylinder(const machine::Tool& tool, const removal::Stock& stock, const MaterialDistance& distance)
      : stock_(stock), distance_(distance), flutes_(tool) {}

  bool near(const Vec3& tip) const { return flutes_.near(tip, stock_); }

  /// Height above the tip at which the cylinder meets material.
  std::optional<double> meets(const removal::Stock::Probe& probe, const Vec3& tip) const {
    const double voxel = stock_.voxel_mm(), radius = flutes_.radius_mm, lowest = flutes_.height_mm + voxel;
    const int n = std::max(12, static_cast<int>(std::ceil(2 * kPi * radius / kStep_mm)));
    const int count = static_cast<int>(std::ceil((stock_.max_mm().z() - tip.z() - lowest) / kStep_mm));
    for (int ring = 0; ring < count;) {
      const double height = lowest + ring * kStep_mm;
      const double clear_mm = distance_.at_least_mm(tip + Vec3(0, 0, height)) - radius;
      ring += std::max(1, static_cast<int>(clear_mm / kStep_mm));
      if (clear_mm > 0) continue;
      for (int i = 0; i < n; ++i) {
        const double phi = 2 * kPi * i / n;
        const Vec3 p = tip + Vec3(radius * std::cos(phi), radius * std::sin(phi), height);
        if (probe.distance_mm(p) < -voxel) return height;
      }
    }
    return std::nullopt;
  }

 private:
  const removal::Stock& stock_;
  const MaterialDistance& distance_;
  FluteEnd flutes_;
};

constexpr std::size_t kMaxLines = 10;

/// Blocks that cut above the flutes, each named once.
class Report {
 public:
  Report(const machine::Job& job, const motion::SimulatedProgram& program, Diagnostics& diagnostics)
      : job_(job), program_(program), diagnostics_(diagnostics), assumed_(machine::assumed_keys(job.path)) {}

  bool full() const { return said_.size() >= kMaxLines; }
  bool has(int number, std::uint32_t block) const { return said_.contains(block) || warned_.contains(number); }
  /// Reports material above the flutes: where the flute length or the blank is assumed, as a warning, once a tool.
  void add(int number, std::uint32_t block, double height_mm) {
    const machine::Tool& tool = job_.tools.at(number);
    const bool flutes = tool.flute_length_mm && *tool.flute_length_mm < tool.overhang_mm;
    const char* key = flutes ? "flute_length_mm" : "overhang_mm";
    const char* name = flutes ? "cut-above-flutes" : "cut-above-overhang";
    const bool length = machine::is_assumed(assumed_, fmt::format("tool.{}", number), key),
               blank = machine::is_assumed(assumed_, "stock", "box_mm");
    if (length || blank) {
      warned_.insert(number);
      diagnostics_.add(program_.text().source.diagnostic(
          Severity::warning, program_.text().blocks[block].offset,
          fmt::format("T{} meets material {:.1f} mm above its tip, but {} = {:g}, {}", number, height_mm, key,
                      cutter_end_mm(tool),
                      length
                          ? "which is assumed; the length that the tool has was expected, or a stock that is cut so far"
                          : "in a blank that is assumed; the blank as it is at that line was expected"),
          name));
      return;
    }
    said_.insert(block);
    diagnostics_.add(program_.text().source.diagnostic(
        Severity::error, program_.text().blocks[block].offset,
        fmt::format("T{} meets material {:.1f} mm above its tip, but {} = {:g}; a cut that {} was expected", number,
                    height_mm, key, cutter_end_mm(tool), flutes ? "its flutes reach" : "ends below the holder"),
        name));
  }

 private:
  const machine::Job& job_;
  const motion::SimulatedProgram& program_;
  Diagnostics& diagnostics_;
  std::map<std::string, std::vector<std::string>> assumed_;
  std::set<std::uint32_t> said_;  ///< blocks
  std::set<int> warned_;          ///< tools
};

class UprightSearch {
 public:
  UprightSearch(const machine::Job& job, const motion::SimulatedProgram& program, const removal::Stock& blank,
                Diagnostics& diagnostics)
      : job_(job), program_(program), blank_(blank), distance_(blank), report_(job, program, diagnostics) {}

  /// Material goes only: what the cylinder does not meet in the blank it never meets.
  void run() {
    const std::size_t last_needed = last_in_blank();
    if (last_needed == 0) return;
    removal::Stock stock(blank_);
    Stage stage("checking the flutes' reach", last_needed);
    for_stretches(last_needed, [&](const removal::ToolRun& run, std::size_t from, std::size_t to) {
      if (run.kind == removal::RunKind::milling) look_at(stock, run.tool, from, to);
      removal::sweep(stock, removal::shape_of(job_.tools.at(run.tool)),
                     std::span(program_.path.stamps).subspan(from, to - from),
                     {.first_id = static_cast<std::int32_t>(from), .stage = &stage});
    });
  }

 private:
  /// Stretches in which a cutter does not come down on what it has left.
  void for_stretches(std::size_t end, const auto& visit) {
    for (const auto& run : program_.path.runs) {
      const std::size_t run_end = std::min(run.from + run.count, end);
      for (std::size_t at = run.from; at < run_end && !report_.full();) {
        const std::size_t to = level_stretch_end(job_.tools.at(run.tool), program_.path, run, at);
        visit(run, at, to);
        at = to;
      }
    }
  }

  /// Stamps of a stretch kStep_mm apart whose flutes end below the stock's top; `visit` returns false to end.
  void for_places(const UpperCylinder& cylinder, std::size_t from, std::size_t to, const auto& visit) const {
    Vec3 last = Vec3::Constant(1e9);
    for (std::size_t k = from; k < to; ++k) {
      const Vec3& tip = program_.path.stamps[k].pose.tip_mm;
      if ((tip - last).norm() < kStep_mm || !cylinder.near(tip)) continue;
      last = tip;
      if (!visit(k, tip)) return;
    }
  }

  /// One past the last stamp at which a cylinder meets the blank; 0: none does.
  std::size_t last_in_blank() {
    std::size_t out = 0;
    const removal::Stock::Probe probe(blank_);
    for_stretches(program_.path.stamps.size(), [&](const removal::ToolRun& run, std::size_t from, std::size_t to) {
      if (run.kind != removal::RunKind::milling) return;
      const UpperCylinder cylinder(job_.tools.at(run.tool), blank_, distance_);
      for_places(cylinder, from, to, [&](std::size_t k, const Vec3& tip) {
        if (cylinder.meets(probe, tip)) out = k + 1;
        return true;
      });
    });
    return out;
  }

  void look_at(const removal::Stock& stock, int tool, std::size_t from, std::size_t to) {
    const UpperCylinder cylinder(job_.tools.at(tool), stock, distance_);
    const removal::Stock::Probe probe(stock);
    for_places(cylinder, from, to, [&](std::size_t k, const Vec3& tip) {
      const std::uint32_t block = program_.moves_in_part().moves[program_.path.stamps[k].move].block;
      if (report_.has(tool, block)) return true;
      if (const auto height = cylinder.meets(probe, tip)) report_.add(tool, block, *height);
      return !report_.full();
    });
  }

  const machine::Job& job_;
  const motion::SimulatedProgram& program_;
  const removal::Stock& blank_;
  MaterialDistance distance_;
  Report report_;
};

/// Whether flutes end below the stock's top anywhere.
bool any_near(const machine::Job& job, const motion::SimulatedProgram& program, const removal::Stock& blank) {
  for (const auto& run : program.path.runs) {
    if (run.kind != removal::RunKind::milling) continue;
    const FluteEnd flutes(job.tools.at(run.tool));
    for (const removal::Stamp& s : std::span(program.path.stamps).subspan(run.from, run.count))
      if (flutes.near(s.pose.tip_mm, blank)) return true;
  }
  return false;
}

/// The cylinder above the flutes, through the whole stock.
ToolSurface upper_cylinder(const machine::Tool& tool, const removal::Stock& stock) {
  const double end_mm = cutter_end_mm(tool), radius_mm = radius_at(tool, end_mm), voxel_mm = stock.voxel_mm();
  const double length_mm = (stock.max_mm() - stock.min_mm()).norm();
  std::vector<OutlineRing> rings;
  const int count = std::max(1, static_cast<int>(std::ceil((length_mm - voxel_mm) / kStep_mm)));
  rings.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
    rings.push_back({OutlineRing::Part::shank, radius_mm, end_mm + voxel_mm + i * kStep_mm});
  return {rings, kStep_mm};
}

/// Tools of any direction.
class TiltedSearch {
 public:
  TiltedSearch(const machine::Job& job, const motion::SimulatedProgram& program, const removal::Stock& blank,
               Diagnostics& diagnostics)
      : program_(program), blank_(blank), report_(job, program, diagnostics), last_needed_(0) {
    for (const auto& [number, tool] : job.tools) cylinders_.try_emplace(number, upper_cylinder(tool, blank));
    for (const auto& run : program.path.runs)
      if (run.kind == removal::RunKind::milling)
        last_needed_ = last_near(cylinders_.at(run.tool), program.path, run, blank, last_needed_);
    if (last_needed_ == 0) return;
    Stage stage("checking the flutes' reach", last_needed_);
    SweptStock stock(job, program, blank, stage);
    for (const auto& run : program.path.runs)
      if (run.from < last_needed_ && !report_.full()) look_along(run, stock);
  }

 private:
  void look_along(const removal::ToolRun& run, SweptStock& stock) {
    PlacesAlong places(cylinders_.at(run.tool), program_.path, run);
    SurfaceFeeler feeler(cylinders_.at(run.tool), stock.stock(), stock.material());
    stock.begin(run);
    const std::size_t end = std::min(run.from + run.count, last_needed_);
    for (std::size_t k = run.from; k < end && !report_.full(); ++k) {
      stock.limit_waiting(k);
      for (const ToolPose& pose : places.at(k))
        if (run.kind == removal::RunKind::milling) look_at(run.tool, k, pose, feeler, stock);
    }
    stock.sweep_to(end);
  }

  void look_at(int tool, std::size_t k, const ToolPose& pose, SurfaceFeeler& feeler, SweptStock& stock) {
    const std::uint32_t block = program_.moves_in_part().moves[program_.path.stamps[k].move].block;
    if (report_.has(tool, block) || !cylinders_.at(tool).may_touch(pose, false, blank_.min_mm(), blank_.max_mm()))
      return;
    bool some_cleared = false;
    const auto touch = feeler.touch(stock.probe(), pose, false, [&](const Vec3& point) {
      const bool cleared = stock.cleared(point, k);
      some_cleared = some_cleared || cleared;
      return !cleared;
    });
    if (touch)
      report_.add(tool, block, (touch->place_mm - pose.tip_mm).dot(pose.axis));
    else if (some_cleared)
      stock.sweep_to(k);
  }

  const motion::SimulatedProgram& program_;
  const removal::Stock& blank_;
  Report report_;
  std::map<int, ToolSurface> cylinders_;
  std::size_t last_needed_;
};

}  // namespace

void report_above_flutes(const machine::Job& job, const motion::SimulatedProgram& program,
                         const std::vector<CutAboveFlutes>& found, Diagnostics& diagnostics) {
  Report report(job, program, diagnostics);
  for (const CutAboveFlutes& cut : found) {
    const nc::Move& m = program.moves_in_part().moves[cut.move];
    if (report.full()) return;
    const int tool = program.moves_in_part().state_of(m).tool;
    if (!report.has(tool, m.block)) report.add(tool, m.block, cut.above_tip_mm);
  }
}

void check_flute_reach(const machine::Job& job, const motion::SimulatedProgram& program, const removal::Stock& blank,
                       Diagnostics& diagnostics) {
  if (!removal::all_upright(program.path.stamps))
    TiltedSearch(job, program, blank, diagnostics);
  else if (any_near(job, program, blank))
    UprightSearch(job, program, blank, diagnostics).run();
}

}  // namespace camber::checks
