#pragma once
// Tools that are kept once, for many jobs: `tools = "shop.toml"` in a job, and `from` in its [tool.N] tables.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "machine/toml_table.h"
#include "machine/tool_proposal.h"

namespace camber::machine {

/// A TOML file with [tool.N] tables (N a number or a name; `name` may name a numbered one), a tool library, or a folder
/// of libraries.
class ToolShelf {
 public:
  /// inch: unit of a tool table of LinuxCNC. Throws InputError where the file cannot be read or is damaged.
  ToolShelf(const std::string& path, bool inch);

  /// Gives `table`, a [tool.N] with the key `from`, what it does not say itself. A tool that is missing, or a number or
  /// name of several different cutters, is an error at `from`, with the names that are nearest.
  void fill(TomlTable& table) const;

 private:
  struct Kept {
    std::optional<double> number;
    std::string name;   ///< empty: none
    std::string place;  ///< "tool.17"; "fusion.json, tool 3"
    std::string text;   ///< keys of a job, of a library's cutter: what tells two cutters apart
    const TomlNode* node = nullptr;
  };
  void add_tables(std::unique_ptr<TomlFile> file, Diagnostics& diagnostics);
  void add_library(const std::vector<ToolProposal>& tools);
  std::string nearest(const std::optional<double>& number, const std::string& name) const;

  std::string path_;
  std::vector<Kept> kept_;
  std::vector<std::unique_ptr<TomlFile>> files_;  ///< what the nodes point into
  std::string left_out_;                          ///< what a library says is missing
};

}  // namespace camber::machine
