#include "api/job.h"

#include <cmath>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include "machine/assumptions.h"
#include "machine/job_file.h"
#include "machine/set_number.h"

namespace camber {

const std::string& Machine::path() const { return impl_->machine.path; }
const std::vector<Diagnostic>& Machine::diagnostics() const { return impl_->found.all(); }
const std::vector<std::string>& Machine::translation() const { return impl_->machine.translation; }
std::string Machine::to_toml() const { return machine::to_toml(impl_->machine); }

void Machine::set(std::string_view key, double value) {
  auto changed = std::make_shared<Impl>(*impl_);
  const std::string wrong = machine::set_number(changed->machine, key, value);
  if (!wrong.empty()) throw std::invalid_argument(wrong);
  impl_ = std::move(changed);
}

Machine v0::read_machine(const std::string& path) {
  auto impl = std::make_shared<Machine::Impl>();
  impl->machine = machine::read_machine(path, impl->found);
  impl->found.throw_if_errors();
  return Machine(std::move(impl));
}

const std::string& Job::path() const { return impl_->job.path; }
const std::string& Job::program_path() const { return impl_->job.program; }
const std::vector<Diagnostic>& Job::diagnostics() const { return impl_->found.all(); }
std::string Job::to_toml() const { return machine::to_toml(impl_->job); }

std::vector<std::string> Job::files() const {
  const machine::Job& job = impl_->job;
  return {job.path, job.program, job.machine_path, job.stock.mesh, job.stock.vdb, job.part.mesh, job.part.program};
}

Machine Job::machine() const {
  auto impl = std::make_shared<Machine::Impl>();
  impl->machine = impl_->job.machine;
  return Machine(std::move(impl));
}

void Job::set_program(const std::string& path) {
  auto changed = std::make_shared<Impl>(*impl_);
  changed->job.program = path;
  impl_ = std::move(changed);
}

void Job::set_machine(const Machine& machine) {
  auto changed = std::make_shared<Impl>(*impl_);
  changed->job.machine = machine.impl().machine;
  changed->job.machine_path = machine.path();
  impl_ = std::move(changed);
}

void Job::set_voxel_mm(double voxel_mm) {
  if (!(voxel_mm > 0) || !std::isfinite(voxel_mm))
    throw std::invalid_argument(fmt::format("voxel_mm = {}: a number greater than zero was expected", voxel_mm));
  auto changed = std::make_shared<Impl>(*impl_);
  changed->job.simulation.voxel_mm = voxel_mm;
  impl_ = std::move(changed);
}

Job v0::read_job(const std::string& path) {
  auto impl = std::make_shared<Job::Impl>();
  impl->job = machine::read_job(path, impl->found);
  impl->found.throw_if_errors();
  return Job(std::move(impl));
}

Job v0::read_unprogrammed_job(const std::string& path) {
  auto impl = std::make_shared<Job::Impl>();
  impl->job = machine::read_unprogrammed_job(path, impl->found);
  impl->found.throw_if_errors();
  return Job(std::move(impl));
}

std::vector<std::string> Job::assumed() const { return machine::assumptions(impl_->job); }

JobOfPrograms v0::read_job_of_programs(const std::string& path) {
  auto impl = std::make_shared<Job::Impl>();
  machine::JobOfPrograms read = machine::read_job_of_programs(path, impl->found);
  impl->found.throw_if_errors();
  impl->job = std::move(read.job);
  return {Job(std::move(impl)), std::move(read.programs)};
}

Job JobOfPrograms::of_program(std::size_t index, const std::string& stock) const {
  auto impl = std::make_shared<Job::Impl>(job.impl());
  if (index > 0) impl->found = {};
  impl->job.program = programs[index];
  if (!stock.empty()) {
    impl->job.stock = {};
    impl->job.stock.vdb = stock;
  }
  return Job(std::move(impl));
}

std::string JobOfPrograms::name(std::size_t index) const {
  return fmt::format("{}-{}", index + 1, std::filesystem::path(programs[index]).stem().string());
}

const machine::Job& api::programmed(const Job& job) {
  if (!job.program_path().empty()) return job.impl().job;
  Diagnostics found = job.impl().found;
  found.add({Severity::error,
             {job.path(), 0, 0},
             "the job has no program; a program in the file, or set_program(), was expected",
             "job-program",
             {}});
  found.throw_if_errors();
  return job.impl().job;
}

}  // namespace camber
