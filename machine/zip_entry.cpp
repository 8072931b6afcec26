#include "machine/zip_entry.h"

#include <algorithm>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <zip.h>

#include "base/confined_files.h"

namespace camber::machine {
namespace {

constexpr zip_uint64_t kMax_bytes = 64u << 20;

struct Close {
  void operator()(zip_t* z) const { zip_discard(z); }
  void operator()(zip_file_t* f) const { zip_fclose(f); }
};

}  // namespace

SourceText read_zip_entry(const std::string& path, const std::string& ending, const std::string& check) {
  require_confined(path);
  std::error_code ec;
  if (!std::filesystem::exists(path, ec)) fail_on_file(path, "no such file", "file-missing");
  int error = 0;
  const std::unique_ptr<zip_t, Close> zip(zip_open(path.c_str(), ZIP_RDONLY, &error));
  if (!zip) fail_on_file(path, fmt::format("is not a zip file; one with a {} file in it was expected", ending), check);
  const auto entries = static_cast<zip_uint64_t>(std::max<zip_int64_t>(zip_get_num_entries(zip.get(), 0), 0));
  zip_uint64_t index = 0;
  std::string name;
  for (; index < entries; ++index) {
    const char* at = zip_get_name(zip.get(), index, 0);
    name = at ? at : "";
    if (name.ends_with(ending)) break;
  }
  if (index == entries) fail_on_file(path, fmt::format("is a zip file without a {} file", ending), check);
  zip_stat_t stat;
  if (zip_stat_index(zip.get(), index, 0, &stat) != 0 || (stat.valid & ZIP_STAT_SIZE) == 0 || stat.size > kMax_bytes)
    fail_on_file(path, fmt::format("contains {} of more than {} MB", name, kMax_bytes >> 20), check);
  const std::unique_ptr<zip_file_t, Close> file(zip_fopen_index(zip.get(), index, 0));
  std::string text(stat.size, '\0');
  if (!file || zip_fread(file.get(), text.data(), stat.size) != static_cast<zip_int64_t>(stat.size))
    fail_on_file(path, fmt::format("contains {}, which cannot be read: damaged, or under a password", name), check);
  return SourceText(path + "/" + name, std::move(text));
}

}  // namespace camber::machine
