// The scripts and the style of report/web/bundle, taken in by the assembler as they stand.
#include <cstddef>

#include "report/page_parts.h"

// CAMBER_BUNDLE(NAME, FILE): the bytes of a file as NAME_begin to NAME_end.
#define CAMBER_BUNDLE(name, file)                                                        \
  asm(".section .rodata\n"                                                               \
      ".hidden " #name "_begin\n.hidden " #name                                          \
      "_end\n"                                                                           \
      ".global " #name "_begin\n.global " #name "_end\n" #name                           \
      "_begin:\n"                                                                        \
      ".incbin \"" CAMBER_BUNDLE_DIR "/" file "\"\n" #name "_end:\n.byte 0\n.previous"); \
  extern "C" {                                                                           \
  extern const char name##_begin[], name##_end[];                                        \
  }

CAMBER_BUNDLE(camber_page_script, "main.js")
CAMBER_BUNDLE(camber_page_style, "main.css")
CAMBER_BUNDLE(camber_page_path, "path.js")
CAMBER_BUNDLE(camber_page_machine, "machine.js")

namespace camber::report {
namespace {

std::string_view between(const char* begin, const char* end) { return {begin, static_cast<std::size_t>(end - begin)}; }

}  // namespace

std::string_view report_script() { return between(camber_page_script_begin, camber_page_script_end); }
std::string_view report_style() { return between(camber_page_style_begin, camber_page_style_end); }
std::string_view path_script() { return between(camber_page_path_begin, camber_page_path_end); }
std::string_view machine_script() { return between(camber_page_machine_begin, camber_page_machine_end); }

}  // namespace camber::report
