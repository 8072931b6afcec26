#pragma once
// Folders of a process: the one in which it reads and writes alone (camber --only-in, the runs of camber ui), and
// temporary ones.
#include <string>

namespace camber {

/// From now on this process reads and writes user's files below `folder` alone. Reading and writing go through
/// require_confined() (SourceText, OutputFile and the few that open files themselves); intermediate files are made
/// there too. Throws InputError [file-missing] where there is no such folder.
void confine_files(const std::string& folder);

/// Throws InputError [file-outside] where confine_files() was called and `path`, all links resolved, lies outside.
/// A file that does not exist yet counts by the folder that it would be in.
void require_confined(const std::string& path);

/// Whether `path`, all links resolved, is `folder` or lies below it.
bool lies_below(const std::string& folder, const std::string& path);

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
