#pragma once
// A job: program, machine, tools, material, stock and settings. Read from job.toml.
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/geometry.h"
#include "machine/features.h"
#include "machine/machine.h"
#include "machine/material.h"
#include "machine/mode.h"

namespace camber::machine {

enum class ToolType { ball, flat, bull, drill, tapered_ball, chamfer, general };

/// One segment of a holder: a cylinder or a cone about the axis.
struct HolderPart {
  double lower_diameter_mm = 0, upper_diameter_mm = 0, length_mm = 0;
};

struct Tool {
  int number = 0;
  ToolType type = ToolType::ball;
  double diameter_mm = 0;
  double corner_radius_mm = 0;                            ///< bull, general
  double tip_diameter_mm = 0;                             ///< chamfer: of the flat at the tip; 0: a point
  double point_angle_rad = 0;                             ///< chamfer, drill: between opposite sides of the cone
  double taper_rad = 0;                                   ///< tapered_ball, general: between the wall and the axis
  double bottom_angle_rad = 0;                            ///< general: the bottom rises by this towards the outside
  double corner_centre_r_mm = 0, corner_centre_z_mm = 0;  ///< general: centre of the corner's arc
  int flutes = 2;
  double helix_rad = 0;
  std::vector<double>
      pitch_rad;         ///< pitch angles from each tooth to the next, in the order in which they cut; empty: equal
  double runout_mm = 0;  ///< offset of the cutter axis from the spindle axis
  double runout_angle_rad = 0;            ///< from tooth 1 to the run-out, against the rotation
  double overhang_mm = 0;                 ///< holder face to tip
  std::optional<double> flute_length_mm;  ///< not given: the whole overhang is fluted
  double typical_flute_mm = 0;            ///< without flute_length_mm: of the part that bends as fluted; 0: all of it
  double neck_diameter_mm = 0;            ///< 0: no neck
  double neck_length_mm = 0;              ///< from the flutes up
  double shank_diameter_mm = 0;           ///< 0: as the cutter
  std::vector<HolderPart> holder;         ///< from the holder's face up
  bool shear = false;                     ///< include shear deflection (Timoshenko)
  double effective_diameter_ratio = 0.8;  ///< bending diameter of the fluted part / diameter
  double youngs_modulus_MPa = 600000;
  double root_stiffness_N_per_mm = kNoLimit;                ///< lateral, holder and spindle
  double root_axial_stiffness_N_per_mm = kNoLimit;          ///< along the axis, holder and spindle
  double root_rotational_stiffness_Nmm_per_rad = kNoLimit;  ///< about the axes across the tool, at the holder face
  std::optional<double> axial_stiffness_N_per_mm{};  ///< stiffness of the tool along its axis; empty: by its geometry
  std::vector<std::string> typical{};         ///< keys that nobody gave, with the typical values that stand for them
  std::optional<double> density_kg_per_m3{};  ///< not given: by the modulus (dynamics/beam_modes.h)
  std::vector<Mode> modes{};                  ///< measured at the tip; empty: those of its beam
};

struct Box {
  Vec3 min_mm = Vec3::Zero(), max_mm = Vec3::Zero();
};

/// Upright.
struct Cylinder {
  Vec3 base_mm = Vec3::Zero();  ///< middle of the lower face
  double diameter_mm = 0, height_mm = 0;
};

/// The part as an elastic body.
struct Workpiece {
  double youngs_modulus_MPa = 0;
  double poisson_ratio = 0.33;
  bool fixed_bottom = true;                      ///< held at the lowest level of the stock
  std::vector<Box> fixed_boxes;                  ///< held inside
  std::string fixed_mesh;                        ///< STL: held inside; empty: none
  double fixture_stiffness_N_per_mm = kNoLimit;  ///< stiffness of all that holds it, in every direction
  double cell_mm = 0;                            ///< cells of its elastic model; 0: chosen (simulate/part_survey.h)
  Diagnostic place;  ///< an error without a message where `fixed` stands, or else [workpiece]
};

/// One of box, cylinder, mesh, vdb.
struct StockDescription {
  std::optional<Box> box;
  std::optional<Cylinder> cylinder;
  std::string mesh;         ///< STL path; empty: none
  std::string vdb;          ///< stock.vdb of another job; empty: none
  double allowance_mm = 0;  ///< > 0: the blank was already cut by this program with the cutter reduced by this much
};

/// Selection of moves to simulate, compensate or judge: moves that match every given criterion; none given: all.
struct Operations {
  std::vector<int> tools;
  std::vector<std::array<int, 2>> blocks;  ///< 1-based line ranges, inclusive
  std::string comments;                    ///< regular expression (ECMAScript, case-insensitive); empty: not given
  bool given() const { return !tools.empty() || !blocks.empty() || !comments.empty(); }
};

struct Part {
  std::string mesh;                      ///< STL; empty: none
  std::string program;                   ///< NC program that is the target; empty: the job's own
  std::optional<Operations> operations;  ///< operations of the target program; not given: the job's operations
  std::optional<Operations> judged;      ///< moves of the target program whose surface is judged; not given: all
};

enum class Coupling { rigid, static_ };
/// Severity of a rapid through material, or of a shank or holder in stock.
enum class Collisions { error, warning, off };

struct Simulation {
  double voxel_mm = 0.1;
  Coupling coupling = Coupling::static_;
  std::optional<Collisions> collisions;  ///< not given: error; a warning where moves of the program are left out
  double rotation_step_rad = kPi / 180.0;
  double envelope_step_mm = 0;  ///< sample spacing along the profile; 0: chosen for the tool (simulate/predict.h)
  std::optional<double> max_memory_GB;  ///< not given: what the machine has (simulate/memory.h)
};

/// The error that compensation corrects and judges.
enum class Reference {
  commanded,  ///< error_um: against the programmed path
  machine     ///< deflection_um: servo lag and corner rounding are not corrected
};

/// Part of a program that a compensation may change.
enum class Lever : std::uint8_t {
  shift,  ///< points of the path
  feed,   ///< F words, where the error that no shift takes away exceeds the tolerance
  passes  ///< runs of cuts that are made twice, where it does
};

/// Where the rounds of a compensation end.
enum class Goal : std::uint8_t {
  best,      ///< at the least error: where a round lowers the 95th percentile by no more than a tenth
  tolerance  ///< where what a shift can still correct is small against the tolerance
};

struct CompensationSettings {
  double tolerance_um = 1.0;
  Goal goal = Goal::best;
  Reference reference = Reference::commanded;
  std::optional<std::array<double, 2>> profile_um;  ///< band of the finished surface; not given: tolerance_um
  double max_shift_mm = 0.1;
  int max_rounds = 8;
  double max_overcut_um = 0;  ///< maximum gouge depth, with the predicted deflection; 0: not given
  /// Depth limit of the job; not given: compensation determines one (compensate::default_depth_limit_um).
  std::optional<double> depth_limit_um() const {
    if (profile_um) return -(*profile_um)[0];
    return max_overcut_um > 0 ? std::optional(max_overcut_um) : std::nullopt;
  }
  /// Half of the width of the band.
  double half_width_um() const { return profile_um ? ((*profile_um)[1] - (*profile_um)[0]) / 2 : tolerance_um; }
  std::vector<Lever> levers;  ///< shift is always among them; empty: shift, and feed where F words can be changed
  bool has(Lever lever) const {
    return levers.empty() ? lever != Lever::passes : std::ranges::find(levers, lever) != levers.end();
  }
  /// Extra machine time for feed and passes: the least error within it. Not given: as much as the tolerance takes, up
  /// to 10 % where the job does not name its levers, else to 200 %.
  std::optional<double> time_budget_percent;
  double min_feed_percent = 20;                 ///< least feed, percent of the programmed one; below it edges rub
  double pass_allowance_mm = 0;                 ///< what the first of two passes leaves; 0: chosen
  double max_angle_growth_rad = 3 * kPi / 180;  ///< between blocks of the path
  Operations operations;                        ///< simulated moves to compensate; none given: the finishing moves
  std::optional<Vec3> work_offset_mm;           ///< program zero in machine coordinates, for the travel limits
};

/// Limits within which camber adapt keeps the loads. Not given: no limit.
struct AdaptLimits {
  std::optional<double> force_N{};         ///< greatest lateral force of a tooth passing
  std::optional<double> torque_Nmm{};      ///< greatest torque of the spindle
  std::optional<double> deflection_mm{};   ///< greatest deflection of the tip
  std::optional<double> form_error_mm{};   ///< magnitude, against the programmed surface
  std::optional<double> chip_mm{};         ///< thickest chip
  std::optional<double> power_W{};         ///< mean over a tooth passing
  std::optional<double> chip_min_mm{};     ///< thickest chip, at least
  std::optional<double> chatter_margin{};  ///< depth over critical depth; kept by spindle speeds, not by feeds
};

/// Part of a program that camber adapt may change.
enum class AdaptLever : std::uint8_t {
  feed,  ///< F words, by load
  speed  ///< S words, and F with them so that the chip stays
};

struct AdaptSettings {
  AdaptLimits limits;
  bool bounds_feed = true;  ///< a limit bounds the feed from above
  std::vector<AdaptLever> levers{AdaptLever::feed};
  bool has(AdaptLever lever) const { return std::ranges::find(levers, lever) != levers.end(); }
  double lowest_feed_mm_per_s = 0, highest_feed_mm_per_s = 0;  ///< both 0: not given
  std::optional<std::array<double, 2>> spindle_rpm{};          ///< lowest, highest speed that may be used
  double step_fraction = 0.05;                                 ///< feeds that differ by less share an F word
  Diagnostic limits_place;                                     ///< an error without a message where the limits stand
};

struct Job {
  std::string path;
  std::string program;  ///< paths are resolved against the job's folder
  std::string machine_path;
  Machine machine;
  std::optional<bool> inch;  ///< unit of a program without G20/G21: `units = "inch"` or "mm"
  Operations operations;
  std::map<int, Tool> tools;
  Material material;
  StockDescription stock;
  Part part;
  Simulation simulation;
  /// An error without a message where voxel_mm stands, or else [stock]: what is said of memory points there.
  Diagnostic voxel_place;
  CompensationSettings compensation;
  std::optional<AdaptSettings> adapt{};
  std::vector<Feature> features{};  ///< that predict and compensate evaluate
  std::optional<ModelError> model_error{};
  std::vector<Mode> workpiece_modes{};   ///< modes of the work on its table; empty: it is rigid
  std::optional<Workpiece> workpiece{};  ///< not given: rigid
};

/// Reads the job and its machine file. Throws InputError with file:line:column.
Job read_job(const std::string& path, Diagnostics& diagnostics);

/// Text of a job.toml with all defaults filled in and resolved paths.
std::string to_toml(const Job& job);

}  // namespace camber::machine
