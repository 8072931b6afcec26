#include "report/page_tables.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/numbers.h"

namespace camber::report {
namespace {

constexpr std::size_t kTiles = 4;

std::string unit_text(const std::string& unit) { return html_text(unit == "um" ? "µm" : unit); }

std::string number(double value, int decimals) {
  if (!std::isfinite(value)) return "–";
  const std::string text = fmt::format("{:.{}f}", value, decimals);
  const bool negative = text.front() == '-' && text.find_first_of("123456789") != std::string::npos;
  return (negative ? "−" : "") + text.substr(text.front() == '-' ? 1 : 0);
}

std::string tile(const Figure& f) {
  const std::string unit = f.unit.empty() ? "" : " <small>" + unit_text(f.unit) + "</small>";
  const std::string value =
      f.after ? number(f.before, f.decimals) + " → " + number(*f.after, f.decimals) : number(f.before, f.decimals);
  return fmt::format("<div class=\"tile\"><div class=\"name\">{}</div><div class=\"value\">{}{}</div></div>\n",
                     html_text(f.name), value, unit);
}

/// "; 28 000 of 84 000 points are drawn ..." or nothing.
std::string decimation_note(std::size_t count, std::size_t most, std::string_view what, std::string_view kept) {
  if (count <= most) return {};
  return fmt::format(" Drawn are about {} of the {} {}: of each run of neighbours {}.", most, count, what, kept);
}

std::string figure_row(const Figure& f, bool with_after) {
  std::string row = fmt::format("<tr><td>{}</td><td>{}</td>", html_text(f.name), number(f.before, f.decimals));
  if (with_after) row += fmt::format("<td>{}</td>", f.after ? number(*f.after, f.decimals) : "");
  return row + fmt::format("<td>{}</td></tr>\n", unit_text(f.unit));
}

std::string figures_table(const ReportData& data) {
  const bool with_after =
      std::any_of(data.figures.begin(), data.figures.end(), [](const auto& f) { return f.after.has_value(); });
  std::string out = "<div class=\"card\"><h2>Figures</h2>\n<table><thead><tr><th></th>";
  out += with_after ? "<th>before</th><th>after</th><th>unit</th>" : "<th>value</th><th>unit</th>";
  out += "</tr></thead><tbody>\n";
  for (const auto& f : data.figures) out += figure_row(f, with_after);
  return out + "</tbody></table></div>\n";
}

std::string rounds_table(const std::vector<RoundRow>& rounds) {
  std::string out =
      "<div class=\"card\"><h2>Rounds of the compensation</h2>\n<table><thead><tr><th>round</th><th>95 %, "
      "µm</th><th>rms, µm</th>"
      "<th>least, µm</th><th>greatest, µm</th><th>largest shift, µm</th></tr></thead><tbody>\n";
  for (const auto& r : rounds)
    out += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                       r.round == 0 ? "as given" : std::to_string(r.round), number(r.p95_um, 2), number(r.rms_um, 2),
                       number(r.min_um, 1), number(r.max_um, 1), number(r.largest_shift_um, 1));
  return out + "</tbody></table></div>\n";
}

}  // namespace

std::string html_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string tiles_html(const ReportData& data) {
  if (data.figures.empty()) return {};
  std::string out = "<div class=\"tiles\">\n";
  for (std::size_t i = 0; i < std::min(kTiles, data.figures.size()); ++i) out += tile(data.figures[i]);
  return out + "</div>\n";
}

std::string map_html(const ReportData& data, const ReportOptions& options, const std::vector<double>& scales_um) {
  if (data.before.empty()) return {};
  const bool two = !data.after.empty();
  std::string out = fmt::format("<div class=\"card\"><h2>Form error on the part</h2>\n<div class=\"maps{}\">\n",
                                two ? "" : " single");
  if (two)
    out +=
        "<figure><figcaption>Before</figcaption><canvas id=\"map0\"></canvas></figure>\n"
        "<figure><figcaption>After</figcaption><canvas id=\"map1\"></canvas></figure>\n";
  else
    out += "<figure><canvas id=\"map0\"></canvas></figure>\n";
  out +=
      "</div>\n<div class=\"bar\"><div class=\"legend\"><canvas id=\"legend\"></canvas></div><span>µm; blue: too much "
      "removed, red: "
      "material left</span></div>\n<div class=\"bar\"><span>view "
      "<button data-view=\"-0.5,0.75\">oblique</button> <button data-view=\"0,1.5708\">from above</button> "
      "<button data-view=\"0,0.25\">from the front</button></span>";
  if (scales_um.size() > 1) {
    out += "<span>scale";
    for (const double s : scales_um) out += fmt::format(" <button data-scale=\"{0}\">± {0} µm</button>", s);
    out += "</span>";
  }
  out +=
      "</div>\n<div class=\"read\" id=\"read\">Drag to turn, shift-drag to move, wheel to zoom, double click to go "
      "back; point at the "
      "surface to read the error.</div>\n";
  out += fmt::format(
      "<p class=\"note\">Machined surface minus the undeflected sweep of the target program, along the surface's "
      "normal. "
      "Errors beyond the scale have its end's colour.{}</p></div>\n",
      decimation_note(data.before.size(), options.most_points, "points",
                      "the first and those with the least and the greatest error"));
  return out;
}

std::string charts_html(const ReportData& data, const ReportOptions& options) {
  std::string out;
  const std::string histogram = data.before.empty() ? ""
                                                    : "<div class=\"card\"><h2>How the error is spread</h2><canvas "
                                                      "class=\"plot\" id=\"histogram\"></canvas></div>\n";
  const std::string rounds = data.rounds.empty() ? "" : rounds_table(data.rounds);
  if (!histogram.empty() && !rounds.empty())
    out += "<div class=\"two\">\n" + histogram + rounds + "</div>\n";
  else
    out += histogram + rounds;
  if (data.feed.empty()) return out;
  out += "<div class=\"card\"><h2>Feed along time</h2><canvas class=\"plot\" id=\"feed\"></canvas>\n";
  out += fmt::format(
      "<p class=\"note\">Wheel to zoom, drag to move, double click for the whole. Rapids go beyond the top where "
      "cutting takes most of the time.{}</p></div>\n",
      decimation_note(data.feed.size(), options.most_feed_samples, "samples",
                      "the first, the slowest and the fastest"));
  return out;
}

std::string tables_html(const ReportData& data) {
  std::string out = data.figures.empty() ? "" : figures_table(data);
  if (data.notes.empty()) return out;
  out += "<div class=\"card\"><h2>Notes</h2>\n<ul>\n";
  for (const auto& note : data.notes) out += fmt::format("<li>{}</li>\n", html_text(note));
  return out + "</ul></div>\n";
}

}  // namespace camber::report
