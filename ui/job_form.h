#pragma once
// The settings of a job's text, one a line, as a form shows them; and edits that leave every other line as it is. What
// a setting means and whether it is right, the commands say that read the job.
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace camber::ui {

/// A line "key = value  # comment", or a default that stands as a comment: "# key = value  # comment".
struct JobField {
  std::string table;  ///< "" at the top, "tool.3", "stock" ...
  std::string key;
  std::string value;        ///< as TOML writes it: with quotation marks, brackets; of several lines: with line ends
  std::string comment;      ///< behind it: source, unit, range
  std::string note;         ///< comment lines above it, since the setting before
  std::size_t line = 0;     ///< from 1
  bool is_default = false;  ///< stands as a comment: not set
  bool guessed = false;     ///< in the table's list `assumed`, or its comment says "typical" or CHECK, or a line of the
                            ///< note begins so
};

/// In the order of the text. The lists `assumed` are no fields. Text that is no TOML gives what can be made out.
std::vector<JobField> job_fields(std::string_view text);

struct JobEdit {
  enum class Kind { set, remove, confirm } kind = Kind::set;
  std::string table, key;
  std::string value{};  ///< value to set, as TOML writes it; without line ends
};

/// set: writes the value in its line, in place of the default that stands as a comment, or as a new line of its table,
/// which is added at the end where it is not there. remove: takes out the line. confirm: keeps the value. All three
/// take the key out of `assumed`, and the mark of a guess out of the line's comment.
std::string with_edits(std::string text, std::span<const JobEdit> edits);

/// The value of a key as text, without quotation marks; empty: not set. Of a list of texts the first.
std::string field_text(std::span<const JobField> fields, std::string_view table, std::string_view key);

/// All texts of a list, or the one that is no list.
std::vector<std::string> texts_of(std::string_view value);

}  // namespace camber::ui
