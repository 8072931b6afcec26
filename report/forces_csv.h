#pragma once
// forces.csv: loads along the path, a row a spindle turn or a block, whichever is shorter.
#include <string>

#include "machine/job.h"
#include "simulate/predict.h"

namespace camber::report {

/// Columns: t_s,block,x_mm,y_mm,z_mm,fx_max_N,fy_max_N,fz_max_N,f_max_N,fx_mean_N,fy_mean_N,fz_mean_N,dx_um,dy_um,
/// mrr_mm3_per_s,removed_mm3,torque_max_Nm,torque_mean_Nm,power_W,h_max_mm,h_mean_mm,specific_energy_MPa. Torque and
/// power are the spindle's for cutting; h is the uncut chip thickness, its mean weighted by area; the specific energy
/// is the spindle's work over the chips' volume (MPa = J/cm3), 0 where nothing is removed. Forces act on the tool, in
/// machine axes; fx_max is the signed value of largest
/// magnitude, f_max the greatest lateral force; dx, dy the deflection at the contact's height as an edge passes the
/// contact, mean over the row's teeth; t, x, y, z belong to the row's first tooth. Throws InputError
/// [file-unwritable].
void write_forces_csv(const std::string& path, const machine::Job& job, const simulate::SimulatedProgram& program,
                      const simulate::Prediction& prediction);

}  // namespace camber::report
