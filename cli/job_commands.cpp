#include "cli/job_commands.h"

#include <fmt/format.h>

#include "cli/console.h"

namespace camber::cli {

int print_effective_job(const std::string& path, const GlobalOptions& options) {
  const Job job = read_job(path);
  settle(job.diagnostics(), options);
  const Machine machine = job.machine();
  fmt::print("# {}\n{}\n# {}\n{}", path, job.to_toml(), machine.path(), machine.to_toml());
  return kDone;
}

std::vector<std::string> files_read(const std::string& job_path, std::vector<std::string> others) {
  const JobOfPrograms all = read_job_of_programs(job_path);
  const std::vector<std::string> files = all.job.files();
  others.insert(others.end(), all.programs.begin(), all.programs.end());
  others.insert(others.end(), files.begin(), files.end());
  return others;
}

bool has_several_programs(const std::string& job_path) { return read_job_of_programs(job_path).programs.size() > 1; }

}  // namespace camber::cli
