// camber ui as its page meets it: over a socket, with a folder of its own.
#include <filesystem>
#include <regex>

#include <gtest/gtest.h>

#include "tests/support/run_camber.h"
#include "tests/support/wall_job.h"
#include "tests/support/workbench.h"

namespace camber {
namespace {

using nlohmann::json;
using tests::Answer;
using tests::file_text;
using tests::Headers;
using tests::TempFolder;
using tests::Workbench;
using tests::write_wall;
namespace fs = std::filesystem;

/// A folder that is served, and one beside it that is not.
class Server : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(folder_ / "served");
    fs::create_directory(folder_ / "outside");
    write_wall(folder_, "served/wall/");
  }
  int start_run(const Workbench& bench, const std::string& command, const std::string& options = "") {
    return bench.post("/api/run?job=wall/job.toml&command=" + command + options).json()["run"];
  }
  void write_slow_job() { folder_.write("served/wall/job.toml", tests::wall_job(0.02)); }
  static std::string checks_of(const json& messages) {
    std::string out;
    for (const json& m : messages) out += m.value("check", "") + ": " + m.value("message", "") + "\n";
    return out;
  }
  TempFolder folder_;
};

TEST_F(Server, PrintsItsAddressAsTheOnlyLineAndEndsWithASignal) {
  Workbench bench(folder_, "", "served");
  EXPECT_TRUE(std::regex_match(bench.url(), std::regex(R"(http://127\.0\.0\.1:\d+/\?token=[0-9a-f]{64})")))
      << bench.url();
  int status = -1;
  EXPECT_EQ(bench.end(SIGINT, &status), "");
  EXPECT_EQ(status, 0);
}

TEST_F(Server, ListensOnTheLoopbackAddressAlone) {
  const Workbench bench(folder_, "", "served");
  char port[8];
  std::snprintf(port, sizeof port, ":%04X", bench.port());
  std::istringstream sockets(file_text("/proc/net/tcp") + file_text("/proc/net/tcp6"));
  int found = 0;
  for (std::string line; std::getline(sockets, line);) {
    const std::size_t at = line.find(port);
    if (at == std::string::npos || line.find(" 0A ") == std::string::npos || at > 45) continue;
    ++found;
    EXPECT_NE(line.find(std::string("0100007F") + port), std::string::npos) << line;
  }
  EXPECT_EQ(found, 1);
}

TEST_F(Server, GivesNothingWithoutTheToken) {
  const Workbench bench(folder_, "", "served");
  for (const Headers& without : {Headers{{"Cookie", ""}}, Headers{{"Cookie", "camber_1=" + bench.token()}},
                                 Headers{{"Cookie", bench.cookie().substr(0, bench.cookie().size() - 1)}}}) {
    for (const char* target :
         {"/", "/?token=0123", "/page/workbench.js", "/page/workbench.css", "/api/about", "/api/jobs",
          "/api/job?job=wall/job.toml", "/api/check?job=wall/job.toml", "/api/runs", "/api/events",
          "/api/difference?before=wall/p.nc&after=wall/p.nc", "/files/wall/p.nc", "/nothing"}) {
      const Answer answer = bench.get(target, without);
      EXPECT_EQ(answer.status, 403) << target;
      EXPECT_EQ(answer.body, R"({"error":"the token is missing: open the address that camber ui has printed"})")
          << target;
    }
    for (const char* target :
         {"/api/programs?name=x.nc", "/api/files?job=wall/job.toml&name=x", "/api/init?job=wall/job.toml",
          "/api/edit?job=wall/job.toml", "/api/text?job=wall/job.toml", "/api/run?job=wall/job.toml&command=predict",
          "/api/runs/1/cancel"})
      EXPECT_EQ(bench.post(target, "x", without).status, 403) << target;
  }
  EXPECT_EQ(file_text(folder_ / "served/wall/job.toml"), tests::wall_job());
}

