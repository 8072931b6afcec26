#include "cli/outputs.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include "base/diagnostics.h"
#include "base/output_file.h"

namespace camber::cli {
namespace {

namespace fs = std::filesystem;

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ec;
  if (fs::exists(a, ec) && fs::exists(b, ec)) return fs::equivalent(a, b, ec) && fs::is_regular_file(a, ec);
  return fs::absolute(a).lexically_normal() == fs::absolute(b).lexically_normal();
}

/// Returns the nearest folder above `path` that exists.
fs::path nearest_folder(fs::path path) {
  std::error_code ec;
  path = fs::absolute(path).lexically_normal();
  while (!fs::exists(path, ec) && path.has_relative_path()) path = path.parent_path();
  return path;
}

}  // namespace

void check_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].empty()) continue;
    require_writable(outputs[i]);
    for (const auto& input : inputs)
      if (!input.empty() && same_file(outputs[i], input))
        fail_on_file(outputs[i], "would be overwritten, but it is an input; another name was expected",
                     "output-is-input");
    for (std::size_t k = 0; k < i; ++k)
      if (!outputs[k].empty() && same_file(outputs[i], outputs[k]))
        fail_on_file(outputs[i], "is given for two outputs; another name was expected", "output-twice");
  }
}

void check_output_folder(const std::string& path) {
  std::error_code ec;
  const fs::path nearest = nearest_folder(path);
  if (!fs::is_directory(nearest, ec))
    fail_on_file(path, fmt::format("cannot be created as a folder: {} is a file", nearest.string()), "file-unwritable");
  if (access(nearest.c_str(), W_OK | X_OK) != 0)
    fail_on_file(path,
                 fmt::format("in the folder {} nothing can be written: {}", nearest.string(), std::strerror(errno)),
                 "file-unwritable");
}

}  // namespace camber::cli
