#pragma once
// Files that the executable holds, taken in by the assembler as they stand.
#include <cstddef>
#include <string_view>

// CAMBER_EMBED(NAME, PATH): the bytes of the file as NAME_begin to NAME_end. At namespace scope, in one source file.
#define CAMBER_EMBED(name, path)                                   \
  asm(".section .rodata\n"                                         \
      ".hidden " #name "_begin\n.hidden " #name                    \
      "_end\n"                                                     \
      ".global " #name "_begin\n.global " #name "_end\n" #name     \
      "_begin:\n"                                                  \
      ".incbin \"" path "\"\n" #name "_end:\n.byte 0\n.previous"); \
  extern "C" {                                                     \
  extern const char name##_begin[], name##_end[];                  \
  }

namespace camber {

/// The bytes between two such symbols.
inline std::string_view embedded(const char* begin, const char* end) {
  return {begin, static_cast<std::size_t>(end - begin)};
}

}  // namespace camber
