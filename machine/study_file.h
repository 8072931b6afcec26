#pragma once
// A study: one job, varied over a grid of its keys. Read from study.toml.
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"
#include "machine/toml_table.h"

namespace camber::machine {

enum class StudyCommand { predict, compensate, adapt };
inline constexpr std::array<std::string_view, 3> kStudyCommandWords{"predict", "compensate", "adapt"};

/// Key of the grid that is none of a job: all feeds of the program, in per cent of the programmed ones.
inline constexpr std::string_view kFeedPercentKey = "feed_percent";

/// A key of the job and the values that it takes.
struct StudyKey {
  std::string key;               ///< dotted: "tool.1.overhang_mm"
  std::vector<TomlNode> values;  ///< one or more; a table sets several keys together
  Diagnostic place;              ///< an error without a message where the values stand
};

struct Study {
  std::string path;
  std::string job;  ///< path of the job that is varied
  StudyCommand command = StudyCommand::predict;
  std::vector<std::string> figures;  ///< dotted paths of the command's JSON; empty: default ones
  std::vector<StudyKey> keys;        ///< in the order of the file
  TomlNode base;                     ///< table of the job's file

  std::size_t cases() const;
};

/// A combination of the values. The last key varies fastest.
struct StudyCase {
  std::vector<std::size_t> values;  ///< one per key of the study: index of its value
};
StudyCase study_case(const Study& study, std::size_t index);

/// A value as tables show it: texts without quotes.
std::string shown_value(const TomlNode& value);

/// Throws InputError where a file cannot be read; other problems go to `diagnostics`. `job` must be a TOML file; its
/// keys are not looked at.
Study read_study(const std::string& path, Diagnostics& diagnostics);

/// The job of a case, but for `feed_percent`. Paths are as they lie from `folder`; kNamesAlone: without folders.
inline constexpr const char* kNamesAlone = "*";
TomlNode study_job(const Study& study, const StudyCase& one, const std::string& folder);
/// The same with absolute paths.
std::vector<std::string> study_files(const Study& study, const StudyCase& one);
/// 100 where the study does not vary it.
double feed_percent(const Study& study, const StudyCase& one);

}  // namespace camber::machine
