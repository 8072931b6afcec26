#pragma once
// A folder of one's own for files that others read by name; it goes with its contents.
#include <string>

namespace camber {

class TemporaryFolder {
 public:
  /// Throws InputError [output] where none can be made.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace camber
