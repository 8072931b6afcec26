#pragma once
// From words to moves: modal state, units, planes, arcs, canned cycles.
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "nc/move.h"
#include "nc/offsets.h"
#include "nc/program.h"

namespace camber::nc {

struct InterpreterOptions {
  /// Unit where the program has neither G20 nor G21; not given: millimetres, with a warning.
  std::optional<bool> inch;
  bool skip_slash_blocks = false;  ///< the block skip switch
  /// G4 P and the P of drilling cycles without a decimal point: milliseconds (Fanuc, Haas, Mazak), or seconds
  /// (LinuxCNC). With a point they are seconds for all.
  bool dwell_p_is_ms = false;
  bool absolute_arc_centre = false;  ///< the control starts in G90.1 rather than G91.1
  double peck_clearance_mm = 0.254;  ///< G83 stops its rapid so far above the last depth; G73 retracts by it

  // What the operator has set at the control; what is not given here and not set by the program is not known.
  std::map<int, Vec3> work_offsets_mm{};     ///< machine coordinates, by the number of ModalState::work_offset
  std::map<int, ToolOffset> tool_offsets{};  ///< by H and D number
  /// Machine coordinates of the reference points: G28, G30 P2, P3, P4.
  std::array<std::optional<Vec3>, 4> reference_points_mm{};

  // Facts of the control. The defaults are LinuxCNC's where it has the code at all.
  bool g52_is_g92 = true;            ///< G52 and G92 share one shift (LinuxCNC); else they add up (Fanuc)
  bool g10_adds_in_g91 = false;      ///< G91 G10 L2 adds to the offset (Fanuc, Haas); else G91 is nothing to it
  bool g10_p0_is_external = false;   ///< G10 L2 P0 sets the shift common to all offsets (Fanuc); else the active one
  bool g10_l20_is_g54_1 = false;     ///< G10 L20 Pn sets G54.1 Pn (Fanuc, Haas); else touches off (LinuxCNC)
  bool g41_1_has_diameter = true;    ///< G41.1 D: a diameter; else it is normal direction control (Fanuc)
  bool radius_corner_lines = false;  ///< outside corners by lines (Fanuc), else by arcs (LinuxCNC)
  bool radius_entry_square = false;  ///< CutterRadius::entry_square_to_next (Fanuc, type A)
  /// After G40 the cutter stays off the contour until a block has a word of the plane (Fanuc); else it returns with
  /// the next move of any kind (LinuxCNC).
  bool radius_exit_waits = false;
  int radius_look_ahead = 1;            ///< CutterRadius::moves_without_plane_motion
  bool rotation_r_adds_in_g91 = false;  ///< R of G68 in G91 is added to the angle (Haas; Fanuc with RIN = 1)
  double scale_unit = 0.001;            ///< what 1 without a decimal point is in P, I, J, K of G51
  /// Arcs by I J K whose radii differ by up to this are spirals (Fanuc 3410 = 0); 0: only those with L are.
  double spiral_radius_difference_mm = 0;
};

/// Arcs whose radii at start and end differ by more than the first are warned of, by more than the second refused.
inline constexpr double kArcRadiusWarningMm = 0.005;
inline constexpr double kArcRadiusErrorMm = 0.05;

/// Interprets the whole program. Words of a block act in the order unit, feed mode, distance mode, plane, F, S, T,
/// M6, M3 M4, coolant on, dwell or motion, M5 M9, stops. Reading ends at M2 or M30. All work offsets are taken as
/// one frame, with a warning when several are cut in, unless their values are known (docs/nc-language.md, Frames).
/// Errors and warnings go to `diagnostics`; errors do not stop the reading (Diagnostics throws InputError after
/// kMaxErrors).
Interpretation interpret(const Program& program, const InterpreterOptions& options, Diagnostics& diagnostics);

}  // namespace camber::nc
