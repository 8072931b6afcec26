#pragma once
// feed.csv: the predicted axes at every period of the control.
#include <span>
#include <string>

#include "base/output_file.h"
#include "feedmodel/timed_path.h"
#include "nc/move.h"

namespace camber::feedmodel {

/// Streams samples to a file that gets its name when it is whole. Columns: t_s,block,x_mm,y_mm,z_mm,
/// vx_mm_per_min,vy_mm_per_min,vz_mm_per_min,feed_cmd_mm_per_min,feed_mm_per_min; positions (to 0.01 um) and
/// speeds are the predicted actual axes, block the 1-based line being commanded.
class FeedCsv {
 public:
  /// Throws InputError [file-unwritable].
  FeedCsv(const nc::Interpretation& program, const std::string& path);
  void write(std::span<const TimedSample> samples);
  void commit() { file_.commit(); }

 private:
  const nc::Interpretation& program_;
  OutputFile file_;
  std::string text_;
};

}  // namespace camber::feedmodel
