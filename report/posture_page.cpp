#include "report/posture_summary.h"

#include <fmt/format.h>

#include "base/triangle_mesh.h"
#include "base/units.h"
#include "report/machine_page.h"
#include "report/page_tables.h"

namespace camber::report {
namespace {

std::vector<std::string> posture_row(std::string name, const posture::PostureFigures& f, double time_s) {
  return {std::move(name),
          number_text(f.overhang_mm, 1),
          number_text(f.compliance_um_per_N, 3),
          number_text(f.error_um, 1),
          number_text(deg_from_rad(f.mean_angle_rad), 1),
          number_text(deg_from_rad(f.max_angle_rad), 1),
          number_text(f.rotary_motion_deg, 0),
          number_text(time_s, 1)};
}

TextTable posture_table(std::string title, std::string first) {
  return {std::move(title),
          {std::move(first), "overhang, mm", "deflection, um/N", "error, um", "angle to the normal, deg", "at most",
           "rotary motion, deg", "time, s"},
          {},
          {}};
}

TextTable before_and_after(const PosturedProgram& program) {
  TextTable table = posture_table("Before and after", "");
  table.rows = {posture_row("three axes", program.postured.upright, program.given_time_s),
                posture_row("new program", program.postured.figures, program.time_s)};
  return table;
}

TextTable overhang_table(const std::vector<PosturedProgram>& rows) {
  TextTable table = posture_table("Overhangs", "step");
  for (std::size_t i = 0; i < rows.size(); ++i)
    table.rows.push_back(posture_row(fmt::format("{}", i + 1), rows[i].postured.figures, rows[i].time_s));
  return table;
}

std::vector<Figure> posture_figures(const PosturedProgram& program) {
  const posture::PostureFigures &f = program.postured.figures, &before = program.postured.upright;
  return {{"deflection normal to the part", before.compliance_um_per_N, f.compliance_um_per_N, "um/N", 3,
           "before.compliance_um_per_N", "compliance_um_per_N"},
          {"form error, about", before.error_um, f.error_um, "um", 1, "before.error_um", "error_um"},
          {"overhang", before.overhang_mm, f.overhang_mm, "mm", 1, "before.overhang_mm", "overhang_mm"},
          {"time", program.given_time_s, program.time_s, "s", 1, "before.time_s", "time_s"},
          {"points that are too near", static_cast<double>(f.unclear), std::nullopt, "", 0, "unclear"},
          {"rotary motion", f.rotary_motion_deg, std::nullopt, "deg", 0, "rotary_motion_deg"},
          {"angle of tool and normal", deg_from_rad(before.mean_angle_rad), deg_from_rad(f.mean_angle_rad), "deg", 1,
           "before.mean_angle_deg", "mean_angle_deg"}};
}

}  // namespace

std::string posture_page(const PosturedOverhangs& overhangs, const PostureAsked& asked,
                         const std::vector<kinematics::PoseSample>& track, const std::vector<std::string>& warnings) {
  const PosturedProgram& program = overhangs.program();
  const machine::Job& job = *asked.job;
  MachinePage page;
  page.title = "Postures of " + asked.program;
  page.subtitle = fmt::format("with the job {}, camber {}", job.path, CAMBER_VERSION);
  page.figures = posture_figures(program);
  page.tables = {before_and_after(program)};
  if (overhangs.rows.size() > 1) page.tables.push_back(overhang_table(overhangs.rows));
  page.warnings = warnings;
  page.part = machine::part_mesh(job.part);
  page.work_origin_mm = program.postured.origin_mm;
  page.tool_diameter_mm = job.tools.at(program.postured.tool).diameter_mm;
  page.notes = {
      "Deflection: of a force of 1 N, normal to the part, mean over the path on the part. It compares postures and "
      "tools; "
      "the form error is that of camber predict.",
      "Times of the pictures follow from feeds and from rapids at the speed of the slowest axis, without acceleration; "
      "those of the tables are the machine's."};
  return machine_page(job.machine, track, page);
}

}  // namespace camber::report
