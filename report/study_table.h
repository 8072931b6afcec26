#pragma once
// The table of a study: a row for each case, as CSV, JSON, text and a page.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace camber::report {

enum class StudyState {
  open,     ///< not computed yet
  done,     ///< exit status 0
  doubtful  ///< computed, but the numbers did not work out (exit status 3)
};
std::string_view to_string(StudyState state);

struct StudyRow {
  std::size_t number = 0;           ///< number of the case, from 1
  std::string hash;                 ///< checksum over all that the case depends on
  std::string folder;               ///< folder of its files, from the study's folder
  std::vector<std::string> values;  ///< one per key
  StudyState state = StudyState::open;
  std::vector<std::string> figures;  ///< one per figure: a number, a word, or nothing
};

struct StudyTable {
  std::string study, job, command;
  std::vector<std::string> keys, figures;
  std::vector<StudyRow> rows;

  std::size_t count(StudyState state) const;
};

/// Figures that a study shows unless it names others: dotted paths of the command's JSON.
std::vector<std::string> default_study_figures(std::string_view command);

/// Reads state and figures of a case from the JSON of its command. A number in a dotted path counts the members of a
/// list from 0, a word finds the member of that `name`. What is not there stays empty.
void read_figures(const std::string& json, const std::vector<std::string>& figures, StudyRow& row);

std::string study_csv(const StudyTable& table);
std::string study_json(const StudyTable& table);
/// For a terminal.
std::string study_text(const StudyTable& table);
/// UTF-8, self-contained but for links to the pages of the cases. The same data give the same bytes.
std::string study_page(const StudyTable& table);

}  // namespace camber::report
