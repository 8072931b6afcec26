#pragma once
// Tables of loads: along the path (forces.csv), of one turn of the spindle, and of the spindle by tool and line.
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "base/geometry.h"
#include "deflection/tooth_pass.h"
#include "machine/job_file.h"
#include "simulate/predict_path.h"

namespace camber::report {

/// The columns of forces.csv, see write_forces_csv.
struct ForceRow {
  double t_s = 0;
  std::size_t line = 0;
  Vec3 tip_mm = Vec3::Zero();
  Vec3 force_max_N = Vec3::Zero();
  double lateral_max_N = 0, axial_max_N = 0;
  Vec3 force_mean_N = Vec3::Zero();
  Vec3 deflection_um = Vec3::Zero();
  double mrr_mm3_per_s = 0, removed_mm3 = 0;
  double torque_max_Nm = 0, torque_mean_Nm = 0, power_W = 0;
  double chip_max_mm = 0, chip_mean_mm = 0;
  double specific_energy_MPa = 0;
  int tool = 0;
  bool valid = true;  ///< the model holds in all of the row's tooth passings
  double chatter_margin = 0, chatter_hz = 0;
};

/// Calls `take` with every row, in the order of the path.
void for_each_force_row(const machine::Job& job, const simulate::SimulatedProgram& program,
                        const simulate::Prediction& prediction, const std::function<void(const ForceRow&)>& take);

/// Columns: t_s,block,x_mm,y_mm,z_mm,fx_max_N,fy_max_N,fz_max_N,f_max_N,fx_mean_N,fy_mean_N,fz_mean_N,dx_um,dy_um,
/// dz_um,mrr_mm3_per_s,removed_mm3,torque_max_Nm,torque_mean_Nm,power_W,h_max_mm,h_mean_mm,specific_energy_MPa,valid,
/// chatter_margin,chatter_Hz.
/// Torque and power are the spindle's for cutting; h is the uncut chip thickness, its mean weighted by area; the
/// specific energy is the spindle's work over the chips' volume (MPa = J/cm3), 0 where nothing is removed. Forces act
/// on the tool, in the part's axes, those of the machine in programs of X, Y and Z; fx_max is the signed value of
/// largest magnitude, f_max the greatest force across the tool's axis; dx, dy, dz the deflection at the height of the
/// contact, at the instant at which an edge passes it, mean over the row's teeth; t, x, y, z belong to the row's first
/// tooth. The margin is the depth of the cut over the depth at which it becomes unstable, the greatest of the row's
/// teeth, with the frequency that would be heard (simulate/chatter.h). Where a tool is tilted, a last column
/// f_axial_max_N holds the force along its axis, of largest magnitude, positive towards the spindle. Throws InputError
/// [file-unwritable].
void write_forces_csv(const std::string& path, const machine::Job& job, const simulate::SimulatedProgram& program,
                      const simulate::Prediction& prediction);

// forces_at_LINE.csv: one turn of the spindle in steps of a degree.

/// Columns: angle_deg, for every tooth t fx_t_N,fy_t_N,fz_t_N,h_max_t_mm, then fx_N,fy_N,fz_N,torque_Nm of all teeth.
/// 360 rows. Forces act on the tool, in machine axes. angle_deg is the turn of the spindle (clockwise seen from
/// above) since tooth 1's edge at the tip pointed along +X; the teeth follow each other, tooth 2 after tooth 1.
/// Rotation steps other than a degree are interpolated. Throws InputError [file-unwritable].
void write_forces_at_csv(const std::string& path, const deflection::TurnForces& turn);

// Load of the spindle by tool and line, for who sets limits of a load monitor; spindle_load.csv.

/// The heaviest turn of the spindle in a line of the program. Power and torque are means over that turn, for cutting
/// alone: what a monitor shows above the idle spindle, before the spindle's own losses.
struct SpindleLoad {
  int tool = 0;
  std::size_t line = 0;
  double power_W = 0, torque_Nm = 0;
};

/// A row for each tool and line that removes material, by tool in the order of its first cut, then by line.
std::vector<SpindleLoad> spindle_loads(const machine::Job& job, const simulate::SimulatedProgram& program,
                                       const simulate::Prediction& prediction);

/// Columns tool,line,power_W,torque_Nm. Throws InputError [file-unwritable].
void write_spindle_load_csv(const std::string& path, const std::vector<SpindleLoad>& loads);

}  // namespace camber::report
