#include "report/page_tables.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "report/page_parts.h"

namespace camber::report {
namespace {

constexpr std::size_t kTiles = 4;
constexpr double kMaxChange_percent = 200;  // of something next to nothing: a percentage says nothing

std::string unit_text(const std::string& unit) {
  if (unit == "um") return "µm";
  if (unit == "mm3") return "mm³";
  return html_text(unit);
}

/// A value that tells where the JSON has the same.
std::string value_html(const Figure& f, double value, const char* which) {
  const std::string text = number_text(value, f.decimals);
  if (f.key.empty()) return text;
  std::string key = which == std::string_view("after") && !f.key_after.empty() ? f.key_after : f.key;
  if (const std::size_t at = key.find("{}"); at != std::string::npos) key.replace(at, 2, which);
  return fmt::format("<span data-key=\"{}\">{}</span>", html_text(key), text);
}

std::string tile(const Figure& f) {
  const std::string unit = f.unit.empty() ? "" : " <small>" + unit_text(f.unit) + "</small>";
  std::string value = value_html(f, f.before, "before");
  if (f.after) value = "<span class=\"was\">" + value + " →</span> " + value_html(f, *f.after, "after");
  return fmt::format("<div class=\"tile\"><div class=\"name\">{}</div><div class=\"value\">{}{}</div></div>\n",
                     html_text(f.name), value, unit);
}

/// "−95.3 %" where that says something.
std::string change_text(const Figure& f) {
  if (!f.after || !std::isfinite(f.before) || !std::isfinite(*f.after) || std::abs(f.before) < 1e-12) return {};
  const double percent = 100 * (std::abs(*f.after) / std::abs(f.before) - 1);
  if (percent > kMaxChange_percent) return {};
  const std::string text = number_text(percent, 1);
  return (percent > 0 && text != "0.0" ? "+" : "") + text + " %";
}

/// Paths may be broken after a slash.
std::string breakable(const std::string& text) {
  std::string out;
  for (const char c : text) {
    out += c;
    if (c == '/') out += "<wbr>";
  }
  return out;
}

std::string figure_row(const Figure& f, bool with_after) {
  std::string row = fmt::format("<tr><td>{}</td><td>{}</td>", html_text(f.name), value_html(f, f.before, "before"));
  if (with_after)
    row += fmt::format("<td>{}</td><td>{}</td>", f.after ? value_html(f, *f.after, "after") : "", change_text(f));
  return row + fmt::format("<td class=\"unit\">{}</td></tr>\n", unit_text(f.unit));
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

std::string script_safe(const std::string& json) {
  std::string out;
  out.reserve(json.size());
  for (const char c : json)
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  return out;
}

std::string number_text(double value, int decimals) {
  if (!std::isfinite(value)) return "–";
  const std::string text = fmt::format("{:.{}f}", value, decimals);
  const bool negative = text.front() == '-' && text.find_first_of("123456789") != std::string::npos;
  return (negative ? "−" : "") + text.substr(text.front() == '-' ? 1 : 0);
}

std::string tiles_html(const ReportData& data) {
  if (data.figures.empty()) return {};
  std::string out = "<div class=\"tiles\">\n";
  for (std::size_t i = 0; i < std::min(kTiles, data.figures.size()); ++i) out += tile(data.figures[i]);
  return out + "</div>\n";
}

std::string figures_html(const ReportData& data) {
  if (data.figures.empty()) return {};
  const bool with_after =
      std::any_of(data.figures.begin(), data.figures.end(), [](const auto& f) { return f.after.has_value(); });
  std::string out = "<div class=\"card\"><h2>Figures</h2>\n<table id=\"figures\"><thead><tr><th></th>";
  out += with_after ? "<th>before</th><th>after</th><th>change</th><th></th>" : "<th>value</th><th></th>";
  out += "</tr></thead><tbody>\n";
  for (const auto& f : data.figures) out += figure_row(f, with_after);
  return out + "</tbody></table></div>\n";
}

std::string table_html(const TextTable& table) {
  std::string out = fmt::format("<div class=\"card\"><h2>{}</h2>\n<div class=\"wide\"><table>", html_text(table.title));
  if (!table.columns.empty()) {
    out += "<thead><tr>";
    for (const auto& name : table.columns) out += "<th>" + html_text(name) + "</th>";
    out += "</tr></thead>";
  }
  out += "<tbody>\n";
  for (const auto& row : table.rows) {
    out += "<tr>";
    for (const auto& cell : row) out += "<td>" + breakable(html_text(cell)) + "</td>";
    out += "</tr>\n";
  }
  out += "</tbody></table></div>\n";
  if (!table.note.empty()) out += "<p class=\"note\">" + html_text(table.note) + "</p>\n";
  return out + "</div>\n";
}

std::string list_html(const std::string& title, const std::string& css_class, const std::vector<std::string>& items) {
  if (items.empty()) return {};
  std::string out = fmt::format("<div class=\"card {}\"><h2>{}</h2>\n<ul>\n", css_class, html_text(title));
  for (const auto& item : items) out += fmt::format("<li>{}</li>\n", html_text(item));
  return out + "</ul></div>\n";
}

std::string page_head(std::string_view page_title, std::string_view subtitle) {
  const std::string title = html_text(page_title);
  std::string out = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  out += kPagePolicy;
  out += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  out += fmt::format("<title>{}</title>\n<style>{}{}</style>\n</head>\n<body>\n<main>\n", title, kPageStyle,
                     report_style());
  return out + fmt::format("<h1>{}</h1>\n<p class=\"sub\">{}</p>\n", title, html_text(subtitle));
}

}  // namespace camber::report
