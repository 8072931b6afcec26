#include "base/folders.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "base/diagnostics.h"

namespace camber {
namespace {

namespace fs = std::filesystem;

/// Set before the process has a second thread.
std::optional<std::string> confined_to;

/// Where a file lies that is written under this name: std::filesystem takes a link that leads to nothing for a file of
/// that name, the system makes what it leads to. Empty: more links than the system follows.
fs::path resolved(fs::path at) {
  constexpr int kMaxLinks = 40;
  std::error_code ec;
  at = fs::absolute(at, ec);
  for (int i = 0; i < kMaxLinks; ++i) {
    const fs::path folder = fs::weakly_canonical(at.parent_path(), ec);
    if (ec) return {};
    at = folder / at.filename();
    if (!fs::is_symlink(at, ec)) return fs::weakly_canonical(at, ec);
    const fs::path next = fs::read_symlink(at, ec);
    if (ec) return {};
    at = next.is_absolute() ? next : folder / next;
  }
  return {};
}

bool begins_with(const fs::path& path, const fs::path& folder) {
  auto at = path.begin();
  for (const fs::path& part : folder)
    if (!part.empty() && (at == path.end() || *at++ != part)) return false;
  return !path.empty();
}

}  // namespace

bool lies_below(const std::string& folder, const std::string& path) {
  std::error_code ec;
  const fs::path whole = fs::canonical(folder, ec);
  return !ec && begins_with(resolved(path), whole);
}

void confine_files(const std::string& folder) {
  std::error_code ec;
  const fs::path whole = fs::canonical(folder, ec);
  if (ec || !fs::is_directory(whole, ec)) fail_on_file(folder, "no such folder", "file-missing");
  confined_to = whole.string();
  setenv("TMPDIR", confined_to->c_str(), 1);
}

void require_confined(const std::string& path) {
  if (!confined_to || begins_with(resolved(path), *confined_to)) return;
  fail_on_file(path, fmt::format("lies outside {}; a file in that folder was expected", *confined_to), "file-outside");
}

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
