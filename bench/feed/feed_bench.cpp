// How fast the feed model is, and how it grows: a program of chords of 0.05 to 0.5 mm on a wavy spiral.
// items_per_second is blocks per second, but for BM_Axes, where it is samples (three axes) per second.
#include <benchmark/benchmark.h>

#include <cmath>

#include "feedmodel/axes.h"
#include "feedmodel/lookahead.h"
#include "feedmodel/motion_plan.h"
#include "feedmodel/path_builder.h"
#include "feedmodel/timed_path.h"

namespace {

using namespace camber;

nc::Interpretation wavy_spiral(std::size_t blocks) {
  nc::Interpretation program;
  program.states.push_back({});
  Vec3 at = Vec3::Zero();
  double angle = 0;
  for (std::size_t i = 0; i < blocks; ++i) {
    const double chord = 0.05 + 0.45 * (0.5 + 0.5 * std::sin(0.01 * static_cast<double>(i)));
    angle += 0.02 + 0.05 * std::sin(0.3 * static_cast<double>(i));
    nc::Move move;
    move.kind = nc::MoveKind::linear;
    move.start_mm = at;
    at += chord * Vec3(std::cos(angle), std::sin(angle), 0.05 * std::sin(0.1 * static_cast<double>(i)));
    move.end_mm = at;
    move.feed_mm_per_s = 50;
    move.block = static_cast<std::uint32_t>(i);
    program.moves.push_back(move);
  }
  return program;
}

machine::Machine machine_of(int lookahead_blocks) {
  machine::Machine m;
  m.control.corner = {.law = machine::CornerLaw::blend, .tolerance_mm = 0.01, .step_fraction = 0.1};
  m.control.arc_normal_fraction = 0.87;
  m.control.arc_tangential_fraction = 0.5;
  m.control.lookahead_blocks = lookahead_blocks;
  for (machine::Axis& axis : m.axis) {
    axis.max_velocity_mm_per_s = 300;
    axis.acceleration_mm_per_s2 = 2000;
    axis.jerk_mm_per_s3 = 100000;
    axis.position_gain_per_s = 40;
    axis.velocity_lag_s = 0.004;
  }
  return m;
}

void BM_LookAhead(benchmark::State& state) {
  const auto blocks = static_cast<std::size_t>(state.range(0));
  const auto rows = feedmodel::plan_motion(wavy_spiral(blocks), machine_of(0)).rows;
  for (auto _ : state) {
    state.PauseTiming();
    auto copy = rows;
    state.ResumeTiming();
    feedmodel::plan_speeds(copy, static_cast<std::size_t>(state.range(1)));
    benchmark::DoNotOptimize(copy.data());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.SetComplexityN(state.range(0));
}
BENCHMARK(BM_LookAhead)
    ->ArgNames({"blocks", "depth"})
    ->ArgsProduct({{10'000, 100'000, 1'000'000}, {0, 50}})
    ->Unit(benchmark::kMillisecond);

void BM_Plan(benchmark::State& state) {
  const auto program = wavy_spiral(static_cast<std::size_t>(state.range(0)));
  const auto machine = machine_of(50);
  for (auto _ : state) benchmark::DoNotOptimize(feedmodel::plan_motion(program, machine).times.data());
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_Plan)->ArgName("blocks")->RangeMultiplier(10)->Range(10'000, 1'000'000)->Unit(benchmark::kMillisecond);

void BM_Axes(benchmark::State& state) {
  feedmodel::Axes axes(machine_of(50), Vec3::Zero());
  Vec3 command = Vec3::Zero();
  for (auto _ : state) {
    for (long i = 0; i < state.range(0); ++i) {
      command += Vec3(0.01, 0.02, 0.005);
      benchmark::DoNotOptimize(axes(command));
    }
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_Axes)->ArgName("samples")->RangeMultiplier(10)->Range(10'000, 1'000'000)->Unit(benchmark::kMillisecond);

void BM_PredictFeed(benchmark::State& state) {
  const auto program = wavy_spiral(static_cast<std::size_t>(state.range(0)));
  const auto machine = machine_of(50);
  std::size_t samples = 0;
  for (auto _ : state)
    feedmodel::predict_feed(program, machine, [&](std::span<const feedmodel::TimedSample> s) { samples += s.size(); });
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.counters["samples/s"] = benchmark::Counter(static_cast<double>(samples), benchmark::Counter::kIsRate);
}
BENCHMARK(BM_PredictFeed)
    ->ArgName("blocks")
    ->RangeMultiplier(10)
    ->Range(10'000, 1'000'000)
    ->Unit(benchmark::kMillisecond);

}  // namespace
