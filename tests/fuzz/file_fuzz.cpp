// libFuzzer target: any bytes are read as a file that is no NC program. The environment variable CAMBER_DOOR names the
// reader (kDoors). A reader returns or throws InputError with a message; what it returned is usable (finite numbers,
// times that rise, limits of the key), and a job or machine that it wrote again reads back as the same.
#include <fuzzer/FuzzedDataProvider.h>
#include <sqlite3.h>
#include <unistd.h>
#include <zip.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "base/triangle_mesh.h"
#include "calib/column_map.h"
#include "calib/feed_accuracy.h"
#include "calib/force_signal.h"
#include "calib/machine_log.h"
#include "calib/trace.h"
#include "compensate/measured.h"
#include "compensate/uncertainty.h"
#include "compensate/verify_program.h"
#include "dynamics/modal_fit.h"
#include "machine/copy_operations.h"
#include "machine/cycle_cases.h"
#include "machine/force_log.h"
#include "machine/job_file.h"
#include "machine/measured_table.h"
#include "machine/study_file.h"
#include "machine/tool_proposal.h"
#include "plan/plan_input.h"
#include "simulate/force_regions.h"
#include "ui/folder.h"

namespace {

using namespace camber;

[[noreturn]] void fail(const char* what, const std::string& more = {}) {
  std::fprintf(stderr, "%s\n%s\n", what, more.c_str());
  std::abort();
}

/// A folder in memory, with the files that a job may name.
const std::string& folder() {
  static const std::string path =
      [] {
        const std::string in = std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : "/tmp";
        std::string made = in + "/camber_fuzz_" + std::to_string(getpid());
        std::filesystem::create_directories(made);
        std::ofstream(made + "/finish.nc")
            << "G21 G90 G94\nT1 M6\nS3000 M3\nG0 X0 Y0 Z5\nG1 Z0 F100\nX10 F300\nG0 Z5\nM2\n";
        std::ofstream(made + "/machine.toml") << "[axis.x]\nmax_speed_mm_per_min = 10000\n";
        std::ofstream(made + "/shop.toml")
            << "[tool.17]\ntype = \"ball\"\ndiameter_mm = 6\nflutes = 2\noverhang_mm = 30\n";
        return made;
      }();
  return path;
}

std::string file_of(std::string_view bytes, const std::string& name) {
  std::string path = folder() + "/" + name;
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
  return path;
}

void hold_finite(double value, const char* what) {
  if (!std::isfinite(value)) fail("a number that is not finite was read", what);
}

/// What is written reads back, and is then written the same.
template <typename Read>
void hold_round_trip(const std::string& text, const std::string& name, const Read& read) {
  Diagnostics diagnostics;
  std::string again;
  try {
    again = to_toml(read(file_of(text, name), diagnostics));
  } catch (const InputError& e) {
    fail("what was written is not read", text + "\n---\n" + e.what());
  }
  if (diagnostics.has_errors()) fail("what was written has errors", text);
  if (again != text) fail("what was written reads as something else", text + "\n--- again\n" + again);
}

void read_machine_file(std::string_view bytes) {
  Diagnostics diagnostics;
  const machine::Machine m = machine::read_machine(file_of(bytes, "machine_fuzz.toml"), diagnostics);
  if (!diagnostics.has_errors()) hold_round_trip(to_toml(m), "machine_again.toml", machine::read_machine);
}

void read_job_file(std::string_view bytes) {
  Diagnostics diagnostics;
  const machine::Job job = machine::read_job(file_of(bytes, "job.toml"), diagnostics);
  if (!diagnostics.has_errors()) hold_round_trip(to_toml(job), "job_again.toml", machine::read_job);
}

/// The other readers of job files: several programs, copy milling, dynamometer logs.
void read_other_jobs(std::string_view bytes) {
  const std::string path = file_of(bytes, "job.toml");
  Diagnostics diagnostics;
  const auto guarded = [](const auto& read) {
    try {
      read();
    } catch (const InputError& e) {
      if (std::string_view(e.what()).empty()) fail("an error without a message");
    }
  };
  guarded([&] { machine::read_job_of_programs(path, diagnostics); });
  guarded([&] { machine::read_force_log(path, diagnostics); });
  guarded([&] {
    const machine::Job job = machine::read_unprogrammed_job(path, diagnostics);
    machine::read_copy_operations(path, job, diagnostics);
  });
}

void read_study_file(std::string_view bytes) {
  Diagnostics diagnostics;
  const machine::Study study = machine::read_study(file_of(bytes, "study.toml"), diagnostics);
  if (diagnostics.has_errors() || study.cases() == 0) return;
  for (const std::size_t k : {std::size_t{0}, study.cases() - 1}) {
    const machine::StudyCase one = machine::study_case(study, k);
    machine::study_job(study, one, folder());
    machine::study_files(study, one);
    hold_finite(machine::feed_percent(study, one), "feed_percent");
  }
}

void read_cases_file(std::string_view bytes) {
  Diagnostics diagnostics;
  machine::read_cases(file_of(bytes, "cases.toml"), nullptr, diagnostics);
}

void hold_trace(const calib::ServoTrace& trace) {
  for (std::size_t k = 1; k < trace.t_s.size(); ++k)
    if (!(trace.t_s[k] > trace.t_s[k - 1])) fail("the times of a trace do not rise");
  for (const double t : trace.t_s) hold_finite(t, "t_s");
}

void read_trace_file(std::string_view bytes) {
  Diagnostics diagnostics;
  hold_trace(calib::read_trace(file_of(bytes, "trace.csv"), diagnostics));
}

/// A column map, a line of "%", and the recording.
void read_mapped_file(std::string_view bytes) {
  Diagnostics diagnostics;
  const std::size_t cut = bytes.find("\n%\n");
  if (cut == std::string_view::npos) return;
  const calib::ColumnMap map = calib::read_column_map(file_of(bytes.substr(0, cut + 1), "map.toml"), diagnostics);
  if (diagnostics.has_errors()) return;
  hold_trace(calib::read_mapped_trace(file_of(bytes.substr(cut + 3), "recording.txt"), map, diagnostics));
}

void read_log_file(std::string_view bytes) {
  Diagnostics diagnostics;
  const calib::MachineLog log = calib::read_machine_log(file_of(bytes, "log.txt"), diagnostics);
  for (const calib::LogEvent& e : log.feed_mm_per_s) hold_finite(e.value, "feed of a log");
  if (calib::has_positions(log)) hold_trace(calib::position_trace(log));
}

/// A job with [force_log], a line of "%", and the log itself.
void read_dynamometer_file(std::string_view bytes) {
  Diagnostics diagnostics;
  const std::size_t cut = bytes.find("\n%\n");
  if (cut == std::string_view::npos) return;
  const machine::ForceLog how = machine::read_force_log(file_of(bytes.substr(0, cut + 1), "job.toml"), diagnostics);
  if (diagnostics.has_errors()) return;
  const calib::MeasuredLog log = calib::read_measured_log(file_of(bytes.substr(cut + 3), "log.csv"), how, diagnostics);
  for (const calib::MeasuredCut& cut_of_log : log.cuts) hold_finite(cut_of_log.mean_N.norm(), "mean force");
}

void hold_tools(const std::vector<machine::ToolProposal>& tools) {
  for (const machine::ToolProposal& tool : tools) {
    for (const auto& value : {tool.diameter_mm, tool.corner_radius_mm, tool.flute_length_mm, tool.shank_diameter_mm,
                              tool.overhang_mm, tool.tip_diameter_mm, tool.neck_diameter_mm, tool.shoulder_length_mm})
      if (value && !(std::isfinite(*value) && *value >= 0)) fail("a size that cannot be was read", tool.what);
    machine::body_toml(tool);
  }
}

/// A library whose format the first letter chooses.
void read_tool_file(std::string_view bytes) {
  static constexpr std::array<const char*, 8> kEndings{".json", ".hsmlib", ".tbl",  ".fctb",
                                                       ".fctl", ".csv",    ".toml", ".tools"};
  if (bytes.empty()) return;
  Diagnostics diagnostics;
  const char* ending = kEndings[static_cast<unsigned char>(bytes[0]) % kEndings.size()];
  hold_tools(machine::read_tools(file_of(bytes.substr(1), std::string("library") + ending), bytes[0] & 8, diagnostics));
}

/// The bytes as the JSON inside a library that is a zip file.
void read_zipped_tools(std::string_view bytes) {
  const std::string path = folder() + "/library.tools";
  std::filesystem::remove(path);
  zip_t* zip = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
  zip_file_add(zip, "tools.json", zip_source_buffer(zip, bytes.data(), bytes.size(), 0), 0);
  if (zip_close(zip) != 0) return;
  Diagnostics diagnostics;
  hold_tools(machine::read_tools(path, false, diagnostics));
}

/// The bytes as the statements that make a database of Vectric.
void read_database(std::string_view bytes) {
  const std::string path = folder() + "/library.vtdb";
  std::filesystem::remove(path);
  sqlite3* db = nullptr;
  if (sqlite3_open(path.c_str(), &db) != SQLITE_OK) return;
  sqlite3_db_config(db, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_limit(db, SQLITE_LIMIT_LENGTH, 1 << 16);
  sqlite3_limit(db, SQLITE_LIMIT_ATTACHED, 0);
  sqlite3_progress_handler(
      db, 20000, [](void*) { return 1; }, nullptr);
  sqlite3_exec(db, "PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; PRAGMA max_page_count = 200", nullptr, nullptr,
               nullptr);
  const std::string statements(bytes);
  sqlite3_exec(db, statements.c_str(), nullptr, nullptr, nullptr);
  sqlite3_close(db);
  Diagnostics diagnostics;
  hold_tools(machine::read_tools(path, false, diagnostics));
}

void read_measured_file(std::string_view bytes) {
  const bool qif = bytes.find('<') != std::string_view::npos;
  Diagnostics diagnostics;
  for (const machine::MeasuredValue& value :
       machine::read_measured_table(file_of(bytes, qif ? "measured.qif" : "measured.csv"), "", diagnostics))
    hold_finite(value.value_mm, "measured value");
}

void read_points_file(std::string_view bytes) {
  for (const compensate::MeasuredPoint& point : compensate::read_measured(file_of(bytes, "points.csv"))) {
    hold_finite(point.place_mm.norm(), "place");
    if (std::abs(point.normal.norm() - 1) > 1e-9) fail("a normal is no unit vector");
  }
}

void read_uncertainty_file(std::string_view bytes) {
  for (const compensate::ParameterGroup& group : compensate::read_uncertainty(file_of(bytes, "fitted.json")))
    for (const compensate::UncertainParameter& p : group.parameters) hold_finite(p.std_error, "std_error");
}

void read_response_file(std::string_view bytes) {
  const dynamics::FrequencyResponse response = dynamics::read_frequency_response(file_of(bytes, "tap.csv"));
  if (response.hz.size() != response.value.size()) fail("a response of two lengths");
  for (std::size_t k = 0; k < response.value.size(); ++k) {
    hold_finite(response.hz[k], "frequency");
    hold_finite(std::abs(response.value[k]), "response");
  }
}

void read_stl_file(std::string_view bytes) {
  const TriangleMesh mesh = read_stl(file_of(bytes, "part.stl"));
  for (const Eigen::Vector3f& vertex : mesh.points)
    if (!vertex.allFinite()) fail("a point that is not finite was read");
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle)
      if (corner >= mesh.points.size()) fail("a triangle without its corner");
}

void read_tables(std::string_view bytes) {
  const std::string path = file_of(bytes, "table.csv");
  if (bytes.find("line_first") != std::string_view::npos)
    calib::read_parts(path);
  else
    simulate::read_force_regions(path);
}

void read_plan_file(std::string_view bytes) {
  Diagnostics diagnostics;
  const plan::PlanInput input = plan::read_plan_input(file_of(bytes, "plan.toml"), diagnostics);
  if (diagnostics.has_errors()) return;
  hold_finite(input.allowance_mm, "allowance_mm");
  hold_finite(input.scallop_mm, "scallop_mm");
  if (input.setups.empty()) fail("a plan without a set-up was read");
}

/// The record beside a compensated program.
void read_record_file(std::string_view bytes) {
  const compensate::Record record = compensate::read_record(file_of(bytes, "out.nc.record.json"));
  const std::string text = compensate::record_json(record);
  if (compensate::record_json(compensate::read_record(file_of(text, "again.nc.record.json"))) != text)
    fail("a record that was written reads as another one", text);
}

/// An edit of camber ui ("tool.1", tab, "diameter_mm", tab, "8"), a line of "%", and the job's text.
void edit_job_form(std::string_view bytes) {
  const std::size_t cut = bytes.find("\n%\n");
  if (cut == std::string_view::npos) return;
  const std::string_view asked = bytes.substr(0, cut);
  const std::size_t first = asked.find('\t'), second = first == asked.npos ? first : asked.find('\t', first + 1);
  if (second == asked.npos || asked.find_first_of("\r\n") != asked.npos) return;
  ui::JobEdit edit{.kind = ui::JobEdit::Kind::set,
                   .table = std::string(asked.substr(0, first)),
                   .key = std::string(asked.substr(first + 1, second - first - 1)),
                   .value = std::string(asked.substr(second + 1))};
  const std::string text(bytes.substr(cut + 3));
  ui::job_fields(ui::with_edits(text, {&edit, 1}));
  edit.kind = ui::JobEdit::Kind::confirm;
  ui::with_edits(text, {&edit, 1});
  edit.kind = ui::JobEdit::Kind::remove;
  const std::string less = ui::with_edits(text, {&edit, 1});
  if (std::ranges::count(less, '\n') > std::ranges::count(text, '\n')) fail("a removed key adds lines", less);
}

struct Door {
  std::string_view name;
  void (*read)(std::string_view bytes);
};

constexpr Door kDoors[] = {
    {"job", read_job_file},
    {"other_jobs", read_other_jobs},
    {"machine", read_machine_file},
    {"study", read_study_file},
    {"cases", read_cases_file},
    {"trace", read_trace_file},
    {"mapped", read_mapped_file},
    {"machine_log", read_log_file},
    {"dynamometer", read_dynamometer_file},
    {"tools", read_tool_file},
    {"zipped_tools", read_zipped_tools},
    {"database", read_database},
    {"measured", read_measured_file},
    {"points", read_points_file},
    {"uncertainty", read_uncertainty_file},
    {"response", read_response_file},
    {"stl", read_stl_file},
    {"tables", read_tables},
    {"plan", read_plan_file},
    {"record", read_record_file},
    {"form", edit_job_form},
};

const Door& door() {
  static const Door& chosen = []() -> const Door& {
    const char* name = std::getenv("CAMBER_DOOR");
    for (const Door& d : kDoors)
      if (name && d.name == name) return d;
    fail("CAMBER_DOOR names no reader");
  }();
  return chosen;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    door().read({reinterpret_cast<const char*>(data), size});
  } catch (const InputError& e) {
    if (std::string_view(e.what()).empty()) fail("an error without a message");
  }
  return 0;
}
