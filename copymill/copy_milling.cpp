#include "copymill/copy_milling.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "base/triangle_mesh.h"
#include "copymill/operation.h"
#include "simulate/job_stock.h"

namespace camber::copymill {
namespace {

constexpr double kAboveAll_mm = 5;
constexpr double kBandVoxels = 4;

TriangleMesh read_part(const machine::Job& job) {
  if (job.part.mesh.empty())
    fail_on_file(job.path, "has no [part] mesh, from which paths are made; one was expected", "part-missing");
  return closed_mesh(machine::part_mesh(job.part), job.part.mesh,
                     "and the cutter could fall through; a closed one was expected");
}

std::string place_text(const Vec3& p) { return fmt::format("X{:g} Y{:g} Z{:g}", p.x(), p.y(), p.z()); }

/// A part that is not in the blank cannot be made from it.
void check_part_inside(const machine::Job& job, const TriangleMesh& part, const removal::Stock& stock) {
  Vec3 lo = part.points.front().cast<double>(), hi = lo;
  for (const auto& p : part.points) lo = lo.cwiseMin(p.cast<double>()), hi = hi.cwiseMax(p.cast<double>());
  const double slack = stock.voxel_mm();
  if ((lo.array() >= stock.min_mm().array() - slack).all() && (hi.array() <= stock.max_mm().array() + slack).all())
    return;
  fail_on_file(
      job.part.mesh,
      fmt::format("the part, {} to {}, is not inside the stock, {} to {}; a part that the stock holds was expected",
                  place_text(lo), place_text(hi), place_text(stock.min_mm()), place_text(stock.max_mm())),
      "part-outside-stock");
}

double standing_cell_mm(const removal::Stock& stock, const machine::Tool& tool) {
  const Vec3 size = stock.max_mm() - stock.min_mm();
  constexpr double kMaxCells = 2e6;
  return std::max({std::clamp(tool.diameter_mm / 40, 0.1, 0.5), std::sqrt(size.x() * size.y() / kMaxCells)});
}

/// The part as an operation needs it; kept to judge what is left in the end.
struct Tooling {
  Tooling(const TriangleMesh& part, const machine::CopyOperation& operation, const machine::Tool& tool,
          const removal::Stock& stock)
      : cut{operation, tool, removal::shape_of(tool)},
        region(operation.region, stock.min_mm().head<2>(), stock.max_mm().head<2>()),
        lowest_mm(operation.region.z_mm ? (*operation.region.z_mm)[0] : stock.min_mm().z()),
        highest_mm(operation.region.z_mm ? (*operation.region.z_mm)[1] : stock.max_mm().z()) {
    if (operation.mode == machine::CopyMode::drilling) return;
    contact.emplace(part, cut.shape, 0);
    if (operation.allowance_mm > 0) field.emplace(part, cut.shape, operation.allowance_mm);
  }
  const TipField& roughing() const { return field ? *field : *contact; }

  OperationCut cut;
  AxisRegion region;
  double lowest_mm, highest_mm;
  std::optional<TipField> contact, field;  ///< fields without and with the allowance; none for holes
};

[[noreturn]] void fail_on_no_place(const OperationCut& cut) {
  Diagnostic none = cut.operation.place;
  none.message = fmt::format(
      "T{} with a diameter of {:g} mm and an allowance of {:g} mm has no place in the region; a "
      "tool that fits between the part's walls was expected",
      cut.operation.tool, cut.tool.diameter_mm, cut.operation.allowance_mm);
  none.check = "tool-too-large";
  throw InputError({none});
}

void run_operation(const TriangleMesh& part, const Tooling& tooling, removal::Stock& stock, Runner& runner,
                   double safe_z, CopyResult& result) {
  const OperationCut& cut = tooling.cut;
  Standing standing(stock, standing_cell_mm(stock, cut.tool), stock.min_mm().z());
  bool placed = true;
  std::optional<PathDepth> depth;
  if (!tooling.contact) {
    drill_holes(cut, standing, runner, safe_z);
  } else {
    depth.emplace(*tooling.contact);
    const Workplace place{part,   cut,    tooling.roughing(), tooling.region, standing, runner,
                          *depth, safe_z, stock.min_mm().z()};
    placed = cut.operation.scallop_mm > 0 ? cut_scallops(place) : cut_levels(place);
  }
  if (!placed) fail_on_no_place(cut);
  if (runner.at()) runner.rapid({runner.at()->x(), runner.at()->y(), runner.safe_z_mm()});
  runner.end();
  if (depth && 1000 * depth->max_mm() > result.path_depth_um)
    result.path_depth_um = 1000 * depth->max_mm(), result.deepest_mm = depth->worst_mm();
  runner.summary().nothing_left = runner.summary().passes == 0;
  result.operations.push_back(runner.summary());
}

LeftMaterial judge(const TriangleMesh& part, const removal::Stock& stock,
                   const std::vector<std::unique_ptr<Tooling>>& toolings) {
  std::vector<Reach> tools;
  for (const auto& t : toolings)
    if (t->contact) tools.push_back({t->cut.shape, &*t->contact, &t->region, t->lowest_mm, t->highest_mm});
  const Vec3 size = stock.max_mm() - stock.min_mm();
  constexpr double kPointsAcross = 300;
  return left_material(part, stock, tools, std::max(2 * stock.voxel_mm(), size.maxCoeff() / kPointsAcross));
}

}  // namespace

CopyResult copy(const machine::Job& job, const std::vector<machine::CopyOperation>& operations,
                const CopyOptions& options, Diagnostics&) {
  CopyResult out;
  const TriangleMesh part = read_part(job);
  out.stock = std::make_unique<removal::Stock>(simulate::job_stock(job, kBandVoxels, [](const Vec3&, const Vec3&) {}));
  check_part_inside(job, part, *out.stock);
  out.stock->share();
  out.blank = std::make_unique<removal::Stock>(*out.stock);
  Runner runner(job, options, *out.stock);
  const double safe_z = out.stock->max_mm().z() + kAboveAll_mm;
  std::vector<std::unique_ptr<Tooling>> toolings;
  for (const machine::CopyOperation& operation : operations) {
    toolings.push_back(std::make_unique<Tooling>(part, operation, job.tools.at(operation.tool), *out.stock));
    if (options.before) options.before(toolings.size() - 1, *out.stock);
    run_operation(part, *toolings.back(), *out.stock, runner, safe_z, out);
    if (runner.stopped()) break;
  }
  runner.finish(out);
  out.left = judge(part, *out.stock, toolings);
  return out;
}

}  // namespace camber::copymill
