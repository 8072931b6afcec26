#include "report/forces_csv.h"

#include <cmath>

#include "base/numbers.h"
#include "base/output_file.h"

namespace camber::report {
namespace {

using removal::Stamp;
using simulate::StampLoad;

constexpr std::size_t kFlushBytes = 1 << 20;

/// Loads of a row's teeth, taken together.
struct Turn {
  std::size_t teeth = 0;
  bool valid = true;
  simulate::ChatterMargins::Passage chatter;
  StampLoad load;

  void add(const StampLoad& l) {
    for (int a = 0; a < 3; ++a)
      if (std::abs(l.force_max_N[a]) > std::abs(load.force_max_N[a])) load.force_max_N[a] = l.force_max_N[a];
    load.lateral_max_N = std::max(load.lateral_max_N, l.lateral_max_N);
    if (std::abs(l.axial_max_N) > std::abs(load.axial_max_N)) load.axial_max_N = l.axial_max_N;
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

ForceRow row_of(const Stamp& first, std::size_t line, const Turn& turn, double rpm, int flutes) {
  const auto n = static_cast<double>(turn.teeth);
  const double passing_s = 60.0 / (rpm * flutes);
  const StampLoad& l = turn.load;
  return {.t_s = first.t_s,
          .line = line,
          .tip_mm = first.pose.tip_mm,
          .force_max_N = l.force_max_N,
          .lateral_max_N = l.lateral_max_N,
          .axial_max_N = l.axial_max_N,
          .force_mean_N = l.force_mean_N / n,
          .deflection_um = 1000 * l.contact_deflection_mm / n,
          .mrr_mm3_per_s = l.chip_mm3 / (n * passing_s),
          .removed_mm3 = l.chip_mm3,
          .torque_max_Nm = l.torque_max_Nmm / 1000,
          .torque_mean_Nm = l.torque_mean_Nmm / (1000 * n),
          .power_W = simulate::power_W(l.torque_mean_Nmm / n, rpm),
          .chip_max_mm = l.chip_max_mm,
          .chip_mean_mm = l.chip_area_mm2 > 0 ? l.chip_mm3 / l.chip_area_mm2 : 0.0,
          .specific_energy_MPa = l.chip_mm3 > 0 ? l.work_Nmm / l.chip_mm3 : 0.0,
          .valid = turn.valid,
          .chatter_margin = turn.chatter.margin,
          .chatter_hz = turn.chatter.hz};
}

void append_row(std::string& out, const ForceRow& r, bool axial) {
  append_cells(out, 4, {r.t_s});
  append_cells(out, 0, {static_cast<double>(r.line)});
  append_cells(out, 4, {r.tip_mm.x(), r.tip_mm.y(), r.tip_mm.z()});
  append_cells(out, 3,
               {r.force_max_N.x(), r.force_max_N.y(), r.force_max_N.z(), r.lateral_max_N, r.force_mean_N.x(),
                r.force_mean_N.y(), r.force_mean_N.z()});
  append_cells(out, 2, {r.deflection_um.x(), r.deflection_um.y(), r.deflection_um.z()});
  append_cells(out, 5, {r.mrr_mm3_per_s});
  append_cells(out, 7, {r.removed_mm3});
  append_cells(out, 6, {r.torque_max_Nm, r.torque_mean_Nm});
  append_cells(out, 4, {r.power_W});
  append_cells(out, 6, {r.chip_max_mm, r.chip_mean_mm});
  append_cells(out, 2, {r.specific_energy_MPa});
  append_cells(out, 0, {r.valid ? 1.0 : 0.0});
  append_cells(out, 4, {r.chatter_margin});
  append_cells(out, 1, {r.chatter_hz});
  if (axial) append_cells(out, 3, {r.axial_max_N});
  out.back() = '\n';
}

}  // namespace

void for_each_force_row(const machine::Job& job, const simulate::SimulatedProgram& program,
                        const simulate::Prediction& prediction, const std::function<void(const ForceRow&)>& take) {
  const auto& stamps = program.path.stamps;
  for (const auto& run : program.path.runs) {
    if (run.kind == removal::RunKind::tapping) continue;  // no chips, no forces
    const auto flutes = static_cast<std::size_t>(job.tools.at(run.tool).flutes);
    const std::size_t end = run.from + run.count;
    for (std::size_t from = run.from; from < end;) {
      const nc::Move& move = program.moves_in_part().moves[stamps[from].move];
      Turn turn;
      std::size_t k = from;
      while (k < end && turn.teeth < flutes && program.moves_in_part().moves[stamps[k].move].block == move.block &&
             (k == from || !stamps[k].first)) {
        turn.valid = turn.valid && prediction.validity.valid(k);
        if (const auto c = prediction.chatter.of(k); c.margin > turn.chatter.margin) turn.chatter = c;
        turn.add(prediction.cut.loads[k++]);
      }
      const double rpm = program.moves_in_part().state_of(move).spindle_speed_rpm;
      ForceRow row = row_of(stamps[from], move.block + 1, turn, rpm, static_cast<int>(flutes));
      row.tool = run.tool;
      take(row);
      from = k;
    }
  }
}

void write_forces_csv(const std::string& path, const machine::Job& job, const simulate::SimulatedProgram& program,
                      const simulate::Prediction& prediction) {
  const bool axial = !removal::all_upright(program.path.stamps);
  OutputFile file(path);
  file.stream()
      << "t_s,block,x_mm,y_mm,z_mm,fx_max_N,fy_max_N,fz_max_N,f_max_N,fx_mean_N,fy_mean_N,fz_mean_N,"
         "dx_um,dy_um,dz_um,mrr_mm3_per_s,removed_mm3,torque_max_Nm,torque_mean_Nm,power_W,h_max_mm,h_mean_mm,"
         "specific_energy_MPa,valid,chatter_margin,chatter_Hz"
      << (axial ? ",f_axial_max_N\n" : "\n");
  std::string text;
  for_each_force_row(job, program, prediction, [&](const ForceRow& row) {
    append_row(text, row, axial);
    if (text.size() < kFlushBytes) return;
    file.stream() << text;
    text.clear();
  });
  file.stream() << text;
  file.commit();
}

}  // namespace camber::report
