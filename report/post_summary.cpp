#include "report/rewrite_summary.h"

#include <fmt/format.h>

#include "base/json.h"
#include "base/numbers.h"
#include "base/units.h"

namespace camber::report {
namespace {

std::string turn_angle_text(double rad) { return format_trimmed(deg_from_rad(rad), 3); }

std::string turns_text(const repath::TurnBack& back) {
  std::string out;
  for (int i = 0; i < 3; ++i)
    if (back.from_rad[i] != back.to_rad[i])
      out += fmt::format("{}{} from {} to {}", out.empty() ? "" : ", ", "ABC"[i], turn_angle_text(back.from_rad[i]),
                         turn_angle_text(back.to_rad[i]));
  return out;
}

}  // namespace

std::string post_text(const PostSummary& summary) {
  const repath::Posted& p = summary.posted;
  const repath::PostDeviation& d = summary.deviation;
  std::string out = fmt::format("blocks     {} became {}; {} moves rewritten\n", summary.blocks_before,
                                summary.blocks_after, p.moves);
  out += fmt::format("feed       {} moves in {} blocks; by the one-degree rule {}, tip off by up to {:.4f} mm\n",
                     p.feed_moves, p.feed_blocks, p.one_degree_blocks, p.one_degree_bound_mm);
  out += fmt::format("tip        off its path by at most {:.4f} mm (largest of {} samples {:.4f})\n", p.tip_bound_mm,
                     d.samples, d.tip_mm);
  if (p.rapid_bound_mm > 0)
    out += fmt::format("           in rapids by at most {:.4f} mm ({:.4f})\n", p.rapid_bound_mm, d.rapid_tip_mm);
  out += fmt::format("axis       off its direction by at most {:.5f} degrees ({:.5f})\n",
                     deg_from_rad(p.axis_bound_rad), deg_from_rad(d.axis_rad));
  for (const repath::TurnBack& back : p.turns_back)
    out += fmt::format("turns back {}: {}, {} mm off along the tool\n",
                       back.in_air ? "in air" : "in a cut, which leaves a mark", turns_text(back),
                       format_trimmed(back.retract_mm, 1));
  return out;
}

std::string post_json(const PostSummary& summary) {
  const repath::Posted& p = summary.posted;
  const repath::PostDeviation& d = summary.deviation;
  Json back = Json::array();
  for (const repath::TurnBack& t : p.turns_back) {
    Json from, to;
    for (int i = 0; i < 3; ++i)
      if (t.from_rad[i] != t.to_rad[i]) {
        const std::string axis(1, "abc"[i]);
        from[axis] = deg_from_rad(t.from_rad[i]);
        to[axis] = deg_from_rad(t.to_rad[i]);
      }
    back.push_back({{"in_air", t.in_air}, {"from_deg", from}, {"to_deg", to}, {"retract_mm", t.retract_mm}});
  }
  const Json report = {{"target", summary.asked.target == repath::PostTarget::tcp ? "tcp" : "joints"},
                       {"tolerance_mm", summary.asked.tolerance_mm},
                       {"rapid_tolerance_mm", summary.asked.rapid_tolerance_mm},
                       {"inverse_time", summary.asked.inverse_time},
                       {"rule", summary.asked.one_degree ? "one-degree" : "tolerance"},
                       {"blocks_before", summary.blocks_before},
                       {"blocks_after", summary.blocks_after},
                       {"moves", p.moves},
                       {"feed_moves", p.feed_moves},
                       {"feed_blocks", p.feed_blocks},
                       {"one_degree_blocks", p.one_degree_blocks},
                       {"tip_bound_mm", p.tip_bound_mm},
                       {"rapid_tip_bound_mm", p.rapid_bound_mm},
                       {"one_degree_tip_bound_mm", p.one_degree_bound_mm},
                       {"axis_bound_deg", deg_from_rad(p.axis_bound_rad)},
                       {"sampled",
                        {{"samples", d.samples},
                         {"tip_mm", d.tip_mm},
                         {"rapid_tip_mm", d.rapid_tip_mm},
                         {"axis_deg", deg_from_rad(d.axis_rad)},
                         {"end_tip_mm", d.end_tip_mm},
                         {"end_axis_deg", deg_from_rad(d.end_axis_rad)}}},
                       {"turns_back", back}};
  return report.dump(2) + "\n";
}

}  // namespace camber::report
