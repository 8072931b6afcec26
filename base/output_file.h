#pragma once
// Output files are written beside their place and renamed when they are whole.
#include <fstream>
#include <functional>
#include <string>
#include <string_view>

namespace camber {

class Diagnostics;

/// Creates `path` + ".part", or where something has that name already, a part with a random name: no file or link that
/// is there is written to. commit() flushes the part and renames it to `path`. Without commit() the part is removed
/// and an older file at `path` stays as it was; a newer one takes over its permissions. Where `path` is a symbolic
/// link, what it points to is written. What is no regular file (/dev/stdout, a pipe) is written as it goes. "-" is
/// standard output where claim_standard_output() was called. Throws InputError [file-unwritable].
class OutputFile {
 public:
  explicit OutputFile(std::string path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  std::ofstream& stream() { return stream_; }
  /// Throws where not everything could be written.
  void commit();

 private:
  std::string path_;       ///< as the user says it
  std::string place_;      ///< behind symbolic links
  std::string part_path_;  ///< as place_ where that is no regular file
  std::ofstream stream_;
  bool committed_ = false;
  int slot_ = -1;  ///< among the parts that a signal removes
};

/// From now on SIGINT, SIGTERM and SIGHUP say which files had been written, remove the parts of files that are not
/// whole and the folders of make_folder() that are empty, and end the process.
void remove_parts_on_signals();

/// Standard output is for the file "-" alone from now on; what is printed goes to standard error.
void claim_standard_output();

/// Says before the work what stands in the way of OutputFile(path): a folder that is not there or may not be written
/// in, a folder in the file's place, a file that is write-protected. An empty path is fine.
/// Throws InputError [file-unwritable].
void require_writable(const std::string& path);

/// The whole of a small file at once.
void write_file(const std::string& path, std::string_view content);

/// Makes a folder where it is not there; remove_empty_folders() takes back those that it made. Throws InputError
/// [file-unwritable].
void make_folder(const std::string& path);
void remove_empty_folders();

/// Runs `write` and adds to `failed` what it could not write: when a disk is full, what still can be written is, and
/// the figures are printed.
void try_to_write(const std::function<void()>& write, Diagnostics& failed);

}  // namespace camber
