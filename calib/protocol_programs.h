#pragma once
// Programs to run on a machine so that fit-feed finds every number it looks for.
#include <string>
#include <vector>

#include "machine/machine_model.h"

namespace camber::calib {

struct ProtocolPart {
  int line_first = 0, line_last = 0;  ///< 1-based, both included
  double angle_deg = 0;               ///< of the corners; 0: circles and chords
  double feed_mm_per_min = 0;
  std::string plane;   ///< "xy", "yz" or "zx"; a rotary axis: its letter
  double size_mm = 0;  ///< side, radius or chord; of a rotary axis degrees
};

struct ProtocolProgram {
  std::string name;   ///< of the file
  std::string tells;  ///< its purpose, one sentence
  std::string text;
  std::vector<ProtocolPart> parts;
};

/// - protocol_xy, _yz, _zx: closed polygons whose corners turn by 10, 20, 30, 60, 90, 120 and 180 degrees, sides of
///   0.5, 1, 3 and 6 mm, 100 to 1500 mm/min: 140 parts a plane. Source: KAKEN report on deflection-compensated CAM.
/// - corners: zigzags of 5 to 75 degrees, where a control's stop angle lies, at two feeds.
/// - circles: full turns of 0.5 to 20 mm radius in three planes.
/// - saturation: chords of 0.5 down to 0.01 mm on a wide circle at a feed that no control keeps up with: the speed that
///   remains gives the block processing time, T_b = 60000 L_b / V_s.
/// - rapids: single axes, 1 to 100 mm.
/// - rotary: for machines with [kinematics]; each rotary axis alone, out and back twice, by 1 to 90 degrees at four
///   feeds (degrees/min), of which the last is above any top speed; without tool-centre-point control.
/// Feeds stay under the axes' top speeds. Nothing cuts: run them well above the table; they need 110 mm from the
/// origin in +X and 45 mm either way in X, Y and Z (less where [axis] travel_mm says so: then the rapids are shorter).
std::vector<ProtocolProgram> protocol_programs(const machine::Machine& machine);

/// line_first,line_last,angle_deg,feed_mm_min,plane,size_mm
std::string parts_csv(const ProtocolProgram& program);

}  // namespace camber::calib
