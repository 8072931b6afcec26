#include "report/html_report.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "base/output_file.h"
#include "report/histogram_svg.h"
#include "report/page_parts.h"
#include "report/page_tables.h"

namespace camber::report {
namespace {

constexpr const char* kPartFrame =
    "<div class=\"card\" id=\"part\"><h2>The part</h2>\n"
    "<noscript><p class=\"note\">The pictures need JavaScript; the tables below do without.</p></noscript>\n"
    "<div class=\"bar\" id=\"part-controls\"></div>\n"
    "<div class=\"scene\" id=\"scene\"></div>\n"
    "<div class=\"bar legends\" id=\"legends\"></div>\n"
    "<p class=\"note\">Form error: machined surface minus the undeflected sweep of the path that the target program "
    "commands, along the normal of the surface; red is excess material, blue is a gouge. Values beyond the scale have "
    "the colour of its end.</p>\n"
    "</div>\n";

constexpr const char* kPlotsFrame =
    "<div class=\"card\" id=\"along\"><h2>Along the path</h2>\n"
    "<div id=\"selected\" class=\"selected\"></div>\n"
    "<div id=\"plots\"></div>\n"
    "<p class=\"note screen\">Click a plot to show the position on the part and the line of the program; drag to zoom, "
    "double-click to reset.</p></div>\n";

bool has_rows(const ReportData& data) {
  return std::any_of(data.path.begin(), data.path.end(), [](const auto& run) { return !run.rows.empty(); });
}

/// Sentences as they stand in a terminal say "um".
std::string in_micrometres(std::string text) {
  constexpr std::string_view kPlain = " um";
  for (std::size_t at = text.find(kPlain); at != std::string::npos; at = text.find(kPlain, at + 1)) {
    const std::size_t end = at + kPlain.size();
    const bool word = end == text.size() || !std::isalnum(static_cast<unsigned char>(text[end]));
    if (word) text.replace(at, kPlain.size(), " µm");
  }
  return text;
}

std::string verdict_html(const PageVerdict& verdict) {
  std::string headline = in_micrometres(verdict.headline);
  if (!headline.empty()) headline[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(headline[0])));
  std::string out = fmt::format("<div class=\"card verdict{}\" id=\"verdict\"><p><b>{}</b></p>\n",
                                verdict.success ? " good" : "", html_text(headline));
  if (!verdict.reasons.empty()) {
    out += "<ul>\n";
    for (const std::string& reason : verdict.reasons)
      out += fmt::format("<li>{}</li>\n", html_text(in_micrometres(reason)));
    out += "</ul>\n";
  }
  return out + "</div>\n";
}

std::string head_html(const ReportData& data) {
  const std::string title = html_text(data.title);
  std::string out = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  out += kPagePolicy;
  out += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  out += fmt::format("<title>{}</title>\n<style>{}{}</style>\n</head>\n<body>\n<main>\n", title, kPageStyle,
                     report_style());
  out += fmt::format("<header><div><h1>{}</h1>\n<p class=\"sub\">{}</p></div></header>\n", title,
                     html_text(data.subtitle));
  if (data.verdict) out += verdict_html(*data.verdict);
  if (!data.download_name.empty())
    out += fmt::format("<p><a class=\"download\" id=\"download\" hidden download=\"{0}\">Download {0}</a></p>\n",
                       html_text(data.download_name));
  return out;
}

std::string histogram_html(const ReportData& data, const PageData& page) {
  if (data.surface.empty()) return {};
  return "<div class=\"card\"><h2>Error distribution</h2>\n" +
         histogram_svg(data.surface, data.compared, page.scale_um, data.names) + "</div>\n";
}

std::string picture_html(const Picture& picture) {
  std::string out = "<div class=\"card\"><h2>" + html_text(picture.title) + "</h2>\n" + picture.svg;
  if (!picture.note.empty()) out += "<p class=\"note\">" + html_text(picture.note) + "</p>\n";
  return out + "</div>\n";
}

std::string scripts_html(const PageData& page) {
  std::string out = "<script type=\"application/json\" id=\"index\">" + script_safe(page.index) + "</script>\n";
  out += "<script type=\"text/plain\" id=\"arrays\">" + page.arrays + "</script>\n";
  for (std::size_t i = 0; i < page.programs.size(); ++i)
    if (!page.programs[i].empty())
      out += fmt::format("<script type=\"text/plain\" id=\"program{}\">{}</script>\n", i, page.programs[i]);
  return out + fmt::format("<script>{}</script>\n", report_script());
}

}  // namespace

std::string html_report(const ReportData& data, const ReportOptions& options) {
  const PageData page = page_data(data, options);
  std::string out = head_html(data) + tiles_html(data);
  out += list_html("Warnings", "warnings", data.warnings);
  const bool pictures = !data.surface.empty() || has_rows(data);
  if (pictures) out += kPartFrame;
  if (has_rows(data)) out += kPlotsFrame;
  out += "<div class=\"columns\">\n" + histogram_html(data, page) + figures_html(data);
  for (const auto& picture : data.pictures) out += picture_html(picture);
  for (const auto& table : data.tables) out += table_html(table);
  std::vector<std::string> notes = data.notes;
  notes.insert(notes.end(), page.left_out.begin(), page.left_out.end());
  out += list_html("Notes", "notes", notes) + "</div>\n</main>\n";
  if (pictures) out += scripts_html(page);
  return out + "</body>\n</html>\n";
}

void write_html_report(const std::string& path, const ReportData& data, const ReportOptions& options) {
  write_file(path, html_report(data, options));
}

}  // namespace camber::report
