#include "report/report_data.h"

#include <algorithm>

#include <fmt/format.h>

#include "report/summary.h"

namespace camber::report {
namespace {

std::vector<SurfaceSample> surface_samples(const std::vector<removal::SurfacePoint>& points) {
  std::vector<SurfaceSample> out;
  out.reserve(points.size());
  for (const auto& p : points)
    out.push_back({p.place_mm.x(), p.place_mm.y(), p.place_mm.z(), p.normal.x(), p.normal.y(), p.normal.z(),
                   1000 * p.error_mm, p.area_mm2});
  return out;
}

void add_figures(ReportData& data, const removal::ErrorFigures& before, const removal::ErrorFigures* after) {
  const auto add = [&](const char* name, double removal::ErrorFigures::*which) {
    data.figures.push_back({name, before.*which, after ? std::optional<double>(after->*which) : std::nullopt, "um", 2});
  };
  add("form error, 95th percentile", &removal::ErrorFigures::p95);
  add("form error, rms", &removal::ErrorFigures::rms);
  add("form error, greatest (material left)", &removal::ErrorFigures::max);
  add("form error, least (cut too deep)", &removal::ErrorFigures::min);
  add("form error, mean", &removal::ErrorFigures::mean);
}

void add_notes(ReportData& data, const Diagnostics& diagnostics, const std::string& unsettled) {
  for (const auto& d : diagnostics.all()) data.notes.push_back(to_string(d));
  if (!unsettled.empty()) data.notes.push_back(unsettled);
  data.notes.push_back(
      "Left out of the model: bending of the work, chatter, heat and wear; the deflection of the tool is static.");
}

}  // namespace

std::vector<FormErrorPoint> form_error_points(const deflection::MachinedProgram& program,
                                              const deflection::Prediction& prediction) {
  std::vector<FormErrorPoint> out;
  out.reserve(prediction.surface.size());
  for (std::size_t i = 0; i < prediction.surface.size(); ++i) {
    const auto& p = prediction.surface[i];
    FormErrorPoint point{.place_mm = p.place_mm, .normal = p.normal, .error_um = 1000 * p.error_mm};
    if (!prediction.total_error_mm.empty()) point.total_error_um = 1000 * prediction.total_error_mm[i];
    if (p.machined_stamp >= 0) {
      const nc::Move& move =
          program.moves.moves[program.path.stamps[static_cast<std::size_t>(p.machined_stamp)].move];
      point.block = move.block + 1;
      point.tool = program.moves.state_of(move).tool;
    }
    out.push_back(point);
  }
  return out;
}

void FeedCollector::add(std::span<const feedmodel::TimedSample> samples) {
  for (const auto& s : samples) {
    if (s.t_s < next_s_) continue;
    next_s_ = s.t_s + period_s_ * 0.999;
    samples_.push_back({s.t_s, 60 * s.feed_command_mm_per_s, 60 * s.velocity_mm_per_s.norm()});
  }
}

ReportData predict_report(const std::string& title, const deflection::MachinedProgram& program,
                          const deflection::Prediction& p, std::vector<FeedSample> feed,
                          const Diagnostics& diagnostics) {
  ReportData data;
  data.title = title;
  data.subtitle = program.text.source.name();
  add_figures(data, p.form_error_um, nullptr);
  double force = 0;
  for (const auto& l : p.cut.loads) force = std::max(force, l.lateral_max_N);
  data.figures.push_back({"greatest lateral force", force, std::nullopt, "N", 1});
  data.figures.push_back({"removed, by the chips", p.cut.chip_mm3, std::nullopt, "mm3", 2});
  data.figures.push_back({"removed, by the stock", p.cut.stock_mm3, std::nullopt, "mm3", 2});
  data.figures.push_back({"machine time", program.feed.time_s, std::nullopt, "s", 1});
  data.before = surface_samples(p.surface);
  data.feed = std::move(feed);
  add_notes(data, diagnostics, unsettled_sentence(p));
  return data;
}

ReportData compensate_report(const std::string& title, const compensate::Compensation& c,
                             std::vector<FeedSample> feed_before, std::vector<FeedSample> feed_after,
                             const Diagnostics& diagnostics) {
  ReportData data;
  data.title = title;
  add_figures(data, c.before_um, &c.after_um);
  data.figures.push_back({"machine time", c.feed_before.time_s, c.feed_after.time_s, "s", 1});
  data.figures.push_back({"largest shift", 1000 * c.max_shift_mm, std::nullopt, "um", 1});
  data.before = surface_samples(c.surface_before);
  data.after = surface_samples(c.surface_after);
  data.feed = std::move(feed_before);
  data.feed_after = std::move(feed_after);
  for (std::size_t i = 0; i < c.rounds.size(); ++i) {
    const auto& e = c.rounds[i].error_um;
    data.rounds.push_back({static_cast<int>(i), e.p95, e.rms, e.min, e.max, 1000 * c.rounds[i].largest_shift_mm});
  }
  data.notes.push_back(fmt::format("Stopped: {}. {} of {} blocks changed.", compensate::to_string(c.stop),
                                   c.blocks_changed, c.blocks_before));
  add_notes(data, diagnostics, unsettled_sentence(c));
  return data;
}

}  // namespace camber::report
