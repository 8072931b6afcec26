#pragma once
// A job: which program on which machine, with which tools, into which stock, as job.toml describes it.
#include <memory>
#include <string>
#include <vector>

#include "camber/machine.h"

namespace camber {
inline namespace v0 {

/// A value; copies are independent.
class CAMBER_API Job {
 public:
  const std::string& path() const;
  const std::string& program_path() const;
  Machine machine() const;
  /// What was noticed while it was read: warnings.
  const std::vector<Diagnostic>& diagnostics() const;
  /// The text of a job.toml with every default filled in and paths as they were resolved.
  std::string to_toml() const;

  /// A study changes one of these and runs the job again.
  void set_program(const std::string& path);
  void set_machine(const Machine& machine);
  /// Greater than zero, else std::invalid_argument.
  void set_voxel_mm(double voxel_mm);

  struct Impl;
  explicit Job(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

/// Reads the job and its machine. Throws InputError with file, line and column.
CAMBER_API Job read_job(const std::string& path);

}  // namespace v0
}  // namespace camber
