#pragma once
// Finds subprograms: parts of the file, and files beside the main program.
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "base/diagnostics.h"
#include "nc/siemens/siemens_tree.h"

namespace camber::nc::siemens {

struct FoundProgram {
  const Program* file = nullptr;
  Part part;
};

class ProgramFiles {
 public:
  ProgramFiles(const Program& main, Diagnostics& diagnostics) : main_(main), diagnostics_(diagnostics) {}
  /// `name`: upper case, as it is called. Looks in `from`, in the main program, then for NAME.SPF and the like beside
  /// it.
  std::optional<FoundProgram> find(const Program& from, const std::string& name);

 private:
  const Program& main_;
  Diagnostics& diagnostics_;
  std::map<std::string, std::unique_ptr<Program>> files_;  ///< null: there is none
  std::map<std::string, std::string> folder_;              ///< names in upper case to paths
  bool folder_read_ = false;
};

}  // namespace camber::nc::siemens
