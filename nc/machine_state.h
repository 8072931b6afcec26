#pragma once
// What the interpreter remembers from block to block, and how moves come out of it.
#include <array>
#include <optional>

#include "base/units.h"
#include "nc/arcs.h"
#include "nc/block_words.h"
#include "nc/move.h"

namespace camber::nc {

/// A drilling cycle's words that stay until it is cancelled, in mm; z, r as they act (absolute in the work frame).
struct CannedCycle {
  int code = 0;  ///< 73, 81 ... 89; 0: none
  double z_mm = 0, r_mm = 0, q_mm = 0, p_s = 0;
  double initial_z_mm = 0;
};

struct MachineState {
  ModalState modal;
  Plane plane = Plane::xy;
  int motion = -1;               ///< 0 ... 3; -1: no motion code yet
  bool absolute_centre = false;  ///< G90.1
  std::optional<bool> inch;      ///< not given yet
  std::optional<double> feed;    ///< F as given; with G94 and G95 in mm
  int selected_tool = 0;         ///< T
  bool retract_to_r = false;     ///< G99
  CannedCycle cycle;
  Vec3 position_mm = Vec3::Zero();
  std::array<bool, 3> known{};   ///< axes whose place in the work frame is known
  bool ended = false;            ///< after M2, M30

  double unit_mm() const { return modal.inch ? kMmPerInch : 1.0; }
  bool all_known() const { return known[0] && known[1] && known[2]; }
};

/// Collects moves; keeps equal modal states together.
class MoveWriter {
 public:
  MoveWriter(Interpretation& out, MachineState& state) : out_(out), state_(state) {}
  void begin_block(std::size_t block) { block_ = static_cast<std::uint32_t>(block); }

  void rapid(const Vec3& to, bool reference, bool canned = false);
  void line(const Vec3& to, double feed_mm_per_s, bool canned = false);
  void arc(const Vec3& to, const Arc& arc, double feed_mm_per_s);
  void dwell(double seconds, bool canned = false);
  void exact_stop() { exact_stop_ = true; }  ///< G9: of this block's moves
  void end_block() { exact_stop_ = false; }

 private:
  void add(MoveKind kind, const Vec3& to, double feed, bool reference, bool canned);

  Interpretation& out_;
  MachineState& state_;
  std::uint32_t block_ = 0;
  bool exact_stop_ = false;
};

/// Feed along the path of a cutting move of the given length, mm/s; nothing (with an error at the block) where it
/// is missing or zero. `name`: the motion code as the message names it.
std::optional<double> cutting_feed(const MachineState& state, const BlockWords& words, double length_mm, const char* name);

/// Runs the active drilling cycle at a place. repeats: L or K.
void run_cycle(MachineState& state, const BlockWords& words, const Vec3& at, int repeats, const Vec3& increment,
               MoveWriter& writer);

}  // namespace camber::nc
