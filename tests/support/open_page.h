#pragma once
// Opens pages in headless Chromium (tests/report/page_test.mjs, tests/ui/page_test.mjs).
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

/// Runs tests/ROOM/page_test.mjs with these arguments. What the check found wrong, a line each; empty: nothing.
inline std::string run_page_script(const std::string& room, const std::string& arguments) {
  const std::string command =
      "node '" CAMBER_SOURCE_DIR "/tests/" + room + "/page_test.mjs' '" CAMBER_WEB_DIR "' " + arguments + " 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return "node could not be started";
  std::string out;
  char buffer[4096];
  for (std::size_t n; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.append(buffer, n);
  const int status = pclose(pipe);
  if (status != 0 && out.empty()) out = "the check failed without a word";
  return out;
}

/// A report page.
inline std::string open_page(const std::string& check, const std::string& page, const std::string& json = {}) {
  return run_page_script("report", check + " '" + page + "'" + (json.empty() ? "" : " '" + json + "'"));
}

}  // namespace camber::tests

#define CAMBER_NEEDS_BROWSER()         \
  if (!::camber::tests::has_browser()) \
  GTEST_SKIP() << "needs chromium and playwright-core (scripts/install-packages --oracles)"
