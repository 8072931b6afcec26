#include "simulate/cut.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <tbb/parallel_for.h>

#include "base/cancel.h"
#include "deflection/beam.h"
#include "motion/path_stretch.h"
#include "removal/engagement.h"
#include "removal/known_run.h"
#include "simulate/cut_parts.h"
#include "simulate/pieces.h"
#include "simulate/tooth_loads.h"

namespace camber::simulate {

using deflection::kFine;
using deflection::Teeth;
using removal::DeflectionTable;
using removal::Stamp;
using removal::Stock;

namespace {

/// Returns engaged_top_mm of the stamp below which the stock rises most.
double engaged_top_mm(const Stock& stock, const machine::Tool& tool, std::span<const Stamp> stamps,
                      const removal::KnownRun* known) {
  double rise = 0;
  if (known) return simulate::engaged_top_mm(stock, tool, std::max(rise, stock.max_mm().z() - known->min_mm.z()));
  for (const auto& s : stamps) {
    // The corner of the stock's box that lies farthest up the tool.
    const Vec3 corner = (s.pose.axis.array() > 0).select(stock.max_mm(), stock.min_mm());
    rise = std::max(
        rise, s.pose.upright() ? stock.max_mm().z() - s.pose.tip_mm.z() : (corner - s.pose.tip_mm).dot(s.pose.axis));
  }
  return simulate::engaged_top_mm(stock, tool, rise);
}

/// In static coupling the run-out of equally spaced teeth displaces the tool (StaticCut): to the chips they are even.
Teeth teeth_in_model(const Teeth& teeth, bool rigid) {
  return !rigid && teeth.evenly_spaced() ? teeth.without_run_out() : teeth;
}

/// The largest deflection that the fields and the beam describe at a stamp: the narrow band holds it with the chip,
/// the deflected cutter is looked for within kMaxDeflection_mm, and a beam bends little against its thickness.
double deflection_limit_mm(const CutTool& tool, const Stamp& stamp) {
  constexpr double kOfDiameter = 0.1, kAtLimit = 0.98;
  // Right after a rapid the motion is the rapid's, and no chip.
  const double chip = stamp.first ? 0 : stamp.feed_per_tooth_mm.norm();
  const double band = std::max(tool.stock.band_mm() / 4, tool.stock.band_mm() - chip);
  const double deflected = kAtLimit * removal::DeflectedEngager::kMaxDeflection_mm;
  return std::min({band, deflected, kOfDiameter * tool.diameter_mm});
}

void watch_range(const CutTool& tool, const CutStretch& stretch, CutResult& result) {
  const std::span<const Stamp> stamps = stretch.stamps();
  const DeflectionTable& deflections = stretch.deflections;
  std::vector<StampLoad>& loads = stretch.loads;
  tbb::parallel_for(std::size_t{0}, stamps.size(), [&](std::size_t k) {
    loads[k].deflection_max_mm = tip_deflection_mm(deflections, deflections.row(static_cast<std::ptrdiff_t>(k)));
  });
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    const double deflection = loads[k].deflection_max_mm, limit = deflection_limit_mm(tool, stamps[k]);
    result.deflection_max_mm = std::max(result.deflection_max_mm, deflection);
    if (deflection <= limit) continue;
    result.deflection_limit_mm = result.beyond_stamps.empty() ? limit : std::min(result.deflection_limit_mm, limit);
    result.beyond_stamps.push_back(static_cast<std::uint32_t>(result.loads.size() + k));
  }
}

/// One tool on one stock; cuts stretch after stretch.
class Cutter {
 public:
  Cutter(Stock& stock, const machine::Tool& tool, const machine::Material& material, std::span<const Stamp> stamps,
         const CutOptions& options)
      : tool_(stock, tool, material, stamps, options),
        coupling_(tool_.rigid ? rigid_coupling(tool_) : static_coupling(tool_)),
        marks_(marks_of(tool_)) {}

  /// Cuts stamps from ... from + count - 1 of all.
  void cut(std::span<const Stamp> all, std::size_t from, std::size_t count, std::span<const Contact> contacts,
           std::int32_t first_id, CutResult& result) {
    prepare_table(count);
    std::vector<StampLoad> loads(count);
    const CutStretch stretch{all, from, first_id, deflections_, loads};
    coupling_->cut(stretch, before_, result);
    if (!tool_.options.drilling) watch_range(tool_, stretch, result);
    marks_->leave(stretch, contacts, tool_.options.surface);
    if (tool_.options.tool_surface) mark_tool_alone(stretch);
    for (const StampLoad& load : loads) result.chip_mm3 += load.chip_mm3;
    result.loads.insert(result.loads.end(), loads.begin(), loads.end());
    keep_last_rows();
  }

  /// The stamps before the first one were cut elsewhere.
  void begin_after(const BendBefore& before) { before_ = before; }

  /// Leaves the stock as cut.
  void finish(CutResult& result) {
    result.stock_mm3 += coupling_->commit();
    if (!tool_.rigid && !result.loads.empty()) result.bend = std::move(before_);
  }

 private:
  /// The table of a stretch, with the rows before it.
  void prepare_table(std::size_t stamps) {
    const deflection::ToothPassModel& model = tool_.model;
    // Rigid: every row is written anew, and a hole's are not read.
    if (!tool_.rigid || deflections_.stamps != stamps)
      deflections_ = DeflectionTable(stamps, (tool_.rigid ? kFine : 1) * model.steps(), model.node_height_mm(),
                                     model.axial(), model.part() != nullptr);
    if (model.part()) deflections_.edges_end_mm = tool_.edges_end_mm;
    const std::size_t size = deflections_.row_size();
    if (before_.rows.size() >= size)
      std::copy_n(before_.rows.end() - static_cast<std::ptrdiff_t>(size), size, deflections_.row(-1));
  }

