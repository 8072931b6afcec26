#include "distribute/section_run.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>

#include <fmt/format.h>

#include "base/bytes.h"
#include "base/folders.h"
#include "base/output_file.h"
#include "compensate/header.h"

namespace camber::distribute {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "camber part 5\n";
constexpr std::size_t kHashLength = 16;

constexpr std::string_view kOwn = "own-";

struct PartFile {
  std::string version, name;
  PartKey key;
  std::string content;
};

/// Makes the bytes that stand before the content.
std::string head_of(const PartName& name, const PartKey& key) {
  ByteWriter out;
  out.text(CAMBER_VERSION);
  out.text(file_name(name));
  out.text(key.job_path);
  out.text(key.hash);
  out.value(static_cast<std::uint64_t>(key.sections));
  out.value(static_cast<std::uint64_t>(key.forces_at));
  return out.take();
}

void read_head(ByteReader& in, PartFile& out) {
  out.version = in.text();
  out.name = in.text();
  out.key.job_path = in.text();
  out.key.hash = in.text();
  out.key.sections = in.value<std::uint64_t>();
  out.key.forces_at = in.value<std::uint64_t>();
}

std::string bytes_of_file(const std::string& path) {
  require_confined(path);
  std::ifstream in(path, std::ios::binary);
  std::string out(static_cast<std::size_t>(fs::file_size(path)), '\0');
  in.read(out.data(), static_cast<std::streamsize>(out.size()));
  out.resize(static_cast<std::size_t>(in.gcount()));
  return out;
}

/// A part without its content, which is long: where that begins in the file, and how many bytes it has. Nothing where
/// the file is not whole.
struct PartHead {
  PartFile part;
  std::uint64_t begin = 0, bytes = 0;
};
std::optional<PartHead> head_of_file(const std::string& path) {
  require_confined(path);
  constexpr std::size_t kBefore = kMagic.size() + kHashLength, kTogether = std::size_t{1} << 20;
  std::ifstream in(path, std::ios::binary);
  std::string before(kBefore, '\0'), bytes(kTogether, '\0');
  in.read(before.data(), kBefore);
  if (!in || std::string_view(before).substr(0, kMagic.size()) != kMagic) return std::nullopt;
  PartHead out;
  compensate::RunningHash hash;
  for (bool first = true; in; first = false) {
    in.read(bytes.data(), kTogether);
    const std::string_view read(bytes.data(), static_cast<std::size_t>(in.gcount()));
    hash.add(read);
    out.bytes += read.size();
    if (!first) continue;
    try {
      ByteReader head(read);
      read_head(head, out.part);
      out.begin = kBefore + read.size() - head.left();
    } catch (const BytesMissing&) {
      return std::nullopt;
    }
  }
  if (hash.text() != std::string_view(before).substr(kMagic.size())) return std::nullopt;
  out.bytes -= out.begin - kBefore;
  return out;
}

/// Unpacks a part; returns nothing where the file is not whole.
std::optional<PartFile> unpacked(std::string text) {
  constexpr std::size_t kHead = kMagic.size() + kHashLength;
  const std::string_view all = text;
  if (all.size() < kHead || all.substr(0, kMagic.size()) != kMagic) return std::nullopt;
  if (compensate::hash_of(all.substr(kHead)) != all.substr(kMagic.size(), kHashLength)) return std::nullopt;
  try {
    ByteReader in(all.substr(kHead));
    PartFile out;
    read_head(in, out);
    text.erase(0, text.size() - in.left());
    out.content = std::move(text);
    return out;
  } catch (const BytesMissing&) {
    return std::nullopt;
  }
}

/// Lists the part files in the order of their names, without those that a section keeps for itself.
std::vector<std::string> part_files(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(folder + "/parts", ec))
    if (entry.path().extension() == ".part" && !entry.path().filename().string().starts_with(kOwn))
      files.push_back(entry.path().string());
  std::ranges::sort(files);
  return files;
}

std::string command_of(const PartName& name, const PartKey& key, const std::string& folder) {
  return fmt::format("camber predict {} -o {} --sections {} --section {} --stage {}{}{}", key.job_path, folder,
                     name.sections, name.section + 1, name.stage == PartStage::sweep ? "sweep" : "solve",
                     name.stage == PartStage::solve && name.round > 1 ? fmt::format(" --round {}", name.round) : "",
                     key.forces_at > 0 ? fmt::format(" --forces-at {}", key.forces_at) : "");
}

}  // namespace

std::string file_name(const PartName& name) {
  const std::string place = fmt::format("{:03}-of-{:03}.part", name.section + 1, name.sections);
  const std::string of = name.stage == PartStage::sweep ? "sweep-" : fmt::format("solve-{}-", name.round);
  return (name.own ? std::string(kOwn) : std::string()) + of + place;
}

