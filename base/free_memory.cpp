#include "base/free_memory.h"

#include <fstream>
#include <string>

namespace camber {

double free_memory_bytes() {
  std::ifstream in("/proc/meminfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("MemAvailable:")) return 1024.0 * std::stod(line.substr(13));
  return 1e18;
}

}  // namespace camber
