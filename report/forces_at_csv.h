#pragma once
// forces_at_LINE.csv: one turn of the spindle in steps of a degree.
#include <string>

#include "deflection/tooth_pass.h"

namespace camber::report {

/// Columns: angle_deg, for every tooth t fx_t_N,fy_t_N,fz_t_N,h_max_t_mm, then fx_N,fy_N,fz_N,torque_Nm of all teeth.
/// 360 rows. Forces act on the tool, in machine axes. angle_deg is the turn of the spindle (clockwise seen from
/// above) since tooth 1's edge at the tip pointed along +X; the teeth follow each other, tooth 2 after tooth 1.
/// Rotation steps other than a degree are interpolated. Throws InputError [file-unwritable].
void write_forces_at_csv(const std::string& path, const deflection::TurnForces& turn);

}  // namespace camber::report
