#include "report/check_summary.h"

#include "report/page_tables.h"

namespace camber::report {

std::string program_page(const ProgramPage& page) {
  std::string out = page_head(page.title, page.subtitle);
  ReportData figures;
  figures.figures = page.figures;
  ProgramCard path{"<div class=\"card\"><p class=\"missing\">The program moves nothing.</p></div>\n", ""};
  if (!page.picture.points.empty()) path = program_card("The path", page.picture);
  out += tiles_html(figures) + list_html("Warnings", "warnings", page.warnings) + path.card;
  out += "<div class=\"columns\">\n" + figures_html(figures);
  for (const TextTable& table : page.tables) out += table_html(table);
  std::vector<std::string> notes = page.notes;
  if (page.picture.thinned) notes.push_back(thinned_note(page.picture, "The picture of the path"));
  return out + list_html("Notes", "notes", notes) + "</div>\n</main>\n" + path.scripts + "</body>\n</html>\n";
}

}  // namespace camber::report
