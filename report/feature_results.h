#pragma once
// Features of a part in every form in which a command shows them: JSON, text, page, features.csv.
#include <span>
#include <string>
#include <vector>

#include "inspect/evaluate.h"
#include "machine/job_file.h"
#include "report/html_report.h"

namespace camber::report {

/// The job's features on a predicted surface, with the band of inspect::model_error_of. Empty: the job has none.
std::vector<inspect::FeatureResult> features_of(const machine::Job& job,
                                                std::span<const removal::SurfacePoint> surface);

/// A list of features under a key of the JSON.
struct NamedFeatures {
  std::string key;  ///< "features"
  std::span<const inspect::FeatureResult> results;
};
/// JSON of a command, with the lists as its last members; lists without features are left out.
std::string with_features(std::string json, std::initializer_list<NamedFeatures> lists);

/// A table for a terminal; empty without features.
std::string features_text(std::span<const inspect::FeatureResult> results);
/// The same before and after a compensation.
std::string features_text(std::span<const inspect::FeatureResult> before,
                          std::span<const inspect::FeatureResult> after);

/// Tables and pictures of the page: deviations of the readings, 1 um as 1 mm (x 1000) while they fit.
void add_features(ReportData& data, std::span<const inspect::FeatureResult> results, const std::string& title);

/// features.csv. A file of that name that is none of ours is not overwritten. Throws InputError [file-unwritable].
void write_features_csv(const std::string& path, const std::vector<inspect::FeatureResult>& results);

}  // namespace camber::report
