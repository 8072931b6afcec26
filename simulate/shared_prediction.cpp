#include "simulate/shared_prediction.h"

#include <cassert>
#include <cstdint>
#include <utility>

#include "simulate/sections.h"

namespace camber::simulate {
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

const Crew* the_crew = nullptr;

}  // namespace

CrewScope::CrewScope(const Crew& crew) {
  assert(!the_crew);
  the_crew = &crew;
}
CrewScope::~CrewScope() { the_crew = nullptr; }

const Crew* current_crew() { return the_crew; }

Prediction predict_together(const machine::Job& job, const Target& target, const SimulatedProgram& program,
                            const Crew& crew, const std::function<void(double)>& progress) {
  const removal::StampPath& path = program.path;
  const bool in_rounds = job.simulation.coupling == machine::Coupling::static_ && path_pieces(path).size() > 1;
  std::vector<removal::Region> regions;
  for (std::size_t r = 0; r < crew.size; ++r) regions.push_back(section_region(job, path, r, crew.size));

  SectionParts parts;
  Swept swept = sweep_path_section(job, target.blank, path, crew.rank, crew.size);
  parts.own_sweep = std::move(swept.own);
  parts.swept = whole_parts_of_crew(crew, swept.section);
  Solved solved;
  std::uint64_t unsettled = 0;
  for (int round = 1;; ++round) {
    solved = solve_path_section(job, target, path, parts,
                                {.section = crew.rank, .sections = crew.size, .turn_from = {}, .progress = progress});
    if (!in_rounds) break;
    std::vector<SolvedSection> all = parts_of_crew(crew, solved.section, [&](std::size_t r) {
      return bytes_of_part(solved.section.within(regions[r], job.simulation.voxel_mm));
    });
    unsettled = solved_again(all);
    if (round == kMaxSectionRounds || (round > 1 && unsettled == 0)) break;
    parts.before_last = std::exchange(parts.last, std::move(all));
    parts.own_before_last = std::exchange(parts.own_last, std::move(solved.own));
  }
  Prediction out = merge_sections(job, target, removal::SurfaceMap(*target.map), program, parts.swept,
                                  whole_parts_of_crew(crew, solved.section));
  out.cut.unsettled += unsettled;  // pieces that the last round has changed still
  return out;
}

}  // namespace camber::simulate
