// The scripts and the style of report/web/bundle, taken in by the assembler as they stand.
#include "base/embedded_file.h"
#include "report/page_parts.h"

CAMBER_EMBED(camber_page_script, CAMBER_BUNDLE_DIR "/main.js")
CAMBER_EMBED(camber_page_style, CAMBER_BUNDLE_DIR "/main.css")
CAMBER_EMBED(camber_page_path, CAMBER_BUNDLE_DIR "/path.js")
CAMBER_EMBED(camber_page_machine, CAMBER_BUNDLE_DIR "/machine.js")

namespace camber::report {

std::string_view report_script() { return embedded(camber_page_script_begin, camber_page_script_end); }
std::string_view report_style() { return embedded(camber_page_style_begin, camber_page_style_end); }
std::string_view path_script() { return embedded(camber_page_path_begin, camber_page_path_end); }
std::string_view machine_script() { return embedded(camber_page_machine_begin, camber_page_machine_end); }

}  // namespace camber::report
