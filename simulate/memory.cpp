#include "simulate/memory.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "base/process_memory.h"
#include "deflection/tooth_pass.h"
#include "removal/cutter.h"
#include "removal/form_error.h"
#include "simulate/cut.h"
#include "simulate/pieces.h"

namespace camber::simulate {
namespace {

using machine::Job;

/// The lowest height that the path leaves, in square cells over the stock.
class HeightMap {
 public:
  HeightMap(const StockSize& stock, double cell_mm)
      : lo_(stock.min_mm), hi_(stock.max_mm), cell_mm_(cell_mm), columns_(cells(0)), rows_(cells(1)) {
    height_.assign(columns_ * rows_, hi_.z());
  }

  void cut(const removal::CutterShape& shape, const Vec3& tip) {
    const double r = shape.radius_mm;
    const std::size_t x1 = index(tip.x() + r, 0, columns_), y1 = index(tip.y() + r, 1, rows_);
    for (std::size_t i = index(tip.x() - r, 0, columns_); i <= x1; ++i)
      for (std::size_t j = index(tip.y() - r, 1, rows_); j <= y1; ++j) {
        const double rho = (centre(i, j) - tip.head<2>()).norm();
        double& h = height_[i * rows_ + j];
        if (rho <= r) h = std::min(h, std::max(lo_.z(), tip.z() + bottom_mm(shape, rho)));
      }
  }

  /// Returns the area of the surface where it is lower than the stock's top.
  double cut_area_mm2() const {
    double area = 0;
    for (std::size_t i = 0; i < columns_; ++i)
      for (std::size_t j = 0; j < rows_; ++j) {
        const double h = at(i, j), dx = at(std::min(i + 1, columns_ - 1), j) - h,
                     dy = at(i, std::min(j + 1, rows_ - 1)) - h;
        if (h >= hi_.z() && dx == 0 && dy == 0) continue;
        const double flat = h < hi_.z() ? cell_mm_ : 0;
        area += cell_mm_ * std::sqrt(flat * flat + dx * dx + dy * dy);
      }
    return area;
  }

 private:
  std::size_t cells(int axis) const {
    return static_cast<std::size_t>(std::max(1.0, std::ceil((hi_[axis] - lo_[axis]) / cell_mm_)));
  }
  std::size_t index(double place, int axis, std::size_t count) const {
    return static_cast<std::size_t>(
        std::clamp(std::floor((place - lo_[axis]) / cell_mm_), 0.0, static_cast<double>(count - 1)));
  }
  Vec2 centre(std::size_t i, std::size_t j) const {
    return {lo_.x() + (static_cast<double>(i) + 0.5) * cell_mm_, lo_.y() + (static_cast<double>(j) + 0.5) * cell_mm_};
  }
  double at(std::size_t i, std::size_t j) const { return height_[i * rows_ + j]; }
  static double bottom_mm(const removal::CutterShape& shape, double rho_mm) {
    if (shape.general) return 0;
    const double c = shape.corner_radius_mm, around = std::max(0.0, rho_mm - shape.bottom_length_mm());
    return c - std::sqrt(std::max(0.0, c * c - around * around));
  }

  Vec3 lo_, hi_;
  double cell_mm_;
  std::size_t columns_, rows_;
  std::vector<double> height_;
};

/// The stamps of a run that are in memory.
std::vector<std::span<const removal::Stamp>> kept_of(const motion::PathStretch& path, const removal::ToolRun& run) {
  std::vector<std::span<const removal::Stamp>> out;
  for (const ListRange& range : path.kept_in(run.from, run.count))
    out.push_back(path.stamps_of(run).subspan(range.from, range.end - range.from));
  return out;
}

double cell_of(const Job& job, const motion::PathStretch& path, const StockSize& stock) {
  constexpr double kVoxels = 16, kOfRadius = 0.25, kOfStock = 1e-3;
  const Vec3 size = stock.max_mm - stock.min_mm;
  double cell = std::max(kVoxels * job.simulation.voxel_mm, kOfStock * std::max(size.x(), size.y()));
  for (const auto& run : path.runs) cell = std::max(cell, kOfRadius * job.tools.at(run.tool).diameter_mm / 2);
  return cell;
}

constexpr double kLeaf = 8;
constexpr double kBytesPerVoxel = 1.3 * sizeof(float);  // with masks, inner nodes and what malloc adds

/// Voxels across the band, in whole leaves.
double thickness(double band_voxels) { return 2 * band_voxels - 1 + kLeaf - 1; }

double cut_area_of(const Job& job, const motion::PathStretch& path, const StockSize& stock) {
  const double cell = cell_of(job, path, stock);
  HeightMap map(stock, cell);
  for (const auto& run : path.runs) {
    const removal::CutterShape shape = removal::shape_of(job.tools.at(run.tool));
    for (const auto& stamps : kept_of(path, run)) {
      std::optional<Vec3> last;
      for (std::size_t k = 0; k < stamps.size(); ++k) {
        const Vec3& tip = stamps[k].pose.tip_mm;
        if (last && k + 1 < stamps.size() && (tip - *last).norm() < cell / 2) continue;
        map.cut(shape, tip);
        last = tip;
      }
    }
  }
  return map.cut_area_mm2();
}

}  // namespace

double cut_area_mm2(const Job& job, const removal::StampPath& path, const StockSize& stock) {
  return cut_area_of(job, path, stock);
}

namespace {

double box_mm2(const Vec3& size) { return 2 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x()); }

double bytes_of_surface(double mm2, double voxel, double band_voxels) {
  return kBytesPerVoxel * mm2 / (voxel * voxel) * thickness(band_voxels);
}

/// The part of a stock in a region.
StockSize clipped(const StockSize& stock, const removal::Region& region) {
  StockSize out = stock;
  out.min_mm = stock.min_mm.cwiseMax(region.min_mm).cwiseMin(stock.max_mm);
  out.max_mm = stock.max_mm.cwiseMin(region.max_mm).cwiseMax(out.min_mm);
  return out;
}

/// Returns the area of a box's faces that lies in another box within it.
double faces_mm2(const StockSize& box, const StockSize& part) {
  const Vec3 size = part.max_mm - part.min_mm;
  double out = 0;
  for (int a = 0; a < 3; ++a) {
    const double face = size[(a + 1) % 3] * size[(a + 2) % 3];
    out += face * ((part.min_mm[a] <= box.min_mm[a] ? 1 : 0) + (part.max_mm[a] >= box.max_mm[a] ? 1 : 0));
  }
  return out;
}

}  // namespace

