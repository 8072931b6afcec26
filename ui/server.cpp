#include "ui/server.h"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <thread>

#include <fmt/format.h>
#include <httplib.h>
#include <pthread.h>

#include "base/diagnostics.h"
#include "base/output_file.h"
#include "ui/bench.h"

namespace camber::ui {
namespace {

namespace fs = std::filesystem;
using httplib::Request;
using httplib::Response;
using nlohmann::json;

constexpr std::size_t kThreads = 32;  ///< each open page takes one, for its events
constexpr std::chrono::seconds kHeartbeat{10};
constexpr std::chrono::milliseconds kBetweenEvents{150};
constexpr std::size_t kPiece_bytes = 1u << 18;

/// Nothing is loaded from anywhere else, no script stands in the page, no other site shows it in a frame.
constexpr const char* kPagePolicy =
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "connect-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// Pages and pictures of the folder run as if of another site: they get at nothing of this one.
constexpr const char* kFilePolicy = "sandbox allow-scripts allow-downloads";

/// Tells the open pages that runs have changed.
class Changes {
 public:
  void notify() {
    {
      const std::lock_guard lock(mutex_);
      ++count_;
    }
    wake_.notify_all();
  }
  void close() {
    closed_ = true;
    notify();
  }
  bool closed() const { return closed_; }
  /// Waits for a count above `seen`, at most kHeartbeat; returns the count.
  std::uint64_t wait(std::uint64_t seen) {
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, kHeartbeat, [&] { return count_ > seen || closed_; });
    return count_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable wake_;
  std::uint64_t count_ = 1;
  std::atomic<bool> closed_{false};
};

/// With a known length, or the library would compress it, which takes longer than to send it to the same machine.
void send(Response& response, std::shared_ptr<const std::string> content, const char* type) {
  if (content->empty()) return response.set_content("", type);
  response.set_content_provider(content->size(), type,
                                [content](std::size_t at, std::size_t length, httplib::DataSink& sink) {
                                  return sink.write(content->data() + at, std::min(length, kPiece_bytes));
                                });
}
void send(Response& response, std::string content, const char* type) {
  send(response, std::make_shared<const std::string>(std::move(content)), type);
}
void send(Response& response, const json& answer) {
  send(response, answer.dump(-1, ' ', false, json::error_handler_t::replace), "application/json");
}
void refuse(Response& response, int status, const std::string& why) {
  response.status = status;
  send(response, json{{"error", why}});
}

void send_file(Response& response, const std::string& path, const char* type) {
  std::error_code ec;
  const auto bytes = fs::file_size(path, ec);
  const auto in = std::make_shared<std::ifstream>(path, std::ios::binary);
  if (ec || !*in) return refuse(response, 404, "the file cannot be read");
  if (bytes == 0) return response.set_content("", type);
  response.set_content_provider(bytes, type, [in](std::size_t at, std::size_t length, httplib::DataSink& sink) {
    std::string piece(std::min(length, kPiece_bytes), '\0');
    in->seekg(static_cast<std::streamoff>(at));
    in->read(piece.data(), static_cast<std::streamsize>(piece.size()));
    return in->gcount() > 0 && sink.write(piece.data(), static_cast<std::size_t>(in->gcount()));
  });
}

const char* type_of(const fs::path& path) {
  static const std::map<std::string, const char*> kTypes{{".html", "text/html; charset=utf-8"},
                                                         {".json", "application/json"},
                                                         {".csv", "text/csv; charset=utf-8"},
                                                         {".toml", "text/plain; charset=utf-8"},
                                                         {".nc", "text/plain; charset=utf-8"},
                                                         {".svg", "image/svg+xml"},
                                                         {".png", "image/png"}};
  const auto found = kTypes.find(path.extension().string());
  return found == kTypes.end() ? "application/octet-stream" : found->second;
}

std::vector<std::string> headers_of(const Request& request, const char* name) {
  std::vector<std::string> out;
  for (auto [at, end] = request.headers.equal_range(name); at != end; ++at) out.push_back(at->second);
  return out;
}

Asked asked_of(const Request& request) {
  Asked out;
  out.hosts = headers_of(request, "Host");
  out.origins = headers_of(request, "Origin");
  out.token = request.get_param_value("token");
  for (const std::string& line : headers_of(request, "Cookie")) out.cookies += (out.cookies.empty() ? "" : ";") + line;
  out.has_body = request.method != "GET" && request.method != "HEAD";
  out.lengths = headers_of(request, "Content-Length");
  return out;
}

Options options_of(const Request& request) {
  Options out;
  for (const auto& [name, value] : request.params)
    if (name.starts_with("o.")) out[name.substr(2)] = value;
  return out;
}

std::string body_of(const httplib::ContentReader& reader) {
  std::string out;
  reader([&](const char* data, std::size_t length) { return out.append(data, length), true; });
  return out;
}

class Server {
 public:
  explicit Server(const ServerOptions& options)
      : folder_(options.folder),
        executable_(options.executable),
        guard_{new_token(), "", options.address, options.max_upload_bytes},
        bench_(folder_, options.executable, [this] { changes_.notify(); }) {
    http_.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    http_.set_keep_alive_max_count(1);  // what a refused request has behind it is no further request
    http_.set_keep_alive_timeout(2);
    // The library would share the port with any other server that asks for it.
    http_.set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    http_.set_payload_max_length(options.max_upload_bytes);
    http_.set_default_headers({{"X-Content-Type-Options", "nosniff"},
                               {"Referrer-Policy", "no-referrer"},
                               {"Cache-Control", "no-store"},
                               {"Cross-Origin-Resource-Policy", "same-origin"}});
    http_.set_pre_routing_handler([this](const Request& request, Response& response) {
      const auto refused = refusal(guard_, asked_of(request));
      if (!refused) return httplib::Server::HandlerResponse::Unhandled;
      refuse(response, refused->status, refused->why);
      return httplib::Server::HandlerResponse::Handled;
    });
    add_page();
    add_questions();
    add_orders();
  }

