// Blocks per second of each stage of reading a program. items_per_second in the output is blocks per second.
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>

#include <fmt/format.h>

#include "nc/emit.h"
#include "nc/interpreter.h"
#include "nc/summary.h"

namespace camber::nc {
namespace {

constexpr int kBlocks = 200000;

/// A finishing pass over a wavy surface, as bench/check-big-program writes it.
std::string lines_program() {
  std::string text = "G21 G17 G90 G94\nS12000 M3\nG0 X0. Y0. Z5.\nG1 Z0. F1500\n";
  for (int i = 0; i < kBlocks; ++i) {
    const double x = 0.05 * (i % 2000), y = 0.001 * (i / 2000);
    fmt::format_to(std::back_inserter(text), "G1 X{:.3f} Y{:.3f} Z{:.3f}\n", x, y, 2 * std::sin(x) * std::cos(y));
  }
  return text + "G0 Z5.\nM30\n";
}

/// Half turns that climb.
std::string arcs_program() {
  std::string text = "G21 G17 G90 G94\nS12000 M3\nG0 X0. Y0. Z0.\nF1500\n";
  for (int i = 0; i < kBlocks; ++i)
    fmt::format_to(std::back_inserter(text), "G3 X{}. Y0. Z{:.3f} I{}. J0.\n", i % 2 ? 0 : 10, 0.001 * i,
                   i % 2 ? -5 : 5);
  return text + "G0 Z5.\nM30\n";
}

std::string program_of(std::int64_t kind) { return kind == 0 ? lines_program() : arcs_program(); }

void read(benchmark::State& state) {
  const std::string text = program_of(state.range(0));
  for (auto _ : state) {
    Diagnostics diagnostics;
    benchmark::DoNotOptimize(read_program(SourceText("bench.nc", text), diagnostics));
  }
  state.SetItemsProcessed(state.iterations() * kBlocks);
}

void interpret_blocks(benchmark::State& state) {
  Diagnostics diagnostics;
  const Program program = read_program(SourceText("bench.nc", program_of(state.range(0))), diagnostics);
  for (auto _ : state) benchmark::DoNotOptimize(interpret(program, {.inch = false}, diagnostics));
  state.SetItemsProcessed(state.iterations() * kBlocks);
}

void summarize_moves(benchmark::State& state) {
  Diagnostics diagnostics;
  const Program program = read_program(SourceText("bench.nc", program_of(state.range(0))), diagnostics);
  const Interpretation moves = interpret(program, {.inch = false}, diagnostics);
  for (auto _ : state) benchmark::DoNotOptimize(summarize(program, moves));
  state.SetItemsProcessed(state.iterations() * kBlocks);
}

void emit_every_tenth(benchmark::State& state) {
  Diagnostics diagnostics;
  const Program program = read_program(SourceText("bench.nc", program_of(state.range(0))), diagnostics);
  const Interpretation moves = interpret(program, {.inch = false}, diagnostics);
  std::vector<MoveEdit> edits;
  for (std::uint32_t m = 10; m + 1 < moves.moves.size(); m += 10) {
    MoveEdit edit{.move = m, .end_mm = moves.moves[m].end_mm + Vec3(0.01, 0, 0)};
    if (moves.moves[m].arc != Move::kNoArc) edit.center_mm = moves.arcs[moves.moves[m].arc].center_mm;
    edits.push_back(edit);
  }
  for (auto _ : state) benchmark::DoNotOptimize(emit(program, moves, edits, {}));
  state.SetItemsProcessed(state.iterations() * kBlocks);
}

BENCHMARK(read)->ArgName("arcs")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(interpret_blocks)->ArgName("arcs")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(summarize_moves)->ArgName("arcs")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(emit_every_tenth)->ArgName("arcs")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace camber::nc

BENCHMARK_MAIN();