double field_bytes(const Vec3& size, double voxel, double band_voxels) {
  return bytes_of_surface(box_mm2(size), voxel, band_voxels);
}

namespace {

/// The tiles that stamps swept together change are in memory until all of them are cut.
double swept_at_once_mm2(const Job& job, const motion::PathStretch& path, double cut_mm2) {
  constexpr double kAtOnce = 10000;
  double most = 0;
  for (const auto& run : path.runs) {
    double way = 0;
    std::size_t count = 0;
    for (const auto& stamps : kept_of(path, run)) {
      for (std::size_t k = 1; k < stamps.size(); ++k) way += (stamps[k].pose.tip_mm - stamps[k - 1].pose.tip_mm).norm();
      count += stamps.size();
    }
    const double length = count == 0 ? 0 : way * std::min(1.0, kAtOnce / static_cast<double>(count));
    most = std::max(most, length * job.tools.at(run.tool).diameter_mm);
  }
  return std::min(cut_mm2, most);
}

double table_bytes(const Job& job, const motion::PathStretch& path, const StockSize& stock) {
  const bool rigid = job.simulation.coupling == machine::Coupling::rigid;
  const CutOptions options;
  const std::size_t stretch = rigid ? options.rigid_stretch_stamps : options.stretch_stamps;
  double most = 0;
  for (const auto& run : path.runs) {
    const machine::Tool& tool = job.tools.at(run.tool);
    double lowest = stock.max_mm.z();
    for (const auto& stamps : kept_of(path, run))
      for (const removal::Stamp& stamp : stamps) lowest = std::min(lowest, stamp.pose.tip_mm.z());
    const double flutes = std::min(tool.overhang_mm, tool.flute_length_mm.value_or(tool.overhang_mm));
    const double top = std::clamp(stock.max_mm.z() - lowest, 0.0, flutes);
    const auto nodes = static_cast<double>(deflection::node_heights(top, flutes).size());
    const double steps = 2 * kPi / job.simulation.rotation_step_rad / tool.flutes * (rigid ? deflection::kFine : 1);
    most = std::max(most, static_cast<double>(std::min(stretch, run.count)) * steps * nodes * 2 * sizeof(float));
  }
  return most;
}

}  // namespace

MemoryFactors memory_factors(const Job& job, const nc::Program& text, const nc::Interpretation& moves,
                             const removal::StampPath& path, const StockSize& stock, const removal::Region* within) {
  return memory_factors(job, text, moves, motion::PathStretch(path), stock, within);
}

MemoryFactors memory_factors(const Job& job, const nc::Program& text, const nc::Interpretation& moves,
                             const motion::PathStretch& path, const StockSize& stock, const removal::Region* within) {
  const StockSize part = within ? clipped(stock, *within) : stock;
  const double cut = cut_area_of(job, path, part);
  std::size_t stamps = 0, own = 0;
  for (const auto& run : path.runs)
    for (const auto& kept : kept_of(path, run)) {
      stamps += kept.size();
      if (within)
        own += static_cast<std::size_t>(std::ranges::count_if(
            kept, [&](const removal::Stamp& stamp) { return within->contains(stamp.pose.tip_mm); }));
    }
  MemoryFactors out{.text_bytes = text.source.text().size(),
                    .blocks = text.blocks.size(),
                    .moves = moves.moves.size(),
                    .stamps = stamps,
                    .size_mm = stock.max_mm - stock.min_mm,
                    .band_mm = stock.band_voxels * job.simulation.voxel_mm,
                    .cut_mm2 = cut,
                    .at_once_mm2 = swept_at_once_mm2(job, path, cut),
                    .table_bytes = table_bytes(job, path, stock),
                    .allowance = job.stock.allowance_mm > 0,
                    .flat = job.stock.box.has_value()};
  if (!within) return out;
  out.blank_mm2 = faces_mm2(stock, part);
  out.own_stamps = own;
  return out;
}

