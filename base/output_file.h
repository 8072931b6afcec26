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
};

/// The whole of a small file at once.
void write_file(const std::string& path, std::string_view content);

}  // namespace camber
