#include "api/run.h"

#include <limits>

#include <tbb/task_arena.h>
#include <tbb/task_scheduler_observer.h>

#include "base/cancel.h"
#include "base/stage.h"

namespace camber {
namespace api {
namespace {

/// Every thread that joins the arena asks its token.
class TokenForWorkers : public tbb::task_scheduler_observer {
 public:
  TokenForWorkers(tbb::task_arena& arena, const std::stop_token& token)
      : tbb::task_scheduler_observer(arena), token_(token) {
    observe(true);
  }
  ~TokenForWorkers() override { observe(false); }
  void on_scheduler_entry(bool is_worker) override {
    if (is_worker) set_stop_token(token_);
  }
  void on_scheduler_exit(bool is_worker) override {
    if (is_worker) set_stop_token({});
  }

 private:
  const std::stop_token& token_;
};

}  // namespace

void Run::execute(const std::function<void()>& work) {
  const std::stop_token token = stop_.get_token();
  const std::stop_callback forward(options_.stop, [this] { stop_.request_stop(); });
  tbb::task_arena arena(options_.threads > 0 ? options_.threads : tbb::task_arena::automatic);
  arena.initialize();
  const TokenForWorkers observer(arena, token);
  arena.execute([&] {
    const CancelScope here(token);
    const StageScope stages(options_.progress ? progress() : StageSink());
    cancellation_point();
    work();
  });
  if (options_.progress) options_.progress("done", 1);  // nothing is left to stop: the answer does not count
}

void Run::show(std::string_view what, double fraction) {
  if (options_.progress && !options_.progress(what, fraction)) stop_.request_stop();
  if (stop_.stop_requested()) throw Cancelled();
}

std::function<void(const std::string&, double)> Run::progress() {
  return [this](const std::string& what, double fraction) { show(what, fraction); };
}

std::function<void(const std::string&, std::optional<double>)> Run::steps() {
  const double unknown = options_.nan_where_unknown ? std::numeric_limits<double>::quiet_NaN() : 0;
  return [this, unknown](const std::string& what, std::optional<double> fraction) {
    show(what, fraction.value_or(unknown));
  };
}

void Run::settle(const Diagnostics& diagnostics) const {
  diagnostics.throw_if_errors();
  if (options_.strict) throw_if_any(diagnostics);
}

void Run::settle_first(const Diagnostics& diagnostics) const {
  settle(diagnostics);
  if (options_.warn) options_.warn(diagnostics.all());
}

double Run::seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }

std::vector<std::string> texts_of(const Diagnostics& diagnostics) {
  std::vector<std::string> out;
  for (const Diagnostic& d : diagnostics.all()) out.push_back(to_string(d));
  return out;
}

}  // namespace api

const char* v0::version() { return CAMBER_VERSION; }

}  // namespace camber
