#pragma once
// Values of the control's variables: positions, modal codes, clocks, alarms.
#include <string>

#include "nc/block_interpreter.h"
#include "nc/expression.h"
#include "nc/reporter.h"

namespace camber::nc {

/// Positions and offsets are in the program's unit, positions in the work frame. What a program cannot know before it
/// runs (machine positions, offsets that it has not set, signals, the date) is taken as 0, or as the work position,
/// with a warning.
///
/// Fanuc, Haas, Mazak: #1000..#1135 signals (0), offsets as in nc/offset_variables.h, #3000 alarm: an error,
/// #3001 #3002 clocks, #3003 #3004 #3005 #3007 switches, #3006 stop, #3011 #3012 date and time (0), #3901 #3902 parts,
/// #4001..#4130 modal codes, #5001.. end of the last block, #5021.. machine position, #5041.. position, #5061.. skip
/// position, #5081.. tool length.
/// LinuxCNC: #5061.. probe, #5161.. #5181.. reference points (0), #5221.. work offsets, #5220 coordinate system, #5400
/// tool, #5401.. its offsets (0), #5420.. position.
///
/// The clocks count the programmed time of cutting moves and dwells and a millisecond for every variable block, so that
/// a loop that waits for them ends.
class SystemVariables {
 public:
  SystemVariables(const Dialect& dialect, BlockInterpreter& interpreter, Reporter& report, Interpretation& out)
      : dialect_(dialect), interpreter_(interpreter), report_(report), out_(out) {}

  /// LinuxCNC's numbers stand among its common variables.
  bool owns(int number) const;
  Value get(int number, std::size_t offset);
  void set(int number, Value value, std::size_t offset);
  /// LinuxCNC's predefined names.
  Value get(const std::string& name) const;
  bool may_be_set(const std::string& name) const { return name == "_value" || name == "_value_returned"; }

  /// Counts blocks for the clocks.
  void tick() { ++ticks_; }
  /// The block's text, for the message of an alarm.
  void set_block(const Program& program, std::uint32_t block) { program_ = &program, block_ = block; }
  void set_call_level(std::size_t level) { call_level_ = static_cast<double>(level); }
  void set_result(Value value) { result_ = value; }

 private:
  Value fanuc(int number, std::size_t offset);
  Value linuxcnc(int number, std::size_t offset);
  std::optional<Value> offset_value(int number, std::size_t offset);
  bool set_offset(int number, Value value, std::size_t offset);
  Value modal(int number) const;
  double position(int axis) const;
  Value not_known(int number, std::size_t offset, const char* what);
  double clock_s();
  std::string message_of_block() const;

  const Dialect& dialect_;
  BlockInterpreter& interpreter_;
  Reporter& report_;
  Interpretation& out_;
  const Program* program_ = nullptr;
  std::uint32_t block_ = 0;
  std::size_t ticks_ = 0, timed_moves_ = 0;
  double timed_s_ = 0, clock_3001_ = 0, clock_3002_ = 0;  ///< the clocks' zero, s
  double call_level_ = 0;
  Value result_;
};

}  // namespace camber::nc