  void keep_last_rows() {
    std::vector<float>& rows = before_.rows;
    const std::size_t most = tool_.rigid ? 1 : BendBefore::kRows, kept = std::min(most, deflections_.stamps);
    const auto count = static_cast<std::ptrdiff_t>(deflections_.stamps);
    const std::size_t old = std::min(rows.size(), (most - kept) * deflections_.row_size());
    rows.erase(rows.begin(), rows.end() - static_cast<std::ptrdiff_t>(old));
    const float* from = deflections_.row(count - static_cast<std::ptrdiff_t>(kept));
    rows.insert(rows.end(), from, from + kept * deflections_.row_size());
    for (std::ptrdiff_t k = 0; k < count && !tool_.rigid; ++k)
      before_.largest_mm = std::max(before_.largest_mm, deflections_.largest_mm(k));
  }

  /// The marks as the same cut would leave them on a part that does not yield.
  void mark_tool_alone(const CutStretch& stretch) const {
    DeflectionTable tool = stretch.deflections.parts ? stretch.deflections.of_tool_alone() : stretch.deflections;
    marks_->leave({stretch.all, stretch.from, stretch.first_id, tool, stretch.loads}, {}, tool_.options.tool_surface);
  }

  CutTool tool_;
  std::unique_ptr<Coupling> coupling_;
  std::unique_ptr<Marks> marks_;
  DeflectionTable deflections_;  ///< of the stretch
  BendBefore before_;            ///< of the stretches before
};

}  // namespace

CutTool::CutTool(Stock& of_stock, const machine::Tool& tool, const machine::Material& material,
                 std::span<const Stamp> stamps, const CutOptions& how)
    : stock(of_stock),
      options(how),
      rigid(how.coupling == machine::Coupling::rigid),
      diameter_mm(tool.diameter_mm),
      edges_end_mm(tool.flute_length_mm.value_or(std::numeric_limits<double>::infinity())),
      top_mm(engaged_top_mm(stock, tool, stamps, options.known)),
      envelope(sampled_envelope(stock, tool, top_mm, how)),
      model(
          envelope, material, deflection::beam_of(tool),
          deflection::node_heights(top_mm, std::min(tool.overhang_mm, tool.flute_length_mm.value_or(tool.overhang_mm))),
          rigid ? 0.0 : how.edge_ramp_mm, teeth_in_model(Teeth(tool), rigid), how.axis_compliance_mm_per_N,
          how.drilling ? nullptr : how.part) {
  if (!how.blank) own_blank.emplace(stock);
  blank = how.blank ? how.blank : &*own_blank;
  const Teeth teeth(tool), modelled = teeth_in_model(teeth, rigid);
  if (!teeth.even()) different_teeth = static_cast<std::size_t>(teeth.count());
  if (!modelled.even() && !how.drilling) tooth_marks.emplace(envelope, modelled);
  if (!rigid && teeth.evenly_spaced()) run_out = deflection::RunOutOffsets(teeth, model.steps());
  if (!rigid) removal::make_patches(envelope, 0.6 * stock.band_mm());
}

void CutTool::keep_turn(std::span<const removal::ChipSample> chips, std::span<const Stamp> all, std::size_t k,
                        CutResult& result) const {
  if (in_turn(k)) model.add_to_turn(chips, k - *options.turn_from, k, removal::motion_in_tool(all, k), result.turn);
}

CutResult cut(Stock& stock, const machine::Tool& tool, const machine::Material& material, std::span<const Stamp> stamps,
              std::span<const Contact> contacts, std::int32_t first_id, const CutOptions& options) {
  return cut_range(stock, tool, material, {stamps, 0, stamps.size(), contacts, first_id}, options);
}

CutResult cut_range(Stock& stock, const machine::Tool& tool, const machine::Material& material, const StampRange& range,
                    const CutOptions& options) {
  const auto& [stamps, first, count, contacts, first_id, before] = range;
  CutResult result;
  result.loads.reserve(count);
  Cutter cutter(stock, tool, material, stamps, options);
  if (before) cutter.begin_after(*before);
  // Which stamps are read depends on where stretches begin: in rigid coupling they are the pieces of sections.
  const bool rigid = options.coupling == machine::Coupling::rigid;
  const std::size_t most =
                        rigid ? std::min(options.rigid_stretch_stamps, motion::kPieceStamps) : options.stretch_stamps,
                    stretches = (count + most - 1) / most;
  for (std::size_t i = 0; i < stretches; ++i) {
    cancellation_point();
    const std::size_t done = rigid ? count * i / stretches : most * i,
                      n = (rigid ? count * (i + 1) / stretches : std::min(most * (i + 1), count)) - done;
    cutter.cut(stamps, first + done, n, contacts.empty() ? contacts : contacts.subspan(done, n), first_id, result);
    if (options.progress) options.progress(static_cast<double>(done + n) / static_cast<double>(count));
  }
  cutter.finish(result);
  return result;
}

double sweep(Stock& stock, const machine::Tool& tool, std::span<const Stamp> stamps, std::int32_t first_id,
             double shrink_mm) {
  return removal::sweep(stock, removal::shape_of(tool), stamps, {.shrink_mm = shrink_mm, .first_id = first_id});
}

}  // namespace camber::simulate
