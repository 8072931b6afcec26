#pragma once
// The folder that camber ui serves: names in it, the jobs, their results.
#include <string>
#include <string_view>
#include <vector>

#include "ui/job_form.h"

namespace camber::ui {

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
