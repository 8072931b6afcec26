#include "report/copy_summary.h"

#include <algorithm>
#include <functional>
#include <vector>

#include <fmt/format.h>

#include "base/json.h"
#include "report/figures_json.h"

namespace camber::report {

using copymill::CopyResult;

namespace {

Json places_json(const copymill::LoadFigures& l) {
  Json out = Json::array();
  for (const copymill::OverTarget& p : l.places)
    out.push_back({{"t_s", p.t_s},
                   {"at_mm", {p.place_mm.x(), p.place_mm.y(), p.place_mm.z()}},
                   {"force_N", p.force_N},
                   {"passings", p.passings}});
  return out;
}

/// The places with the greatest forces, in the program's order.
std::string places_text(const copymill::LoadFigures& l) {
  constexpr std::size_t kNamed = 5;
  std::vector<copymill::OverTarget> worst = l.places;
  std::ranges::stable_sort(worst, std::greater<>(), &copymill::OverTarget::force_N);
  if (worst.size() > kNamed) worst.resize(kNamed);
  std::ranges::stable_sort(worst, {}, &copymill::OverTarget::t_s);
  std::string out = fmt::format("      more than {:.0f} % of the target in {} place{}, {}by time:\n",
                                100 * copymill::LoadFigures::kOver, l.places.size(), l.places.size() == 1 ? "" : "s",
                                l.places.size() > kNamed ? fmt::format("the worst {} ", kNamed) : "");
  for (const copymill::OverTarget& p : worst)
    out += fmt::format("        {:.0f} N at X{:.3f} Y{:.3f} Z{:.3f}, {:.2f} s, {} passings\n", p.force_N,
                       p.place_mm.x(), p.place_mm.y(), p.place_mm.z(), p.t_s, p.passings);
  return out;
}

Json load_json(const copymill::LoadFigures& l) {
  return {{"target", l.target_N},
          {"max", l.max_N},
          {"within_share", l.counted > 0 ? static_cast<double>(l.within) / static_cast<double>(l.counted) : 0.0},
          {"passings", l.passings},
          {"counted", l.counted},
          {"over", l.over}};
}

/// Adds up the operations that have a target: all passings together, the greatest load by its own target.
copymill::LoadFigures together(const CopyResult& r) {
  copymill::LoadFigures out;
  for (const copymill::OperationSummary& o : r.operations) {
    if (o.load.target_N <= 0) continue;
    if (out.target_N <= 0 || o.load.max_N / o.load.target_N > out.max_N / out.target_N)
      out.target_N = o.load.target_N, out.max_N = o.load.max_N;
    out.passings += o.load.passings, out.counted += o.load.counted, out.within += o.load.within,
        out.over += o.load.over;
  }
  return out;
}

Json operations_json(const CopyResult& r) {
  Json out = Json::array();
  for (const copymill::OperationSummary& o : r.operations)
    out.push_back({{"tool", o.tool},
                   {"mode", machine::word_of(o.mode)},
                   {"time_s", o.time_s},
                   {"cutting_s", o.cutting_s},
                   {"removed_mm3", o.removed_mm3},
                   {"levels", o.levels},
                   {"passes", o.passes},
                   {"ramps", o.ramps},
                   {"plunges", o.plunges},
                   {"retracts", o.retracts},
                   {"trochoid_circles", o.trochoid_circles},
                   {"nothing_left", o.nothing_left},
                   {"load", load_json(o.load)},
                   {"over_target", places_json(o.load)},
                   {"changes", o.changes.size()}});
  return out;
}

}  // namespace

std::string copy_json(const CopyResult& r, double compute_s) {
  Json j;
  j["schema_version"] = kSchemaVersion;
  j["time_s"] = r.time_s;
  j["blocks"] = r.blocks;
  j["removed_mm3"] = r.removed_mm3;
  j["left_um"] = {{"max", r.left.max_um}, {"p95", r.left.p95_um}, {"mean", r.left.mean_um}};
  j["gouge_um"] = r.path_depth_um;
  j["stock_gouge_um"] = r.left.gouge_um;
  j["reached_mm2"] = r.left.reached_mm2;
  j["unreached_mm2"] = r.left.unreached_mm2;
  j["load"] = load_json(together(r));
  j["ticks"] = r.ticks;
  j["tick_ms"] = {{"mean", r.tick_mean_ms}, {"max", r.tick_max_ms}};
  j["stopped"] = r.stopped;
  j["operations"] = operations_json(r);
  j["compute_s"] = compute_s;
  return j.dump(2) + "\n";
}

std::string copy_log_csv(const CopyResult& r) {
  std::string out = "t_s,tool,x_mm,y_mm,z_mm,what,from,to,unit,load_over_target,reason\n";
  for (const copymill::OperationSummary& o : r.operations)
    for (const copymill::Change& c : o.changes) {
      const bool feed = c.what == copymill::Quantity::feed;
      const double scale = feed ? 60 : 1;
      out += fmt::format("{:.4f},{},{:.3f},{:.3f},{:.3f},{},{:.3f},{:.3f},{},{:.3f},{}\n", c.t_s, o.tool,
                         c.place_mm.x(), c.place_mm.y(), c.place_mm.z(), copymill::name_of(c.what), scale * c.from,
                         scale * c.to, feed ? "mm/min" : "mm", c.share, copymill::text_of(c.cause));
    }
  return out;
}

std::string copy_text(const CopyResult& r, double compute_s) {
  std::string out = fmt::format("{:>4}  {:<14}{:>10}{:>12}{:>14}{:>8}{:>8}{:>7}{:>10}\n", "tool", "mode", "time, s",
                                "cutting, s", "removed, mm3", "levels", "passes", "ramps", "retracts");
  for (const copymill::OperationSummary& o : r.operations) {
    out += fmt::format("{:>4}  {:<14}{:>10.1f}{:>12.1f}{:>14.1f}{:>8}{:>8}{:>7}{:>10}\n", fmt::format("T{}", o.tool),
                       machine::word_of(o.mode), o.time_s, o.cutting_s, o.removed_mm3, o.levels, o.passes, o.ramps,
                       o.retracts);
    if (o.load.target_N > 0)
      out += fmt::format(
          "      force {:.0f} N at most, target {:.0f} N; 80 to 105 % of it for {:.1f} % of {} passings that no "
          "bound holds\n",
          o.load.max_N, o.load.target_N,
          o.load.counted > 0 ? 100.0 * static_cast<double>(o.load.within) / static_cast<double>(o.load.counted) : 0.0,
          o.load.counted);
    if (!o.load.places.empty()) out += places_text(o.load);
    if (o.trochoid_circles > 0)
      out += fmt::format("      {} trochoid circles instead of full cuts\n", o.trochoid_circles);
    if (o.nothing_left) out += "      nothing was left for this operation\n";
  }
  out += fmt::format("time {:.1f} s, {} blocks, {:.1f} mm3 removed{}\n", r.time_s, r.blocks, r.removed_mm3,
                     r.stopped ? "; stopped before the end" : "");
  out += fmt::format("left on the part: {:.0f} um at most, {:.0f} um p95; path into the part: {:.1f} um; ",
                     r.left.max_um, r.left.p95_um, r.path_depth_um);
  out += fmt::format("{:.1f} mm2 that no tool reaches\n", r.left.unreached_mm2);
  return out + fmt::format("{} ticks, {:.4f} ms each, at most {:.3f} ms; computed in {:.1f} s\n", r.ticks,
                           r.tick_mean_ms, r.tick_max_ms, compute_s);
}

}  // namespace camber::report
