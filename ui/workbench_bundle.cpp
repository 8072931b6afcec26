// The page, its script and its style, taken in by the assembler as they stand.
#include "ui/server.h"

#include "base/embedded_file.h"

CAMBER_EMBED(camber_ui_html, CAMBER_PAGE_DIR "/index.html")
CAMBER_EMBED(camber_ui_script, CAMBER_PAGE_DIR "/bundle/workbench.js")
CAMBER_EMBED(camber_ui_style, CAMBER_PAGE_DIR "/bundle/workbench.css")

namespace camber::ui {

std::string_view page_html() { return embedded(camber_ui_html_begin, camber_ui_html_end); }
std::string_view page_script() { return embedded(camber_ui_script_begin, camber_ui_script_end); }
std::string_view page_style() { return embedded(camber_ui_style_begin, camber_ui_style_end); }

}  // namespace camber::ui
