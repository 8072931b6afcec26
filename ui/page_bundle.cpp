// The page, its script and its style, taken in by the assembler as they stand.
#include "ui/page_bundle.h"

#include <cstddef>

// CAMBER_BUNDLE(NAME, FILE): the bytes of a file as NAME_begin to NAME_end.
#define CAMBER_BUNDLE(name, file)                                                      \
  asm(".section .rodata\n"                                                             \
      ".hidden " #name "_begin\n.hidden " #name                                        \
      "_end\n"                                                                         \
      ".global " #name "_begin\n.global " #name "_end\n" #name                         \
      "_begin:\n"                                                                      \
      ".incbin \"" CAMBER_PAGE_DIR "/" file "\"\n" #name "_end:\n.byte 0\n.previous"); \
  extern "C" {                                                                         \
  extern const char name##_begin[], name##_end[];                                      \
  }

CAMBER_BUNDLE(camber_ui_html, "index.html")
CAMBER_BUNDLE(camber_ui_script, "bundle/workbench.js")
CAMBER_BUNDLE(camber_ui_style, "bundle/workbench.css")

namespace camber::ui {
namespace {

std::string_view between(const char* begin, const char* end) { return {begin, static_cast<std::size_t>(end - begin)}; }

}  // namespace

std::string_view page_html() { return between(camber_ui_html_begin, camber_ui_html_end); }
std::string_view page_script() { return between(camber_ui_script_begin, camber_ui_script_end); }
std::string_view page_style() { return between(camber_ui_style_begin, camber_ui_style_end); }

}  // namespace camber::ui
