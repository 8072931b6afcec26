#pragma once
// The modes of a job's tools, and their teeth.
#include "dynamics/beam_modes.h"
#include "dynamics/cut.h"
#include "machine/tool.h"

namespace camber::dynamics {

/// Damping of a tool in holder and spindle where none is measured; usual values are 0.01 to 0.05.
constexpr double kUsualDamping = 0.03;
constexpr int kBeamModes = 3;         ///< number of the beam's lowest modes that are examined
constexpr double kModeCounts = 0.05;  ///< those count that are this part as flexible as the most flexible one

/// Modes at the tip: those that are given, or those of its beam that count, with the usual damping, alike in x and y.
std::vector<Mode> modes_of(const machine::Tool& tool);
/// Modes of the tool's beam, whether or not the job gives measured modes.
std::vector<BeamMode> beam_modes_of(const machine::Tool& tool, int count = kBeamModes);

/// Pitches, lag and radius of a tool; no slices.
Cut teeth_of(const machine::Tool& tool);

}  // namespace camber::dynamics
