#include "report/report_data.h"
#include "machine/assumptions.h"
#include "report/page_tables.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "report/chatter_page.h"
#include "report/feature_results.h"
#include "report/figures_json.h"
#include "report/histogram_svg.h"
#include "report/verdict_text.h"
#include "simulate/verdict.h"

namespace camber::report {
namespace {

using simulate::SimulatedProgram;

std::uint32_t line_of(const SimulatedProgram& program, std::int32_t stamp) {
  if (stamp < 0 || static_cast<std::size_t>(stamp) >= program.path.stamps.size()) return 0;
  return program.moves_in_part().moves[program.path.stamps[static_cast<std::size_t>(stamp)].move].block + 1;
}

SurfaceSample sample_of(const removal::SurfacePoint& p, const SimulatedProgram& program) {
  return {.place_mm = p.crossing_mm,
          .normal = p.normal,
          .error_um = 1000 * p.error_mm,
          .contour_um = 1000 * p.contour_mm,
          .area_mm2 = p.valid ? p.area_mm2 : 0,
          .block = line_of(program, p.machined_stamp)};
}

void add_stock(ReportData& data, const removal::StockShape& stock) {
  data.stock = {stock.crossings.size(), [&crossings = stock.crossings](std::size_t i) {
                  SurfaceSample out;
                  out.place_mm = crossings[i].place_mm;
                  out.normal = crossings[i].outward;
                  return out;
                }};
  data.stock_cell_mm = stock.cell_mm;
}

/// `key`: of the group in the JSON, with {} for before and after.
void add_figures(ReportData& data, const removal::ErrorFigures& before, const removal::ErrorFigures* after,
                 const std::string& key) {
  const auto add = [&](const char* name, double removal::ErrorFigures::*which, const char* last) {
    data.figures.push_back(
        {name, before.*which, after ? std::optional<double>(after->*which) : std::nullopt, "um", 2, key + "." + last});
  };
  add("form error, 95th percentile", &removal::ErrorFigures::p95, "p95");
  add("form error, rms", &removal::ErrorFigures::rms, "rms");
  add("form error, maximum (excess material)", &removal::ErrorFigures::max, "max");
  add("form error, minimum (gouge)", &removal::ErrorFigures::min, "min");
  add("form error, mean", &removal::ErrorFigures::mean, "mean");
}

/// Adds the parts of the form error that the page shows, each as a quantity of its own.
void add_parts(ReportData& data, const simulate::Prediction& p) {
  const auto part = [&](const char* name, double value, const char* key) {
    data.figures.push_back({name, value, std::nullopt, "um", 2, key});
  };
  part("due to deflection, rms", p.deflection_um.rms, "deflection_um.rms");
  part("due to deflection, 95th percentile", p.deflection_um.p95, "deflection_um.p95");
  if (p.deflection_parts_um) {
    part("of it of the tool, 95th percentile", p.deflection_parts_um->tool_um.p95, "tool_deflection_um.p95");
    part("of it of the workpiece, 95th percentile", p.deflection_parts_um->part_um.p95, "part_deflection_um.p95");
  }
  part("due to servo lag and corner rounding, rms", p.contour_um.rms, "contour_um.rms");
  part("due to servo lag and corner rounding, 95th percentile", p.contour_um.p95, "contour_um.p95");
  if (!p.contour_parts_um) return;
  part("of it due to servo lag, 95th percentile", p.contour_parts_um->lag_um.p95, "contour_parts_um.lag.p95");
  part("of it due to the path tolerance, 95th percentile", p.contour_parts_um->path_tolerance_um.p95,
       "contour_parts_um.path_tolerance.p95");
  part("of it due to the corner law, 95th percentile", p.contour_parts_um->corner_law_um.p95,
       "contour_parts_um.corner_law.p95");
}

void add_texts(ReportData& data, const machine::Job& job, const Diagnostics& diagnostics,
               const std::string& unsettled) {
  if (const auto assumed = machine::assumptions(job); !assumed.empty())
    data.warnings.push_back(fmt::format("assumed, not given: {}", fmt::join(assumed, "; ")));
  for (const auto& d : diagnostics.all()) data.warnings.push_back(to_string(d));
  if (!unsettled.empty()) data.warnings.push_back(unsettled);
  data.notes.push_back(
      "Not in the model: deflection of the workpiece, thermal growth and wear. Tool deflection is static.");
  for (TextTable table :
       {material_table(job), tools_table(job), machine_table(job.machine), simulation_table(job), inputs_table(job)})
    data.tables.push_back(std::move(table));
}

void add_worst_lines(ReportData& data, const SimulatedProgram& program, bool after) {
  TextTable table = worst_lines_table(data.surface, program.text().source.text(), after);
  if (!table.rows.empty()) data.tables.insert(data.tables.begin(), std::move(table));
}

/// Where the job names operations, the path and the plots are of them.
std::vector<PathRow> shown_rows(ReportData& data, const machine::Job& job, const SimulatedProgram& program,
                                std::vector<PathRow> rows) {
  if (!job.operations.given() || rows.empty()) return rows;
  const double whole_s = rows.back().t_s;
  rows = rows_of_cut(std::move(rows), program.path);
  const std::string note =
      rows.empty() ? std::string()
                   : fmt::format("Path and plots show the operations of the job, {:.1f} to {:.1f} s of {:.1f} s.",
                                 rows.front().t_s, rows.back().t_s, whole_s);
  if (!note.empty() && std::ranges::find(data.notes, note) == data.notes.end()) data.notes.push_back(note);
  return rows;
}

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

TextTable rounds_table(const compensate::CompensationResult& c) {
  TextTable table{"Rounds of the compensation",
                  {"round", "95 %, µm", "rms, µm", "mean, µm", "least, µm", "greatest, µm", "largest shift, µm"},
                  {},
                  fmt::format("Stopped: {}. Round {} was written.", compensate::to_string(c.verdict.stop), c.best)};
  for (std::size_t i = 0; i < c.rounds.size(); ++i) {
    const auto& e = c.rounds[i].error_um;
    table.rows.push_back({i == 0 ? "as given" : std::to_string(i), number_text(e.p95, 2), number_text(e.rms, 2),
                          number_text(e.mean, 2), number_text(e.min, 2), number_text(e.max, 2),
                          number_text(1000 * c.rounds[i].largest_shift_mm, 1)});
  }
  return table;
}

/// Machine time against error, as a table.
TextTable time_table(const compensate::CompensationResult& c) {
  TextTable table{
      "Machine time against error",
      {"extra time allowed, %", "machine time, s", "95 %, µm", "rms, µm", "changes of feed", "runs cut twice"},
      {},
      {}};
  for (const compensate::TimePoint& p : c.time_points) {
    const compensate::Round& r = c.rounds[p.round];
    table.rows.push_back({fmt::format("{:g}", p.allowed_percent), number_text(r.machine_time_s, 1),
                          number_text(r.error_um.p95, 2), number_text(r.error_um.rms, 2), std::to_string(r.slowed),
                          std::to_string(r.repeated)});
  }
  return table;
}

void add_times(ReportData& data, const machine::Job& job, const compensate::CompensationResult& c) {
  if (c.time_points.empty()) return;
  data.pictures.push_back({"Machine time against error", time_error_svg(c, job.compensation.half_width_um()),
                           "Blue: the best program for each time allowed, filled where runs are cut twice; red ring: "
                           "the emitted program; dashed: the tolerance; grey: all rounds."});
  data.tables.insert(data.tables.begin(), time_table(c));
}

TextTable limits_table(const machine::Job& job, const compensate::CompensationResult& c) {
  TextTable table{"Limits and changes", {}, {}, {}};
  table.rows = {{"tolerance", fmt::format("{:g} µm", job.compensation.tolerance_um)},
                {"maximum shift", fmt::format("{:g} µm", 1000 * job.compensation.max_shift_mm)},
                {"path points at this limit", std::to_string(c.rounds[c.best].limited_points)},
                {"blocks", fmt::format("{} before, {} after", c.emitted.blocks_before, c.emitted.blocks_after)},
                {"blocks changed", std::to_string(c.emitted.blocks_changed)}};
  return table;
}

/// The figures of both motions side by side.
TextTable traced_table(const SimulatedProgram& program, const simulate::Prediction& p, const simulate::TracedRun& t) {
  TextTable table{
      "Feed model and trace",
      {"", "95 %, µm", "rms, µm", "mean, µm", "least, µm", "greatest, µm", "machine time, s"},
      {},
      fmt::format("{}: {} samples, {:.4g} ms apart, matched to the program by {}; in the cut the axes were "
                  "{:.2f} µm or less off the programmed path for 95 % of the samples, {:.2f} µm at most.",
                  file_name(t.trace), t.samples.size(), 1000 * t.period_s, t.by_line ? "the column line" : "place",
                  1000 * t.off_path_p95_mm, 1000 * t.off_path_max_mm)};
  const auto add = [&](const char* name, const removal::ErrorFigures& e, const std::string& time) {
    table.rows.push_back({name, number_text(e.p95, 2), number_text(e.rms, 2), number_text(e.mean, 2),
                          number_text(e.min, 2), number_text(e.max, 2), time});
  };
  add("feed model", t.predicted.form_error_um, number_text(t.model.feed.time_s, 2));
  add("trace", p.form_error_um, number_text(program.feed.time_s, 2));
  add("trace − feed model", t.difference_um, "");
  return table;
}

}  // namespace

FormErrorPoints form_error_points(const SimulatedProgram& program, const simulate::Prediction& prediction,
                                  const simulate::TracedRun* traced) {
  return {prediction.surface.size(), [&program, &prediction, traced](std::size_t i) {
            const auto& p = prediction.surface[i];
            FormErrorPoint point{.place_mm = p.place_mm,
                                 .crossing_mm = p.crossing_mm,
                                 .normal = p.normal,
                                 .error_um = 1000 * p.error_mm,
                                 .contour_um = 1000 * p.contour_mm,
                                 .area_mm2 = p.area_mm2};
            point.valid = p.valid;
            if (prediction.deflection_parts_um) point.part_um = 1000 * static_cast<double>(p.part_mm);
            if (!prediction.total_error_mm.empty()) point.total_error_um = 1000 * prediction.total_error_mm[i];
            if (traced) point.model_error_um = 1000 * traced->predicted.surface[i].error_mm;
            if (p.machined_stamp >= 0) {
              const auto stamp = static_cast<std::size_t>(p.machined_stamp);
              const nc::Move& move = program.moves_in_part().moves[program.path.stamps[stamp].move];
              point.block = move.block + 1;
              point.tool = program.moves_in_part().state_of(move).tool;
            }
            return point;
          }};
}

ReportData predict_report(const machine::Job& job, const SimulatedProgram& program, const simulate::Prediction& p,
                          const removal::StockShape& stock, std::vector<PathRow> rows, const Diagnostics& diagnostics) {
  ReportData data;
  data.title = "Predicted form error of " + file_name(job.program);
  data.subtitle = job.path;
  const Figure time{"machine time", program.feed.time_s, std::nullopt, "s", 1, "machine_time_s"};
  if (simulate::beyond_model(p)) {
    data.figures.push_back(time);
  } else {
    add_figures(data, p.form_error_um, nullptr, "form_error_um");
    add_parts(data, p);
    // Shown large: two of the error, the force, the time.
    auto next = data.figures.begin() + 2;
    if (!simulate::forces_beyond_model(p))
      next = data.figures.insert(next,
                                 {"maximum lateral force", largest_force_N(p), std::nullopt, "N", 1, "force_N.max"}) +
             1;
    data.figures.insert(next, time);
  }
  if (!simulate::forces_beyond_model(p))
    data.figures.push_back({"removed, by the chips", chips_mm3(p), std::nullopt, "mm3", 2, "removed_mm3.path"});
  data.figures.push_back({"removed, by the stock", p.cut.stock_mm3, std::nullopt, "mm3", 2, "removed_mm3.stock"});
  data.surface = {p.surface.size(), [&](std::size_t i) { return sample_of(p.surface[i], program); }};
  data.voxel_mm = job.simulation.voxel_mm;
  add_stock(data, stock);
  rows = shown_rows(data, job, program, std::move(rows));
  add_loads(rows, program.path, p.cut.loads, p.chatter.passages);
  add_errors(rows, program.path, p.surface);
  if (turns(rows)) data.machine = machine_view(job, rows);
  data.path.push_back({"", program.text().source.text(), std::move(rows)});
  if (!simulate::beyond_model(p)) add_worst_lines(data, program, false);
  add_chatter(data, job, p.chatter);
  add_texts(data, job, diagnostics, unsettled_sentence(program, p));
  if (std::vector<std::string> doubts = simulate::doubts(job, program, p); !doubts.empty())
    data.verdict = PageVerdict{false, "these figures are not to be relied on", std::move(doubts)};
  return data;
}

void add_traced(ReportData& data, const SimulatedProgram& program, const simulate::Prediction& p,
                const simulate::TracedRun& t, std::vector<PathRow> model_rows) {
  data.title += " where a trace measured the axes";
  data.names = {"feed model", "trace"};
  data.compared = true;
  const auto line_of_model = [&program, &t](std::int32_t stamp) {
    if (stamp < 0 || static_cast<std::size_t>(stamp) >= t.model.path.stamps.size()) return std::uint32_t{0};
    return program.moves_in_part().moves[t.model.path.stamps[static_cast<std::size_t>(stamp)].move].block + 1;
  };
  data.surface = {p.surface.size(), [&p, &t, &program, line_of_model](std::size_t i) {
                    const auto& model = t.predicted.surface[i];
                    SurfaceSample sample = sample_of(p.surface[i], program);
                    sample.error_after_um = sample.error_um;
                    sample.block_after = sample.block;
                    sample.error_um = 1000 * model.error_mm;
                    sample.contour_um = 1000 * model.contour_mm;
                    sample.block = line_of_model(model.machined_stamp);
                    return sample;
                  }};
  data.path.back().name = data.names[1];
  add_loads(model_rows, t.model.path, t.predicted.cut.loads, t.predicted.chatter.passages);
  add_errors(model_rows, t.model.path, t.predicted.surface);
  data.path.insert(data.path.begin(), {data.names[0], program.text().source.text(), std::move(model_rows)});
  data.tables.insert(data.tables.begin(), traced_table(program, p, t));
}

ReportData compensate_report(const machine::Job& job, const compensate::CompensationResult& c, CompensatedRun before,
                             CompensatedRun after, const std::string& output, const Diagnostics& diagnostics,
                             const nc::Interpretation* shifted_from) {
  ReportData data;
  data.title = "Compensation of " + file_name(job.program);
  data.subtitle = job.path;
  add_figures(data, c.figures.before_um, &c.figures.after_um, "{}_um");
  const auto part = [&](const char* name, const removal::ErrorFigures& before, const removal::ErrorFigures& after,
                        const char* key) {
    data.figures.push_back({name, before.rms, after.rms, "um", 2, key});
  };
  const auto &given = c.figures.plain_before, &emitted = c.figures.plain_after;
  part("error, rms", given.error_um, emitted.error_um, "{}.error_um.rms");
  part("due to deflection, rms", given.deflection_um, emitted.deflection_um, "{}.deflection_um.rms");
  part("due to servo lag and corner rounding, rms", given.contour_um, emitted.contour_um, "{}.contour_um.rms");
  if (given.total_um && emitted.total_um)
    part("against the part's mesh, rms", *given.total_um, *emitted.total_um, "{}.total_error_um.rms");
  data.figures.insert(data.figures.begin() + 2,
                      {"largest shift", 1000 * c.path.max_shift_mm, std::nullopt, "um", 1, "max_shift_um"});
  data.figures.insert(data.figures.begin() + 3, {"machine time", c.figures.feed_before.time_s,
                                                 c.figures.feed_after.time_s, "s", 1, "machine_time_s.{}"});
  data.figures.push_back(
      {"surface without a form error, about", c.figures.unseen_mm2, std::nullopt, "mm2", 1, "unseen_mm2"});
  data.voxel_mm = job.simulation.voxel_mm;
  data.compared = c.surfaces.after.size() == c.surfaces.before.size();
  data.surface = {c.surfaces.before.size(),
                  [&c, &given = before.program, &written = after.program, compared = data.compared](std::size_t i) {
                    SurfaceSample sample = sample_of(c.surfaces.before[i], given);
                    if (!compared) return sample;
                    sample.error_after_um = 1000 * c.surfaces.after[i].error_mm;
                    sample.block_after = line_of(written, c.surfaces.after[i].machined_stamp);
                    return sample;
                  }};
  add_stock(data, c.surfaces.stock);
  add_shifts(after.rows, after.program.moves_in_part(), shifted_from ? *shifted_from : before.program.moves_in_part());
  for (CompensatedRun* run : {&before, &after}) {
    run->rows = shown_rows(data, job, run->program, std::move(run->rows));
    add_loads(run->rows, run->program.path, run->loads, run->chatter);
    add_errors(run->rows, run->program.path, run == &before ? c.surfaces.before : c.surfaces.after);
    if (!data.machine && turns(run->rows)) data.machine = machine_view(job, run->rows);
    data.path.push_back({run == &before ? "before" : "after", run->program.text().source.text(), std::move(run->rows)});
  }
  if (c.verdict.better || c.best > 0) data.download_name = file_name(output);  // else nothing is written
  data.tables = {rounds_table(c), limits_table(job, c)};
  add_times(data, job, c);
  add_worst_lines(data, data.compared ? after.program : before.program, data.compared);
  for (TextTable& table : compensation_tables(c)) data.tables.push_back(std::move(table));
  add_features(data, features_of(job, c.surfaces.before), "Features before the compensation");
  add_features(data, features_of(job, c.surfaces.after), "Features after the compensation");
  add_texts(data, job, diagnostics, {});
  const VerdictText verdict = verdict_text(c, job.compensation);
  data.verdict = PageVerdict{verdict.success, verdict.headline, verdict.reasons};
  return data;
}

void add_measured(ReportData& data, const std::vector<compensate::MeasuredPoint>& points) {
  std::vector<SurfaceSample> samples;
  for (const compensate::MeasuredPoint& p : points)
    samples.push_back({.place_mm = p.place_mm, .normal = p.normal, .error_um = 1000 * p.error_mm});
  data.measured = samples;
}

}  // namespace camber::report