  /// Returns the address of the page.
  std::string listen(const std::string& address, int port) {
    const bool bound = port == 0 ? (port = http_.bind_to_any_port(address)) > 0 : http_.bind_to_port(address, port);
    if (!bound)
      fail_on_file(fmt::format("{}:{}", address, port),
                   "cannot be listened on; another --port or --address was expected", "address");
    guard_.cookie_name = fmt::format("camber_{}", port);
    thread_ = std::thread([this] {
      http_.listen_after_bind();
      ended_ = true;
    });
    // httplib's stop() does nothing before its loop runs: a signal that comes sooner would be waited for in vain.
    while (!http_.is_running() && !ended_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return fmt::format("http://{}:{}/?token={}", host_text(address), port, guard_.token);
  }

  ~Server() {
    changes_.close();
    http_.stop();
    if (thread_.joinable()) thread_.join();
  }

 private:
  using Answer = std::function<void(const Request&, Response&)>;

  /// Returns `answer` with exceptions turned into replies.
  static Answer guarded(Answer answer) {
    return [answer](const Request& request, Response& response) {
      try {
        answer(request, response);
      } catch (const Refused& refused) {
        refuse(response, refused.status, refused.why);
      } catch (const InputError& problem) {
        refuse(response, 400, problem.what());
      } catch (const std::exception& problem) {
        refuse(response, 500, problem.what());
      }
    };
  }
  void get(const char* path, Answer answer) { http_.Get(path, guarded(std::move(answer))); }
  /// Orders take their body by themselves.
  void post(const char* path, std::function<void(const Request&, const httplib::ContentReader&, Response&)> answer) {
    http_.Post(path, [answer](const Request& request, Response& response, const httplib::ContentReader& reader) {
      guarded([&](const Request& r, Response& out) { answer(r, reader, out); })(request, response);
    });
  }

  void add_page() {
    get("/", [this](const Request& request, Response& response) {
      if (request.has_param("token"))
        response.set_header("Set-Cookie",
                            fmt::format("{}={}; HttpOnly; SameSite=Strict; Path=/", guard_.cookie_name, guard_.token));
      response.set_header("Content-Security-Policy", kPagePolicy);
      send(response, std::string(page_html()), "text/html; charset=utf-8");
    });
    get("/page/workbench.js", [](const Request&, Response& response) {
      send(response, std::string(page_script()), "text/javascript; charset=utf-8");
    });
    get("/page/workbench.css", [](const Request&, Response& response) {
      send(response, std::string(page_style()), "text/css; charset=utf-8");
    });
    get("/api/events", [this](const Request&, Response& response) { send_events(response); });
  }

  void send_events(Response& response) {
    response.set_chunked_content_provider(
        "text/event-stream", [this, seen = std::uint64_t{0}](std::size_t, httplib::DataSink& sink) mutable {
          const std::uint64_t now = changes_.wait(seen);
          if (changes_.closed()) {
            sink.done();
            return true;
          }
          const std::string text =
              now == seen ? ":\n\n"
                          : fmt::format("event: runs\ndata: {}\n\n",
                                        bench_.runs().dump(-1, ' ', false, json::error_handler_t::replace));
          seen = now;
          std::this_thread::sleep_for(kBetweenEvents);
          return sink.write(text.data(), text.size());
        });
  }

  void add_questions() {
    get("/api/about", [this](const Request&, Response& response) {
      json out = bench_.about();
      out["max_upload_bytes"] = guard_.max_upload_bytes;
      send(response, out);
    });
    get("/api/jobs", [this](const Request&, Response& response) { send(response, bench_.jobs()); });
    get("/api/job", [this](const Request& request, Response& response) {
      send(response, bench_.job(request.get_param_value("job")));
    });
    get("/api/check", [this](const Request& request, Response& response) {
      send(response, request.has_param("job")
                         ? bench_.check(request.get_param_value("job"))
                         : bench_.check_program(request.get_param_value("program"), options_of(request)));
    });
    get("/api/runs", [this](const Request&, Response& response) { send(response, bench_.runs()); });
    get(R"(/api/runs/(\d{1,8}))", [this](const Request& request, Response& response) {
      send(response, bench_.run(std::stoi(request.matches[1].str())));
    });
    get("/api/difference", [this](const Request& request, Response& response) {
      send(response, bench_.difference(request.get_param_value("before"), request.get_param_value("after")));
    });
    get("/files/(.+)", [this](const Request& request, Response& response) {
      const std::string name = request.matches[1].str(), path = folder_.file(name);
      response.set_header("Content-Security-Policy", kFilePolicy);
      if (request.has_param("download")) response.set_header("Content-Disposition", "attachment");
      send_file(response, path, type_of(path));
    });
  }

  void add_orders() {
    post("/api/programs", [this](const Request& request, const httplib::ContentReader& reader, Response& response) {
      const std::string name = upload_name(request.get_param_value("name"));
      send(response, bench_.begin(take_upload(new_folder(fs::path(name).stem().string()) + "/" + name, reader),
                                  options_of(request)));
    });
    post("/api/files", [this](const Request& request, const httplib::ContentReader& reader, Response& response) {
      const std::string job = request.get_param_value("job");
      folder_.file(job);
      const std::string name = folder_of(job) + upload_name(request.get_param_value("name"));
      std::error_code ec;
      if (fs::exists(fs::symlink_status(folder_.place(name), ec)))
        throw Refused{409, name + " is there already; another name was expected"};
      send(response, json{{"file", take_upload(name, reader)}});
    });
    post("/api/init", [this](const Request& request, const httplib::ContentReader&, Response& response) {
      send(response, bench_.init(request.get_param_value("job"), options_of(request)));
    });
    post("/api/edit", [this](const Request& request, const httplib::ContentReader& reader, Response& response) {
      send(response, bench_.edit(request.get_param_value("job"), body_of(reader)));
    });
    post("/api/text", [this](const Request& request, const httplib::ContentReader& reader, Response& response) {
      send(response, bench_.replace(request.get_param_value("job"), body_of(reader)));
    });
    post("/api/run", [this](const Request& request, const httplib::ContentReader&, Response& response) {
      send(response,
           bench_.run(request.get_param_value("job"), request.get_param_value("command"), options_of(request)));
    });
    post(R"(/api/runs/(\d{1,8})/cancel)",
         [this](const Request& request, const httplib::ContentReader&, Response& response) {
           send(response, bench_.cancel(std::stoi(request.matches[1].str())));
         });
  }

  /// "part", or "part-2" where that is there.
  std::string new_folder(const std::string& stem) {
    const std::lock_guard lock(mutex_);
    std::error_code ec;
    std::string name = stem;
    for (int i = 2; fs::exists(fs::symlink_status(folder_.place(name), ec)); ++i) name = fmt::format("{}-{}", stem, i);
    folder_.make_folder(name);
    return name;
  }

  /// Writes an upload to the folder piece by piece, so that it is never in memory as a whole. Returns its name.
  std::string take_upload(const std::string& name, const httplib::ContentReader& reader) {
    OutputFile file(folder_.place(name));
    std::uint64_t bytes = 0;
    const bool whole = reader([&](const char* data, std::size_t length) {
      bytes += length;
      file.stream().write(data, static_cast<std::streamsize>(length));
      return bytes <= guard_.max_upload_bytes;
    });
    if (!whole) throw Refused{400, name + " did not arrive as a whole"};
    file.commit();
    return name;
  }

  const Folder folder_;
  const std::string executable_;
  RequestGuard guard_;
  std::mutex mutex_;  ///< of new folders
  Changes changes_;
  Bench bench_;
  httplib::Server http_;
  std::thread thread_;
  std::atomic<bool> ended_ = false;  ///< the loop of http_
};

/// Waits for a signal that ends the process; other threads do not get them.
class EndingSignals {
 public:
  EndingSignals() {
    sigemptyset(&signals_);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals_, signal);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
  }
  void wait() const {
    int signal = 0;
    sigwait(&signals_, &signal);
  }

 private:
  sigset_t signals_;
};

}  // namespace

void serve(const ServerOptions& options) {
  const EndingSignals signals;
  Server server(options);
  const std::string url = server.listen(options.address, options.port);
  if (options.ready) options.ready(url);
  signals.wait();
}

}  // namespace camber::ui
