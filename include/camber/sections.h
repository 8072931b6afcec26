#pragma once
// A prediction in sections of the path, for several processes or machines: camber predict --sections and camber merge.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "camber/diagnostics.h"
#include "camber/predict.h"
#include "camber/run.h"

namespace camber {
inline namespace v0 {

struct SectionOptions {
  std::size_t sections = 1;   ///< number of sections of the path
  std::size_t section = 1;    ///< which one is computed, 1 ... sections
  bool solve = false;         ///< all sections are swept first, then solved
  int round = 1;              ///< number of the solving round, in static coupling
  std::size_t forces_at = 0;  ///< see PredictOptions
};

struct SectionResult {
  std::string part{};     ///< file that the others, and merge(), read; empty: rigid coupling has one round
  bool has_round = true;  ///< false: rigid coupling has one round, and nothing was done
  bool computed = false;  ///< false: it was there, whole and of this job
  std::int64_t stamps = 0, voxels = 0;    ///< work of this call: tooth passings, and voxels of the parts
  std::int64_t solved_again = 0;          ///< pieces that this round has solved again; 0: the section has settled
  std::vector<Diagnostic> diagnostics{};  ///< warnings
};

/// Computes one part of a prediction and writes it to FOLDER/parts, unless it is there. The job is read from its file:
/// parts know it by a hash of all files that it reads. Throws InputError, Cancelled; std::invalid_argument for a
/// section or round that there is not.
CAMBER_API SectionResult predict_section(const std::string& job_path, const std::string& folder,
                                         const SectionOptions& options, const RunOptions& run = {});

/// Computes all sections one after the other, and joins them in options.output_folder: a prediction of a path that is
/// too long for the memory. No trace, no meshes. Throws as predict_section() and merge().
CAMBER_API PredictResult predict_in_sections(const std::string& job_path, std::size_t sections,
                                             const PredictOptions& options, const RunOptions& run = {});

/// See PredictOptions.
struct MergeOptions {
  bool rows = true;
  bool throw_if_unwritten = true;
};

/// Joins all parts in a folder, of the last round, and writes the files of a prediction beside them. Throws InputError
/// where a part is missing, torn, or of another version or job; nothing is written then.
CAMBER_API PredictResult merge(const std::string& folder, const MergeOptions& options, const RunOptions& run = {});
CAMBER_API PredictResult merge(const std::string& folder, const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
