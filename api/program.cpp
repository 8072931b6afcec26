#include "api/program.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/units.h"
#include "kinematics/control_options.h"
#include "machine/control_kind.h"
#include "nc/language.h"
#include "nc/offsets.h"

namespace camber {
namespace {

/// The dialect of a control by its name, as --dialect has it.
nc::Dialect dialect_of_control(const std::string& name, const std::string& path) {
  const auto names = machine::control_kind_names();
  const auto at = std::ranges::find(names, name);
  if (at == names.end())
    fail_on_file(path, fmt::format("dialect {}: one of {} was expected", name, fmt::join(names, ", ")), "dialect");
  return kinematics::dialect_of(machine::control_kinds()[static_cast<std::size_t>(at - names.begin())]);
}

}  // namespace

nc::InterpreterOptions api::interpreter_options(const ReadOptions& options, const std::string& path) {
  nc::InterpreterOptions out;
  out.inch = options.inch;
  out.skip_slash_blocks = options.skip_slash_blocks;
  for (const int n : options.skip_switches) {
    if (n < 1 || n > 9) fail_on_file(path, fmt::format("skip switch {}: 1 to 9 was expected", n), "skip-switch");
    out.skip_switches |= static_cast<std::uint16_t>(1u << static_cast<unsigned>(n));
  }
  if (!options.dialect.empty()) out.dialect = dialect_of_control(options.dialect, path);
  if (options.least_increments) out.whole_numbers_are_increments = *options.least_increments;
  for (const auto& [number, length_mm] : options.tool_lengths_mm) out.tool_offsets[number].length_mm = length_mm;
  for (const auto& [name, values] : options.work_offsets) {
    const auto number = nc::work_offset_number(name);
    if (!number || (values.size() != 3 && values.size() != 6))
      fail_on_file(
          path,
          fmt::format("work offset {}: a name such as G54 and three or six machine coordinates were expected", name),
          "work-offset");
    out.work_offsets_mm[*number] = {values[0], values[1], values[2]};
    if (values.size() == 6) out.rotary_offsets_rad[*number] = rad_from_deg(1) * Vec3(values[3], values[4], values[5]);
  }
  return out;
}

namespace {

Program program_of(SourceText source, const ReadOptions& options) {
  auto impl = std::make_shared<Program::Impl>();
  impl->path = source.name();
  impl->options = api::interpreter_options(options, impl->path);
  impl->text = nc::read_program(std::move(source), nc::language_asked_for(impl->options), impl->found);
  return Program(std::move(impl));
}

}  // namespace

const std::string& Program::path() const { return impl_->path; }
const std::string& Program::text() const { return impl_->text.source.text(); }

Program v0::read_program(const std::string& path, const ReadOptions& options) {
  return program_of(SourceText::read(path), options);
}

Program v0::program_from_text(std::string name, std::string text, const ReadOptions& options) {
  return program_of(SourceText(std::move(name), std::move(text)), options);
}

}  // namespace camber
