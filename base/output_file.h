#pragma once
// Output files are written beside their place and renamed when they are whole.
#include <fstream>
#include <string>
#include <string_view>

namespace camber {

/// Opens `path` + ".part"; commit() flushes and renames it to `path`. Without commit() the part is removed
/// and an older file at `path` stays as it was. Throws InputError [file-unwritable].
class OutputFile {
 public:
  explicit OutputFile(std::string path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  std::ofstream& stream() { return stream_; }
  /// Where the unfinished file stands, for writers that open files by name.
  const std::string& part_path() const { return part_path_; }
  void commit();

 private:
  std::string path_, part_path_;
  std::ofstream stream_;
  bool committed_ = false;
  int slot_ = -1;  ///< among the parts that a signal removes
};

/// From now on SIGINT, SIGTERM and SIGHUP remove the parts of files that are not whole before they end the process.
void remove_parts_on_signals();

/// The whole of a small file at once.
void write_file(const std::string& path, std::string_view content);

}  // namespace camber
