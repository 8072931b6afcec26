#include "ui/folder.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "base/diagnostics.h"
#include "base/folders.h"
#include "base/output_file.h"

namespace camber::ui {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxJob_bytes = 1u << 22;

bool is_name(std::string_view name) {
  if (name.empty() || name.starts_with('/') || name.find('\\') != std::string_view::npos) return false;
  for (const unsigned char c : name)
    if (c < 0x20 || c == 0x7f) return false;
  while (!name.empty()) {
    const std::size_t end = std::min(name.find('/'), name.size());
    const std::string_view part = name.substr(0, end);
    if (part.empty() || part == "." || part == ".." || part.starts_with('-')) return false;
    name.remove_prefix(std::min(end + 1, name.size()));
  }
  return true;
}

std::string read(const std::string& path, std::size_t most) {
  std::ifstream in(path, std::ios::binary);
  std::string out(most, '\0');
  in.read(out.data(), static_cast<std::streamsize>(most));
  out.resize(static_cast<std::size_t>(in.gcount()));
  return out;
}

/// A top-level key `program`.
bool is_job(const fs::path& path) {
  std::error_code ec;
  if (path.extension() != ".toml" || fs::file_size(path, ec) > kMaxJob_bytes || ec) return false;
  const std::vector<JobField> fields = job_fields(read(path.string(), kMaxJob_bytes));
  return std::ranges::any_of(fields,
                             [](const JobField& f) { return f.table.empty() && f.key == "program" && !f.is_default; });
}

/// Results are listed with their job.
bool is_searched(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename().string();
  return entry.is_directory() && !entry.is_symlink() && !name.starts_with('.') && !name.ends_with(".results");
}

}  // namespace

Folder::Folder(const std::string& path) {
  std::error_code ec;
  path_ = fs::canonical(path, ec).string();
  if (ec || !fs::is_directory(path_, ec)) fail_on_file(path, "no such folder", "file-missing");
}

std::string Folder::place(std::string_view name) const {
  if (!is_name(name)) throw Refused{403, fmt::format("{} is no name of a file in the folder", name)};
  std::string out = path_ + "/" + std::string(name);
  if (!lies_below(path_, out)) throw Refused{403, fmt::format("{} lies outside the folder", name)};
  return out;
}

std::string Folder::file(std::string_view name) const {
  std::string out = place(name);
  std::error_code ec;
  if (!fs::is_regular_file(out, ec)) throw Refused{404, fmt::format("{}: no such file", name)};
  return out;
}

std::string Folder::text(std::string_view name) const {
  const std::string path = file(name);
  std::error_code ec;
  const auto bytes = fs::file_size(path, ec);
  if (bytes > kMaxText_bytes) throw Refused{413, fmt::format("{} has {} bytes", name, bytes)};
  return read(path, static_cast<std::size_t>(bytes));
}

void Folder::write(std::string_view name, std::string_view content) const { write_file(place(name), content); }

void Folder::make_folder(std::string_view name) const {
  std::error_code ec;
  fs::create_directories(place(name), ec);
  if (ec) throw Refused{500, fmt::format("{} cannot be made: {}", name, ec.message())};
}

std::string Folder::scratch() const {
  make_folder(".camber");
  return ".camber";
}

std::vector<std::string> Folder::jobs() const {
  std::vector<std::string> out;
  std::error_code ec;
  for (fs::recursive_directory_iterator at(path_, fs::directory_options::skip_permission_denied, ec), end;
       !ec && at != end; at.increment(ec)) {
    if (at->is_directory() && (at.depth() >= kMaxDepth || !is_searched(*at))) at.disable_recursion_pending();
    if (at->is_symlink() || !at->is_regular_file() || !is_job(at->path())) continue;
    const std::string name = at->path().lexically_relative(path_).generic_string();
    if (is_name(name) && !at->path().filename().string().starts_with('.')) out.push_back(name);
  }
  std::ranges::sort(out);
  return out;
}

std::vector<std::string> Folder::files_beside(std::string_view job) const {
  std::vector<std::string> out;
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(fs::path(place(job)).parent_path(), ec)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file() && is_name(name) && !name.starts_with('.')) out.push_back(name);
  }
  std::ranges::sort(out);
  return out;
}

JobSummary job_summary(const Folder& folder, std::string_view job) {
  JobSummary out{std::string(job), {}, {}, {}, job_fields(folder.text(job))};
  for (const JobField& f : out.fields)
    if (f.table.empty() && f.key == "program" && !f.is_default)
      for (const std::string& name : texts_of(f.value)) out.programs.push_back(beside(job, name));
  const std::string machine = field_text(out.fields, "", "machine");
  out.machine = machine.empty() || machine.starts_with("preset:") ? machine : beside(job, machine);
  out.units = field_text(out.fields, "", "units");
  return out;
}

std::string results_of(std::string_view job) {
  return std::string(job.substr(0, job.ends_with(".toml") ? job.size() - 5 : job.size())) + ".results";
}

std::string folder_of(std::string_view name) { return std::string(name.substr(0, name.rfind('/') + 1)); }

std::string beside(std::string_view job, std::string_view name) {
  const fs::path path(name);
  if (path.is_absolute()) return path.string();
  return (fs::path(folder_of(job)) / path).lexically_normal().generic_string();
}

std::string upload_name(std::string_view given) {
  constexpr std::size_t kMaxBytes = 120;
  const std::string_view name = given.substr(given.find_last_of("/\\") + 1);
  if (!is_name(name) || name.starts_with('.') || name.size() > kMaxBytes)
    throw Refused{400, fmt::format("\"{}\" cannot be the name of a file here", name)};
  return std::string(name);
}

}  // namespace camber::ui
