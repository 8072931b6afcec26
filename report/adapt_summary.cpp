#include "report/adapt_summary.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/json.h"
#include "base/numbers.h"
#include "base/units.h"
#include "report/figures_json.h"

namespace camber::report {

using adapt::AdaptResult;

namespace {

double shown(const adapt::LoadLimit& limit, double value) { return adapt::text_of(limit.load).scale * value; }

Json loads_json(const AdaptResult& r) {
  Json out = Json::array();
  for (const adapt::LoadFigure& f : r.loads)
    out.push_back({{"name", adapt::text_of(f.limit.load).key},
                   {"limit", shown(f.limit, f.limit.value)},
                   {"max_before", shown(f.limit, f.max_before)},
                   {"max_after", shown(f.limit, f.max_after)},
                   {"max_elsewhere", shown(f.limit, f.max_elsewhere)}});
  return out;
}

Json over_json(const AdaptResult& r) {
  Json out = Json::array();
  for (const adapt::OverLimit& o : r.over)
    out.push_back({{"line", o.line},
                   {"new_line", o.new_line},
                   {"name", adapt::text_of(o.limit.load).key},
                   {"value", shown(o.limit, o.value)},
                   {"feed_mm_per_min", mm_per_min_from_mm_per_s(o.feed_mm_per_s)},
                   {"reason", adapt::to_string(o.reason)}});
  return out;
}

Json sweep_json(const AdaptResult& r) {
  Json out = Json::array();
  for (const adapt::SweepRow& row : r.sweep)
    out.push_back({{"factor", row.factor},
                   {"time_s", row.time_s},
                   {"blocks", row.blocks},
                   {"constant_feed_mm_per_min", mm_per_min_from_mm_per_s(row.constant_feed_mm_per_s)},
                   {"constant_time_s", row.constant_time_s}});
  return out;
}

Json or_null(double value) { return value > 0 ? Json(value) : Json(nullptr); }

Json chatter_json(const AdaptResult& r) {
  Json rows = Json::array();
  for (const adapt::SpeedChange& c : r.speeds)
    rows.push_back({{"tool", c.tool},
                    {"modes", c.measured ? "given" : "beam"},
                    {"speed_before_rpm", c.before_rpm},
                    {"speed_after_rpm", c.after_rpm},
                    {"margin_before", c.margin_before},
                    {"margin_after", c.margin_after},
                    {"line", c.line},
                    {"new_line", c.new_line},
                    {"chatter_Hz", c.chatter_hz},
                    {"depth_mm", c.depth_mm},
                    {"kept_depth_mm", c.kept_depth_mm},
                    {"stable_speed_rpm", or_null(c.advised_rpm)},
                    {"best_speed_rpm", or_null(c.best_rpm)},
                    {"best_speed_depth_mm", or_null(c.best_depth_mm)},
                    {"probability", c.probability},
                    {"kept", c.kept},
                    {"reason", c.reason}});
  const bool kept = std::ranges::all_of(r.speeds, &adapt::SpeedChange::kept);
  return {{"limit", r.chatter_limit}, {"kept", kept}, {"operations", std::move(rows)}};
}

std::string chatter_rows(const AdaptResult& r) {
  if (r.chatter_limit <= 0) return {};
  std::string out = fmt::format("margin of chatter, at most {:g}:\n", r.chatter_limit);
  for (const adapt::SpeedChange& c : r.speeds)
    out += fmt::format("  T{}: {}; probability {:.0f} %, {}\n", c.tool, speed_change_text(c), 100 * c.probability,
                       c.measured ? "modes of the job" : "beam's modes, usual damping");
  return out;
}

/// Says which depth or speed would keep the limit.
std::string cure_of(const adapt::SpeedChange& c) {
  std::string depth = fmt::format("an axial depth of {:.2g} mm at S{:.0f}", c.kept_depth_mm, c.before_rpm);
  if (c.advised_rpm > 0 && c.advised_rpm != c.after_rpm)
    return fmt::format("S{:.0f} with F {:.2f} times as high would keep it, but {}; that, or {}, was expected",
                       c.advised_rpm, c.advised_rpm / c.before_rpm, c.reason, depth);
  if (c.best_rpm > 0 && c.advised_rpm <= 0)
    return fmt::format("no speed that may be used keeps it; {}, or {:.2g} mm at S{:.0f}, was expected", depth,
                       c.best_depth_mm, c.best_rpm);
  return depth + " was expected";
}

/// Lines of the emitted program, without repetition.
std::size_t blocks_over(const AdaptResult& r) {
  std::size_t out = 0, last = 0;
  for (const adapt::OverLimit& o : r.over) {
    out += o.new_line != last ? 1 : 0;
    last = o.new_line;
  }
  return out;
}

std::string over_row(const adapt::OverLimit& o) {
  const adapt::LoadText& text = adapt::text_of(o.limit.load);
  return fmt::format("line {} ({}): {} {:.{}f} {} at {:.0f} mm/min; {}", o.line, o.new_line, text.name,
                     shown(o.limit, o.value), text.decimals, text.unit, mm_per_min_from_mm_per_s(o.feed_mm_per_s),
                     adapt::to_string(o.reason));
}

}  // namespace

std::string adapt_json(const AdaptResult& r, const machine::AdaptSettings& asked, double compute_s) {
  Json j;
  j["schema_version"] = kSchemaVersion;
  j["time_before_s"] = r.time_before_s;
  j["time_after_s"] = r.time_after_s;
  j["cutting_time_before_s"] = r.cutting_time_before_s;
  j["cutting_time_after_s"] = r.cutting_time_after_s;
  j["milling_time_before_s"] = r.milling_time_before_s;
  j["milling_time_after_s"] = r.milling_time_after_s;
  j["constant_feed"] = {{"feed_mm_per_min", mm_per_min_from_mm_per_s(r.constant_feed_mm_per_s)},
                        {"time_s", r.constant_time_s},
                        {"milling_time_s", r.constant_milling_time_s}};
  if (asked.highest_feed_mm_per_s > 0)
    j["feed_mm_per_min"] = {{"lowest", mm_per_min_from_mm_per_s(asked.lowest_feed_mm_per_s)},
                            {"highest", mm_per_min_from_mm_per_s(asked.highest_feed_mm_per_s)}};
  j["blocks"] = {{"before", r.blocks_before}, {"after", r.blocks_after}, {"changed", r.blocks_changed}};
  j["loads"] = loads_json(r);
  j["over_limit_blocks"] = blocks_over(r);
  j["over_limit"] = over_json(r);
  j["within_limits"] = r.good;
  j["within_time"] = r.in_time;
  j["limit_factor"] = r.limit_factor;
  j["predictions"] = r.predictions;
  if (r.chatter_limit > 0) j["chatter"] = chatter_json(r);
  if (!r.sweep.empty()) j["sweep"] = sweep_json(r);
  j["doubts"] = r.doubts;
  j["compute_s"] = compute_s;
  return j.dump(2) + "\n";
}

std::string speed_change_text(const adapt::SpeedChange& c) {
  const std::string before = fmt::format("{:.2f} at S{:.0f} in line {}", c.margin_before, c.before_rpm, c.line);
  if (c.after_rpm == c.before_rpm) return before;
  return fmt::format("{}; {:.2f} at S{:.0f} in line {} of the new program", before, c.margin_after, c.after_rpm,
                     c.new_line);
}

std::string adapt_text(const AdaptResult& r, double compute_s) {
  constexpr std::size_t kShown = 8;
  std::string out;
  if (!r.loads.empty())
    out = fmt::format("{:<26}{:>10}{:>10}{:>10}{:>14}\n", "load", "limit", "before", "after", "elsewhere");
  for (const adapt::LoadFigure& f : r.loads) {
    const adapt::LoadText& text = adapt::text_of(f.limit.load);
    const auto cell = [&](double v) { return fmt::format("{:.{}f}", shown(f.limit, v), text.decimals); };
    out += fmt::format("{:<26}{:>10}{:>10}{:>10}{:>14}\n", fmt::format("{}, {}", text.name, text.unit),
                       cell(f.limit.value), cell(f.max_before), cell(f.max_after), cell(f.max_elsewhere));
  }
  out += chatter_rows(r);
  out += fmt::format("time {:.1f} s before, {:.1f} s after ({:+.1f} %)", r.time_before_s, r.time_after_s,
                     100 * (r.time_after_s / r.time_before_s - 1));
  if (r.constant_feed_mm_per_s > 0)
    out += fmt::format("; {:.1f} s with {:.0f} mm/min throughout, the greatest single feed within the limits",
                       r.constant_time_s, mm_per_min_from_mm_per_s(r.constant_feed_mm_per_s));
  out += fmt::format("\nblocks {} before, {} after, {} changed\n", r.blocks_before, r.blocks_after, r.blocks_changed);
  if (r.limit_factor != 1) out += fmt::format("limits x {:.3f} for the time limit\n", r.limit_factor);
  if (!r.over.empty()) out += fmt::format("{} blocks remain beyond a limit:\n", blocks_over(r));
  for (std::size_t i = 0; i < std::min(r.over.size(), kShown); ++i) out += "  " + over_row(r.over[i]) + "\n";
  if (r.over.size() > kShown) out += fmt::format("  and {} more (--json)\n", r.over.size() - kShown);
  if (!r.sweep.empty())
    out += fmt::format("{:>14}{:>12}{:>10}{:>26}{:>12}\n", "limits x", "time, s", "blocks", "single feed, mm/min",
                       "time, s");
  for (const adapt::SweepRow& row : r.sweep) {
    const bool constant = row.constant_feed_mm_per_s > 0;
    out += fmt::format(
        "{:>14.2f}{:>12.1f}{:>10}{:>26}{:>12}\n", row.factor, row.time_s, row.blocks,
        constant ? fmt::format("{:.0f}", mm_per_min_from_mm_per_s(row.constant_feed_mm_per_s)) : std::string("none"),
        constant ? fmt::format("{:.1f}", row.constant_time_s) : std::string("-"));
  }
  return out + fmt::format("computed in {:.1f} s, {} predictions of the new program\n", compute_s, r.predictions);
}

std::vector<std::string> adapt_failures(const AdaptResult& r) {
  std::vector<std::string> out = r.doubts;
  if (!r.in_time)
    out.push_back("no limits are high enough for the time limit: the control or the highest feed takes the time");
  for (const adapt::SpeedChange& c : r.speeds)
    if (!c.kept)
      out.push_back(fmt::format("the margin of chatter of T{} exceeds chatter_margin = {:g}: {}; {}", c.tool,
                                r.chatter_limit, speed_change_text(c), cure_of(c)));
  if (r.good) return out;
  for (const adapt::OverLimit& o : r.over)
    if (o.reason == adapt::OverReason::control) {
      out.push_back("a load exceeds its limit although its feed might be lower: " + over_row(o));
      break;
    }
  return out;
}

}  // namespace camber::report
