#pragma once
// Output files are written to a temporary file and renamed when complete.
#include <exception>
#include <fstream>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

namespace camber {

class Diagnostics;

/// Creates `path` + ".part", or, if that exists, a part with a random name; existing files and links are not written
/// to. commit() brings the part to the disk and renames it to `path`. Without commit() the part is removed and an older
/// file at `path` is unchanged; the new file inherits the permissions of an older one. If `path` is a symbolic link,
/// its target is written. Other than regular files (/dev/stdout, a pipe) are written directly. "-" is standard output
/// where claim_standard_output() was called. Throws InputError [file-unwritable].
class OutputFile {
 public:
  explicit OutputFile(std::string path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  std::ofstream& stream() { return stream_; }
  /// Throws if not everything could be written.
  void commit();

 private:
  void discard();
  void close_descriptor();

  std::string path_;       ///< as given by the user
  std::string place_;      ///< with symbolic links resolved
  std::string part_path_;  ///< as place_ where that is no regular file
  std::ofstream stream_;
  bool committed_ = false;
  int descriptor_ = -1;  ///< descriptor of the unfinished file
  int slot_ = -1;        ///< among the parts that a signal removes
};

/// From now on SIGINT, SIGTERM and SIGHUP say which files had been written, remove the parts of files that are not
/// whole and the folders of make_folder() that are empty, and end the process.
void remove_parts_on_signals();

/// Standard output is for the file "-" alone from now on; what is printed goes to standard error.
void claim_standard_output();

/// Checks in advance that OutputFile(path) will succeed: the folder exists and is writable, `path` is not a folder, an
/// existing file is not write-protected. An empty path is accepted. Throws InputError [file-unwritable].
void require_writable(const std::string& path);

/// Writes a small file.
void write_file(const std::string& path, std::string_view content);

/// Makes a folder where it is not there; remove_empty_folders() takes back those that it made. Throws InputError
/// [file-unwritable].
void make_folder(const std::string& path);
void remove_empty_folders();

/// Runs `write` and adds its write errors to `failed`, so that on a full disk the remaining files are still written and
/// the figures printed.
void try_to_write(const std::function<void()>& write, Diagnostics& failed);

/// Keeps the first exception of several pieces of work, of one thread or of many, until all of them have ended. In a
/// tbb::task_group an exception that leaves a task stops the parallel loops of the others half way, and what they were
/// computing would be written as if it were whole.
class FirstFailure {
 public:
  /// Does `work`; does not throw.
  template <typename Work>
  void guard(const Work& work) noexcept {
    try {
      work();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!first_) first_ = std::current_exception();
    }
  }

  /// Throws what the first piece that failed has thrown. Called after all have ended.
  void rethrow() const {
    if (first_) std::rethrow_exception(first_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr first_;
};

}  // namespace camber
