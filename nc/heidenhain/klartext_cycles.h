#pragma once
// Cycles: definitions, calls, patterns, and the moves of each. Internal to heidenhain/.
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "nc/canned_cycles.h"
#include "nc/heidenhain/klartext_flow.h"

namespace camber::nc::heidenhain {

/// The cycle that is defined.
struct CycleDefinition {
  int number = -1;  ///< none
  std::size_t offset = 0;
  bool passed = false;             ///< refused, or the maker's own: its definition said so, and its calls do nothing
  std::map<int, double> values{};  ///< values of old cycles, by the number behind the point
  std::map<int, double> feeds{};
  double radius = 0, sense = -1;
  bool is_old() const { return number >= 0 && number < 100; }
};

/// Machining cycles at the place of the tool.
class CycleMoves {
 public:
  CycleMoves(StatementContext& at, Modes& modes, Tools& tools, DatumFrames& frames, Mover& mover)
      : at_(at), modes_(modes), tools_(tools), frames_(frames), mover_(mover) {}

  CycleDefinition& cycle() { return cycle_; }
  void run(std::size_t offset);
  double q(int number);
  std::optional<double> q_if_set(int number);
  void go(MoveKind kind, const Vec3& programmed_end, double feed_mm_per_s, double dwell_s = 0);

 private:
  struct Hole {
    double surface_mm = 0, clearance_mm = 0, second_mm = 0;
    double depth_mm = 0;  ///< depth from the surface, negative
    double peck_mm = 0, less_mm = 0, least_mm = 0;
    double above_mm = 0.2;  ///< rapids in the hole stop so far above the last depth
    int breaks = 0;         ///< chip breaks before the tool leaves the hole
    double break_mm = 0.2;
    double start_mm = 0;  ///< negative: the hole is open down to there
    double pre_feed_mm_per_s = 0, feed_mm_per_s = 0;
    std::optional<double> feed_out_mm_per_s{};
    double dwell_s = 0, dwell_top_s = 0;
    Vec3 off_mm = Vec3::Zero();  ///< motion off the wall before the tool leaves
  };
  void go_to_height(MoveKind kind, double height_mm, double feed_mm_per_s = 0);
  void go_round(const Vec3& centre, double sweep_rad, double end_height_mm, double feed_mm_per_s);
  void drill(int number);
  void drill_hole(const Hole& hole);
  void bore_back();
  void drill_old();
  void mill_bore();
  void mill_thread();
  void mill_old_pocket();
  void mill_pocket_cycle();
  PocketMoves pocket_moves();
  double pocket_cutter_mm() const;
  double tapping_feed(double pitch_mm);
  double old_value(int part) const;
  double old_feed(int part) const;
  double feed_q(int number);
  [[noreturn]] void refuse(const char* check, const std::string& message) const;
  [[noreturn]] void too_many_cuts() const;

  StatementContext& at_;
  Modes& modes_;
  Tools& tools_;
  DatumFrames& frames_;
  Mover& mover_;
  CycleDefinition cycle_;
  std::size_t count_ = 0;  ///< of the moves of all cycles
  int g_ = 0;              ///< Move::cycle
};

/// CYCL DEF, CYCL CALL, PATTERN DEF.
class Cycles {
 public:
  Cycles(StatementContext& at, Modes& modes, Tools& tools, DatumFrames& frames, Mover& mover,
         RadiusCompensation& compensation, Orientation& orientation, Flow& flow)
      : at_(at),
        modes_(modes),
        tools_(tools),
        frames_(frames),
        mover_(mover),
        compensation_(compensation),
        orientation_(orientation),
        flow_(flow),
        moves_(at, modes, tools, frames, mover) {}

  void define(const Statement& s);
  void define_pattern(const Statement& s);
  void call(std::size_t offset);
  /// CYCL CALL, CYCL CALL PAT, CYCL CALL POS X Y Z F.
  void run_call(const Statement& s, Functions& functions);

 private:
  void define_old(int number, int part, Cursor at, const Statement& s);
  void begin(int number, std::size_t offset) { moves_.cycle() = {number, offset}; }
  void run_pattern(int number);

  StatementContext& at_;
  Modes& modes_;
  Tools& tools_;
  DatumFrames& frames_;
  Mover& mover_;
  RadiusCompensation& compensation_;
  Orientation& orientation_;
  Flow& flow_;
  CycleMoves moves_;
  std::vector<Vec3> pattern_;  ///< PATTERN DEF: places, programmed
};

}  // namespace camber::nc::heidenhain
