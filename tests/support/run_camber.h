#pragma once
// Runs the camber executable as a user would, in a folder of its own.
#include <cstdlib>
#include <string>

#include <sys/wait.h>

#include "test_paths.h"
#include "tests/support/temp_folder.h"

namespace camber::tests {

struct CamberRun {
  int status = -1;  ///< exit status; -1: it did not end by itself
  std::string out, err;
};

/// `arguments` as in a shell; the folder is the working directory.
inline CamberRun run_camber(const TempFolder& folder, const std::string& arguments) {
  const std::string command = "cd '" + folder.path() + "' && '" CAMBER_EXECUTABLE "' " + arguments +
                              " > camber-out.txt 2> camber-err.txt < /dev/null";
  const int result = std::system(command.c_str());
  return {WIFEXITED(result) ? WEXITSTATUS(result) : -1, file_text(folder / "camber-out.txt"),
          file_text(folder / "camber-err.txt")};
}

}  // namespace camber::tests
