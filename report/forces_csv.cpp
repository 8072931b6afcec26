#include "report/forces_csv.h"

#include <cmath>

#include "base/numbers.h"
#include "base/output_file.h"

namespace camber::report {
namespace {

using removal::Stamp;
using simulate::StampLoad;

/// Loads of a row's teeth, taken together.
struct Row {
  std::size_t teeth = 0;
  StampLoad load;

  void add(const StampLoad& l) {
    for (int a = 0; a < 3; ++a)
      if (std::abs(l.force_max_N[a]) > std::abs(load.force_max_N[a])) load.force_max_N[a] = l.force_max_N[a];
    load.lateral_max_N = std::max(load.lateral_max_N, l.lateral_max_N);
    load.force_mean_N += l.force_mean_N;
    load.contact_deflection_mm += l.contact_deflection_mm;
    load.chip_mm3 += l.chip_mm3;
    load.torque_max_Nmm = std::max(load.torque_max_Nmm, l.torque_max_Nmm);
    load.torque_mean_Nmm += l.torque_mean_Nmm;
    load.work_Nmm += l.work_Nmm;
    load.chip_max_mm = std::max(load.chip_max_mm, l.chip_max_mm);
    load.chip_area_mm2 += l.chip_area_mm2;
    ++teeth;
  }
};

void write_row(std::string& out, const Stamp& first, std::size_t line, const Row& row, double rpm, int flutes) {
  const auto n = static_cast<double>(row.teeth);
  const double passing_s = 60.0 / (rpm * flutes);
  const StampLoad& l = row.load;
  append_cells(out, 4, {first.t_s});
  append_cells(out, 0, {static_cast<double>(line)});
  append_cells(out, 4, {first.pose.tip_mm.x(), first.pose.tip_mm.y(), first.pose.tip_mm.z()});
  append_cells(out, 3,
               {l.force_max_N.x(), l.force_max_N.y(), l.force_max_N.z(), l.lateral_max_N, l.force_mean_N.x() / n,
                l.force_mean_N.y() / n, l.force_mean_N.z() / n});
  append_cells(out, 2, {1000 * l.contact_deflection_mm.x() / n, 1000 * l.contact_deflection_mm.y() / n});
  append_cells(out, 5, {l.chip_mm3 / (n * passing_s)});
  append_cells(out, 7, {l.chip_mm3});
  append_cells(out, 6, {l.torque_max_Nmm / 1000, l.torque_mean_Nmm / (1000 * n)});
  append_cells(out, 4, {simulate::power_W(l.torque_mean_Nmm / n, rpm)});
  append_cells(out, 6, {l.chip_max_mm, l.chip_area_mm2 > 0 ? l.chip_mm3 / l.chip_area_mm2 : 0.0});
  append_cells(out, 2, {l.chip_mm3 > 0 ? l.work_Nmm / l.chip_mm3 : 0.0});
  out.back() = '\n';
}

}  // namespace

void write_forces_csv(const std::string& path, const machine::Job& job, const simulate::SimulatedProgram& program,
                      const simulate::Prediction& prediction) {
  OutputFile file(path);
  file.stream() << "t_s,block,x_mm,y_mm,z_mm,fx_max_N,fy_max_N,fz_max_N,f_max_N,fx_mean_N,fy_mean_N,fz_mean_N,"
                   "dx_um,dy_um,mrr_mm3_per_s,removed_mm3,torque_max_Nm,torque_mean_Nm,power_W,h_max_mm,h_mean_mm,"
                   "specific_energy_MPa\n";
  std::string text;
  const auto& stamps = program.path.stamps;
  for (const auto& run : program.path.runs) {
    if (run.kind == removal::RunKind::tapping) continue;  // no chips, no forces
    const auto flutes = static_cast<std::size_t>(job.tools.at(run.tool).flutes);
    const std::size_t end = run.from + run.count;
    for (std::size_t from = run.from; from < end;) {
      const nc::Move& move = program.moves.moves[stamps[from].move];
      Row row;
      std::size_t k = from;
      while (k < end && row.teeth < flutes && program.moves.moves[stamps[k].move].block == move.block &&
             (k == from || !stamps[k].first))
        row.add(prediction.cut.loads[k++]);
      const double rpm = program.moves.state_of(move).spindle_speed_rpm;
      write_row(text, stamps[from], move.block + 1, row, rpm, static_cast<int>(flutes));
      from = k;
    }
    file.stream() << text;
    text.clear();
  }
  file.commit();
}

}  // namespace camber::report
