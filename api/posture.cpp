#include "api/commands/posture.h"

#include <array>
#include <stdexcept>
#include <string_view>

#include "api/job.h"
#include "api/program.h"
#include "api/run.h"
#include "base/stage.h"
#include "base/units.h"
#include "camber/posture.h"

namespace camber {
namespace {

constexpr std::array<std::string_view, 4> kPostureModes{"chosen", "normal", "lead-tilt", "seed"};
constexpr std::array<std::string_view, 4> kWrittenAs{"tip", "tilted", "dynamic", "joints"};

template <typename Enum>
Enum word_of(const std::array<std::string_view, 4>& words, const std::string& word, const char* what) {
  for (std::size_t i = 0; i < words.size(); ++i)
    if (words[i] == word) return static_cast<Enum>(i);
  std::string all;
  for (const std::string_view w : words) all += (all.empty() ? "" : ", ") + std::string(w);
  throw std::invalid_argument(std::string(what) + ": " + word + "; one of " + all + " was expected");
}

posture::PostureOptions rules_of(const PostureOptions& options) {
  posture::PostureOptions out;
  out.mode = word_of<posture::Mode>(kPostureModes, options.mode, "mode");
  out.indexed = options.indexed;
  out.clearance_mm = options.clearance_mm;
  out.stock = options.stock;
  out.lead_rad = rad_from_deg(options.lead_deg);
  out.tilt_rad = rad_from_deg(options.tilt_deg);
  out.max_tilt_rad = rad_from_deg(options.max_tilt_deg);
  out.least_angle_rad = rad_from_deg(options.least_angle_deg);
  return out;
}

PostureFigures figures_of(const api::PosturedProgram& program) {
  const posture::PostureFigures& f = program.postured.figures;
  return {.overhang_mm = f.overhang_mm,
          .points = f.points,
          .contacts = f.contacts,
          .unclear = f.unclear,
          .rotary_motion_deg = f.rotary_motion_deg,
          .mean_angle_deg = deg_from_rad(f.mean_angle_rad),
          .max_angle_deg = deg_from_rad(f.max_angle_rad),
          .compliance_um_per_N = f.compliance_um_per_N,
          .lag_um = f.lag_um,
          .error_um = f.error_um,
          .time_s = program.time_s};
}

}  // namespace

PostureResult v0::posture(const Program& program, const Job& job, const PostureOptions& options,
                          const RunOptions& run_options) {
  PostureResult result;
  api::PostureCommand command{.text = &program.impl().text,
                              .output = program.path(),
                              .job = &job.impl().job,
                              .interpreter = program.impl().options,
                              .tool = options.tool,
                              .step_mm = options.step_mm,
                              .options = rules_of(options),
                              .overhang_step_mm = options.overhang_step_mm,
                              .least_error = options.least_error};
  if (!options.write_as.empty()) command.written = word_of<nc::OneDirection>(kWrittenAs, options.write_as, "write_as");
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found = job.impl().found;
    found.append(program.impl().found);
    const StageScope stages([&](const std::string& what, double share) { run.show(what, share); });
    const api::PosturedOverhangs overhangs = api::posture_programs(command, found);
    run.settle(found);
    const api::PosturedProgram& chosen = overhangs.program();
    result.success = chosen.blocked_line == 0 && chosen.postured.figures.unclear == 0;
    result.blocked_line = chosen.blocked_line;
    result.unclear_line = chosen.unclear_line;
    result.text = chosen.postured.text;
    result.figures = figures_of(chosen);
    if (options.overhang_step_mm > 0 && result.success)
      for (const api::PosturedProgram& row : overhangs.rows) result.overhangs.push_back(figures_of(row));
    result.diagnostics = found.all();
    result.json = api::posture_json(overhangs, command);
  });
  return result;
}

}  // namespace camber
