#pragma once
// The loads of a tool whose path is made while it cuts: tooth passing after tooth passing, and a look at the next ones.
#include <cstdint>
#include <memory>
#include <span>

#include "machine/material.h"
#include "machine/tool.h"
#include "removal/engagement.h"
#include "removal/stock.h"
#include "removal/tool_path.h"
#include "simulate/cut.h"
#include "simulate/force_regions.h"

namespace camber::simulate {

struct LoadProbeOptions {
  double envelope_step_mm = 0.1;  ///< as CutOptions
  double rotation_step_rad = kPi / 180;
  Vec3 axis_compliance_mm_per_N = Vec3::Zero();
  std::int32_t first_id = 0;  ///< of the stamps in the stock: that of the run before, next_id()
  bool drilling = false;      ///< straight down: see simulate/holes.h
  bool deflections = true;    ///< StampLoad::deflection_max_mm is told
  /// Known to ProbedLoad::felt alone; must outlive the probe.
  const ForceRegions* regions = nullptr;
};

struct ProbedLoad {
  StampLoad felt;                   ///< with the factors of the regions, chip by chip: what a sensor would tell
  StampLoad expected;               ///< without them: what the model tells of the same chips
  Vec3 chips_at_mm = Vec3::Zero();  ///< their middle, by thickness
};

/// Cuts with the undeflected cutter: the loads are those of simulate::cut in rigid coupling where it reads every tooth
/// passing, and so is the stock. One tool, upright, in one operation; for one thread.
class LoadProbe {
 public:
  /// `tips`: where the tool may stand; its lowest place decides how far up the flutes chips are looked for. Copies the
  /// stock as the operation's blank.
  LoadProbe(removal::Stock& stock, const machine::Tool& tool, const machine::Material& material,
            const removal::TipBox& tips, const LoadProbeOptions& options);
  ~LoadProbe();

  /// The loads of consecutive tooth passings, each in the stock as those before it left it, and then cut. Results do
  /// not depend on how stamps are divided among calls. Valid until the next call.
  std::span<const ProbedLoad> append(std::span<const removal::Stamp> stamps);
  /// What the model tells of a stamp that might come next, or somewhat later along the path; nothing is cut. The load
  /// grows with Stamp::feed_per_tooth_mm.
  StampLoad look(const removal::Stamp& stamp);
  struct Look {
    StampLoad at_feed, at_half;
    Vec3 chips_at_mm = Vec3::Zero();  ///< their middle, by thickness
  };
  /// The same at the stamp's feed and at half of it.
  Look look_at_two_feeds(const removal::Stamp& stamp);
  /// Reads what the stock has around a place before a tooth passing needs it (StepEngager::approach).
  void approach(const Vec3& tip_mm, int most);
  /// Returns Stock::distance_mm of the stock as it stands.
  double distance_mm(const Vec3& place_mm) const;
  /// Writes what is pending to the stock and goes on. Returns the volume removed since the last time, mm^3.
  double flush();
  std::int32_t next_id() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace camber::simulate
