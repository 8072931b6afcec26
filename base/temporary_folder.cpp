#include "base/temporary_folder.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "base/diagnostics.h"

namespace camber {

TemporaryFolder::TemporaryFolder() {
  std::error_code none;
  path_ = (std::filesystem::temp_directory_path(none) / "camber-XXXXXX").string();
  if (mkdtemp(path_.data()) == nullptr)
    fail_on_file(path_, fmt::format("the folder for intermediate files cannot be made: {}", std::strerror(errno)),
                 "output");
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code left;
  std::filesystem::remove_all(path_, left);
}

}  // namespace camber
