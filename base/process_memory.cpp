#include "base/process_memory.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace camber {
namespace {

constexpr double kUnknown = 1e18;

/// The number at the beginning of a file; none where there is no such file or it holds a word ("max").
std::optional<double> number_in(const std::string& path) {
  std::ifstream in(path);
  double value = 0;
  return in >> value ? std::optional(value) : std::nullopt;
}

/// The number behind a word at the beginning of a line; 0 where there is none.
double entry_of(const std::string& path, const std::string& word) {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);)
    if (line.starts_with(word)) return std::stod(line.substr(word.size()));
  return 0;
}

/// Returns the memory that a control group still allows. Files in its cache are given up when memory is needed.
double left_in_group(const std::string& folder, const char* limit, const char* used) {
  const auto max = number_in(folder + limit), now = number_in(folder + used);
  if (!max || !now) return kUnknown;
  return std::max(0.0, *max - *now + entry_of(folder + "/memory.stat", "inactive_file "));
}

/// Returns the least that the control groups of the process (versions 2 and 1) and those above them still allow.
double left_in_groups() {
  double left = kUnknown;
  std::ifstream in("/proc/self/cgroup");
  for (std::string line; std::getline(in, line);) {
    const bool second = line.starts_with("0::");
    if (!second && line.find(":memory:") == std::string::npos) continue;
    const std::string root = second ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory";
    for (std::string path = line.substr(line.rfind(':') + 1);; path.resize(path.rfind('/'))) {
      if (path == "/") path.clear();
      left = std::min(left, second ? left_in_group(root + path, "/memory.max", "/memory.current")
                                   : left_in_group(root + path, "/memory.limit_in_bytes", "/memory.usage_in_bytes"));
      if (path.empty()) break;
    }
  }
  return left;
}

}  // namespace

double free_memory_bytes() {
  const double available = 1024 * entry_of("/proc/meminfo", "MemAvailable:");
  return std::min(available > 0 ? available : kUnknown, left_in_groups());
}

double used_memory_bytes() { return 1024 * entry_of("/proc/self/status", "VmRSS:"); }

void return_freed_memory() {
#if defined(__GLIBC__)
  malloc_trim(0);
#endif
}

}  // namespace camber
