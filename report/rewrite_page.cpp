#include "report/rewrite_summary.h"

#include <algorithm>
#include <iterator>
#include <numeric>

#include <fmt/format.h>

#include "base/json.h"
#include "base/numbers.h"
#include "report/decimate.h"
#include "report/packed_arrays.h"
#include "report/page_tables.h"
#include "report/path_card.h"

namespace camber::report {
namespace {

constexpr double kWidth = 560, kHeight = 250, kLeft = 44, kRight = 10, kTop = 26, kBottom = 40;

constexpr const char* kHint =
    "Drag to rotate, drag with the right button or Shift to pan, use the wheel or two fingers to zoom, double-click to "
    "reset. Dots mark the ends of blocks where they are far enough apart; a ring marks the largest deviation.";

std::string row(const std::string& name, const std::string& value, const char* unit, const char* key = nullptr) {
  const std::string shown = key != nullptr ? fmt::format("<span data-key=\"{}\">{}</span>", key, value) : value;
  return fmt::format("<tr><td>{}</td><td>{}</td><td class=\"unit\">{}</td></tr>\n", html_text(name), shown, unit);
}

std::string deviation_html(const RewritePage& page) {
  std::string out = "<div class=\"card\"><h2>Deviation of the new path from the old one</h2>\n" +
                    fractions_svg({"Histogram of the deviation", "% of the rewritten length", "deviation, µm", 0,
                                   1000 * page.tolerance_mm, 3, page.length_by_deviation_mm});
  out += "<table><tbody>\n" + row("tolerance", number_text(page.tolerance_mm, 4), "mm", "tolerance_mm");
  out += row("maximum, bound of the fit", number_text(page.max_deviation_mm, 4), "mm", "max_deviation_mm");
  out += row("maximum, over points laid densely on both paths", number_text(page.measured_deviation_mm, 4), "mm",
             "measured_deviation_mm");
  out += row("position of the maximum",
             fmt::format("X{:.3f} Y{:.3f} Z{:.3f}", page.worst_place_mm.x() + 0.0, page.worst_place_mm.y() + 0.0,
                         page.worst_place_mm.z() + 0.0),
             "");
  out += row("rewritten runs of blocks", fmt::format("{}", page.runs), "", "runs");
  return out + "</tbody></table></div>\n";
}

}  // namespace

std::string fractions_svg(const FractionHistogram& histogram) {
  const auto& length = histogram.amounts;
  const double all = std::accumulate(length.begin(), length.end(), 0.0);
  if (!(all > 0)) return "<p class=\"note\">Nothing was rewritten.</p>\n";
  const double most = nice_limit(100 * *std::max_element(length.begin(), length.end()) / all);
  const auto x = [](double fraction) { return kLeft + fraction * (kWidth - kLeft - kRight); };
  const auto y = [](double fraction) { return kHeight - kBottom - fraction * (kHeight - kTop - kBottom); };
  std::string out =
      fmt::format("<svg class=\"histogram\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">\n", kWidth,
                  kHeight, html_text(histogram.title));
  const auto text = [&](double at_x, double at_y, const char* anchor, const std::string& what) {
    fmt::format_to(std::back_inserter(out), "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", at_x,
                   at_y, anchor, what);
  };
  for (const double fraction : {0.0, 0.5, 1.0}) {
    fmt::format_to(std::back_inserter(out), "<path stroke=\"#e3e8ee\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>\n", x(0),
                   y(fraction), x(1));
    text(kLeft - 6, y(fraction) + 4, "end", fmt::format("{:g}", fraction * most));
  }
  out += "<path fill=\"#1668b8\" d=\"";
  const double bins = static_cast<double>(length.size());
  for (std::size_t i = 0; i < length.size(); ++i)
    if (length[i] > 0)
      fmt::format_to(std::back_inserter(out), "M{:.1f} {:.1f}V{:.2f}H{:.1f}V{:.1f}Z", x(static_cast<double>(i) / bins),
                     y(0), y(100 * length[i] / all / most), x((static_cast<double>(i) + 0.9) / bins), y(0));
  out += "\"/>\n";
  for (const double fraction : {0.0, 0.5, 1.0})
    text(x(fraction), kHeight - kBottom + 17,
         fraction == 0   ? "start"
         : fraction == 1 ? "end"
                         : "middle",
         format_trimmed(histogram.from + fraction * (histogram.to - histogram.from), histogram.decimals));
  text(kLeft - 36, 16, "start", html_text(histogram.fraction_of));
  text(x(0.5), kHeight - 6, "middle", html_text(histogram.axis));
  return out + "</svg>\n";
}

std::string rewrite_page(const RewritePage& page) {
  std::string out = page_head(page.title, page.subtitle);
  constexpr std::size_t kLarge = 3;
  ReportData figures, tiles;
  figures.figures = page.figures;
  tiles.figures.assign(page.figures.begin(),
                       page.figures.begin() + static_cast<std::ptrdiff_t>(std::min(kLarge, page.figures.size())));
  tiles.figures.push_back({"largest deviation", page.max_deviation_mm, std::nullopt, "mm", 4, "max_deviation_mm"});
  out += tiles_html(tiles) + path_card_html("The path", kHint);
  out += "<div class=\"columns\">\n";
  if (page.deviation) out += deviation_html(page);
  for (const FractionHistogram& h : page.histograms)
    out += "<div class=\"card\"><h2>" + html_text(h.title) + "</h2>\n" + fractions_svg(h) + "</div>\n";
  out += figures_html(figures);
  for (const auto& table : page.tables) out += table_html(table);
  std::vector<std::string> notes = page.notes;
  for (const std::string& note : {thinned_note(page.before, "The picture of the program before"),
                                  thinned_note(page.after, "The picture of the program after")})
    if (!note.empty()) notes.push_back(note);
  out += list_html("Notes", "notes", notes) + "</div>\n</main>\n";
  PackedArrays arrays;
  Json index = {
      {"paths", Json::array({picture_json(arrays, page.before, "before"), picture_json(arrays, page.after, "after")})}};
  if (page.measured_deviation_mm > 0)
    index["worst"] = {page.worst_place_mm.x(), page.worst_place_mm.y(), page.worst_place_mm.z()};
  if (!page.part.points.empty()) index["part"] = picture_json(arrays, page.part, "part");
  return out + path_scripts_html(index, arrays) + "</body>\n</html>\n";
}

}  // namespace camber::report