TEST_F(Server, HandsTheTokenOverIntoACookieThatNoScriptAndNoOtherSiteGets) {
  const Workbench bench(folder_, "", "served");
  const Answer page = bench.get("/?token=" + bench.token(), {{"Cookie", ""}});
  EXPECT_EQ(page.status, 200);
  EXPECT_NE(page.head.find("Set-Cookie: " + bench.cookie() + "; HttpOnly; SameSite=Strict; Path=/\r\n"),
            std::string::npos)
      << page.head;
  EXPECT_NE(page.head.find("frame-ancestors 'none'"), std::string::npos);
  EXPECT_NE(page.head.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(bench.get("/").head.find("Set-Cookie"), std::string::npos);
  EXPECT_EQ(page.body.find(bench.token()), std::string::npos);
}

TEST_F(Server, RefusesOtherHosts) {
  const Workbench bench(folder_, "", "served");
  EXPECT_EQ(bench.get("/api/runs", {{"Host", "localhost:9999"}}).status, 200);
  for (const char* host : {"", "evil.example", "127.0.0.1.evil.example:80", "0.0.0.0"})
    EXPECT_EQ(bench.get("/api/runs", {{"Host", host}}).status, 403) << host;
  EXPECT_EQ(bench.get("/api/runs", {{"Host", "127.0.0.1"}, {"Host", "evil.example"}}).status, 403);
}

TEST_F(Server, RefusesOrdersOfOtherSites) {
  const Workbench bench(folder_, "", "served");
  const std::string order = "/api/run?job=wall/job.toml&command=time";
  EXPECT_EQ(bench.post(order, "", {{"Origin", "http://localhost:4444"}}).status, 200);
  for (const char* origin : {"http://evil.example", "null", "https://127.0.0.1"})
    EXPECT_EQ(bench.post(order, "", {{"Origin", origin}}).status, 403) << origin;
  EXPECT_EQ(bench.get("/api/runs").json().size(), 1u);
}

TEST_F(Server, LimitsUploads) {
  const Workbench bench(folder_, "--max-upload-mb 0.01", "served");
  EXPECT_EQ(bench.post("/api/files?job=wall/job.toml&name=big.stl", "", {{"Content-Length", "10001"}}).status, 413);
  EXPECT_EQ(bench.post("/api/files?job=wall/job.toml&name=big.stl", "", {{"Content-Length", ""}}).status, 411);
  const Answer chunked = bench.post("/api/files?job=wall/job.toml&name=big.stl", "",
                                    {{"Content-Length", ""}, {"Transfer-Encoding", "chunked"}});
  EXPECT_EQ(chunked.status, 411);
  EXPECT_FALSE(fs::exists(folder_ / "served/wall/big.stl"));
  const std::string body(10000, 'x');
  EXPECT_EQ(bench.post("/api/files?job=wall/job.toml&name=fits.stl", body).json(), json({{"file", "wall/fits.stl"}}));
  EXPECT_EQ(file_text(folder_ / "served/wall/fits.stl"), body);
}

TEST_F(Server, WritesNoUploadOverAFileOrOutside) {
  folder_.write("outside/secret.txt", "secret");
  fs::create_symlink(folder_ / "outside", folder_ / "served/way_out");
  fs::create_symlink(folder_ / "outside/new.stl", folder_ / "served/wall/new.stl");
  fs::create_symlink(folder_ / "outside", folder_ / "served/prog");
  write_wall(folder_, "outside/job/");
  fs::create_symlink(folder_ / "outside/job", folder_ / "served/other");
  const Workbench bench(folder_, "", "served");
  const auto send = [&](const std::string& target) { return bench.post(target, "%\nM30\n%\n").status; };
  EXPECT_EQ(send("/api/files?job=wall/job.toml&name=p.nc"), 409);
  EXPECT_EQ(send("/api/files?job=wall/job.toml&name=new.stl"), 403);
  EXPECT_EQ(send("/api/files?job=other/job.toml&name=a.stl"), 403);
  EXPECT_EQ(send("/api/files?job=../outside/job/job.toml&name=a.stl"), 403);
  for (const char* name : {"..", ".", "", ".hidden", "-o", "a%0Ab", "x/..", "a%00b"})
    EXPECT_EQ(send(std::string("/api/files?job=wall/job.toml&name=") + name), 400) << name;
  EXPECT_EQ(send("/api/files?job=wall/job.toml&name=../../outside/a.stl"), 200);  // its last part
  EXPECT_TRUE(fs::exists(folder_ / "served/wall/a.stl"));
  EXPECT_EQ(send("/api/programs?name=prog.nc"), 403);
  EXPECT_EQ(file_text(folder_ / "outside/secret.txt"), "secret");
  EXPECT_FALSE(fs::exists(folder_ / "outside/new.stl"));
  EXPECT_FALSE(fs::exists(folder_ / "outside/a.stl"));
  EXPECT_FALSE(fs::exists(folder_ / "outside/prog.nc"));
  EXPECT_FALSE(fs::exists(folder_ / "outside/job/a.stl"));
}

TEST_F(Server, ShowsNoFileOutside) {
  folder_.write("outside/secret.txt", "secret");
  folder_.write("served/open.txt", "open");
  fs::create_symlink(folder_ / "outside/secret.txt", folder_ / "served/link.txt");
  fs::create_symlink(folder_ / "outside", folder_ / "served/way_out");
  fs::create_symlink(folder_ / "served/open.txt", folder_ / "served/inside.txt");
  const Workbench bench(folder_, "", "served");
  EXPECT_EQ(bench.get("/files/open.txt").body, "open");
  EXPECT_EQ(bench.get("/files/inside.txt").body, "open");
  for (const char* name : {"link.txt", "way_out/secret.txt", "../outside/secret.txt", "%2e%2e/outside/secret.txt",
                           "/etc/hostname", "wall/../../outside/secret.txt"}) {
    const Answer answer = bench.get(std::string("/files/") + name);
    EXPECT_EQ(answer.status, 403) << name;
    EXPECT_EQ(answer.body.find("secret\""), std::string::npos) << name;
  }
  EXPECT_EQ(bench.get("/api/difference?before=open.txt&after=link.txt").status, 403);
  EXPECT_EQ(bench.get("/api/job?job=link.txt").status, 403);
  EXPECT_EQ(bench.get("/api/check?program=link.txt").status, 403);
}

TEST_F(Server, KeepsPagesOfTheFolderApartFromItsOwn) {
  folder_.write("served/evil.html", "<script>fetch('/api/jobs')</script>");
  const Workbench bench(folder_, "", "served");
  const Answer answer = bench.get("/files/evil.html");
  EXPECT_NE(answer.head.find("Content-Security-Policy: sandbox allow-scripts allow-downloads\r\n"), std::string::npos)
      << answer.head;
  EXPECT_EQ(answer.head.find("allow-same-origin"), std::string::npos);
}

TEST_F(Server, RefusesJobsThatNameFilesOutside) {
  folder_.write("outside/p.nc", tests::kWallProgram);
  folder_.write("outside/machine.toml", tests::kWallMachine);
  fs::create_symlink(folder_ / "outside/machine.toml", folder_ / "served/wall/linked.toml");
  const Workbench bench(folder_, "", "served");
  const std::string job = tests::wall_job(), served = fs::canonical(folder_ / "served").string();
  const auto said = [&](const std::string& from, const std::string& to) {
    std::string text = job;
    folder_.write("served/wall/job.toml", text.replace(text.find(from), from.size(), to));
    const json checked = bench.get("/api/check?job=wall/job.toml").json();
    EXPECT_EQ(checked["status"], 1);
    std::string out;
    for (const json& m : checked["messages"])
      out += m.value("file", "") + ": " + m.value("message", "") + " [" + m.value("check", "") + "]\n";
    return out;
  };
  const std::string why = " lies outside " + served + "; a file in that folder was expected [file-outside]\n";
  EXPECT_EQ(said("\"p.nc\"", "\"../../outside/p.nc\""), "../outside/p.nc:" + why);
  EXPECT_EQ(said("\"p.nc\"", "\"" + (folder_ / "outside/p.nc") + "\""), (folder_ / "outside/p.nc") + ":" + why);
  EXPECT_EQ(said("\"machine.toml\"", "\"linked.toml\""), "wall/linked.toml:" + why);
  EXPECT_EQ(said("box_mm", "mesh = \"/etc/hostname\"\n# box_mm"), "/etc/hostname:" + why);
  EXPECT_EQ(said("box_mm", "vdb = \"/etc/hostname\"\n# box_mm"), "/etc/hostname:" + why);
}

TEST_F(Server, LetsNoRunWriteOutside) {
  fs::create_symlink(folder_ / "outside", folder_ / "served/wall/job.results");
  const Workbench bench(folder_, "", "served");
  const json run = bench.ended(start_run(bench, "time"));
  EXPECT_EQ(run["state"], "failed");
  EXPECT_EQ(run["messages"][0]["message"], "wall/job.results/time lies outside the folder");
  EXPECT_TRUE(fs::is_empty(folder_ / "outside"));
}

TEST_F(Server, MakesAJobOfAProgramAndSaysWhatIsGuessed) {
  const Workbench bench(folder_, "", "served");
  const json made = bench.post("/api/programs?name=part.nc", tests::kWallProgram).json();
  EXPECT_EQ(made["job"], "part/job.toml") << made;
  EXPECT_EQ(file_text(folder_ / "served/part/part.nc"), tests::kWallProgram);
  const json job = bench.get("/api/job?job=part/job.toml").json();
  EXPECT_EQ(job["text"], file_text(folder_ / "served/part/job.toml"));
  bool guessed = false;
  for (const json& f : job["fields"]) guessed |= f["key"] == "overhang_mm" && f["guessed"] == true;
  EXPECT_TRUE(guessed);
  EXPECT_EQ(bench.post("/api/programs?name=part.nc", tests::kWallProgram).json()["job"], "part-2/job.toml");
  EXPECT_EQ(bench.get("/api/jobs").json().size(), 3u);
}

TEST_F(Server, SaysWhatIsWrongWithAProgramAtItsLine) {
  const Workbench bench(folder_, "", "served");
  const json made = bench.post("/api/programs?name=bad.nc", "G21 G90\nT1 M6\nS100 M3\nG1 X1 F0\n").json();
  EXPECT_TRUE(made["job"].is_null());
  EXPECT_EQ(made["messages"][0]["line"], 4);
  const json checked = bench.get("/api/check?program=bad/bad.nc").json();
  EXPECT_EQ(checked["status"], 1);
  EXPECT_EQ(checked["messages"].back()["line"], 4);
  EXPECT_EQ(checked["messages"].back()["message"], "F0 on a cutting move (G1); the feed must be greater than zero");
}

TEST_F(Server, WritesAnEditOnlyWhereTheJobCanBeReadThen) {
  const Workbench bench(folder_, "", "served");
  const std::string target = "/api/edit?job=wall/job.toml";
  const json saved = bench.post(target, "set\ttool.1\tflutes\t3\nset\tstock\tallowance_mm\t0.2\n").json();
  EXPECT_EQ(saved["saved"], true) << saved;
  const std::string text = file_text(folder_ / "served/wall/job.toml");
  EXPECT_EQ(saved["text"], text);
  EXPECT_NE(text.find("flutes = 3\n"), std::string::npos);
  const json refused = bench.post(target, "set\ttool.1\tflutes\t0\n").json();
  EXPECT_EQ(refused["saved"], false);
  EXPECT_EQ(refused["messages"][0]["file"], "wall/job.toml");
  EXPECT_EQ(checks_of(refused["messages"]), "value-range: flutes is 0; a whole number from 1 to 100 was expected\n");
  EXPECT_EQ(file_text(folder_ / "served/wall/job.toml"), text);
  EXPECT_EQ(bench.post(target, "paint\ta\tb\tc").status, 400);
  EXPECT_EQ(bench.post("/api/text?job=wall/job.toml", "no job").json()["saved"], false);
  EXPECT_EQ(file_text(folder_ / "served/wall/job.toml"), text);
  EXPECT_EQ(bench.post("/api/text?job=wall/job.toml", tests::wall_job()).json()["saved"], true);
  EXPECT_EQ(file_text(folder_ / "served/wall/job.toml"), tests::wall_job());
  for (const auto& entry : fs::directory_iterator(folder_ / "served/wall"))
    EXPECT_EQ(entry.path().filename().string().find("draft"), std::string::npos) << entry.path();
}

TEST_F(Server, ChecksAJobWithItsSheetAndAProgramWithItsPath) {
  const Workbench bench(folder_, "", "served");
  const json checked = bench.get("/api/check?job=wall/job.toml").json();
  EXPECT_EQ(checked["status"], 0) << checked;
  EXPECT_EQ(checked["figures"]["moves"]["linear"], 3);
  const json program = bench.get("/api/check?program=wall/p.nc&o.units=mm").json();
  EXPECT_EQ(program["status"], 0) << program;
  const std::string path = bench.get("/files/" + program["path"].get<std::string>()).body;
  const json head = json::parse(path.substr(0, path.find('\n')));
  EXPECT_EQ(head["points"], 5) << head;
  EXPECT_NE(bench.get("/files/" + checked["sheet"].get<std::string>()).body.find("<svg"), std::string::npos);
}

TEST_F(Server, CompensatesToTheBytesOfTheCommandLine) {
  const Workbench bench(folder_, "", "served");
  const json run = bench.ended(start_run(bench, "compensate"));
  EXPECT_EQ(run["state"], "done") << run;
  const Answer program = bench.get("/files/" + run["program"].get<std::string>() + "?download=1");
  EXPECT_NE(program.head.find("Content-Disposition: attachment"), std::string::npos);
  ASSERT_EQ(tests::run_camber(folder_, "compensate served/wall/job.toml -o by_hand.nc").status, 0);
  EXPECT_EQ(program.body, file_text(folder_ / "by_hand.nc"));
  EXPECT_GT(program.body.size(), 50u);
  const json jobs = bench.get("/api/jobs").json();
  const json& result = jobs[0]["results"][0];
  EXPECT_EQ(result["command"], "compensate");
  EXPECT_TRUE(result["figures"]["machine_time_s"].is_object() || result["figures"].contains("machine_time_before_s"))
      << result;
  const json hunks = bench.get("/api/difference?before=wall/p.nc&after=" + run["program"].get<std::string>()).json();
  EXPECT_FALSE(hunks.empty());
}

TEST_F(Server, RunsEveryCommand) {
  folder_.write("served/wall/job.toml",
                tests::wall_job() + "[adapt]\nlimits = { force_N = 120.0 }\nfeed_mm_per_min = [50, 2000]\n");
  const Workbench bench(folder_, "", "served");
  const int last = [&] {
    int id = 0;
    for (const char* command : {"predict", "adapt", "feed", "time"}) id = start_run(bench, command);
    return id;
  }();
  const int compressed = start_run(bench, "compress", "&o.tolerance-mm=0.01");
  bench.ended(compressed);
  EXPECT_EQ(last, 4);
  for (int id = 1; id <= compressed; ++id) {
    const json run = bench.ended(id);
    EXPECT_TRUE(run["state"] == "done" || run["state"] == "doubtful") << run;
    EXPECT_TRUE(fs::exists(folder_ / ("served/" + run["figures"].get<std::string>()))) << run;
  }
  EXPECT_EQ(bench.get("/files/wall/job.results/predict/report.html").status, 200);
}

TEST_F(Server, RefusesCommandsAndOptionsThatItDoesNotKnow) {
  const Workbench bench(folder_, "", "served");
  const auto error = [&](const std::string& query) {
    const Answer answer = bench.post("/api/run?job=wall/job.toml&" + query);
    EXPECT_EQ(answer.status, 400);
    return answer.json()["error"].get<std::string>();
  };
  EXPECT_EQ(error("command=rm"), "there is no run rm");
  EXPECT_EQ(error("command=predict&o.output=/tmp/x"), "predict has no option output here");
  EXPECT_EQ(bench.post("/api/run?job=wall/job.toml&command=fit-feed&o.trace=../outside/t.csv").status, 403);
  EXPECT_EQ(bench.post("/api/run?job=nothing.toml&command=predict").status, 404);
  const json run = bench.ended(start_run(bench, "compress", "&o.tolerance-mm=-1"));
  EXPECT_EQ(run["state"], "failed");
  EXPECT_EQ(run["status"], 2);
  EXPECT_NE(run["messages"][0]["message"].get<std::string>().find("--tolerance-mm"), std::string::npos) << run;
}

TEST_F(Server, CancelsWhatRunsAndWhatWaits) {
  write_slow_job();
  const Workbench bench(folder_, "", "served");
  const int first = start_run(bench, "predict"), second = start_run(bench, "predict"), third = start_run(bench, "time");
  const json running =
      bench.waited(first, [](const json& r) { return r["state"] == "running" && r["share"] != nullptr; });
  EXPECT_NE(running["step"], "");
  EXPECT_EQ(bench.get("/api/runs/2").json()["state"], "queued");
  EXPECT_EQ(bench.post("/api/runs/2/cancel").status, 200);
  EXPECT_EQ(bench.post("/api/runs/1/cancel").status, 200);
  EXPECT_EQ(bench.ended(first)["state"], "cancelled");
  EXPECT_EQ(bench.ended(second)["state"], "cancelled");
  EXPECT_EQ(bench.ended(third)["state"], "done");
  EXPECT_EQ(bench.post("/api/runs/1/cancel").status, 409);
  EXPECT_FALSE(fs::exists(folder_ / "served/wall/job.results/predict/summary.json"));
}

TEST_F(Server, GoesOnAfterARunHasCrashed) {
  write_slow_job();
  const Workbench bench(folder_, "", "served");
  const int id = start_run(bench, "predict");
  const json running = bench.waited(id, [](const json& r) { return r["state"] == "running"; });
  kill(running["pid"].get<int>(), SIGSEGV);
  const json run = bench.ended(id);
  EXPECT_EQ(run["state"], "crashed");
  EXPECT_EQ(run["signal"], SIGSEGV);
  EXPECT_EQ(run["messages"].back()["message"],
            "the run crashed (Segmentation fault); the server goes on. Please report it with the files");
  EXPECT_EQ(bench.ended(start_run(bench, "time"))["state"], "done");
}

TEST_F(Server, StopsItsRunWhenItEnds) {
  write_slow_job();
  Workbench bench(folder_, "", "served");
  const json running = bench.waited(start_run(bench, "predict"), [](const json& r) { return r["state"] == "running"; });
  int status = -1;
  bench.end(SIGTERM, &status);
  EXPECT_EQ(status, 0);
  EXPECT_NE(kill(running["pid"].get<int>(), 0), 0);
}

TEST_F(Server, RefusesAJobThatNeedsMoreMemoryThanThereIsAsTheCommandLineDoes) {
  folder_.write("served/wall/job.toml", tests::wall_job(0.0005));
  const Workbench bench(folder_, "", "served");
  const json run = bench.ended(start_run(bench, "predict"));
  EXPECT_EQ(run["state"], "failed");
  const auto by_hand = tests::run_camber(folder_, "predict served/wall/job.toml -o by_hand");
  EXPECT_EQ(by_hand.status, 1);
  const json& last = run["messages"].back();
  EXPECT_EQ(last["check"], "voxel-memory") << run;
  // How much memory is free differs from one moment to the next.
  const std::string message = last["message"];
  EXPECT_NE(by_hand.err.find(message.substr(0, message.find("GB"))), std::string::npos) << message << by_hand.err;
}

TEST_F(Server, TellsOpenPagesOfRuns) {
  const Workbench bench(folder_, "", "served");
  start_run(bench, "time");
  // The page's connection stays; what it has got is looked at once the server has ended it.
  std::string events;
  std::thread page([&] { events = bench.get("/api/events").body; });
  bench.ended(1);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const_cast<Workbench&>(bench).end(SIGTERM);
  page.join();
  EXPECT_NE(events.find("event: runs\ndata: [{"), std::string::npos) << events;
  EXPECT_NE(events.find("\"state\":\"done\""), std::string::npos) << events;
}

TEST_F(Server, SaysWhyItCannotListen) {
  const Workbench bench(folder_, "", "served");
  const std::string port = std::to_string(bench.port());
  const auto second = tests::run_camber(folder_, "ui served --no-open --port " + port);
  EXPECT_EQ(second.status, 1);
  EXPECT_EQ(second.err, "127.0.0.1:" + port +
                            ": error: cannot be listened on; another --port or --address was expected [address]\n");
  EXPECT_EQ(second.out, "");
  EXPECT_EQ(tests::run_camber(folder_, "ui nowhere --no-open").status, 2);
}

}  // namespace
}  // namespace camber
