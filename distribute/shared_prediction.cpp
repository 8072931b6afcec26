#include "distribute/shared_prediction.h"

#include <cstdint>
#include <utility>

#include "distribute/path_sections.h"

namespace camber::distribute {

using namespace simulate;
namespace {

/// The parts of all processes; `bytes`: of `own` for another one.
template <class Part, class Bytes>
std::vector<Part> parts_of_crew(const Crew& crew, const Part& own, const Bytes& bytes) {
  const std::vector<std::string> given = crew.exchange(bytes);
  std::vector<Part> out;
  for (std::size_t r = 0; r < crew.size; ++r) out.push_back(r == crew.rank ? own : part_from<Part>(given[r]));
  return out;
}

template <class Part>
std::vector<Part> whole_parts_of_crew(const Crew& crew, const Part& own) {
  return parts_of_crew(crew, own, [bytes = bytes_of_part(own)](std::size_t) { return bytes; });
}

std::uint64_t solved_again(const std::vector<SolvedSection>& sections) {
  std::uint64_t out = 0;
  for (const SolvedSection& s : sections)
    if (!s.history.empty()) out += s.history.back().solved_again;
  return out;
}

/// Properties that two predictions must share so that one begins where the other ended: the voxels, and how the path is
/// divided.
struct Division {
  struct PiecesOfRun {
    int tool = 0;
    removal::RunKind kind{};
    std::size_t pieces = 0;
    bool operator==(const PiecesOfRun&) const = default;
  };
  double voxel_mm = 0, band_mm = 0;
  Vec3 min_mm = Vec3::Zero(), max_mm = Vec3::Zero();  ///< box of the blank
  std::vector<PiecesOfRun> runs;

  bool operator==(const Division&) const = default;
};

Division division_of(const removal::Stock& blank, const removal::StampPath& path) {
  Division out{blank.voxel_mm(), blank.band_mm(), blank.min_mm(), blank.max_mm(), {}};
  for (const removal::ToolRun& run : path.runs) out.runs.push_back({run.tool, run.kind, 0});
  for (const StretchPiece& piece : path_pieces(path)) ++out.runs[piece.run].pieces;
  return out;
}

}  // namespace

struct CrewPredictions::Memory {
  CrewFigures figures;
  // Of the prediction before; empty: none, or nothing that its rounds have left.
  Division division;
  std::vector<PieceRange> ranges;
  std::vector<SolvedSection> solved;
  OwnSolution own;
};

CrewPredictions::CrewPredictions(const Crew& crew) : crew_(crew), memory_(std::make_unique<Memory>()) {}
CrewPredictions::~CrewPredictions() = default;

const CrewFigures& CrewPredictions::figures() const { return memory_->figures; }

simulate::Predictor CrewPredictions::predictor() {
  return [this](const machine::Job& job, const Target& target, const SimulatedProgram& program,
                const PredictOptions& options) { return predict(job, target, program, options); };
}

Prediction CrewPredictions::predict(const machine::Job& job, const Target& target, const SimulatedProgram& program,
                                    const PredictOptions& options) {
  if (options.turn_from || options.chip_ratio != 0 || target.part_yields)
    return simulate::predict(job, target, program, options);
  return predict_together(job, target, program, options.progress);
}

Prediction CrewPredictions::predict_together(const machine::Job& job, const Target& target,
                                             const SimulatedProgram& program,
                                             const std::function<void(double)>& progress) {
  const Crew& crew = crew_;
  Memory& memory = *memory_;
  const removal::StampPath& path = program.path;
  const bool in_rounds = job.simulation.coupling == machine::Coupling::static_ && path_pieces(path).size() > 1;
  const Division division = division_of(target.blank, path);
  SectionParts parts;
  parts.from_another_path = in_rounds && !memory.solved.empty() && memory.division == division;
  const SectionPlace place =
      parts.from_another_path ? SectionPlace(path, crew.rank, memory.ranges) : SectionPlace(path, crew.rank, crew.size);
  std::vector<removal::Region> regions;
  for (std::size_t r = 0; r < crew.size; ++r) regions.push_back(section_region(job, path, place, r));
  const auto solved_of_crew = [&](const SolvedSection& own) {
    return parts_of_crew(crew, own,
                         [&](std::size_t r) { return bytes_of_part(own.within(regions[r], job.simulation.voxel_mm)); });
  };
  ++memory.figures.predictions;
  memory.figures.pieces += place.pieces.size();
  if (parts.from_another_path) {
    ++memory.figures.from_the_last;
    parts.last = std::exchange(memory.solved, {});
    parts.own_last = std::exchange(memory.own, {});
  } else {
    Swept swept = sweep_path_section(job, target.blank, path, place);
    parts.own_sweep = std::move(swept.own);
    parts.swept = whole_parts_of_crew(crew, swept.section);
  }
  Solved solved;
  std::uint64_t unsettled = 0;
  for (int round = 1;; ++round) {
    solved = solve_path_section(job, target, path, place, parts, progress);
    ++memory.figures.rounds;
    if (!in_rounds) break;
    std::vector<SolvedSection> all = solved_of_crew(solved.section);
    unsettled = solved_again(all);
    memory.figures.solved += round == 1 ? place.pieces.size() : unsettled;
    if (round == kMaxSectionRounds || (round > 1 && unsettled == 0)) {
      memory.division = division;
      memory.ranges = place.ranges;
      memory.solved = std::move(all);
      memory.own = std::move(solved.own);
      break;
    }
    parts.from_another_path = false;
    parts.before_last = std::exchange(parts.last, std::move(all));
    parts.own_before_last = std::exchange(parts.own_last, std::move(solved.own));
  }
  if (!in_rounds) memory.figures.solved += place.pieces.size();
  std::vector<SolvedSection> all = whole_parts_of_crew(crew, solved.section);
  Prediction out =
      merge_sections(job, target, removal::SurfaceMap(*target.map), program, each_of(parts.swept), each_of(all));
  out.cut.unsettled += unsettled;  // pieces that the last round has changed still
  return out;
}

}  // namespace camber::distribute
