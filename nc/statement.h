#pragma once
// Assignments and flow control of NC programs: #1=2, IF GOTO WHILE DO END, and LinuxCNC's O-words.
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "nc/expression.h"

namespace camber::nc {

enum class StatementKind : std::uint8_t {
  assign_number,  ///< values: number of the variable, new value
  assign_name,    ///< label: index of the name; values: new value
  condition,      ///< IF [..] [THEN]: the rest of the block runs where it holds. values: condition
  go_to,          ///< values: block number
  loop,           ///< WHILE [..] DO m (values: condition), DO m, o while, o do, o repeat (values: times)
  loop_end,       ///< END m, o endwhile, o endrepeat
  loop_until,     ///< o while [..] that closes an o do. values: condition
  branch_if,      ///< o if [..], IF [..] THEN on a line of its own. values: condition
  branch_elseif,  ///< values: condition
  branch_else,
  branch_end,
  leave_loop,  ///< o break
  next_turn,   ///< o continue
  sub,
  sub_end,     ///< values: result, if any
  sub_return,  ///< values: result, if any
  call         ///< values: arguments; where label is kNoLabel, the first one is the number of the sub
};

struct Statement {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::uint32_t kNoLabel = kNone;

  StatementKind kind = StatementKind::condition;
  bool o_word = false;
  bool repeats = false;  ///< loop: o repeat
  std::uint32_t block = 0, offset = 0;
  std::uint32_t label = kNoLabel;  ///< index into MacroTables::labels; of an assignment into Expressions::names
  std::uint32_t first_value = 0, value_count = 0;  ///< range in MacroTables::values
  /// The other end: of a loop its last statement and the reverse; of if, elseif, else the endif; of sub its endsub; of
  /// break and continue the loop.
  std::uint32_t partner = kNone;
  std::uint32_t next_branch = kNone;  ///< for if and elseif: the next elseif, else or endif
};

/// A word whose value is an expression. Its Word::value is NaN.
struct ExpressionWord {
  std::uint32_t word = 0;        ///< index into Program::words
  std::uint32_t expression = 0;  ///< index into Expressions::list
};

/// Tables of a program with macros; a plain program has none. Everything is in the order of the file.
struct MacroTables {
  Expressions expressions;
  std::vector<ExpressionWord> words;
  std::vector<Statement> statements;
  std::vector<std::uint32_t> values;  ///< values of statements: indices into Expressions::list
  std::vector<std::string> labels;    ///< labels of O-words and DO loops: "100", "name", "DO 1"
  bool calls = false;                 ///< the program has M97, M98, M99, G65 or G66
  bool local_calls = false;           ///< M97
  bool broken = false;                ///< something of it could not be read: loops and calls are not to be run
  bool flow() const { return calls || !statements.empty() || !words.empty(); }
};

/// Reads one statement at text[at, end); `at` moves behind it. Throws MacroError [expression], [statement].
class StatementReader {
 public:
  StatementReader(MacroTables& out, std::string_view text, std::size_t& at, std::size_t end, std::uint32_t block)
      : out_(out), text_(text), at_(at), end_(end), block_(block) {}

  enum class Found : std::uint8_t {
    nothing,
    statement,
    ignored  ///< DPRNT and the like, and a program's name: the rest of the block, or the name, has no effect
  };
  /// Reads at a letter: IF, WHILE, DO, END, GOTO, ELSE, ENDIF, DPRNT ...
  Found read_keyword();
  /// Reads at an O: o100 sub, o<name> call [1] ...; nothing where O and a number stand alone.
  Found read_o_word();
  /// Reads an assignment at a #.
  void read_assignment();

 private:
  bool take(std::string_view word);
  void skip_blanks();
  bool at_block_end();
  std::uint32_t whole_number(std::string_view what);
  std::uint32_t label_index(std::string label);
  ExpressionReader expressions() { return {out_.expressions, text_, at_, end_}; }
  Statement& add(StatementKind kind, std::size_t offset, std::uint32_t label = Statement::kNoLabel);
  void add_value(std::uint32_t expression);
  void read_if(std::size_t begin);
  void read_while(std::size_t begin);
  void read_loop_number(StatementKind kind, std::size_t begin, std::string_view what);
  bool read_o_keyword(std::size_t begin, std::uint32_t label, bool computed);

  MacroTables& out_;
  std::string_view text_;
  std::size_t& at_;
  std::size_t end_;
  std::uint32_t block_;
};

/// Joins the ends of loops, branches and subs. Returns what is wrong with them.
std::vector<MacroError> link_statements(MacroTables& macro);

}  // namespace camber::nc
