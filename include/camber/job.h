#pragma once
// A job: program, machine, tools, material and stock, as in job.toml.
#include <cstddef>
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
  /// The files that it names, itself included; names may be empty.
  std::vector<std::string> files() const;
  /// Warnings found while reading.
  const std::vector<Diagnostic>& diagnostics() const;
  /// Text of an equivalent job.toml with all defaults filled in and resolved paths.
  std::string to_toml() const;

  /// Setters for parameter studies.
  void set_program(const std::string& path);
  void set_machine(const Machine& machine);
  /// Greater than zero, else std::invalid_argument.
  void set_voxel_mm(double voxel_mm);

  /// A sentence for each value that nobody gave and that is only assumed; results begin with them.
  std::vector<std::string> assumed() const;

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

/// A job, and its programs in their order, one or more. Each begins on what the one before it has left.
struct JobOfPrograms {
  Job job;  ///< job of the first program
  std::vector<std::string> programs{};

  /// The job of a program, counted from 0; `stock`: the stock.vdb that the program before it has left; empty: the job's
  /// own blank. Only the first has the warnings of the files.
  CAMBER_API Job of_program(std::size_t index, const std::string& stock = {}) const;
  /// Name of a program's results: its place and its file's name, "2-finish".
  CAMBER_API std::string name(std::size_t index) const;
};
/// Reads a job with one or several programs; read_job refuses several.
CAMBER_API JobOfPrograms read_job_of_programs(const std::string& path);

}  // namespace v0
}  // namespace camber
