#include "ui/runs.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "base/diagnostics.h"

namespace camber::ui {
namespace {

using nlohmann::json;

constexpr std::array<std::string_view, 7> kStates{"queued", "running",   "done",   "doubtful",
                                                  "failed", "cancelled", "crashed"};

bool is_over(RunState state) { return state != RunState::queued && state != RunState::running; }

RunState state_of(const Ended& ended) {
  if (ended.stopped) return RunState::cancelled;
  if (ended.signal != 0) return RunState::crashed;
  if (ended.status == 0) return RunState::done;
  return ended.status == 3 ? RunState::doubtful : RunState::failed;
}

json optional(const std::optional<double>& value) { return value ? json(*value) : json(nullptr); }

json error(const std::string& message) { return {{"event", "error"}, {"severity", "error"}, {"message", message}}; }

/// Returns the message of a run that a signal ended.
std::string crash_text(int signal) {
  return fmt::format("the run crashed ({}); the server goes on. Please report it with the files", strsignal(signal));
}

}  // namespace

std::string_view name_of(RunState state) { return kStates[static_cast<std::size_t>(state)]; }

json json_of(const CommandRun& run, bool with_messages) {
  json out{{"id", run.id},
           {"job", run.job},
           {"command", run.name},
           {"arguments", run.command.arguments},
           {"program", run.command.program},
           {"report", run.command.report},
           {"figures", run.command.figures},
           {"state", name_of(run.state)},
           {"step", run.step},
           {"share", optional(run.share)},
           {"left_s", optional(run.left_s)},
           {"status", run.status},
           {"signal", run.signal},
           {"pid", run.pid},
           {"begun", run.begun},
           {"ended", run.ended},
           {"message_count", run.messages.size()}};
  if (with_messages) out["messages"] = run.messages;
  return out;
}

void take_event(std::string_view line, json& messages, CommandRun* progress) {
  if (line.empty()) return;
  json event = json::parse(line, nullptr, false);
  if (!event.is_object() || !event.contains("event")) event = error(std::string(line));
  if (event["event"] == "progress") {
    if (!progress) return;
    const auto number = [&](const char* key) {
      const json& value = event[key];
      return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
    };
    progress->step = event.value("what", "");
    progress->share = number("share"), progress->left_s = number("left_s");
    return;
  }
  if (!event.contains("severity")) event["severity"] = "error";
  if (messages.size() < Runs::kMaxMessages) messages.push_back(std::move(event));
}

std::vector<std::string> command_line(const std::string& executable, const Command& command) {
  std::vector<std::string> out{executable};
  out.insert(out.end(), command.arguments.begin(), command.arguments.end());
  out.insert(out.end(), {"--events", "--only-in", "."});
  return out;
}

Runs::Runs(std::string executable, const Folder& folder, std::function<void()> changed)
    : executable_(std::move(executable)), folder_(folder), changed_(std::move(changed)), worker_([this] { work(); }) {}

Runs::~Runs() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    if (process_) process_->stop();
  }
  wake_.notify_all();
  worker_.join();
}

int Runs::add(std::string job, std::string name, Command command) {
  int id = 0;
  {
    const std::lock_guard lock(mutex_);
    id = ++last_id_;
    if (runs_.size() >= kMaxRuns)
      if (const auto old = std::ranges::find_if(runs_, [](const CommandRun& r) { return is_over(r.state); });
          old != runs_.end())
        runs_.erase(old);
    CommandRun run;
    run.id = id, run.job = std::move(job), run.name = std::move(name), run.command = std::move(command);
    runs_.push_back(std::move(run));
  }
  wake_.notify_all();
  changed_();
  return id;
}

bool Runs::cancel(int id) {
  bool found = false;
  {
    const std::lock_guard lock(mutex_);
    const auto run = std::ranges::find(runs_, id, &CommandRun::id);
    if (run == runs_.end() || is_over(run->state)) return false;
    found = true;
    if (run->state == RunState::queued)
      run->state = RunState::cancelled;
    else if (process_)
      process_->stop();
  }
  changed_();
  return found;
}

std::vector<CommandRun> Runs::all() const {
  const std::lock_guard lock(mutex_);
  return runs_;
}

std::optional<CommandRun> Runs::find(int id) const {
  const std::lock_guard lock(mutex_);
  const auto run = std::ranges::find(runs_, id, &CommandRun::id);
  return run == runs_.end() ? std::nullopt : std::optional(*run);
}

void Runs::update(int id, const std::function<void(CommandRun&)>& change) {
  {
    const std::lock_guard lock(mutex_);
    const auto run = std::ranges::find(runs_, id, &CommandRun::id);
    if (run != runs_.end()) change(*run);
  }
  changed_();
}

void Runs::work() {
  for (;;) {
    int next = 0;
    {
      std::unique_lock lock(mutex_);
      const auto waiting = [&] { return std::ranges::find(runs_, RunState::queued, &CommandRun::state); };
      wake_.wait(lock, [&] { return stop_ || waiting() != runs_.end(); });
      if (stop_) return;
      next = waiting()->id;
    }
    execute(next);
  }
}

void Runs::execute(int id) {
  const std::optional<CommandRun> run = find(id);
  if (!run) return;
  try {
    folder_.make_folder(results_of(run->job, run->name));
    {
      const std::lock_guard lock(mutex_);
      const auto at = std::ranges::find(runs_, id, &CommandRun::id);
      if (stop_ || at == runs_.end() || at->state != RunState::queued) return;
      process_ = std::make_unique<Process>(command_line(executable_, run->command), folder_.path());
      at->state = RunState::running, at->begun = std::time(nullptr), at->pid = process_->pid();
    }
    changed_();
    const Ended ended = process_->wait(
        [&](std::string_view line) { update(id, [&](CommandRun& r) { take_event(line, r.messages, &r); }); });
    finish(id, ended);
  } catch (const Refused& refused) {
    fail(id, refused.why);
  } catch (const std::exception& problem) {
    fail(id, problem.what());
  }
  const std::lock_guard lock(mutex_);
  process_.reset();
}

/// Before it has begun.
void Runs::fail(int id, const std::string& why) {
  update(id, [&](CommandRun& r) {
    r.state = RunState::failed;
    r.begun = r.ended = std::time(nullptr);
    r.messages.push_back(error(why));
  });
}

/// The record of the run stays beside its results: the server may be another one tomorrow.
void Runs::finish(int id, const Ended& ended) {
  update(id, [&](CommandRun& r) {
    r.state = state_of(ended);
    r.status = ended.status, r.signal = ended.signal;
    r.ended = std::time(nullptr);
    r.step.clear();
    r.share.reset(), r.left_s.reset();
    if (r.state == RunState::crashed) r.messages.push_back(error(crash_text(ended.signal)));
  });
  const std::optional<CommandRun> run = find(id);
  if (!run || run->state == RunState::cancelled) return;
  try {
    folder_.write(results_of(run->job, run->name) + "/run.json", json_of(*run, true).dump(2) + "\n");
  } catch (const InputError& problem) {
    update(id, [&](CommandRun& r) { r.messages.push_back(error(problem.what())); });
  }
}

}  // namespace camber::ui
