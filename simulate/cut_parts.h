#pragma once
// One tool that cuts one stock, in parts: the tool (CutTool), how its chips become loads and deflections (Coupling),
// and what the deflected cutter leaves (Marks). Internal to simulate/cut.cpp, which puts them together.
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "deflection/run_out_offsets.h"
#include "deflection/tooth_pass.h"
#include "removal/deflection_table.h"
#include "simulate/cut.h"

namespace camber::simulate {

/// The tool with its envelope and its model.
struct CutTool {
  CutTool(removal::Stock& stock, const machine::Tool& tool, const machine::Material& material,
          std::span<const removal::Stamp> stamps, const CutOptions& options);
  CutTool(const CutTool&) = delete;

  /// Passing k is of the revolution whose forces are recorded.
  bool in_turn(std::size_t k) const {
    return options.turn_from && k >= *options.turn_from &&
           k < *options.turn_from + static_cast<std::size_t>(envelope.flutes);
  }
  void keep_turn(std::span<const removal::ChipSample> chips, std::span<const removal::Stamp> all, std::size_t k,
                 CutResult& result) const;

  removal::Stock& stock;
  const CutOptions& options;
  bool rigid;
  std::optional<removal::Stock> own_blank;
  const removal::Stock* blank;  ///< before the first stamp
  double diameter_mm, edges_end_mm, top_mm;
  removal::EnvelopeGrid envelope;
  deflection::ToothPassModel model;
  std::optional<deflection::ToothMarks> tooth_marks;  ///< of teeth that are not even
  deflection::RunOutOffsets run_out;                  ///< static: of equally spaced teeth
  std::size_t different_teeth = 1;                    ///< of which each takes another chip
};

/// Stamps from ... of all, which are cut together, their deflections and their loads (one per stamp).
struct CutStretch {
  std::span<const removal::Stamp> all;
  std::size_t from = 0;
  std::int32_t first_id = 0;  ///< of all[0]
  removal::DeflectionTable& deflections;
  std::vector<StampLoad>& loads;

  std::span<const removal::Stamp> stamps() const { return all.subspan(from, loads.size()); }
  std::int32_t id() const { return first_id + static_cast<std::int32_t>(from); }
};

/// Cuts stretch after stretch.
class Coupling {
 public:
  virtual ~Coupling() = default;
  /// Fills deflections and loads of the stretch; `before`: of the stamps before it.
  virtual void cut(const CutStretch& stretch, const BendBefore& before, CutResult& result) = 0;
  /// Leaves the stock as cut. Returns the volume removed, mm^3.
  virtual double commit() = 0;
};

/// Deflections straight from the chips of the undeflected cutter.
std::unique_ptr<Coupling> rigid_coupling(const CutTool& tool);
/// Each tooth passing is brought to its static equilibrium.
std::unique_ptr<Coupling> static_coupling(const CutTool& tool);

/// What a cutter leaves.
class Marks {
 public:
  virtual ~Marks() = default;
  /// Marks the surface (null: none) and fills StampLoad::contact_deflection_mm at the contacts (one per stamp, or
  /// empty).
  virtual void leave(const CutStretch& stretch, std::span<const Contact> contacts,
                     removal::SurfaceMap* surface) const = 0;
};

/// Makes the marks of even teeth, of uneven teeth, or of a drill.
std::unique_ptr<Marks> marks_of(const CutTool& tool);

}  // namespace camber::simulate
