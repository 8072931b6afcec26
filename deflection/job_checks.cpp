#include "deflection/job_checks.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <string>

#include <fmt/format.h>

#include "deflection/beam.h"

namespace camber::deflection {
namespace {

/// First cutting move of every (tool, spindle speed, direction); later ones repeat what was said.
using Key = std::tuple<int, double, nc::SpindleDirection>;
std::map<Key, const nc::Move*> first_moves(const nc::Interpretation& moves, const std::vector<bool>& selected) {
  std::map<Key, const nc::Move*> out;
  for (std::size_t i = 0; i < moves.moves.size(); ++i) {
    if (!selected[i]) continue;
    const auto& s = moves.state_of(moves.moves[i]);
    out.try_emplace({s.tool, s.spindle_speed_rpm, s.spindle}, &moves.moves[i]);
  }
  return out;
}

void warn_of_vibration(const machine::Tool& tool, double rpm, const nc::Program& program, std::size_t offset,
                       Diagnostics& diagnostics) {
  constexpr double kSteelDensity = 7850, kCarbideDensity = 14500, kSteelLimit_MPa = 300000;
  const double density = tool.youngs_modulus_MPa > kSteelLimit_MPa ? kCarbideDensity : kSteelDensity;
  const double first_hz = beam_of(tool).first_frequency_hz(tool, density);
  const double tooth_hz = rpm / 60 * tool.flutes;
  if (tooth_hz <= first_hz / 3) return;
  diagnostics.add(program.source.diagnostic(
      Severity::warning, offset,
      fmt::format(
          "T{} passes {:.0f} teeth a second, more than a third of its first natural frequency of about {:.0f} Hz: "
          "a static deflection no longer holds",
          tool.number, tooth_hz, first_hz),
      "tooth-frequency"));
}

}  // namespace

void check_cutting(const machine::Job& job, const nc::Program& program, const nc::Interpretation& moves,
                   const std::vector<bool>& selected, Diagnostics& diagnostics) {
  const auto firsts = first_moves(moves, selected);
  if (firsts.empty())
    diagnostics.add({Severity::error,
                     {program.source.name(), 0, 0},
                     "no line or arc belongs to the job's operations; a tool and a range that cut were expected",
                     "nothing-to-cut",
                     {}});
  for (const auto& [key, move] : firsts) {
    const auto& [number, rpm, direction] = key;
    const std::size_t offset = program.blocks[move->block].offset;
    const auto error = [&](std::string message, const char* check) {
      diagnostics.add(program.source.diagnostic(Severity::error, offset, std::move(message), check));
    };
    const auto tool = job.tools.find(number);
    if (tool == job.tools.end()) {
      error(fmt::format("T{} cuts here, but the job has no [tool.{}]", number, number), "tool-missing");
      continue;
    }
    if (tool->second.type == machine::ToolType::drill)
      error(fmt::format("T{} is a drill in the job, but mills here; ball, flat or bull was expected", number),
            "tool-type");
    if (direction == nc::SpindleDirection::stopped || rpm <= 0)
      error(fmt::format("T{} cuts here with the spindle {}; S above zero and M3 were expected", number,
                        rpm <= 0 ? "at S0" : "stopped"),
            "spindle-stopped");
    else if (direction == nc::SpindleDirection::counter_clockwise)
      error(fmt::format("T{} cuts here under M4, but cutters are right-hand; M3 was expected", number),
            "spindle-direction");
    else
      warn_of_vibration(tool->second, rpm, program, offset, diagnostics);
  }
}

double field_bytes(const Vec3& size, double voxel, double band_voxels) {
  constexpr double kCopies = 4;         // blank, target, machined, blank of a later tool
  constexpr double kBytesPerVoxel = 8;  // distance and stamp
  constexpr double kLeaf = 8;
  const double area = 2 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
  return kCopies * kBytesPerVoxel * area / (voxel * voxel) * (2 * band_voxels + kLeaf);
}

namespace {
double free_memory_bytes() {
  std::ifstream in("/proc/meminfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("MemAvailable:")) return 1024.0 * std::stod(line.substr(13));
  return 1e18;
}
}  // namespace

void check_memory(const machine::Job& job, const Vec3& lo, const Vec3& hi, double band_voxels,
                  Diagnostics& diagnostics) {
  const double voxel = job.simulation.voxel_mm;
  const double needed = field_bytes(hi - lo, voxel, band_voxels), free = free_memory_bytes();
  if (needed <= free) return;
  double enough = voxel;
  while (field_bytes(hi - lo, enough, band_voxels) > free / 2) enough *= 1.25;
  diagnostics.add(
      {Severity::error,
       {job.path, 0, 0},
       fmt::format("voxel_mm = {:g} needs about {:.1f} GB for a stock of {:.0f} x {:.0f} x {:.0f} mm, but {:.1f} GB "
                   "are free; voxel_mm = {:.2g} or a smaller stock was expected",
                   voxel, needed / 1e9, hi.x() - lo.x(), hi.y() - lo.y(), hi.z() - lo.z(), free / 1e9, enough),
       "voxel-memory",
       {}});
}

}  // namespace camber::deflection
