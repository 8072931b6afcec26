#include "report/fit_summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "base/json.h"
#include "base/units.h"

namespace camber::report {
namespace {

using calib::FitFeedResult;

// --- text ------------------------------------------------------------------------------------------------------

double percent(double value, double reference) { return 100 * (value / reference - 1); }

std::string parameters_text(const std::vector<calib::FitParameter>& parameters) {
  std::string out;
  out += fmt::format("{:<44} {:>14} {:<7} {:>12} {:>5} {:>10}\n", "parameter", "value", "unit", "std error", "from",
                     "before");
  for (const calib::FitParameter& p : parameters)
    out += fmt::format("{:<44} {:>14.6g} {:<7} {:>12} {:>5} {:>10}  {}\n", p.name, p.value, p.unit,
                       p.std_error ? fmt::format("{:.2g}", *p.std_error) : "-",
                       p.stretches > 0 ? fmt::format("{}", p.stretches) : "-",
                       p.changed_from ? fmt::format("{:.6g}", *p.changed_from) : "-", p.note);
  return out;
}

std::string laws_text(const FitFeedResult& result) {
  std::string out;
  out += fmt::format("{:<52} {:>10} {:>10}\n", "corner law, held-out parts", "time, %", "cost");
  for (const calib::JudgedCornerLaw& law : result.laws)
    out += fmt::format("{:<52} {:>10.3f} {:>10.3f}\n", law.name, law.held_out_percent, law.held_out_cost);
  out += fmt::format("taken: {}\n\n", result.law);
  return out;
}

/// Stretches of the logs: over all, and those that are off by the most.
std::string logged_text(const FitFeedResult& result) {
  std::string out;
  if (result.logged.empty()) return out;
  const auto line = [&out](const char* name, const calib::LoggedError& e) {
    out += fmt::format("{:<9} {:>4} logged stretches: time {:.2f} % mean, {:.2f} % worst\n", name, e.stretches, e.mean,
                       e.worst);
  };
  line("fitted", result.logged_fitted);
  line("held out", result.logged_held_out);
  constexpr std::size_t kShown = 5;
  std::vector<calib::LoggedTime> worst = result.logged;
  std::ranges::stable_sort(worst, std::greater<>(),
                           [](const calib::LoggedTime& t) { return std::abs(t.model_s - t.time_s) / t.time_s; });
  for (std::size_t i = 0; i < std::min(kShown, worst.size()); ++i)
    out += fmt::format("  {}: lines {}-{}: {:.3f} s logged, {:.3f} s predicted ({:+.2f} %){}\n", worst[i].program_name,
                       worst[i].part.line_first, worst[i].part.line_last, worst[i].time_s, worst[i].model_s,
                       percent(worst[i].model_s, worst[i].time_s), worst[i].kept_back ? ", held out" : "");
  return out;
}

std::string promise_text(const std::optional<calib::TimePromise>& promise) {
  if (!promise) return {};
  return fmt::format("time of a next program like the parts held out: {:+.2f} to {:+.2f} % off in 19 of 20 cases\n",
                     promise->low_percent, promise->high_percent);
}

std::string fit_text_of(const FitFeedResult& result) {
  std::string out;
  out += laws_text(result) + parameters_text(result.parameters);
  constexpr const char* kAxes = "xyz";
  for (int i = 0; i < 3; ++i) {
    const calib::DriveFit& drive = result.drives[i];
    if (!drive.moved) continue;
    out += fmt::format("axis {}: {}; position rms {:.3f} um fitted, {:.3f} um held out\n", kAxes[i], drive.model,
                       1000 * drive.fitted_rms_mm, 1000 * drive.held_out_rms_mm);
  }
  for (const char letter : result.machine.kinematics.rotary_axes()) {
    const calib::DriveFit& drive = result.rotary_drives[static_cast<std::size_t>(letter - 'a')];
    if (!drive.moved) continue;
    out += fmt::format("axis {}: {}; position rms {:.6f} degrees fitted, {:.6f} degrees held out\n", letter,
                       drive.model, drive.fitted_rms_mm, drive.held_out_rms_mm);
  }
  const auto line = [&](const char* name, const calib::FitError& e) {
    out += fmt::format("{:<9} {:>4} parts: time {:.2f} % mean, path speed rms {:.2f} %, p95 {:.2f} % of the feed\n",
                       name, e.parts, e.part_time_percent, e.speed_rms_percent, e.speed_p95_percent);
  };
  line("fitted", result.fitted);
  line("held out", result.held_out);
  out += promise_text(result.promise);
  for (const calib::RunAccuracy& run : result.runs)
    out += fmt::format("{}: {:.2f} s traced, {:.2f} s predicted ({:+.2f} %), path speed rms {:.2f} %, p95 {:.2f} %\n",
                       run.program_name, run.accuracy.time_trace_s, run.accuracy.time_model_s,
                       run.accuracy.time_error_percent, run.accuracy.speed_rms_percent, run.accuracy.speed_p95_percent);
  out += logged_text(result);
  out += fmt::format("residual of part times: median {:.2f} ms; {}\n", result.residual_median_ms, result.message);
  return out;
}

std::string fit_text_of(const calib::StretchFit& fit) {
  std::string out;
  out += parameters_text(fit.parameters);
  const auto line = [&out](const std::string& name, const calib::StretchErrors& e) {
    out += fmt::format("{:<76} {:>7.2f} {:>7.2f} {:>7.2f} {:>+7.2f}\n", name, e.mean, e.p90, e.worst, e.total);
  };
  out += fmt::format(
      "\n{:<76} {:>7} {:>7} {:>7} {:>7}\n",
      fmt::format("error of the stretch times, % ({} geometries, {} folds)", fit.stretches.size(), fit.folds), "mean",
      "p90", "worst", "total");
  for (const calib::JudgedLaw& law : fit.laws) {
    line("held out: " + law.law.name, law.held_out);
    line("  each kind of motion by a fit on the others", law.kind_held_out);
  }
  if (!fit.laws.empty()) {
    line("chosen, held out: " + fit.laws[fit.chosen].law.name, fit.held_out);
    line("chosen, each kind of motion by a fit on the others", fit.laws[fit.chosen].kind_held_out);
    line("chosen, fitted to all", fit.fitted);
  }
  line("constant feed", fit.constant_feed);
  line("stop at every block", fit.stop_every_block);
  out += promise_text(fit.promise);
  out += fmt::format("\n{:<16} {:>4} {:>8} {:>10} {:>9} {:>9} {:>9} {:>10} {:>10}   %\n", "lines", "tool", "kind",
                     "machine, s", "held out", "by kind", "fitted", "const feed", "stop each");
  for (const calib::JudgedStretch& s : fit.stretches) {
    const auto& t = s.timed;
    out += fmt::format("{:<16} {:>4} {:>8} {:>10.3f} {:>+9.2f} {:>+9.2f} {:>+9.2f} {:>+10.2f} {:>+10.2f}\n",
                       fmt::format("{}-{}", t.stretch.line_first, t.stretch.line_last), t.stretch.tool, name_of(s.kind),
                       t.time_s, percent(s.held_out_s, t.time_s), percent(s.kind_held_out_s, t.time_s),
                       percent(s.fitted_s, t.time_s), percent(s.constant_feed_s, t.time_s),
                       percent(s.stop_every_block_s, t.time_s));
  }
  for (const auto& gap : fit.unseen_corners_rad)
    out += fmt::format(
        "no corner between {:.1f} and {:.1f} degrees was seen; camber protocol writes programs that have them\n",
        deg_from_rad(gap[0]), deg_from_rad(gap[1]));
  out += fmt::format("{}\n", fit.message);
  return out;
}

// --- JSON ------------------------------------------------------------------------------------------------------

/// JSON has no infinity.
Json finite_number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

void add_promise(Json& held_out, const std::optional<calib::TimePromise>& promise) {
  if (promise) held_out["next_program_time_percent"] = {promise->low_percent, promise->high_percent};
}

Json error_json(const calib::FitError& e) {
  return {{"parts", e.parts},
          {"part_time_percent", e.part_time_percent},
          {"speed_rms_percent", e.speed_rms_percent},
          {"speed_p95_percent", e.speed_p95_percent}};
}

constexpr std::array<const char*, 3> kAxisNames{"x", "y", "z"};

template <std::size_t n>
Json residuals_json(const std::array<calib::SpeedResidual, n>& residuals, const std::array<const char*, n>& names) {
  Json list = Json::array();
  for (std::size_t i = 0; i < n; ++i)
    list.push_back(
        {{"where", names[i]}, {"stations", residuals[i].stations}, {"speed_rms_percent", residuals[i].rms_percent}});
  return list;
}

Json parameters_json(const std::vector<calib::FitParameter>& parameters) {
  Json list = Json::array();
  for (const calib::FitParameter& p : parameters)
    list.push_back({{"name", p.name},
                    {"value", finite_number(p.value)},
                    {"unit", p.unit},
                    {"std_error", p.std_error ? finite_number(*p.std_error) : Json(nullptr)},
                    {"written", p.written},
                    {"stretches", p.stretches},
                    {"changed_from", p.changed_from ? finite_number(*p.changed_from) : Json(nullptr)},
                    {"note", p.note}});
  return list;
}

Json errors_json(const calib::StretchErrors& e) {
  return {{"stretch_time_mean_percent", e.mean},
          {"stretch_time_p90_percent", e.p90},
          {"stretch_time_worst_percent", e.worst},
          {"total_time_percent", e.total}};
}

Json report_of(const calib::StretchFit& fit) {
  Json report;
  report["parameters"] = parameters_json(fit.parameters);
  report["held_out"] = errors_json(fit.held_out);
  report["held_out"]["stretches"] = fit.stretches.size();
  add_promise(report["held_out"], fit.promise);
  report["fitted"] = errors_json(fit.fitted);
  report["baselines"] = {{"constant_feed", errors_json(fit.constant_feed)},
                         {"stop_at_every_block", errors_json(fit.stop_every_block)}};
  for (const calib::JudgedLaw& law : fit.laws)
    report["laws"].push_back({{"name", law.law.name},
                              {"held_out", errors_json(law.held_out)},
                              {"kind_held_out", errors_json(law.kind_held_out)}});
  for (const calib::JudgedStretch& s : fit.stretches)
    report["stretches"].push_back({{"program", s.program_name},
                                   {"line_first", s.timed.stretch.line_first},
                                   {"line_last", s.timed.stretch.line_last},
                                   {"tool", s.timed.stretch.tool},
                                   {"time_s", s.timed.time_s},
                                   {"held_out_s", s.held_out_s},
                                   {"kind", name_of(s.kind)},
                                   {"kind_held_out_s", s.kind_held_out_s},
                                   {"fitted_s", s.fitted_s},
                                   {"constant_feed_s", s.constant_feed_s},
                                   {"stop_every_block_s", s.stop_every_block_s}});
  report["converged"] = fit.converged;
  report["message"] = fit.message;
  return report;
}

Json report_of(const FitFeedResult& result) {
  Json report;
  report["parameters"] = parameters_json(result.parameters);
  report["held_out"] = error_json(result.held_out);
  add_promise(report["held_out"], result.promise);
  report["fitted"] = error_json(result.fitted);
  for (int i = 0; i < 3; ++i)
    report["drives"].push_back({{"axis", std::string(1, "xyz"[i])},
                                {"moved", result.drives[i].moved},
                                {"model", result.drives[i].model},
                                {"fitted_rms_mm", result.drives[i].fitted_rms_mm},
                                {"held_out_rms_mm", result.drives[i].held_out_rms_mm}});
  for (const char letter : result.machine.kinematics.rotary_axes()) {
    const calib::DriveFit& drive = result.rotary_drives[static_cast<std::size_t>(letter - 'a')];
    report["drives"].push_back({{"axis", std::string(1, letter)},
                                {"moved", drive.moved},
                                {"model", drive.model},
                                {"fitted_rms_deg", drive.fitted_rms_mm},
                                {"held_out_rms_deg", drive.held_out_rms_mm}});
  }
  for (const calib::RunAccuracy& run : result.runs)
    report["runs"].push_back({{"program", run.program_name},
                              {"time_trace_s", run.accuracy.time_trace_s},
                              {"time_model_s", run.accuracy.time_model_s},
                              {"time_error_percent", run.accuracy.time_error_percent},
                              {"speed_rms_percent", run.accuracy.speed_rms_percent},
                              {"speed_p95_percent", run.accuracy.speed_p95_percent},
                              {"by_place", residuals_json(run.accuracy.by_state, calib::kPathStates)},
                              {"by_axis", residuals_json(run.accuracy.by_axis, kAxisNames)}});
  for (const calib::LoggedTime& t : result.logged)
    report["logged"].push_back({{"program", t.program_name},
                                {"line_first", t.part.line_first},
                                {"line_last", t.part.line_last},
                                {"held_out", t.kept_back},
                                {"time_s", t.time_s},
                                {"model_s", t.model_s}});
  if (!result.logged.empty()) {
    report["fitted"]["logged_time_percent"] = result.logged_fitted.mean;
    report["held_out"]["logged_time_percent"] = result.logged_held_out.mean;
  }
  for (const calib::JudgedCornerLaw& law : result.laws)
    report["laws"].push_back(
        {{"name", law.name}, {"held_out", {{"part_time_percent", law.held_out_percent}, {"cost", law.held_out_cost}}}});
  report["law"] = result.law;
  report["residual_median_ms"] = result.residual_median_ms;
  report["converged"] = result.converged;
  report["message"] = result.message;
  return report;
}

}  // namespace

std::string fit_json(const FeedFit& fit) {
  return std::visit([](const auto& result) { return report_of(result); }, fit).dump(2) + "\n";
}

std::string fit_text(const FeedFit& fit) {
  return std::visit([](const auto& result) { return fit_text_of(result); }, fit);
}

std::string left_out_text(const std::vector<calib::HeldOutRun>& runs) {
  std::string out;
  out += fmt::format(
      "\nleave one trace out: every trace predicted by a fit on the others\n{:<34} {:>7} {:>6} {:>6} {:>6} {:>11} "
      "{:>7} {:>7}\n",
      "", "total %", "part %", "p90 %", "worst", "over 0.5 %", "rms %", "p95 %");
  const auto line = [&out](const std::string& name, const calib::FeedAccuracy& a) {
    const calib::PartTimes t = calib::part_times(a);
    out += fmt::format("{:<34} {:>+7.2f} {:>6.2f} {:>6.2f} {:>6.2f} {:>4} of {:>4} {:>7.2f} {:>7.2f}\n", name,
                       a.time_error_percent, t.mean, t.p90, t.worst, t.over, t.parts, a.speed_rms_percent,
                       a.speed_p95_percent);
  };
  for (const calib::HeldOutRun& run : runs) {
    const std::size_t slash = run.program_name.find_last_of('/');
    line(slash == std::string::npos ? run.program_name : run.program_name.substr(slash + 1), run.accuracy);
    line("  constant feed", run.constant_feed);
    line("  stop at every block", run.stop_every_block);
    out += fmt::format("  drives alone: x {:.3f}, y {:.3f}, z {:.3f} um rms", 1000 * run.drive_rms_mm[0],
                       1000 * run.drive_rms_mm[1], 1000 * run.drive_rms_mm[2]);
    for (const auto& [letter, rms_deg] : run.rotary_drive_rms_deg)
      out += fmt::format(", {} {:.5f} degrees rms", letter, rms_deg);
    out += fmt::format("\n");
  }
  return out;
}

std::string block_time_text(const calib::BlockTimeFit& fit) {
  std::string out;
  for (const calib::ChordRun& r : fit.runs)
    if (r.saturated)
      out += fmt::format("lines {}-{}: {:.4g} mm at F{:.0f}: {:.0f} mm/min, {:.4g} ms a block\n", r.line_first,
                         r.line_last, r.chord_mm, mm_per_min_from_mm_per_s(r.feed_mm_per_s),
                         mm_per_min_from_mm_per_s(r.speed_mm_per_s), 1000 * r.block_time_s);
  return out + fit.message + "\n";
}

}  // namespace camber::report
