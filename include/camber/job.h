#pragma once
// A job: program, machine, tools, material and stock, as in job.toml.
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
  /// Warnings found while reading.
  const std::vector<Diagnostic>& diagnostics() const;
  /// Text of an equivalent job.toml with all defaults filled in and resolved paths.
  std::string to_toml() const;

  /// Setters for parameter studies.
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
/// Reads a job as read_job does, but the file may leave out the program, or name one that is not there yet: for
/// posture(), or before set_program(). A command that needs a program throws InputError, [job-program], where the job
/// has none.
CAMBER_API Job read_unprogrammed_job(const std::string& path);

}  // namespace v0
}  // namespace camber
