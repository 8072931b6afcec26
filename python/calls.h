#pragma once
// A call of the library from Python: without the GIL, with progress, and with signals honoured.
#include <pybind11/pybind11.h>

#include <functional>

#include "camber/run.h"

namespace camber_python {

/// Keyword arguments that every call takes.
struct CallOptions {
  pybind11::object progress = pybind11::none();  ///< f(what, fraction); False stops the call
  bool strict = false;
  int threads = 0;
};

/// Runs `work` on a thread of its own without the GIL, and lets Python handle signals meanwhile: an exception of a
/// handler (KeyboardInterrupt) or of `progress` stops the work and is raised. Exceptions of `work` pass through.
void call(const CallOptions& options, const std::function<void(const camber::RunOptions&)>& work);

}  // namespace camber_python
