#include "report/cycle_page.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "base/numbers.h"
#include "base/units.h"
#include "report/page_tables.h"
#include "report/path_card.h"

namespace camber::report {
namespace {

using feedmodel::CycleTime;
using feedmodel::CycleUse;
using feedmodel::kCycleKinds;

std::string cell(const std::string& text) { return "<td>" + html_text(text) + "</td>"; }

std::string tile(const std::string& name, const std::string& value) {
  return fmt::format("<div class=\"tile\"><div class=\"name\">{}</div><div class=\"value\">{}</div></div>\n",
                     html_text(name), html_text(value));
}

std::string card(const std::string& title, const std::string& body) {
  return body.empty() ? "" : fmt::format("<div class=\"card\"><h2>{}</h2>\n{}</div>\n", html_text(title), body);
}

/// Wider than a phone: it is moved sideways there.
std::string wide(const std::string& body) { return body.empty() ? body : "<div class=\"wide\">\n" + body + "</div>\n"; }

std::string feed_text(double mm_per_s) { return fmt::format("{:.0f}", mm_per_min_from_mm_per_s(mm_per_s)); }

std::string use_cells(const CycleUse& use) {
  std::string out;
  for (const auto& kind : kCycleKinds) out += cell(fmt::format("{:.1f}", use.time.*kind.field));
  out += cell(fmt::format("{:.1f}", use.time.total_s()));
  out += cell(feed_text(use.commanded_feed_mm_per_s())) + cell(feed_text(use.average_feed_mm_per_s()));
  return out + cell(fmt::format("{:.3f}", use.e())) + cell(fmt::format("{:.3f}", use.k()));
}

std::string table_head(const std::vector<std::string>& first) {
  std::string out = "<div class=\"wide\"><table><thead><tr>";
  for (const auto& name : first) out += "<th>" + html_text(name) + "</th>";
  for (const auto& kind : kCycleKinds) out += fmt::format("<th>{}, s</th>", kind.name);
  return out + "<th>total, s</th><th>F, mm/min</th><th>actual, mm/min</th><th>e</th><th>k</th></tr></thead><tbody>\n";
}

std::string ratios_note() { return "<p>" + html_text(kRatiosSentence) + "</p>\n"; }

std::string rows_table(const CyclePage& page) {
  std::string out = table_head(page.keys.empty() ? std::vector<std::string>{"case"} : page.keys);
  for (const CycleRow& row : page.rows) {
    out += "<tr>";
    if (page.keys.empty()) out += cell(row.name);
    for (const double value : row.values) out += cell(format_trimmed(value, 4));
    out += use_cells(row.time.all) + "</tr>\n";
  }
  return out + "</tbody></table></div>\n" + ratios_note();
}

std::string tools_table(const CycleTime& time) {
  std::string out = table_head({"tool"});
  for (const CycleUse& use : time.tools)
    out += "<tr>" + cell(fmt::format("T{}", use.tool)) + use_cells(use) + "</tr>\n";
  return out + "</tbody></table></div>\n" + ratios_note();
}

std::string notes_list(const std::vector<std::string>& notes) {
  if (notes.empty()) return {};
  std::string out = "<ul class=\"notes\">\n";
  for (const auto& note : notes) out += "<li>" + html_text(note) + "</li>\n";
  return out + "</ul>\n";
}

}  // namespace

std::string dominance_sentence(const CycleTime& time) {
  const double total = time.all.time.total_s();
  if (total <= 0) return "nothing in this program takes time";
  const auto& kind = feedmodel::dominant_kind(time.all.time);
  std::string out = fmt::format("{} takes {:.0f} % of the time", kind.name, 100 * time.all.time.*kind.field / total);
  const double lost_s = time.all.time.cutting_s - time.all.commanded_s;
  if (time.all.time.cutting_s > 0)
    out += fmt::format("; {:.1f} s of cutting ({:.0f} %) go to acceleration, corners, arcs and short blocks",
                       std::max(0.0, lost_s), std::max(0.0, 100 * lost_s / time.all.time.cutting_s));
  if (time.below_full_rapid > 0)
    out += fmt::format("; {} of {} positioning moves ({:.0f} %) are too short for full rapid", time.below_full_rapid,
                       time.g00.moves,
                       100.0 * static_cast<double>(time.below_full_rapid) / static_cast<double>(time.g00.moves));
  return out;
}

std::string cycle_page(const CyclePage& page) {
  assert(!page.rows.empty());
  assert(std::ranges::all_of(page.rows, [&](const CycleRow& row) { return row.values.size() >= page.keys.size(); }));
  const CycleTime& first = page.rows.front().time;
  std::string out = page_head(page.title, page.subtitle) + "<div class=\"tiles\">\n";
  const std::string of = page.rows.size() > 1 ? ", " + page.rows.front().name : "";
  out += tile("total time" + of, fmt::format("{:.1f} s", first.all.time.total_s()));
  out += tile("cutting", fmt::format("{:.1f} s", first.all.time.cutting_s));
  out += tile("positioning", fmt::format("{:.1f} s", first.all.time.positioning_s));
  out += tile("actual / commanded feed, e", fmt::format("{:.3f}", first.all.e())) + "</div>\n";
  ProgramCard path;
  if (!page.picture.points.empty()) path = program_card("The path" + of, page.picture);
  out += path.card + page.machine.pictures;
  out +=
      card("Where the time goes", wide(split_bars_svg(page.rows)) +
                                      fmt::format("<p class=\"note\">{}{}.</p>\n",
                                                  page.rows.size() > 1 ? html_text(page.rows.front().name) + ": " : "",
                                                  html_text(dominance_sentence(first))));
  out += card("Total time over " + (page.keys.empty() ? "" : page.keys.front()), wide(sweep_svg(page)));
  out += card(page.rows.size() > 1 ? "Side by side" : "By kind", rows_table(page));
  out += card("By tool" + of, tools_table(first));
  out += card("Distances" + of,
              wide(distance_svg(first.g00, "positionings, G0") + distance_svg(first.g01, "straight cuts, G1")));
  out += page.machine.axes;
  std::vector<std::string> notes = page.notes;
  notes.insert(notes.end(), page.machine.notes.begin(), page.machine.notes.end());
  if (page.picture.thinned) notes.push_back(thinned_note(page.picture, "The picture of the path"));
  out += card("Notes", notes_list(notes));
  return out + "</main>\n" + path.scripts + page.machine.scripts + "</body>\n</html>\n";
}

}  // namespace camber::report