MemoryEstimate estimate_memory(const MemoryFactors& f, double voxel_mm) {
  constexpr double kAlways = 80e6, kBytesPerBlock = 112, kBytesPerMove = 80 + 48;  // with the plan
  constexpr double kPointsPerVoxel = 1.2, kGroups = 12, kMinBand = 4, kTilesDeep = 2;
  constexpr double kTileSide = 16, kTileBytes = 17 * 17 * 17 * 8;  // voxels; with one more layer, distance and stamp
  const auto stamps = static_cast<double>(f.stamps), own = static_cast<double>(f.own_stamps.value_or(f.stamps));
  const double given = kAlways + static_cast<double>(f.text_bytes) + kBytesPerBlock * static_cast<double>(f.blocks) +
                       kBytesPerMove * static_cast<double>(f.moves) + sizeof(removal::Stamp) * stamps;
  const double band = std::max(kMinBand, f.band_mm / voxel_mm), voxel_mm2 = voxel_mm * voxel_mm;
  const double distance = kBytesPerVoxel * f.cut_mm2 / voxel_mm2 * thickness(band);
  const double tiles = kTilesDeep * kTileBytes * f.at_once_mm2 / voxel_mm2 / (kTileSide * kTileSide);
  const double points = kPointsPerVoxel * f.cut_mm2 / voxel_mm2;
  const double blank = bytes_of_surface(f.blank_mm2.value_or(box_mm2(f.size_mm)), voxel_mm, band),
               allowance = f.allowance ? distance : 0;
  constexpr double kOfFlat = 0.02;  // of the leaves along edges, and numbers in place of the others
  const double kept = f.flat ? kOfFlat * blank : blank;
  const double loads = (sizeof(StampLoad) + sizeof(Contact)) * own, map_points = sizeof(removal::SurfacePoint) * points;
  // The blank is made; the target is cut; the points of the map are put together; the program is cut, with its loads;
  // the stock is written.
  const MemoryEstimate made{given, blank, 0, 0};
  const MemoryEstimate target{given + sizeof(removal::Stamp) * own, kept, allowance + 2 * distance + tiles, 0};
  const MemoryEstimate map{given + sizeof(Vec3) * own, kept, allowance + 2 * distance, 1.125 * map_points};
  const MemoryEstimate cut{given + f.table_bytes + loads, kept, 2 * distance, map_points + kGroups * points};
  const MemoryEstimate written{given + loads, blank, distance, map_points};
  return std::max({made, target, map, cut, written},
                  [](const auto& a, const auto& b) { return a.total() < b.total(); });
}

double memory_limit_bytes(const Job& job) {
  if (job.simulation.max_memory_GB) return 1e9 * *job.simulation.max_memory_GB;
  return free_memory_bytes() + used_memory_bytes();
}

MemoryEstimate check_memory(const Job& job, const MemoryFactors& factors, Diagnostics& diagnostics) {
  const double voxel = job.simulation.voxel_mm, limit = memory_limit_bytes(job);
  const MemoryEstimate out = estimate_memory(factors, voxel);
  if (out.total() <= limit) return out;
  constexpr double kStep = 1.25, kRoom = 0.9;
  const Vec3& size = factors.size_mm;
  double enough = voxel;
  while (enough < size.minCoeff() && estimate_memory(factors, enough).total() > kRoom * limit) enough *= kStep;
  const std::string other = enough < size.minCoeff() ? fmt::format("voxel_mm = {:.2g} or a smaller stock", enough)
                                                     : "a shorter program or more memory";
  Diagnostic said = job.voxel_place;
  said.severity = Severity::error;
  if (said.location.file.empty()) said.location.file = job.path;
  said.message = fmt::format(
      "voxel_mm = {:g} needs about {:.3g} GB for a stock of {:.0f} x {:.0f} x {:.0f} mm and {} tooth passings, but "
      "{:.3g} GB are {}; {} was expected",
      voxel, out.total() / 1e9, size.x(), size.y(), size.z(), factors.stamps, limit / 1e9,
      job.simulation.max_memory_GB ? "allowed (max_memory_GB)" : "available", other);
  said.check = "voxel-memory";
  diagnostics.add(std::move(said));
  return out;
}

}  // namespace camber::simulate
