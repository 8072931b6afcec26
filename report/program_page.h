#pragma once
// The page of a program as it is: its path, figures, tools and what was found in it.
#include <string>
#include <vector>

#include "report/html_report.h"
#include "report/path_card.h"

namespace camber::report {

struct ProgramPage {
  std::string title, subtitle;
  std::vector<Figure> figures;  ///< the first four are shown large
  PathPicture picture;          ///< without points: the page says that nothing moves
  std::vector<TextTable> tables;
  std::vector<std::string> warnings, notes;
};

/// The page's text, UTF-8, self-contained. The same data give the same bytes. Does not throw.
std::string program_page(const ProgramPage& page);

}  // namespace camber::report
