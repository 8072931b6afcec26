#pragma once
// Variables of a running program: local ones for each level of calls, common ones, and those of the control.
#include <array>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "nc/expression.h"

namespace camber::nc {

class SystemVariables;

/// A level of local variables.
struct LocalVariables {
  static constexpr std::size_t kCount = 34;
  std::array<Value, kCount> numbered{};  ///< #1 .. #33
  std::map<std::string, double> named;   ///< #<name>
};

class Variables : public VariableSource {
 public:
  Variables(const Dialect& dialect, SystemVariables& system) : dialect_(dialect), system_(system), levels_(1) {}

  Value get(double number, std::size_t offset) override;
  Value get(const std::string& name, std::size_t offset) override;
  bool known(double number) override;
  bool known(const std::string& name) override;
  /// Throws MacroError [variable] for a variable that cannot be set.
  void set(double number, Value value, std::size_t offset);
  void set(const std::string& name, Value value, std::size_t offset);

  void enter_level(LocalVariables locals) { levels_.push_back(std::move(locals)); }
  void leave_level() { levels_.pop_back(); }
  std::size_t levels() const { return levels_.size(); }

 private:
  enum class Scope { local, common, system };
  Scope place_of(double number, std::size_t offset) const;

  const Dialect& dialect_;
  SystemVariables& system_;
  std::vector<LocalVariables> levels_;
  std::unordered_map<int, double> common_;
  std::map<std::string, double> global_;  ///< #<_name>
};

}  // namespace camber::nc
