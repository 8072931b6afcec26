#pragma once
// Sequencer: decides which block runs next (jumps, loops, subprograms, modal calls).
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/diagnostics.h"
#include "nc/siemens/block_runner.h"

namespace camber::nc::siemens {

struct FoundProgram {
  const Program* file = nullptr;
  Part part;
};

/// Finds subprograms: parts of the file, and files beside the main program.
class ProgramFiles {
 public:
  ProgramFiles(const Program& main, Diagnostics& diagnostics) : main_(main), diagnostics_(diagnostics) {}
  /// `name`: upper case, as it is called. Looks in `from`, in the main program, then for NAME.SPF and the like beside
  /// it.
  std::optional<FoundProgram> find(const Program& from, const std::string& name);

 private:
  const Program& main_;
  Diagnostics& diagnostics_;
  std::map<std::string, std::unique_ptr<Program>> files_;  ///< null: there is none
  std::map<std::string, std::string> folder_;              ///< names in upper case to paths
  bool folder_read_ = false;
};

class Sequencer {
 public:
  Sequencer(const Program& program, const InterpreterOptions& options, Diagnostics& diagnostics, Reporter& report,
            Interpretation& out);
  void run();

 private:
  /// A program that runs: the main program, a subprogram.
  struct Frame {
    const Program* file = nullptr;
    Part part;
    std::uint32_t at = 0;           ///< next block
    std::uint32_t called_from = 0;  ///< Move::block for files of their own
    Level level;
    std::size_t times_left = 0;  ///< further runs (P)
    std::uint32_t start = 0;
    std::shared_ptr<const BlockRunner::Saved> saved;
    bool of_mcall = false;
    /// Copied back at the end: variable here, node in the caller.
    std::vector<std::pair<std::shared_ptr<Variable>, std::uint32_t>> copied_back;
    /// REPEAT of a part: runs from `first` to before `end`, then goes to `back`.
    struct Repeat {
      std::uint32_t first, end, back;
      std::size_t times_left;
    };
    std::vector<Repeat> repeats;
    std::unordered_map<std::uint32_t, double> last_of;  ///< FOR block: the last value
  };
  struct ModalCall {
    const Tree* tree = nullptr;
    const Program* file = nullptr;
    const Item* item = nullptr;  ///< a subprogram, called anew with its values
    std::optional<CycleCall> cycle;
  };

  void step();
  void run_block(const Statement* statement);
  void run_plain_block();
  bool run_flow(const Statement& s);
  bool says_machine_frame(const Item& item) const;
  void run_items(const Statement& s);
  void run_word(const Item& item);
  void run_command_word(const Item& item);
  void set_extra(const Item& item, Extra extra);
  void after_block();
  void finish_block();
  void run_call(const Item& item, std::size_t times, const Statement& s);
  void report_missing(const std::string& name, std::size_t offset);
  void start_subprogram(const std::string& name, const Item& item, std::size_t times, bool of_mcall);
  CycleCall cycle_call(const Item& item);
  void bind_parameters(Frame& frame, const Statement* procedure, const Item& item);
  void leave_frame();
  void end_of_part();
  void jump(const Jump& j);
  std::optional<std::uint32_t> find_target(const std::string& name, Jump::Search search) const;
  void go_to(std::uint32_t block);
  void repeat_part(const Statement& s);
  void enter_for(const Statement& s);
  void count_run();
  bool is_skipped(const Block& block) const;
  std::uint32_t called_from() const;
  void mark_repeated_moves();
  void warn_of_blocks_behind_the_end() const;
  BlockPlace place() const;
  Frame& frame() { return frames_.back(); }
  const Frame& frame() const { return frames_.back(); }
  const Tree& tree() const { return tree_of(*frame().file); }
  double word_value(const Item& item, std::string_view what);

  const Program& main_;
  const InterpreterOptions& options_;
  Reporter& report_;
  Interpretation& out_;
  BlockRunner runner_;
  Evaluator evaluator_;
  ProgramFiles files_;
  std::vector<Frame> frames_;
  std::optional<ModalCall> modal_;
  int run_errors_ = 0;
  bool running_ = true;
  bool ended_ = false;
  std::uint32_t block_ = 0;         ///< the one at hand
  std::vector<std::uint8_t> runs_;  ///< counts of the main file
  std::map<const Program*, std::vector<std::uint8_t>> other_runs_;
  std::size_t repeated_ = 0;
  bool block_has_expression_ = false;
  bool in_machine_frame_ = false;  ///< of a block with expressions: SUPA, G53, G153 stand in it
};

}  // namespace camber::nc::siemens
