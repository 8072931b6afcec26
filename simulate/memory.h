#pragma once
// How much memory a job needs, before its fields are made.
#include <cstddef>
#include <optional>

#include "base/diagnostics.h"
#include "machine/job_file.h"
#include "nc/move.h"
#include "nc/program_text.h"
#include "removal/stock.h"
#include "removal/tool_path.h"

namespace camber::simulate {

/// Bytes at the stage that needs most.
struct MemoryEstimate {
  double program = 0;  ///< text, blocks, moves, plan, stamps and their loads
  double blank = 0;    ///< field of the blank, shared by all copies
  double cut = 0;  ///< what the copies have of their own: the blank with its allowance, the target, the machined stock
  double surface = 0;  ///< points of the form error
  double total() const { return program + blank + cut + surface; }
};

/// A job's stock as far as its size goes.
struct StockSize {
  Vec3 min_mm = Vec3::Zero(), max_mm = Vec3::Zero();
  double band_voxels = 0;
};

/// What the memory of a prediction depends on.
struct MemoryFactors {
  std::size_t text_bytes = 0, blocks = 0, moves = 0, stamps = 0;  ///< of the program
  Vec3 size_mm = Vec3::Zero();                                    ///< of the stock
  double band_mm = 0;
  double cut_mm2 = 0;      ///< surface that the tools make
  double at_once_mm2 = 0;  ///< of it, by the stamps that are swept together
  double table_bytes = 0;  ///< deflections of the stamps that are cut together
  bool allowance = false;
  bool flat = false;  ///< the blank's faces are, and kept once while the tool cuts (removal::Stock::share)
  // Only for a part of the prediction (a section); not given: the whole.
  std::optional<double> blank_mm2{};        ///< of the stock's surface, what has a field
  std::optional<std::size_t> own_stamps{};  ///< that have loads and cutters of the target
};

/// The area that the tools cut is taken from a coarse height map of the path (cut_area_mm2). `within` (null:
/// everywhere): where a part of the prediction has its fields.
MemoryFactors memory_factors(const machine::Job& job, const nc::Program& text, const nc::Interpretation& moves,
                             const removal::StampPath& path, const StockSize& stock,
                             const removal::Region* within = nullptr);

/// Estimates the memory of `predict`; within 30 % of the measured peak on the jobs of bench/real/memory.
MemoryEstimate estimate_memory(const MemoryFactors& factors, double voxel_mm);

/// Bytes of the distance field of a box's surface.
double field_bytes(const Vec3& size_mm, double voxel_mm, double band_voxels);

/// Area that the tools of a path cut from a box, mm^2, about.
double cut_area_mm2(const machine::Job& job, const removal::StampPath& path, const StockSize& stock);

/// [simulation] max_memory_GB, or what the machine has for this process.
double memory_limit_bytes(const machine::Job& job);

/// Error [voxel-memory], at voxel_mm or [stock], where the job needs more than the limit; says which voxel_mm would
/// fit. Returns what it needs.
MemoryEstimate check_memory(const machine::Job& job, const MemoryFactors& factors, Diagnostics& diagnostics);

}  // namespace camber::simulate
