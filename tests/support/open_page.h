#pragma once
// Opens a report page in headless Chromium (tests/report/page_test.mjs).
#include <cstdio>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "test_paths.h"

namespace camber::tests {

inline bool has_browser() {
  return (std::filesystem::exists("/usr/bin/chromium") || std::filesystem::exists("/usr/bin/chromium-browser")) &&
         std::filesystem::exists(CAMBER_WEB_DIR "/node_modules/playwright-core");
}

/// What the check found wrong, a line each; empty: nothing.
inline std::string open_page(const std::string& check, const std::string& page, const std::string& json = {}) {
  std::string command = "node '" CAMBER_SOURCE_DIR "/tests/report/page_test.mjs' '" CAMBER_WEB_DIR "' " + check + " '" +
                        page + "' " + (json.empty() ? "" : "'" + json + "' ") + "2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return "node could not be started";
  std::string out;
  char buffer[4096];
  for (std::size_t n; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.append(buffer, n);
  const int status = pclose(pipe);
  if (status != 0 && out.empty()) out = "the check failed without a word";
  return out;
}

}  // namespace camber::tests

#define CAMBER_NEEDS_BROWSER()         \
  if (!::camber::tests::has_browser()) \
  GTEST_SKIP() << "needs chromium and playwright-core (scripts/install-packages --oracles)"
