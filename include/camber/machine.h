#pragma once
// A machine tool and its control, as machine.toml describes them.
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "camber/diagnostics.h"

namespace camber {
inline namespace v0 {

/// A value; copies are independent.
class CAMBER_API Machine {
 public:
  const std::string& path() const;
  /// Warnings found while reading.
  const std::vector<Diagnostic>& diagnostics() const;
  /// How [source] of the file was read, a line each; empty: it has none.
  const std::vector<std::string>& translation() const;
  /// Text of an equivalent machine.toml with all defaults filled in.
  std::string to_toml() const;

  /// Sets a number by its key in the file, in the file's unit: "axis.x.acceleration_mm_per_s2"; "axis.all.KEY" sets
  /// the three axes. Throws std::invalid_argument for an unknown key or a value out of range.
  void set(std::string_view key, double value);

  struct Impl;
  explicit Machine(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

/// Throws InputError with file, line and column for unknown keys, wrong types and values out of range.
CAMBER_API Machine read_machine(const std::string& path);

}  // namespace v0
}  // namespace camber
