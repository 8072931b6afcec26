#include "calls.h"

#include <chrono>
#include <future>
#include <stop_token>

namespace py = pybind11;

namespace camber_python {
namespace {

constexpr std::chrono::milliseconds kSignalsEvery{50};

/// Calls a Python function from the working thread. Its exception is kept and stops the work.
class PythonProgress {
 public:
  explicit PythonProgress(py::object function) : function_(std::move(function)) {}

  bool operator()(std::string_view what, double fraction) {
    const py::gil_scoped_acquire gil;
    try {
      const py::object answer = function_(py::str(what.data(), what.size()), fraction);
      return answer.is_none() || answer.cast<bool>();
    } catch (...) {
      problem_ = std::current_exception();
      return false;
    }
  }
  const std::exception_ptr& problem() const { return problem_; }

 private:
  py::object function_;
  std::exception_ptr problem_;
};

/// Waits without the GIL; between waits Python handles its signals. Returns what a handler raised, or null.
std::exception_ptr wait_for(std::future<void>& done, std::stop_source& stop) {
  std::exception_ptr raised;
  for (;;) {
    {
      const py::gil_scoped_release no_gil;
      if (done.wait_for(kSignalsEvery) == std::future_status::ready) return raised;
    }
    if (raised || PyErr_CheckSignals() == 0) continue;
    raised = std::make_exception_ptr(py::error_already_set());
    stop.request_stop();
  }
}

}  // namespace

void call(const CallOptions& options, const std::function<void(const camber::RunOptions&)>& work) {
  std::stop_source stop;
  PythonProgress progress(options.progress);
  camber::RunOptions run{.stop = stop.get_token(), .strict = options.strict, .threads = options.threads};
  if (!options.progress.is_none())
    run.progress = [&](std::string_view what, double fraction) { return progress(what, fraction); };
  auto done = std::async(std::launch::async, [&] { work(run); });
  if (const auto raised = wait_for(done, stop)) std::rethrow_exception(raised);
  if (progress.problem()) std::rethrow_exception(progress.problem());
  done.get();
}

}  // namespace camber_python
