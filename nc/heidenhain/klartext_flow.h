#pragma once
// Which statement is next: labels, calls, jumps, parameters. M functions, some of which end the program. Internal to
// heidenhain/.
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nc/heidenhain/klartext_motion.h"

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
class Functions {
 public:
  Functions(StatementContext& at, Modes& modes, Tools& tools, RadiusCompensation& compensation,
            Orientation& orientation, Flow& flow)
      : at_(at), modes_(modes), tools_(tools), compensation_(compensation), orientation_(orientation), flow_(flow) {}

  void run(const BlockValues::Function& f);
  void run_before(const BlockValues& b);
  void run_after(const BlockValues& b);
  void call_tool(const Statement& s);
  bool cycle_is_modal() const { return cycle_modal_; }
  void end_modal_cycle() { cycle_modal_ = false; }

 private:
  StatementContext& at_;
  Modes& modes_;
  Tools& tools_;
  RadiusCompensation& compensation_;
  Orientation& orientation_;
  Flow& flow_;
  bool cycle_modal_ = false;  ///< M89
};

}  // namespace camber::nc::heidenhain
