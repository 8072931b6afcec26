#include "machine/cycle_cases.h"

#include <filesystem>

#include <fmt/format.h>

#include "machine/set_number.h"
#include "machine/toml_table.h"

namespace camber::machine {
namespace {

namespace fs = std::filesystem;

/// Path at `key` against the file's folder; "" where it is not given. The file must be there.
std::string file_at(TomlTable& table, std::string_view key, const fs::path& folder) {
  const std::string given = table.text(key, "");
  if (given.empty()) return {};
  const std::string path = (folder / given).lexically_normal().string();
  std::error_code ec;
  if (!fs::is_regular_file(path, ec))
    table.error_at(key, fmt::format("{}: no such file: {} (paths are relative to the folder of the cases)", key, path),
                   "file-missing");
  return path;
}

void read_set(TomlTable table, Machine& machine) {
  for (const auto& key : table.keys()) {
    const auto value = table.optional_number(key, kAnyNumberOrInf);
    if (!value) continue;
    const std::string wrong = set_number(machine, key, *value);
    if (!wrong.empty()) table.error_at(key, wrong, "case-set");
  }
}

CycleCase read_case(const std::string& name, TomlTable table, const fs::path& folder, const Machine* fallback,
                    Diagnostics& diagnostics) {
  CycleCase out;
  out.name = name;
  out.title = table.text("title", "");
  out.program = file_at(table, "program", folder);
  const std::string machine = file_at(table, "machine", folder);
  std::error_code ec;
  if (!machine.empty() && fs::is_regular_file(machine, ec))
    out.machine = read_machine(machine, diagnostics);
  else if (machine.empty() && fallback)
    out.machine = *fallback;
  else if (machine.empty())
    table.missing("machine", "a machine.toml, here or by --machine,");
  if (auto set = table.table("set")) read_set(*set, out.machine);
  table.finish();
  return out;
}

}  // namespace

std::vector<CycleCase> read_cases(const std::string& path, const Machine* fallback, Diagnostics& diagnostics) {
  const auto file = read_toml(path, "a list of cases ([case.1] ...)", diagnostics);
  diagnostics.throw_if_errors();
  TomlTable top = TomlTable::top(*file, diagnostics);
  const fs::path folder = fs::path(path).parent_path();
  std::vector<CycleCase> out;
  if (auto cases = top.table("case"))
    for (const auto& name : cases->keys())
      if (auto one = cases->table(name)) out.push_back(read_case(name, *one, folder, fallback, diagnostics));
  if (out.empty()) top.missing("case", "at least one table [case.NAME]");
  top.finish();
  diagnostics.throw_if_errors();
  return out;
}

}  // namespace camber::machine
