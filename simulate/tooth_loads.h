#pragma once
// What every cut of one tool begins with and ends in: the envelope at which its chips are sampled, and the figures of a
// tooth passing.
#include <span>

#include "base/tool_pose.h"
#include "deflection/tooth_pass.h"
#include "machine/tool.h"
#include "removal/cutter.h"
#include "removal/deflection_table.h"
#include "removal/stock.h"
#include "simulate/cut.h"

namespace camber::simulate {

/// Height above the tip up to which a cutter can meet material, where the stock rises to `rise_mm` above the tip at
/// most.
double engaged_top_mm(const removal::Stock& stock, const machine::Tool& tool, double rise_mm);

/// The envelope at which chips are sampled, up to engaged_top_mm.
removal::EnvelopeGrid sampled_envelope(const removal::Stock& stock, const machine::Tool& tool, double top_mm,
                                       const CutOptions& options);

/// Forces in the part's axes, torque, work and chip of a tooth passing; deflections and the volume of its chips are not
/// among them. `pass`: in the tool's frame.
StampLoad summarize(const deflection::ToothPass& pass, const ToolPose& pose = {});

/// The load of a tooth passing between two others, without the deflections.
StampLoad between(const StampLoad& a, const StampLoad& b, double way);

/// Returns the largest deflection of the tip over the rotation steps of a row of `table`; no other place of a bending
/// beam moves more.
double tip_deflection_mm(const removal::DeflectionTable& table, const float* row);

}  // namespace camber::simulate