PartKey part_key(const machine::Job& job, std::size_t sections, std::size_t forces_at) {
  return {job.path, compensate::hash_of_inputs(job), sections, forces_at};
}

std::string PartFiles::path(const PartName& name) const { return folder_ + "/parts/" + file_name(name); }

bool PartFiles::has(const PartName& name) {
  std::error_code ec;
  if (!fs::is_regular_file(path(name), ec)) return false;
  const auto found = head_of_file(path(name));
  return found && found->part.version == CAMBER_VERSION && found->part.key.hash == key_.hash &&
         found->part.key.forces_at == key_.forces_at && found->part.name == file_name(name);
}

void PartFiles::give(const PartName& name, const Write& write) {
  make_folder(folder_);
  make_folder(folder_ + "/parts");
  OutputFile file(path(name));
  compensate::RunningHash hash;
  const auto put = [&](std::string_view bytes) {
    hash.add(bytes);
    file.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  };
  file.stream() << kMagic << std::string(kHashLength, ' ');
  put(head_of(name, key_));
  write(put);
  file.stream().seekp(static_cast<std::streamoff>(kMagic.size()));
  file.stream() << hash.text();
  file.commit();
}

std::string PartFiles::again(const PartName& name) const { return "run " + command_of(name, key_, folder_); }

void PartFiles::refuse_torn(const PartName& name) const {
  fail_on_file(path(name), "is not whole; a part that was written to its end was expected: " + again(name),
               "part-torn");
}

void PartFiles::expect_there(const PartName& name) const {
  std::error_code ec;
  if (!fs::is_regular_file(path(name), ec))
    fail_on_file(path(name), "is missing; the part of this section was expected: " + again(name), "part-missing");
}

void PartFiles::expect_own(const PartName& name, const std::string& version, const std::string& of_name,
                           const PartKey& key) const {
  if (version != CAMBER_VERSION)
    fail_on_file(path(name),
                 fmt::format("was written by camber {}, this is {}; parts of one version were expected: {}", version,
                             CAMBER_VERSION, again(name)),
                 "part-version");
  if (key.hash != key_.hash || key.forces_at != key_.forces_at || of_name != file_name(name))
    fail_on_file(path(name),
                 fmt::format("is of another job, program or setting (hash {}) than {} now (hash {}): {}", key.hash,
                             key_.job_path, key_.hash, again(name)),
                 "part-job");
}

std::string PartFiles::take(const PartName& name) {
  expect_there(name);
  auto found = unpacked(bytes_of_file(path(name)));
  if (!found) refuse_torn(name);
  expect_own(name, found->version, found->name, found->key);
  return std::move(found->content);
}

void PartFiles::check(const PartName& name) {
  expect_there(name);
  const auto found = head_of_file(path(name));
  if (!found) refuse_torn(name);
  expect_own(name, found->part.version, found->part.name, found->part.key);
}

std::function<std::string()> PartFiles::take_pieces(const PartName& name) {
  expect_there(name);
  const auto found = head_of_file(path(name));
  if (!found) refuse_torn(name);
  expect_own(name, found->part.version, found->part.name, found->part.key);
  auto in = std::make_shared<std::ifstream>(path(name), std::ios::binary);
  in->seekg(static_cast<std::streamoff>(found->begin));
  return [this, name, in, left = found->bytes]() mutable {
    std::uint64_t size = 0;
    in->read(reinterpret_cast<char*>(&size), sizeof size);
    if (!*in || left < sizeof size || left - sizeof size < size) refuse_torn(name);
    left -= sizeof size + size;
    std::string out(size, '\0');
    in->read(out.data(), static_cast<std::streamsize>(size));
    if (!*in) refuse_torn(name);
    return out;
  };
}

PartKey find_parts(const std::string& folder) {
  std::optional<PartKey> out;
  for (const std::string& file : part_files(folder)) {
    const auto found = unpacked(bytes_of_file(file));
    if (!found) continue;
    if (out && out->sections != found->key.sections)
      fail_on_file(folder,
                   fmt::format("has parts of {} and of {} sections; parts of one prediction were expected",
                               out->sections, found->key.sections),
                   "part-sections");
    out = found->key;
  }
  if (!out)
    fail_on_file(folder, "has no parts of a prediction; camber predict --sections N --section I writes them",
                 "part-missing");
  return *out;
}

int last_round(const std::string& folder, const PartKey& key) {
  int out = 0;
  for (const std::string& file : part_files(folder)) {
    const std::string name = fs::path(file).filename().string();
    if (name.rfind("solve-", 0) != 0) continue;
    const auto found = unpacked(bytes_of_file(file));
    if (!found || found->key.hash == key.hash) out = std::max(out, std::atoi(name.c_str() + 6));
  }
  return out;
}

}  // namespace camber::distribute
