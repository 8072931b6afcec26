#include "machine/mode_reader.h"

#include <fmt/format.h>

#include "machine/job_keys.h"

namespace camber::machine {

std::vector<Mode> read_modes(TomlTable& owner) {
  std::vector<Mode> modes;
  for (TomlTable& table : owner.tables("mode")) {
    Mode mode;
    const auto direction = table.required_choice("direction", kDirectionWords);
    if (direction) mode.direction = *direction == 0 ? Vec2::UnitX() : Vec2::UnitY();
    for (const auto& k : kModeKeys)
      if (!table.has(k.key)) table.missing(k.key, k.range.wanted());
    read_numbers<Mode>(table, kModeKeys, mode);
    table.finish();
    modes.push_back(mode);
  }
  return modes;
}

std::string modes_text(const std::vector<Mode>& modes, std::string_view owner) {
  std::string out;
  for (const Mode& m : modes)
    out += fmt::format("\n[[{}.mode]]\n", owner) +
           toml_line("direction", kDirectionWords[m.direction.x() != 0 ? 0 : 1]) + toml_lines<Mode>(kModeKeys, m);
  return out;
}

}  // namespace camber::machine
