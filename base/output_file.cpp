#include "base/output_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "base/diagnostics.h"

namespace camber {

OutputFile::OutputFile(std::string path) : path_(std::move(path)), part_path_(path_ + ".part") {
  errno = 0;
  stream_.open(part_path_, std::ios::binary | std::ios::trunc);
  if (!stream_) fail_on_file(path_, std::string("cannot be written: ") + std::strerror(errno), "file-unwritable");
}

OutputFile::~OutputFile() {
  if (committed_) return;
  stream_.close();
  std::error_code ec;
  std::filesystem::remove(part_path_, ec);
}

void OutputFile::commit() {
  stream_.close();
  if (stream_.fail()) fail_on_file(path_, "could not be written to its end (is the disk full?)", "file-unwritable");
  std::error_code ec;
  std::filesystem::rename(part_path_, path_, ec);
  if (ec) fail_on_file(path_, "cannot be written: " + ec.message(), "file-unwritable");
  committed_ = true;
}

void write_file(const std::string& path, std::string_view content) {
  OutputFile file(path);
  file.stream().write(content.data(), static_cast<std::streamsize>(content.size()));
  file.commit();
}

}  // namespace camber
