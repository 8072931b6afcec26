// Which lines of a program leave the largest form error? Usage: worst_lines JOB.toml
#include <camber/camber.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <vector>

int main(int argc, char** argv) {
  if (argc != 2) return std::puts("usage: worst_lines JOB.toml"), 2;
  try {
    camber::RunOptions run;
    run.progress = [](std::string_view what, double done) {
      std::fprintf(stderr, "\r%3.0f %% %.*s\033[K", 100 * done, static_cast<int>(what.size()), what.data());
      return true;  // false would stop the prediction
    };
    const camber::PredictResult result = camber::predict(camber::read_job(argv[1]), {}, run);
    std::map<long, double> worst;
    for (const camber::ErrorPoint& point : result.form_error)
      worst[point.block] = std::max(worst[point.block], std::abs(point.error_um));
    std::vector<std::pair<double, long>> lines;
    for (const auto& [line, error_um] : worst) lines.emplace_back(error_um, line);
    std::ranges::sort(lines, std::greater<>());
    std::fprintf(stderr, "\r\033[K");
    std::printf("95 %% of the surface is within %.2f um\n", result.form_error_um.p95);
    for (std::size_t i = 0; i < std::min<std::size_t>(10, lines.size()); ++i)
      std::printf("line %6ld: %7.2f um\n", lines[i].second, lines[i].first);
  } catch (const camber::InputError& problem) {
    return std::fprintf(stderr, "%s\n", problem.what()), 1;
  }
}
