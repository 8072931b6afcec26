#pragma once
// Expressions of NC programs: [#1 + 2 * SIN[30]], #101, #<depth>. Read once into postfix form, then evaluated often.
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "nc/dialect.h"

namespace camber::nc {

/// A number, or nothing where a variable is vacant (Fanuc's #0).
using Value = std::optional<double>;

enum class Op : std::uint8_t {
  number,
  variable,        ///< takes a number, gives the variable's value
  named,           ///< operand: index of a name
  variable_known,  ///< EXISTS[#100]
  name_known,      ///< EXISTS[#<name>]
  negate,
  plus,
  add,
  subtract,
  multiply,
  divide,
  modulo,
  power,
  equal,
  not_equal,
  greater,
  greater_equal,
  less,
  less_equal,
  logic_and,
  logic_or,
  logic_xor,
  logic_not,
  sine,
  cosine,
  tangent,
  arc_sine,
  arc_cosine,
  arc_tangent,    ///< arc tangent of one number, -90 to 90 degrees
  arc_tangent_2,  ///< ATAN[y]/[x] and ATAN[y,x]
  square_root,
  absolute,
  round,
  fix,
  fup,
  logarithm,
  exponential,
  from_bcd,  ///< BIN
  to_bcd     ///< BCD
};

struct ExpressionOp {
  Op op = Op::number;
  std::uint32_t offset = 0;  ///< position in the file
  double operand = 0;
};

struct Expression {
  std::uint32_t offset = 0;                            ///< position in the file
  std::uint32_t first = 0, count = 0;                  ///< range in Expressions::ops, AND, OR and XOR last
  std::uint32_t product_first = 0, product_count = 0;  ///< the same with AND as a product (Dialect)
};

/// All expressions of one file.
struct Expressions {
  std::vector<ExpressionOp> ops;
  std::vector<Expression> list;
  std::vector<std::string> names;  ///< names of parameters, lower case, without blanks
  /// Offset of the first abbreviated function, operator or statement (SI[30], GO10), if there is one.
  std::optional<std::uint32_t> abbreviation{};
  void note_abbreviation(std::size_t offset) {
    if (!abbreviation) abbreviation = static_cast<std::uint32_t>(offset);
  }
};

/// An error in an expression or a statement, and its place.
struct MacroError : std::runtime_error {
  MacroError(std::size_t offset_, std::string check_, const std::string& message)
      : std::runtime_error(message), offset(offset_), check(std::move(check_)) {}
  std::size_t offset;
  std::string check;
};

/// Reads expressions from text[at, end). `at` moves behind what was read. Throws MacroError [expression].
class ExpressionReader {
 public:
  ExpressionReader(Expressions& out, std::string_view text, std::size_t& at, std::size_t end)
      : out_(out), text_(text), at_(at), end_(end) {}

  /// True when a value that is no plain number begins here: a sign may stand before #, [ or a function.
  bool begins_value() const;
  /// The value of a word: a variable, [an expression] or a function. Returns its index in Expressions::list.
  std::uint32_t read_value();
  /// The right side of an assignment: an expression that needs no brackets.
  std::uint32_t read_open();
  /// [an expression]
  std::uint32_t read_bracketed();
  /// The number behind a #, up to before the =: 1, [#1 + 2], #1.
  std::uint32_t read_variable_number();
  /// The name in <name>; index of it.
  std::uint32_t read_name();

 private:
  enum class What : std::uint8_t { value, open, bracketed, variable_number };
  std::uint32_t read(What what);
  void read_as(What what);
  void binary(int min_priority);
  void operand();
  void parameter();
  void variable_number();
  void number();
  void bracketed();
  void function(Op op, std::size_t begin);
  std::optional<Op> function_here(std::size_t& length, bool* abbreviated = nullptr) const;
  std::optional<Op> operator_here(std::size_t& length, bool* abbreviated = nullptr) const;
  int priority(Op op) const;
  void push(Op op, std::size_t offset, double operand = 0);
  void skip_blanks();
  char peek();
  void expect(char c, std::string_view where);

  Expressions& out_;
  std::string_view text_;
  std::size_t& at_;
  std::size_t end_;
  int depth_ = 0;
  bool and_as_product_ = false;
  bool has_logic_ = false;
};

/// Source of the values of variables.
class VariableSource {
 public:
  virtual ~VariableSource() = default;
  /// `offset`: where it stands, for messages. Throw MacroError where there is no such variable.
  virtual Value get(double number, std::size_t offset) = 0;
  virtual Value get(const std::string& name, std::size_t offset) = 0;
  virtual bool known(double number) = 0;
  virtual bool known(const std::string& name) = 0;
};

/// `round_step`: what ROUND rounds to; 1 but in axis words. Throws MacroError [expression] where the value is no
/// number.
Value evaluate(const Expressions& expressions, std::uint32_t index, VariableSource& variables, const Dialect& dialect,
               double round_step = 1);

}  // namespace camber::nc
