#pragma once
// Programs to run on a machine so that fit_feed() has the data it needs, and a test piece for fit-parts.
#include <string>
#include <vector>

#include "camber/machine.h"

namespace camber {
inline namespace v0 {

struct ProtocolOptions {
  bool part = false;           ///< a test piece to cut and measure instead
  double diameter_mm = 6;      ///< with it: diameter of its end mill
  std::string machine_name{};  ///< with it: file of the machine, as the job of the test piece names it
};

/// A file of the protocol and what it is good for.
struct ProtocolFile {
  std::string name{}, text{};
  std::string printed{};  ///< the line that `camber protocol` prints of it; may be empty
};

/// Throws InputError.
CAMBER_API std::vector<ProtocolFile> protocol(const Machine& machine, const ProtocolOptions& options = {});

}  // namespace v0
}  // namespace camber
