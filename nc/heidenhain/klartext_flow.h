#pragma once
// Which statement is next: labels, calls, jumps, parameters; M functions, some of which end the program; cycles.
// Internal to heidenhain/.
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nc/canned_cycles.h"
#include "nc/heidenhain/klartext_motion.h"
#include "nc/heidenhain/klartext_words.h"

namespace camber::nc::heidenhain {

class Flow {
 public:
  Flow(StatementContext& at, Modes& modes, Tools& tools, Diagnostics& diagnostics);

  /// The statement to run; null at the end of the program.
  const Statement* next();
  /// LBL, CALL LBL, CALL PGM, SEL PGM, END PGM, Q5 = ..., FN.
  void run(const Statement& s);
  void end_by_function();  ///< M2, M30
  void select_program(std::string_view path) { selected_program_ = path; }
  void open_selected(std::size_t offset) { open_program(selected_program_, offset); }
  void mark_repeated_moves();

 private:
  /// A program or a subprogram that runs.
  struct Level {
    const Program* file = nullptr;
    std::size_t next = 0;
    bool is_program = true;         ///< else from LBL to LBL 0
    std::uint32_t called_from = 0;  ///< Move::block of moves in other files
  };
  Level& level() { return levels_.back(); }
  void enter(const Level& level);
  void leave();
  void jump(const std::string& label, std::size_t offset);
  void call_label(const Statement& s);
  void call_program(const Statement& s, bool selected);
  void open_program(const std::string& path, std::size_t offset);
  void end_program();
  void note_rest(const Statement& s);
  void assign(const Statement& s);
  bool set_or_say(const ParameterName& name, const Statement& s, const std::function<double()>& value);
  void run_function(const Statement& s);
  std::optional<bool> definition_asked(Cursor& at) const;
  void jump_behind_goto(Cursor& at, const Statement& s, bool holds);
  std::string label_name(Cursor& at);

  StatementContext& at_;
  Modes& modes_;
  Tools& tools_;
  Diagnostics& diagnostics_;
  std::vector<Level> levels_;
  std::map<std::pair<const Tree*, std::size_t>, int> repeats_left_;
  std::vector<std::uint8_t> runs_;  ///< number of runs of each block of the main program, up to 255
  std::size_t repeated_ = 0;
  std::map<std::string, std::unique_ptr<Program>> files_;
  std::string selected_program_;
  bool ended_ = false;
};

/// M functions, and TOOL CALL, which may have some.
class Functions : MotionParts {
 public:
  Functions(const MotionParts& parts, RadiusCompensation& compensation, Orientation& orientation, Flow& flow)
      : MotionParts(parts), compensation_(compensation), orientation_(orientation), flow_(flow) {}

  void run(const BlockValues::Function& f);
  void run_before(const BlockValues& b);
  void run_after(const BlockValues& b);
  void call_tool(const Statement& s);
  bool cycle_is_modal() const { return cycle_modal_; }
  void end_modal_cycle() { cycle_modal_ = false; }

 private:
  RadiusCompensation& compensation_;
  Orientation& orientation_;
  Flow& flow_;
  bool cycle_modal_ = false;  ///< M89
};

// --- cycles

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
class CycleMoves : MotionParts {
 public:
  explicit CycleMoves(const MotionParts& parts) : MotionParts(parts) {}

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

  CycleDefinition cycle_;
  std::size_t count_ = 0;  ///< of the moves of all cycles
  int g_ = 0;              ///< Move::cycle
};

/// CYCL DEF, CYCL CALL, PATTERN DEF.
class Cycles : MotionParts {
 public:
  Cycles(const MotionParts& parts, RadiusCompensation& compensation, Orientation& orientation, Flow& flow)
      : MotionParts(parts), compensation_(compensation), orientation_(orientation), flow_(flow), moves_(parts) {}

  void define(const Statement& s);
  void define_pattern(const Statement& s);
  void call(std::size_t offset);
  /// CYCL CALL, CYCL CALL PAT, CYCL CALL POS X Y Z F.
  void run_call(const Statement& s, Functions& functions);

 private:
  void define_old(int number, int part, Cursor at, const Statement& s);
  void begin(int number, std::size_t offset) { moves_.cycle() = {number, offset}; }
  void run_pattern(int number);

  RadiusCompensation& compensation_;
  Orientation& orientation_;
  Flow& flow_;
  CycleMoves moves_;
  std::vector<Vec3> pattern_;  ///< PATTERN DEF: places, programmed
};

}  // namespace camber::nc::heidenhain
