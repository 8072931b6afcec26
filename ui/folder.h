#pragma once
// The folder that camber ui serves: names in it, the jobs, their results.
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace camber::ui {

// The settings of a job's text, one a line, as a form shows them; and edits that leave every other line as it is. What
// a setting means and whether it is right, the commands say that read the job.

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

/// A request that names something that it may not, or that is not there.
struct Refused {
  int status = 403;
  std::string why;
};

/// Names of files are relative to the folder, with /.
class Folder {
 public:
  /// Throws InputError [file-missing] where there is no such folder.
  explicit Folder(const std::string& path);
  const std::string& path() const { return path_; }

  /// The file's path. Throws Refused: 403 where the name is none (absolute, with .., beginning with - in a part) or
  /// where it, links resolved, lies outside.
  std::string place(std::string_view name) const;
  /// The same of a file that is there; else Refused 404.
  std::string file(std::string_view name) const;
  /// Its text. Throws Refused: 413 above kMaxText_bytes.
  std::string text(std::string_view name) const;
  /// Writes a file that is whole or not there. Throws Refused, InputError [file-unwritable].
  void write(std::string_view name, std::string_view content) const;
  /// Makes a folder. Throws Refused.
  void make_folder(std::string_view name) const;
  /// A folder for what is not kept, made if it is not there: ".camber".
  std::string scratch() const;

  /// TOML files that name a program, down to kMaxDepth folders, in alphabetical order; links are not followed.
  std::vector<std::string> jobs() const;
  /// Files beside the job, without folders and hidden ones.
  std::vector<std::string> files_beside(std::string_view job) const;

  static constexpr std::size_t kMaxText_bytes = 1u << 30;
  static constexpr int kMaxDepth = 3;

 private:
  std::string path_;
};

/// Summary of a job from the lines of its text; the commands judge the values.
struct JobSummary {
  std::string name;                   ///< name of the job's file
  std::vector<std::string> programs;  ///< names in the folder
  std::string machine;                ///< name in the folder, or preset:NAME
  std::string units;                  ///< "mm", "inch" or empty
  std::vector<JobField> fields;
};
JobSummary job_summary(const Folder& folder, std::string_view job);

/// "finish/job.toml" has its results in "finish/job.results".
std::string results_of(std::string_view job);
/// "finish/job.toml" lies in "finish/"; empty: at the top.
std::string folder_of(std::string_view name);
/// A name as written in a job, seen from the served folder.
std::string beside(std::string_view job, std::string_view name);

/// The last part of what a browser calls a file; throws Refused 400 for one that is no name: with a control character,
/// hidden, beginning with a minus, of more than 120 bytes.
std::string upload_name(std::string_view given);

}  // namespace camber::ui
