#include "nc/program_files.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

namespace camber::nc {

struct ProgramFiles::Index {
  std::unordered_map<double, std::vector<std::uint32_t>> numbered;  ///< N words
  std::unordered_map<std::uint32_t, std::uint32_t> programs;        ///< O words
  std::map<std::string, std::uint32_t> subs;                        ///< o100 sub
  std::vector<std::uint32_t> program_starts;
  std::vector<std::uint8_t> runs;
};

ProgramFiles::ProgramFiles(const Program& main, Diagnostics& diagnostics) : main_(main), diagnostics_(diagnostics) {}
ProgramFiles::~ProgramFiles() = default;

std::optional<std::uint32_t> program_number(const Program& file, std::uint32_t block) {
  for (const Word& w : file.words_of(block)) {
    if (w.letter == 'N') continue;
    if (w.letter != 'O' || !(w.value >= 0 && w.value < 1e9)) return std::nullopt;
    return static_cast<std::uint32_t>(w.value);
  }
  return std::nullopt;
}

ProgramFiles::Index& ProgramFiles::index(const Program& file) {
  auto& found = indexes_[&file];
  if (found) return *found;
  found = std::make_unique<Index>();
  for (std::uint32_t b = 0; b < file.blocks.size(); ++b) {
    for (const Word& w : file.words_of(b))
      if (w.letter == 'N') found->numbered[w.value].push_back(b);
    if (const auto number = program_number(file, b)) {
      found->programs.try_emplace(*number, b);
      found->program_starts.push_back(b);
    }
  }
  for (const Statement& s : file.macro.statements)
    if (s.kind == StatementKind::sub) found->subs.try_emplace(file.macro.labels[s.label], s.block);
  found->runs.resize(file.blocks.size());
  return *found;
}

std::vector<std::uint8_t>& ProgramFiles::runs(const Program& file) { return index(file).runs; }

void ProgramFiles::forget_runs() {
  for (auto& [file, index] : indexes_) std::fill(index->runs.begin(), index->runs.end(), 0);
}

const std::vector<std::uint32_t>& ProgramFiles::program_starts(const Program& file) {
  return index(file).program_starts;
}

/// The first of the names that is a file beside the main program.
const Program* ProgramFiles::file_named(const std::vector<std::string>& names) {
  const auto known = files_.find(names.front());
  if (known != files_.end()) return known->second.get();
  auto& file = files_[names.front()];
  const auto folder = std::filesystem::path(main_.source.name()).parent_path();
  for (const std::string& name : names) {
    const auto path = folder / name;
    std::error_code none;
    if (!std::filesystem::is_regular_file(path, none) || std::filesystem::equivalent(path, main_.source.name(), none))
      continue;
    file = std::make_unique<Program>(read_program(SourceText::read(path.string()), diagnostics_));
    break;
  }
  return file.get();
}

std::optional<BlockPlace> ProgramFiles::find_program(const Program& from, std::uint32_t number) {
  for (const Program* file : {&from, &main_}) {
    const auto& programs = index(*file).programs;
    if (const auto found = programs.find(number); found != programs.end()) return BlockPlace{file, found->second};
  }
  std::vector<std::string> names;
  const std::string own = std::filesystem::path(main_.source.name()).extension().string();
  for (const std::string& extension : {own, std::string(), std::string(".nc"), std::string(".NC"), std::string(".ngc"),
                                       std::string(".tap"), std::string(".eia"), std::string(".txt")})
    for (const char* letter : {"O", "o", ""})
      for (const std::string& digits :
           {fmt::format("{}", number), fmt::format("{:04}", number), fmt::format("{:05}", number)})
        names.push_back(letter + digits + extension);
  const Program* file = file_named(names);
  if (!file) return std::nullopt;
  const auto& programs = index(*file).programs;
  const auto found = programs.find(number);
  return BlockPlace{file, found != programs.end() ? found->second : 0};
}

std::optional<BlockPlace> ProgramFiles::find_sub(const Program& from, const std::string& label) {
  for (const Program* file : {&from, &main_}) {
    const auto& subs = index(*file).subs;
    if (const auto found = subs.find(label); found != subs.end()) return BlockPlace{file, found->second};
  }
  if (label.find('/') != std::string::npos) return std::nullopt;
  const Program* file = file_named({label + ".ngc", label + ".NGC", label + ".nc"});
  if (!file) return std::nullopt;
  const auto& subs = index(*file).subs;
  const auto found = subs.find(label);
  if (found == subs.end()) return std::nullopt;
  return BlockPlace{file, found->second};
}

std::optional<std::uint32_t> ProgramFiles::find_block(BlockPlace from, double number) {
  Index& all = index(*from.file);
  const auto found = all.numbered.find(number);
  if (found == all.numbered.end()) return std::nullopt;
  const auto after = std::upper_bound(all.program_starts.begin(), all.program_starts.end(), from.block);
  const std::uint32_t begin = after == all.program_starts.begin() ? 0 : *(after - 1);
  const std::uint32_t end =
      after == all.program_starts.end() ? static_cast<std::uint32_t>(from.file->blocks.size()) : *after;
  std::optional<std::uint32_t> first;
  for (const std::uint32_t block : found->second) {
    if (block < begin || block >= end) continue;
    if (block > from.block) return block;
    if (!first) first = block;
  }
  return first;
}

}  // namespace camber::nc
