#include "report/posture_summary.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "base/json.h"
#include "base/units.h"

namespace camber::report {
namespace {

constexpr std::array<std::string_view, 4> kPostureModes{"chosen", "normal", "lead-tilt", "seed"};
constexpr std::array<std::string_view, 4> kPostureWritten{"tip", "tilted", "dynamic", "joints"};

Json posture_figures_json(const PosturedProgram& program) {
  const posture::PostureFigures& f = program.postured.figures;
  return {{"overhang_mm", f.overhang_mm},
          {"points", f.points},
          {"contacts", f.contacts},
          {"unclear", f.unclear},
          {"rotary_motion_deg", f.rotary_motion_deg},
          {"mean_angle_deg", deg_from_rad(f.mean_angle_rad)},
          {"max_angle_deg", deg_from_rad(f.max_angle_rad)},
          {"compliance_um_per_N", f.compliance_um_per_N},
          {"lag_um", f.lag_um},
          {"error_um", f.error_um},
          {"time_s", program.time_s}};
}

std::string program_text(const PosturedProgram& program, const PostureAsked& asked) {
  const posture::PostureFigures& f = program.postured.figures;
  const posture::PostureFigures& before = program.postured.upright;
  std::string out = fmt::format("points    {}, {} of them on the part; {} nearer than {:g} mm\n", f.points, f.contacts,
                                f.unclear, asked.options.clearance_mm);
  out += fmt::format("before    {:.1f} degrees from the normal; overhang {:g} mm, {:.3f} um for each N; {:.1f} s\n",
                     deg_from_rad(before.mean_angle_rad), before.overhang_mm, before.compliance_um_per_N,
                     program.given_time_s);
  out += fmt::format("tool      {:.1f} degrees from the normal, at most {:.1f}; rotary axes turn {:.0f} degrees\n",
                     deg_from_rad(f.mean_angle_rad), deg_from_rad(f.max_angle_rad), f.rotary_motion_deg);
  out +=
      fmt::format("overhang  {:g} mm: {:.3f} um normal to the part for each N\n", f.overhang_mm, f.compliance_um_per_N);
  if (asked.options.indexed) {
    const Vec3& axis = program.postured.axes.front();
    out += fmt::format("direction I{:.4f} J{:.4f} K{:.4f} for all moves, written as {}\n", axis.x(), axis.y(), axis.z(),
                       kPostureWritten[static_cast<std::size_t>(program.written)]);
  }
  if (before.lag_um > 0 || f.lag_um > 0)
    out += fmt::format("axes      late by {:.1f} um normal to the part, before {:.1f}\n", f.lag_um, before.lag_um);
  out +=
      fmt::format("error     about {:.1f} um, before {:.1f}; camber predict says where\n", f.error_um, before.error_um);
  out += fmt::format("time      {:.1f} s\n", program.time_s);
  return out;
}

std::string overhang_text(const PosturedOverhangs& overhangs) {
  std::string out = fmt::format("{:>12} {:>10} {:>10} {:>10} {:>12} {:>8}\n", "overhang mm", "um/N", "error um",
                                "angle deg", "rotary deg", "time s");
  for (const PosturedProgram& row : overhangs.rows) {
    const posture::PostureFigures& f = row.postured.figures;
    out +=
        fmt::format("{:>12.1f} {:>10.3f} {:>10.1f} {:>10.1f} {:>12.0f} {:>8.1f}\n", f.overhang_mm,
                    f.compliance_um_per_N, f.error_um, deg_from_rad(f.mean_angle_rad), f.rotary_motion_deg, row.time_s);
  }
  const posture::PostureFigures& least = overhangs.rows[least_error(overhangs.rows)].postured.figures;
  const posture::PostureFigures &shortest = overhangs.rows.back().postured.figures,
                                &chosen = overhangs.program().postured.figures;
  if (least.overhang_mm > chosen.overhang_mm)
    out += fmt::format("the least error is that of {:g} mm; --least-error writes its program\n", least.overhang_mm);
  else if (chosen.overhang_mm > shortest.overhang_mm)
    out += fmt::format("the program is that of {:g} mm, which has the least error; {:g} mm are clear, too\n",
                       chosen.overhang_mm, shortest.overhang_mm);
  return out;
}

}  // namespace

bool clear(const posture::Postured& row) { return !row.blocked_move && row.figures.unclear == 0; }

std::size_t least_error(const std::vector<PosturedProgram>& rows) {
  const auto error_um = [](const PosturedProgram& row) { return row.postured.figures.error_um; };
  return static_cast<std::size_t>(std::ranges::min_element(rows, {}, error_um) - rows.begin());
}

std::string posture_text(const PosturedOverhangs& overhangs, const PostureAsked& asked) {
  const PosturedProgram& program = overhangs.program();
  const bool all = asked.overhang_step_mm > 0 && program.postured.figures.unclear == 0;
  return (all ? overhang_text(overhangs) + "\n" : std::string()) + program_text(program, asked);
}

std::string posture_json(const PosturedOverhangs& overhangs, const PostureAsked& asked) {
  const PosturedProgram& program = overhangs.program();
  Json report = posture_figures_json(program);
  report["mode"] = kPostureModes[static_cast<std::size_t>(asked.options.mode)];
  if (asked.options.indexed) {
    report["mode"] = "indexed";
    report["written"] = kPostureWritten[static_cast<std::size_t>(program.written)];
    if (!program.postured.axes.empty()) {
      const Vec3& axis = program.postured.axes.front();
      report["direction"] = {axis.x(), axis.y(), axis.z()};
    }
  }
  report["clearance_mm"] = asked.options.clearance_mm;
  const posture::PostureFigures& before = program.postured.upright;
  report["before"] = {{"overhang_mm", before.overhang_mm},
                      {"mean_angle_deg", deg_from_rad(before.mean_angle_rad)},
                      {"max_angle_deg", deg_from_rad(before.max_angle_rad)},
                      {"compliance_um_per_N", before.compliance_um_per_N},
                      {"lag_um", before.lag_um},
                      {"error_um", before.error_um},
                      {"time_s", program.given_time_s}};
  if (program.blocked_line > 0) report["blocked_line"] = program.blocked_line;
  if (program.unclear_line > 0) report["unclear_line"] = program.unclear_line;
  if (asked.overhang_step_mm > 0 && clear(program.postured))
    for (const PosturedProgram& row : overhangs.rows) report["overhangs"].push_back(posture_figures_json(row));
  return report.dump(2) + "\n";
}

}  // namespace camber::report
