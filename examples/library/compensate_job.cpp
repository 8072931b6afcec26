// A job's program compensated, for no longer than a number of seconds. Usage: compensate_job JOB.toml OUT.nc SECONDS
#include <camber/camber.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <thread>

int main(int argc, char** argv) {
  if (argc != 4) return std::puts("usage: compensate_job JOB.toml OUT.nc SECONDS"), 2;
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(std::atof(argv[3]));
  std::stop_source stop;
  const std::jthread watch([&](const std::stop_token& done) {
    while (!done.stop_requested() && Clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    stop.request_stop();  // from any thread
  });
  try {
    const camber::CompensateResult result =
        camber::compensate(camber::read_job(argv[1]), {}, {.stop = stop.get_token()});
    std::printf("%s\n95 %%: %.2f um before, %.2f um after\n", result.headline.c_str(), result.before_um.p95,
                result.after_um.p95);
    if (!result.better) return 3;
    std::ofstream(argv[2], std::ios::binary) << result.program;
    return result.success ? 0 : 3;
  } catch (const camber::Cancelled&) {
    return std::puts("not finished in time"), 3;
  } catch (const camber::BeyondModel& problem) {
    return std::fprintf(stderr, "%s\n", problem.what()), 3;
  } catch (const camber::InputError& problem) {
    return std::fprintf(stderr, "%s\n", problem.what()), 1;
  }
}
