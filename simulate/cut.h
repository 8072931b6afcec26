#pragma once
// Cutting a path: chips, forces and deflections at every stamp, and the stock that the deflected cutter leaves.
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "deflection/part_compliance.h"
#include "deflection/static_cut.h"
#include "deflection/tooth_pass.h"
#include "machine/material.h"
#include "machine/simulation_settings.h"
#include "machine/tool.h"
#include "removal/form_error.h"
#include "removal/stock.h"
#include "removal/tool_path.h"

namespace camber::removal {
struct KnownRun;
}

namespace camber::simulate {

/// The loads of one tooth passing. Forces act on the tool, in the part's axes, which are the machine's where the tool
/// is upright.
struct StampLoad {
  Vec3 force_max_N = Vec3::Zero();   ///< per component the signed value of maximum magnitude
  double lateral_max_N = 0;          ///< largest force across the tool's axis
  double axial_max_N = 0;            ///< along the tool's axis, towards the spindle; signed, of maximum magnitude
  Vec3 force_mean_N = Vec3::Zero();  ///< over the tooth passing
  Vec3 contact_deflection_mm =
      Vec3::Zero();     ///< at the height of the contact, at the instant at which an edge passes it
  double chip_mm3 = 0;  ///< volume of the chips
  double torque_max_Nmm = 0, torque_mean_Nmm = 0;  ///< over the tooth passing
  double work_Nmm = 0;                             ///< work work of the spindle over the tooth passing
  double chip_max_mm = 0;                          ///< thickest chip
  double chip_area_mm2 = 0;                        ///< chip_mm3 over it is the mean thickness
  double deflection_max_mm = 0;                    ///< of the tip, at any rotation step
  deflection::ChipArc arc;                         ///< where the chips are around the tool
};

/// P = M 2 pi n / 60.
constexpr double power_W(double torque_mean_Nmm, double spindle_speed_rpm) {
  return torque_mean_Nmm / 1000 * 2 * kPi * spindle_speed_rpm / 60;
}

/// Contact point: where the envelope generates the surface.
struct Contact {
  double height_mm = 0;
  double angle_rad = 0;
};

struct CutOptions {
  machine::Coupling coupling = machine::Coupling::static_;
  double envelope_step_mm = 0.1;
  double rotation_step_rad = kPi / 180;
  std::size_t stretch_stamps = 400;         ///< stamps in memory at a time, static
  std::size_t rigid_stretch_stamps = 1500;  ///< stamps in memory at a time, rigid
  int max_rounds = 40;                      ///< maximum iterations of one tooth passing
  double edge_ramp_mm = 0.002;              ///< static only, see edge_force
  double settle_um = 0.1;                   ///< see SettleOptions
  double settle_fraction = 0.01;
  std::size_t longest_gap = deflection::ReadingPace::kLongest;  ///< see SettleOptions
  Vec3 axis_compliance_mm_per_N = Vec3::Zero();                 ///< of the machine's axes
  bool drilling = false;  ///< straight down: see simulate/holes.h; with rigid coupling
  /// Static: NoRest is thrown after so many readings without an equilibrium, where they are kHopeless of all that cut
  /// so far. One of thousands of chips counts as several.
  std::size_t give_up_after = std::numeric_limits<std::size_t>::max();
  std::function<void(double)> progress;    ///< completed fraction, 0 to 1
  const removal::Stock* blank = nullptr;   ///< copy of the uncut stock if available; saves a copy
  removal::SurfaceMap* surface = nullptr;  ///< takes the marks of the deflected cutter, if given
  /// How the part yields along the run; null: it does not.
  const deflection::PartCompliance* part = nullptr;
  /// Takes the marks of the same cutter without the part's deflection, if given.
  removal::SurfaceMap* tool_surface = nullptr;
  /// First stamp of a revolution whose forces are recorded tooth by tooth in CutResult::turn.
  std::optional<std::size_t> turn_from;
  /// Rigid only, not 0: the loads for chips of this ratio to their thickness are recorded as well, as another feed of
  /// the same path would take them.
  double chip_ratio = 0;
  const removal::KnownRun* known = nullptr;  ///< of the stamps of the run, where they are one (removal/known_run.h)
};

/// How the tool was bent while it cut the stamps before others, static coupling.
struct BendBefore {
  std::vector<float> rows;  ///< of removal::DeflectionTable, of the last stamps, kRows at most
  double largest_mm = 0;    ///< of all
  static constexpr std::size_t kRows = 4;
};

struct CutResult {
  std::vector<StampLoad> loads;                   ///< one per stamp
  std::vector<StampLoad> loads_at_ratio;          ///< one per stamp; empty without CutOptions::chip_ratio
  double chip_mm3 = 0;                            ///< sum over the chips
  double stock_mm3 = 0;                           ///< change of the stock that engagement reads
  double rapid_mm3 = 0;                           ///< of it: allowance that rapids end in, without chips; see judge()
  std::size_t read = 0;                           ///< tooth passings whose chips were read from the stock
  deflection::ReadingPace::Errors extrapolation;  ///< static: of the deflections of the others
  int rounds_max = 0;                             ///< of the static solution: readings of a tooth passing's chips
  std::size_t unsettled = 0;                      ///< stretches of tooth passings without a static equilibrium
  std::vector<std::uint32_t> unsettled_moves;     ///< their Stamp::move, without consecutive repetitions
  std::vector<std::uint32_t> unsettled_stamps;    ///< all of their passings: indices of `loads`
  std::vector<deflection::NoEquilibrium> unsettled_reasons;  ///< of the first passing of each
  std::vector<std::uint32_t> beyond_stamps;  ///< with a deflection beyond the model's range: indices of `loads`
  double deflection_max_mm = 0;              ///< of the edge at the tip, in any tooth passing
  double deflection_limit_mm = 0;            ///< smallest limit among those exceeded
  BendBefore bend;                           ///< static: at the end
  deflection::TurnForces turn;               ///< empty without CutOptions::turn_from
  double milled_mm3() const { return stock_mm3 - rapid_mm3; }  ///< what chips describe
};

/// Thrown where a cut is given up: the tool comes to rest in hardly any tooth passing.
struct NoRest {
  static constexpr double kHopeless = 0.7;
  std::size_t unsettled = 0, readings = 0;  ///< readings: those that cut
  std::uint32_t move = 0;                   ///< Stamp::move of the first one
  deflection::NoEquilibrium reason = deflection::NoEquilibrium::swings;
};

/// Cuts `stock`: with the deflected cutter, or in rigid coupling (no feedback of the deflection) with the undeflected
/// one; the surface of the deflected cutter is then only in `surface`. `contacts` (one per stamp, or empty) is used
/// only for StampLoad::contact_deflection_mm. Stamp ids in the stock are first_id + index.
CutResult cut(removal::Stock& stock, const machine::Tool& tool, const machine::Material& material,
              std::span<const removal::Stamp> stamps, std::span<const Contact> contacts, std::int32_t first_id,
              const CutOptions& options);

/// Cuts `stock` with the undeflected cutter, reduced by shrink_mm along its normal. Returns the volume removed, mm^3.
double sweep(removal::Stock& stock, const machine::Tool& tool, std::span<const removal::Stamp> stamps,
             std::int32_t first_id, double shrink_mm);

/// The contact of every stamp with a target surface: of the points at which the envelope moves tangentially
/// (f . n = 0), the middle of the points deepest in the target, within 1 um.
std::vector<Contact> find_contacts(const removal::Stock& target, const machine::Tool& tool,
                                   std::span<const removal::Stamp> stamps);

}  // namespace camber::simulate
