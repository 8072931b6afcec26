// The page of camber study: every case in one table, and each figure against the first key that has numbers.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "base/numbers.h"
#include "report/page_tables.h"
#include "report/study_table.h"

namespace camber::report {
namespace {

constexpr double kStudyWidth = 560, kStudyHeight = 250, kStudyLeft = 64, kStudyRight = 16, kStudyTop = 26,
                 kStudyBottom = 206;
constexpr const char* kLineColours[] = {"#1668b8", "#d9622b", "#2e8b57", "#8b4fa8",
                                        "#b8860b", "#5c6877", "#c2185b", "#00838f"};
constexpr std::size_t kMaxLines = std::size(kLineColours);

struct StudyLine {
  std::string name;  ///< values of the other keys
  std::vector<std::array<double, 2>> points;
};

/// The first key all of whose values are numbers, and more than one.
std::optional<std::size_t> plotted_key(const StudyTable& table) {
  for (std::size_t k = 0; k < table.keys.size(); ++k) {
    bool numbers = true, several = false;
    for (const StudyRow& row : table.rows) {
      numbers = numbers && parse_number(row.values[k]).has_value();
      several = several || row.values[k] != table.rows.front().values[k];
    }
    if (numbers && several) return k;
  }
  return std::nullopt;
}

std::vector<StudyLine> study_lines(const StudyTable& table, std::size_t key, std::size_t figure) {
  std::vector<StudyLine> out;
  for (const StudyRow& row : table.rows) {
    const auto value = parse_number(row.figures.empty() ? "" : row.figures[figure]);
    if (!value) continue;
    std::string name;
    for (std::size_t k = 0; k < table.keys.size(); ++k)
      if (k != key) name += (name.empty() ? "" : ", ") + row.values[k];
    auto line = std::ranges::find(out, name, &StudyLine::name);
    if (line == out.end()) line = out.insert(out.end(), {name, {}});
    line->points.push_back({*parse_number(row.values[key]), *value});
  }
  for (StudyLine& line : out) std::ranges::sort(line.points);
  return out;
}

std::string study_label(double x, double y, const char* anchor, const std::string& what) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, html_text(what));
}

std::string study_svg(const std::string& key, const std::string& figure, const std::vector<StudyLine>& lines) {
  double x0 = 1e300, x1 = -1e300, y0 = 0, y1 = 0;
  std::vector<double> ticks;
  for (const StudyLine& line : lines)
    for (const auto& [x, y] : line.points) {
      x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
      if (!std::ranges::count(ticks, x)) ticks.push_back(x);
    }
  const double wide = std::max(x1 - x0, 1e-12), high = std::max(y1 - y0, 1e-12);
  const auto at_x = [&](double x) { return kStudyLeft + (x - x0) / wide * (kStudyWidth - kStudyLeft - kStudyRight); };
  const auto at_y = [&](double y) { return kStudyBottom - (y - y0) / high * (kStudyBottom - kStudyTop); };
  std::string out = fmt::format(
      "<svg class=\"fixed\" viewBox=\"0 0 {} {}\" width=\"100%\" role=\"img\" font-size=\"12\" fill=\"#5c6877\" "
      "font-family=\"system-ui, sans-serif\">\n",
      kStudyWidth, kStudyHeight);
  for (const double y : {y0, y0 + high / 2, y1}) {
    out += fmt::format("<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#e3e8ee\"/>\n", kStudyLeft,
                       kStudyWidth - kStudyRight, at_y(y), at_y(y));
    out += study_label(kStudyLeft - 6, at_y(y) + 4, "end", fmt::format("{:.4g}", y));
  }
  std::ranges::sort(ticks);
  for (const double x : ticks) out += study_label(at_x(x), kStudyBottom + 16, "middle", fmt::format("{:g}", x));
  out += study_label((kStudyLeft + kStudyWidth - kStudyRight) / 2, kStudyBottom + 36, "middle", key);
  out += study_label(4, 14, "start", figure);
  for (std::size_t i = 0; i < std::min(lines.size(), kMaxLines); ++i) {
    std::string points;
    for (const auto& [x, y] : lines[i].points) {
      points += fmt::format("{:.1f},{:.1f} ", at_x(x), at_y(y));
      out +=
          fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", at_x(x), at_y(y), kLineColours[i]);
    }
    out += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"/>\n", points,
                       kLineColours[i]);
  }
  return out + "</svg>\n";
}

std::string legend_html(const StudyTable& table, std::size_t key, const std::vector<StudyLine>& lines) {
  if (lines.size() < 2) return {};
  std::string names, out;
  for (std::size_t k = 0; k < table.keys.size(); ++k)
    if (k != key) names += (names.empty() ? "" : ", ") + table.keys[k];
  out = fmt::format("<p class=\"note\">{}: ", html_text(names));
  for (std::size_t i = 0; i < std::min(lines.size(), kMaxLines); ++i)
    out += fmt::format("<span style=\"color:{}\">●</span> {} ", kLineColours[i], html_text(lines[i].name));
  if (lines.size() > kMaxLines) out += fmt::format("and {} more in the table", lines.size() - kMaxLines);
  return out + "</p>\n";
}

std::string plots_html(const StudyTable& table) {
  const auto key = plotted_key(table);
  if (!key) return {};
  std::string out = "<div class=\"two\">\n";
  for (std::size_t f = 0; f < table.figures.size(); ++f) {
    const auto lines = study_lines(table, *key, f);
    if (lines.empty()) continue;
    out += fmt::format("<div class=\"card\"><h2>{}</h2>\n{}{}</div>\n", html_text(table.figures[f]),
                       study_svg(table.keys[*key], table.figures[f], lines), legend_html(table, *key, lines));
  }
  return out + "</div>\n";
}

std::string rows_html(const StudyTable& table) {
  std::string out = "<div class=\"card\"><h2>All cases</h2>\n<div class=\"wide\"><table>\n<tr><th>case</th>";
  for (const auto* names : {&table.keys, &table.figures})
    for (const std::string& name : *names) out += "<th>" + html_text(name) + "</th>";
  out += "<th>state</th></tr>\n";
  for (const StudyRow& row : table.rows) {
    const std::string number = fmt::format("{}", row.number);
    out += "<tr><td>" +
           (row.state == StudyState::open
                ? number
                : fmt::format("<a href=\"{}/report.html\">{}</a>", html_text(row.folder), number)) +
           "</td>";
    for (const auto* cells : {&row.values, &row.figures})
      for (const std::string& cell : *cells) out += "<td>" + html_text(cell) + "</td>";
    out += fmt::format("<td>{}</td></tr>\n", to_string(row.state));
  }
  return out + "</table></div></div>\n";
}

}  // namespace

std::string study_page(const StudyTable& table) {
  std::string out = page_head("Study " + table.study,
                              fmt::format("camber {} of {}, {} cases", table.command, table.job, table.rows.size()));
  std::vector<std::string> warnings;
  for (const StudyRow& row : table.rows)
    if (row.state == StudyState::doubtful)
      warnings.push_back(fmt::format("Case {}: the numbers did not work out; its page says why.", row.number));
  if (const std::size_t open = table.count(StudyState::open))
    warnings.push_back(fmt::format("{} of {} cases are not computed yet.", open, table.rows.size()));
  return out + list_html("Warnings", "warnings", warnings) + plots_html(table) + rows_html(table) +
         "</main>\n</body>\n</html>\n";
}

}  // namespace camber::report
