// libFuzzer targets: any bytes are read as a file of one kind. CAMBER_DOOR names the reader; each is an executable.
//
// What has to hold: no crash, no hang, no unbounded memory, no exception but InputError, and that with a message. The
// last byte of the input chooses among the forms that a reader takes; the others are the file, as it would be on a
// disk.
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "base/diagnostics.h"
#include "base/stl.h"
#include "calib/column_map.h"
#include "calib/machine_log.h"
#include "calib/trace.h"
#include "dynamics/frequency_response.h"
#include "machine/cases.h"
#include "machine/force_log.h"
#include "machine/job.h"
#include "machine/measured_table.h"
#include "machine/study.h"
#include "machine/tool_proposal.h"
#include "ui/guard.h"
#include "ui/job_form.h"

namespace camber::fuzz {
namespace {

/// In memory, and of this process alone: the fuzzer may run many at once.
const std::string& folder() {
  static const std::string path = [] {
    std::string name = "/dev/shm/camber-fuzz-XXXXXX";
    if (!mkdtemp(name.data())) std::abort();
    std::atexit([] { std::filesystem::remove_all(folder()); });
    return name;
  }();
  return path;
}

std::string put(const std::string& name, std::string_view content) {
  const std::string path = folder() + "/" + name;
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

/// What a command would have beside the job that is read.
void put_neighbours() {
  static const bool once = [] {
    put("machine.toml", "[axis.x]\nacceleration_mm_per_s2 = 500\n[axis.y]\n[axis.z]\n");
    put("p.nc", "G21 G90 G54\nT1 M6\nS3000 M3\nG0 X0 Y0\nG1 Z-1 F600\nM30\n");
    return true;
  }();
  static_cast<void>(once);
}

void require(bool holds) {
  if (!holds) std::abort();
}

/// Text in front of a line "=====", and what follows it: two files in one input.
std::array<std::string_view, 2> two_files(std::string_view text) {
  constexpr std::string_view kBetween = "\n=====\n";
  const std::size_t at = text.find(kBetween);
  if (at == std::string_view::npos) return {text, {}};
  return {text.substr(0, at + 1), text.substr(at + kBetween.size())};
}

void read_job_door(std::string_view text, unsigned, Diagnostics& diagnostics) {
  put_neighbours();
  machine::read_job(put("job.toml", text), diagnostics);
}

void read_machine_door(std::string_view text, unsigned, Diagnostics& diagnostics) {
  machine::read_machine(put("m.toml", text), diagnostics);
}

void read_study_door(std::string_view text, unsigned form, Diagnostics& diagnostics) {
  put_neighbours();
  if (form % 2 == 1) {
    machine::read_cases(put("cases.toml", text), nullptr, diagnostics);
    return;
  }
  const auto [study, job] = two_files(text);
  put("job.toml", job);
  machine::read_study(put("study.toml", study), diagnostics);
}

/// A servo trace by its own header, by a column map, or a log of MTConnect.
void read_trace_door(std::string_view text, unsigned form, Diagnostics& diagnostics) {
  const auto check = [](const calib::ServoTrace& trace) {
    for (std::size_t i = 1; i < trace.size(); ++i) require(trace.t_s[i] > trace.t_s[i - 1]);
    require(trace.command_mm.size() == trace.size() && trace.actual_mm.size() == trace.size());
  };
  if (form % 3 == 0) {
    check(calib::read_trace(put("trace.csv", text), diagnostics));
  } else if (form % 3 == 1) {
    const auto [map, trace] = two_files(text);
    const calib::ColumnMap columns = calib::read_column_map(put("columns.toml", map), diagnostics);
    if (!diagnostics.has_errors()) check(calib::read_mapped_trace(put("trace.txt", trace), columns, diagnostics));
  } else {
    const std::string path = put("log.xml", text);
    if (calib::is_machine_log(path)) calib::position_trace(calib::read_machine_log(path, diagnostics));
  }
}

void read_forces_door(std::string_view text, unsigned, Diagnostics& diagnostics) {
  machine::read_force_log(put("job.toml", text), diagnostics);
}

void read_tools_door(std::string_view text, unsigned form, Diagnostics& diagnostics) {
  constexpr std::array kEndings{"json", "tools", "csv", "hsmlib", "fctl", "fctb", "vtdb", "tbl"};
  const std::string path = put(std::string("tools.") + kEndings[form % kEndings.size()], text);
  for (const machine::ToolProposal& tool : machine::read_tools(path, (form & 64) != 0, diagnostics)) {
    require(!tool.diameter_mm || std::isfinite(*tool.diameter_mm));
    machine::body_toml(tool);
  }
  std::filesystem::remove(path);
}

void read_stl_door(std::string_view text, unsigned, Diagnostics&) {
  const TriangleMesh mesh = read_stl(put("part.stl", text));
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t point : triangle) require(point < mesh.points.size());
  for (const auto& point : mesh.points) require(point.allFinite());
  mesh.open_edges();
}

void read_measured_door(std::string_view text, unsigned form, Diagnostics& diagnostics) {
  if (form % 3 == 0) {
    machine::read_qif(put("results.qif", text));
  } else if (form % 3 == 1) {
    machine::read_measured_csv(put("measured.csv", text), {});
  } else {
    const auto [columns, table] = two_files(text);
    machine::read_measured_table(put("measured.csv", table), put("columns.toml", columns), diagnostics);
  }
}

void read_tap_door(std::string_view text, unsigned form, Diagnostics&) {
  dynamics::read_frequency_response(put(form % 2 == 0 ? "tap.csv" : "tap.uff", text));
}

/// Nobody without the token gets in, whatever the headers are; the form of a job's text gives back what was set.
void ask_page_door(std::string_view text, unsigned form, Diagnostics&) {
  const std::string all(text);
  const auto [first, second] = two_files(text);
  if (form % 2 == 0) {
    const ui::Guard guard{"0123456789abcdef", "camber-8000", "127.0.0.1", 1000};
    ui::Asked asked{{std::string(first)}, {}, {}, std::string(second), (form & 2) != 0, {all}};
    if ((form & 4) != 0) asked.hosts = {"127.0.0.1:8000"};
    if ((form & 8) != 0) asked.origins = {std::string(first)};
    const bool knows = all.find(guard.token) != std::string::npos;
    require(ui::refusal(guard, asked).has_value() || knows);
    return;
  }
  const auto fields = ui::job_fields(first);
  if (fields.empty()) return;
  const ui::JobField& field = fields[form / 2 % fields.size()];
  if (field.is_default || field.value.find('\n') != std::string::npos) return;
  const ui::JobEdit edit{ui::JobEdit::Kind::set, field.table, field.key, "12.5"};
  const std::string edited = ui::with_edits(std::string(first), std::span(&edit, 1));
  require(ui::field_text(ui::job_fields(edited), field.table, field.key) == "12.5");
}

using Door = void (*)(std::string_view, unsigned, Diagnostics&);
constexpr Door kDoor = CAMBER_DOOR;

}  // namespace
}  // namespace camber::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data), size - 1);
  camber::Diagnostics diagnostics;
  try {
    camber::fuzz::kDoor(text, data[size - 1], diagnostics);
  } catch (const camber::InputError& problem) {
    if (std::string_view(problem.what()).empty()) std::abort();
  }
  return 0;
}
