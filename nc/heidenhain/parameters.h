#pragma once
// Q, QL, QR and QS parameters, and formulas of them.
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "nc/heidenhain/cursor.h"

namespace camber::nc::heidenhain {

/// An error in a formula or a value, and its place.
struct FormulaError : std::runtime_error {
  FormulaError(std::size_t at, std::string name, const std::string& message)
      : std::runtime_error(message), offset(at), check(std::move(name)) {}
  std::size_t offset;
  std::string check;
};

/// Q5, QL5, QR5, QS5.
struct ParameterName {
  char kind = 'Q';  ///< Q, L, R, S
  int number = 0;
  auto operator<=>(const ParameterName&) const = default;
  std::string text() const;
};

class Parameters {
 public:
  /// Values that the control keeps itself (Q108: radius of the tool); nothing for others.
  std::function<std::optional<double>(int)> system{};

  /// The value; NaN where only the machine knows it. Throws FormulaError [undefined-parameter] where it was never set.
  double value(const ParameterName& name, std::size_t offset);
  void set(const ParameterName& name, double value);
  /// Marks a value that only the machine knows: `why` is said where a move depends on it.
  void set_unknown(const ParameterName& name, std::string why);
  /// NaN for a function that asks the control; its brackets are passed over.
  double of_control(Cursor& at, const std::string& name);
  bool is_defined(const ParameterName& name) const;
  const std::string& text(int number) const;
  void set_text(int number, std::string value) { texts_[number] = std::move(value); }

  /// Returns the reason for the last NaN that value() gave.
  const std::string& why_unknown() const { return why_; }

  /// QL parameters belong to a program: called programs have their own.
  void enter_program() { local_.emplace_back(); }
  void leave_program() { local_.pop_back(); }

 private:
  std::map<int, double>& values_of(char kind);
  std::map<int, double> q_, r_;
  std::vector<std::map<int, double>> local_{1};
  std::map<int, std::string> texts_;
  std::map<ParameterName, std::string> unknown_;
  std::string why_;
};

/// Q5, QL5, QR5, QS5 at the cursor; nothing, and no move, where none stands there.
std::optional<ParameterName> read_parameter(Cursor& at);

/// A number, or a parameter with a sign.
double read_value(Cursor& at, Parameters& parameters);

/// A formula: numbers, parameters, + - * / % ^, brackets, functions with or without brackets. Angles in degrees.
double read_formula(Cursor& at, Parameters& parameters);

/// Returns whether the cursor is at a text: "..." or a QS parameter.
bool is_text(Cursor& at);

/// A text: "..." and QS parameters joined by ||, TOCHAR, SUBSTR.
std::string read_text_formula(Cursor& at, Parameters& parameters);

}  // namespace camber::nc::heidenhain
