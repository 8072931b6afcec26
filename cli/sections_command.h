#pragma once
// camber predict --sections and camber merge.
#include <chrono>
#include <memory>
#include <string>

#include "api/commands/sections.h"
#include "cli/global_options.h"
#include "cli/progress.h"

namespace camber::cli {

struct SectionsArguments {
  std::string job;
  std::string output_folder;
  std::string json;           ///< copy of summary.json; empty: none
  std::size_t forces_at = 0;  ///< 0: none
  std::size_t sections = 1;
  std::size_t section = 0;  ///< from 1; 0: all of them, and the merge
  bool solve = false;       ///< stage of a single section; else sweep
  int round = 1;            ///< number of the solving round, from 1
};

int run_sections(const SectionsArguments& arguments, const GlobalOptions& options);

struct MergeArguments {
  std::string folder;
  std::string json;
  std::shared_ptr<simulate::ReadPrograms> programs{};  ///< see api::PredictRequest
};

/// Joins the parts, writes the folder of a prediction, and says what camber predict says.
int merge_and_write(const machine::Job& job, const distribute::PartKey& key, int round, distribute::PartStore& store,
                    const MergeArguments& arguments, const GlobalOptions& options,
                    std::chrono::steady_clock::time_point begin);
api::StepProgress section_steps(ProgressLine& progress);

int run_merge(const MergeArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
