#include "posture/posture_program.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/triangle_mesh.h"
#include "removal/stock.h"
#include "simulate/job_stock.h"
#include "simulate/predict_path.h"

namespace camber::posture {
namespace {

constexpr double kFieldVoxel_mm = 0.25, kVoxelsAcross = 20;  ///< voxels across the smallest tool
constexpr double kBandVoxels = 3;
constexpr int kFaces = 48;  ///< faces of a cylinder
constexpr std::size_t kMaxFaces = 400000;

using Triangle = std::array<Vec3, 3>;

/// The prism about a cylinder.
std::vector<Triangle> prism(const machine::Cylinder& cylinder) {
  const double radius = cylinder.diameter_mm / 2 / std::cos(kPi / kFaces);
  const Vec3 &base = cylinder.base_mm, up(0, 0, cylinder.height_mm);
  std::vector<Triangle> out;
  for (int i = 0; i < kFaces; ++i) {
    const auto corner = [&](int k) -> Vec3 {
      const double angle = 2 * kPi * k / kFaces;
      return base + radius * Vec3(std::cos(angle), std::sin(angle), 0);
    };
    const Vec3 a = corner(i), b = corner(i + 1);
    out.insert(out.end(), {{base, a, b}, {base + up, a + up, b + up}, {a, b, b + up}, {a, b + up, a + up}});
  }
  return out;
}

/// A square across every crossing of a grid line with the surface.
std::vector<Triangle> faces_of(const removal::Stock& stock) {
  const Vec3 size = stock.max_mm() - stock.min_mm();
  const double area = 2 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
  // Three lines cross a slope where one crosses a face along the grid.
  const auto wanted = static_cast<std::size_t>(3 * area / (kStockCell_mm * kStockCell_mm));
  const removal::StockShape shape = removal::stock_shape(stock, std::clamp<std::size_t>(wanted, 1, kMaxFaces));
  std::vector<Triangle> out;
  for (const removal::StockCrossing& crossing : shape.crossings) {
    Eigen::Index axis = 0;
    crossing.outward.cwiseAbs().maxCoeff(&axis);
    const Vec3 a = shape.cell_mm / 2 * Vec3::Unit((axis + 1) % 3), b = shape.cell_mm / 2 * Vec3::Unit((axis + 2) % 3);
    const Vec3& p = crossing.place_mm;
    out.push_back({p - a - b, p + a - b, p + a + b});
    out.push_back({p - a - b, p + a + b, p - a + b});
  }
  return out;
}

/// The stamps before a block.
removal::StampPath before_block(const simulate::SimulatedProgram& program, std::uint32_t first) {
  removal::StampPath out = program.path;
  const auto end = std::find_if(out.stamps.begin(), out.stamps.end(), [&](const removal::Stamp& stamp) {
    return program.moves_in_part().moves[stamp.move].block >= first;
  });
  const auto count = static_cast<std::size_t>(end - out.stamps.begin());
  out.stamps.resize(count);
  std::erase_if(out.runs, [&](const removal::ToolRun& run) { return run.from >= count; });
  if (!out.runs.empty()) out.runs.back().count = std::min(out.runs.back().count, count - out.runs.back().from);
  return out;
}

bool cuts_before(const nc::Interpretation& moves, std::size_t first) {
  return std::any_of(moves.moves.begin(), moves.moves.begin() + static_cast<std::ptrdiff_t>(first),
                     [](const auto& m) { return m.kind != nc::MoveKind::rapid && m.kind != nc::MoveKind::dwell; });
}

void add_cut_stock(machine::Job job, const nc::Program& program, std::uint32_t first, Surroundings& out,
                   Diagnostics& diagnostics) {
  const simulate::SimulatedProgram simulated = motion::simulate_motion(program.source, job, {}, diagnostics);
  diagnostics.throw_if_errors();
  if (job.stock.vdb.empty()) {
    double voxel = kFieldVoxel_mm;
    for (const auto& [number, tool] : job.tools) voxel = std::min(voxel, tool.diameter_mm / kVoxelsAcross);
    job.simulation.voxel_mm = std::max(job.simulation.voxel_mm, voxel);
  }
  removal::Stock stock = simulate::job_stock(job, kBandVoxels, [](const Vec3&, const Vec3&) {});
  if (job.stock.allowance_mm > 0)
    simulate::sweep_path(stock, job, simulated.path, job.stock.allowance_mm, "cutting up to the allowance");
  simulate::sweep_path(stock, job, before_block(simulated, first), 0, "cutting what earlier tools cut");
  out.add(faces_of(stock), Obstacle::stock);
}

}  // namespace

void add_stock(const machine::Job& job, const nc::Program& program, const nc::Interpretation& moves, std::size_t first,
               Surroundings& out, Diagnostics& diagnostics) {
  const machine::StockDescription& stock = job.stock;
  if (!stock.box && !stock.cylinder && stock.mesh.empty() && stock.vdb.empty()) return;
  if (stock.allowance_mm > 0 || !stock.vdb.empty() || cuts_before(moves, first))
    add_cut_stock(job, program, moves.moves[first].block, out, diagnostics);
  else if (stock.box)
    out.add_box(stock.box->min_mm, stock.box->max_mm, Obstacle::stock);
  else if (stock.cylinder)
    out.add(prism(*stock.cylinder), Obstacle::stock);
  else
    out.add(read_mesh(stock.mesh), Vec3::Zero(), Obstacle::stock);
}

}  // namespace camber::posture
