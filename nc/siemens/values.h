#pragma once
// Values, variables and expressions of a running program.
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/geometry.h"
#include "nc/siemens/siemens_tree.h"

namespace camber::nc::siemens {

/// A statement cannot be carried out.
struct RunError : std::runtime_error {
  RunError(std::size_t at, std::string_view name, const std::string& message)
      : std::runtime_error(message), offset(at), check(name) {}
  std::size_t offset;
  std::string check;
};

/// point outside = linear * point inside + shift.
struct Affine {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Vec3 shift_mm = Vec3::Zero();
  Affine then_inside(const Affine& inner) const { return {linear * inner.linear, linear * inner.shift_mm + shift_mm}; }
  bool is_identity() const { return linear == Eigen::Matrix3d::Identity() && shift_mm == Vec3::Zero(); }
};

/// A number (NaN: not known), a text or a frame.
struct Value {
  double number = 0;
  std::shared_ptr<const std::string> text{};
  std::shared_ptr<const Affine> frame{};
};

struct Variable {
  ValueType type = ValueType::real;
  std::uint32_t dimensions = 0;
  std::uint32_t size[3] = {1, 1, 1};
  std::vector<Value> values{1};
  std::size_t count() const { return values.size(); }
};

/// Interface through which the evaluator asks the interpreter.
class SystemValues {
 public:
  virtual ~SystemValues() = default;
  /// Returns the value of $P_EP[X] and the like; nothing: it is not known.
  virtual std::optional<Value> system_value(const std::string& name, const std::vector<Value>& indexes,
                                            const std::vector<std::string>& index_names) = 0;
  virtual double unit_mm() const = 0;
};

/// Variables of one program level, by the names of its file.
struct Level {
  std::vector<std::shared_ptr<Variable>> variables;
};

class Evaluator {
 public:
  explicit Evaluator(SystemValues& system) : system_(system), r_(300, 0.0) {}

  void use(const Tree& tree, Level& level) { tree_ = &tree, level_ = &level; }
  const Tree& tree() const { return *tree_; }

  Value value(std::uint32_t node);
  /// A known or unknown (NaN) number.
  double number(std::uint32_t node);
  std::string text(std::uint32_t node);
  /// A condition. Throws where it is not known.
  bool truth(std::uint32_t node);
  /// A number that has to be known.
  double known_number(std::uint32_t node, std::string_view what);
  /// A name alone that no DEF has declared.
  bool is_undeclared(std::uint32_t node) const;

  void assign(const Item& item);
  void declare(const Declared& declared);
  std::shared_ptr<Variable> variable(std::uint32_t name) const;
  /// The variable, alone or with indexes, that a node names; null for any other expression.
  std::shared_ptr<Variable> whole_variable(std::uint32_t node) const;
  double& parameter(double number, std::size_t offset);
  /// Sets the variable, element or parameter that a node names, if it names one.
  void set_by_node(std::uint32_t node, const Value& value);
  const std::string& unknown_name() const { return unknown_name_; }
  /// The name of an axis or a variable of type AXIS: "X".
  std::string axis_name(std::uint32_t node);

 private:
  const Node& node(std::uint32_t index) const { return tree_->nodes[index]; }
  Value call(const Node& n);
  Value binary(const Node& n);
  Value system(const Node& n);
  Value frame_function(const Node& n, const std::string& name);
  std::size_t element(const Variable& variable, std::uint32_t first, std::uint32_t count, std::size_t offset);
  Value converted(const Value& value, ValueType type, std::size_t offset) const;
  [[noreturn]] void unknown(std::size_t offset, std::string_view what) const;

  SystemValues& system_;
  const Tree* tree_ = nullptr;
  Level* level_ = nullptr;
  std::vector<double> r_;
  std::string unknown_name_;
  int depth_ = 0;
};

}  // namespace camber::nc::siemens
