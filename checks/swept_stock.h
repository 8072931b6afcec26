#pragma once
// A copy of the blank that is cut along a program, for checks of what stands beside the tool.
#include <cstddef>
#include <optional>
#include <vector>

#include "base/stage.h"
#include "checks/tool_surface.h"
#include "machine/job_file.h"
#include "motion/simulated_program.h"
#include "removal/cutter.h"
#include "removal/stock.h"

namespace camber::checks {

/// The undeflected cutter, swept stretch by stretch. In sweeps a cutter has no upper end, so that what stands above the
/// flutes disappears with the rest; therefore a stretch is looked at before it is swept, and what the flutes of its
/// own stamps have removed by then is worked out point by point (cleared()).
class SweptStock {
 public:
  /// All must outlive this.
  SweptStock(const machine::Job& job, const motion::SimulatedProgram& program, const removal::Stock& blank,
             Stage& stage);

  const removal::Stock& stock() const { return stock_; }
  MaterialDistance& material() { return material_; }
  const removal::Stock::Probe& probe() const { return *probe_; }
  /// A run begins: its tool cuts from here on.
  void begin(const removal::ToolRun& run);
  /// Sweeps what is left of the run's stamps before `end`.
  void sweep_to(std::size_t end);
  /// Sweeps where so many stamps are waiting that cleared() would become slow.
  void limit_waiting(std::size_t k) {
    if (k - swept_ >= kMaxWaiting) sweep_to(k);
  }
  /// Whether the flutes, in a stamp of the run before `end` that is not swept yet, have removed the material at a
  /// point but for a voxel.
  bool cleared(const Vec3& point, std::size_t end) const;

 private:
  static constexpr std::size_t kMaxWaiting = 10000;

  const machine::Job& job_;
  const motion::SimulatedProgram& program_;
  Stage& stage_;
  removal::Stock stock_;
  MaterialDistance material_;
  std::optional<removal::Stock::Probe> probe_;
  removal::CutterShape shape_;
  double flutes_mm_ = 0;
  std::size_t swept_ = 0;  ///< stamps
};

/// One past the last stamp of the run at which the tool's shank or holder, here or on the way from the stamp before,
/// may touch a stock; at least `from`.
std::size_t last_near(const ToolSurface& tool, const removal::StampPath& path, const removal::ToolRun& run,
                      const removal::Stock& stock, std::size_t from);

/// Places along a run's stamps between which no point of the tool moves by more than kCollisionStep_mm.
class PlacesAlong {
 public:
  PlacesAlong(const ToolSurface& tool, const removal::StampPath& path, const removal::ToolRun& run)
      : tool_(tool), stamps_(path.stamps), end_(run.from + run.count) {}

  /// Poses to look at after stamp k - 1 and up to stamp k, of the run's stamps in order; none: `k` is close enough to
  /// the last one.
  const std::vector<ToolPose>& at(std::size_t k);

 private:
  const ToolSurface& tool_;
  const std::vector<removal::Stamp>& stamps_;
  std::size_t end_;
  double since_mm_ = 0;       ///< moved since the last place
  double step_to_next_ = -1;  ///< from stamp k to k + 1; negative: not known
  std::vector<ToolPose> places_;
};

}  // namespace camber::checks
