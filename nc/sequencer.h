#pragma once
// Sequencer: decides which block runs next (calls, jumps, loops). BlockInterpreter runs the block once its words have
// numbers.
#include <map>
#include <optional>
#include <vector>

#include "nc/block_interpreter.h"
#include "nc/program_files.h"
#include "nc/system_variables.h"
#include "nc/variables.h"

namespace camber::nc {

class Sequencer {
 public:
  Sequencer(ProgramFiles& files, const InterpreterOptions& options, Reporter& report, Interpretation& out);

  /// Runs the program to its end, or to the first thing that makes running on senseless. A program without macros,
  /// calls and skipped blocks goes through BlockInterpreter block by block.
  void run();
  RunVerdict verdict() const { return interpreter_.verdict(); }

 private:
  /// A subprogram to run.
  struct Call {
    BlockPlace start;
    std::size_t times = 1;
    std::optional<LocalVariables> locals{};  ///< a level of its own; else it shares the caller's
    std::uint32_t offset = 0;                ///< position of the word that calls
  };
  struct Frame {
    Call call;
    BlockPlace return_to;
    BlockPlace caller;
    std::uint32_t called_from = 0;  ///< Move::block
    bool o_word = false;
    std::map<std::uint32_t, double> turns_left;  ///< turns left of o repeat
  };
  using LoopKey = std::pair<const Program*, std::uint32_t>;

  bool divides_lines(const Program& file) const;
  bool is_divided(const Block& block) const;
  std::span<const BlockPart> parts_of(std::uint32_t block) const;
  std::span<const Word> words_here() const;
  std::uint32_t part_of(std::uint32_t block, std::uint32_t offset) const;
  BlockPlace behind(const Statement& s);
  void advance();
  void refuse_what_is_read_elsewhere();
  void run_plain();
  void run_blocks();
  void step();
  void run_flow_block(const Block& block);
  bool run_statements(std::size_t first, std::size_t end);
  void run_flow_statement(std::uint32_t index);
  void run_branch(std::uint32_t index);
  void run_loop(std::uint32_t index);
  void next_turn(std::uint32_t head);
  void leave_loop(std::uint32_t head);
  void call_sub(const Statement& s);
  void return_from_sub(const Statement& s);

  bool evaluate_words();
  void run_words_and_calls();
  void run_words(std::span<const Word> words);
  void take_calls(std::vector<Word>& words);
  void call_program(const Word& code, std::span<const Word> words);
  void call_macro(std::size_t at, std::vector<Word>& words);
  void return_from_program(const Word& code, std::span<const Word> words);
  void leave_frame();
  void enter(Call call, bool o_word = false);
  void end_of_program_text();
  bool runs_into_next_program();
  void jump_to_number(double number, std::uint32_t offset, BlockPlace from);
  void note_jump(std::uint32_t offset);
  void note_entry(std::uint32_t offset) { entered_[{at_.file, offset}] = repeated_; }
  void count_run();
  void go(BlockPlace place);
  void mark_repeated_moves();
  void warn_of_blocks_behind_the_end();
  [[noreturn]] void fail_as_endless();

  Value value_of(const Statement& s, std::size_t which, double round_step = 1);
  bool holds(const Statement& s);
  const Statement& statement(std::uint32_t index) const { return at_.file->macro.statements[index]; }
  bool is_skipped(const Block& block) const;
  std::uint32_t called_from() const;
  std::map<std::uint32_t, double>& turns_left() { return frames_.empty() ? turns_left_ : frames_.back().turns_left; }

  ProgramFiles& files_;
  const InterpreterOptions& options_;
  const Dialect& dialect_;
  Reporter& report_;
  Interpretation& out_;
  BlockInterpreter interpreter_;
  SystemVariables system_;
  Variables variables_;

  BlockPlace at_;
  bool running_ = true, failed_ = false;
  std::vector<Frame> frames_;
  std::map<std::uint32_t, double> turns_left_;       ///< turns left in the main program
  std::vector<std::optional<Call>> modal_calls_{1};  ///< G66, of each level of macros
  std::vector<Word> words_;                          ///< words of the block, with numbers for values
  bool editable_ = true;
  std::vector<std::uint8_t>* runs_ = nullptr;  ///< counts of the file that at_ is in
  std::size_t repeated_ = 0;                   ///< blocks run again, and the moves that they made
  std::map<LoopKey, std::size_t> entered_;     ///< repeated_ when the loop was entered
};

}  // namespace camber::nc
