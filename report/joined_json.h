#pragma once
// JSON of a result that was joined from several.
#include <cstddef>
#include <string>
#include <vector>

namespace camber::report {

/// How the pieces of a path in sections were joined.
struct SectionFigures {
  std::size_t pieces = 0, rounds = 1;
  std::vector<std::size_t> solved_again{};  ///< pieces, of each round from the second on
  std::vector<double> largest_change_um{};  ///< largest change of the stock before a piece, likewise
};
/// summary.json of a prediction with them.
std::string with_sections(const std::string& json, const SectionFigures& figures);

/// JSON of all programs of a job from that of each: `programs`, a list with `program` and `output` first, and the sum
/// of their times. An empty text stands for a program without a result. `assumed`: of the job.
std::string join_results(const std::vector<std::string>& assumed, const std::vector<std::string>& programs,
                         const std::vector<std::string>& json, const std::vector<std::string>& places);

}  // namespace camber::report
