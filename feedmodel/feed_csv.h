#pragma once
// Writes feed.csv: the predicted axes at every period of the control.
#include <span>
#include <string>

#include "base/diagnostics.h"
#include "base/output_file.h"
#include "feedmodel/timed_path.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::feedmodel {

/// Streams samples to a file that is renamed when complete. Columns: t_s,block,x_mm,y_mm,z_mm,
/// vx_mm_per_min,vy_mm_per_min,vz_mm_per_min,feed_cmd_mm_per_min,feed_mm_per_min; positions (to 0.01 um) and
/// speeds are the predicted actual axes, block the 1-based line being commanded.
///
/// In programs with rotary motion X, Y and Z are those of the machine, feed_mm_per_min is what F counts in the block
/// (JointSample), and the columns go on with the rotary axes of the machine's chain, of a_deg,b_deg,c_deg (to 1e-5
/// degrees), and the actual pose in the program's frame, tip_x_mm,tip_y_mm,tip_z_mm (to 0.01 um),axis_x,axis_y,axis_z.
class FeedCsv {
 public:
  /// rotary_axes: letters of those that get columns, in the order a, b, c; empty without rotary motion. Throws
  /// Throws InputError [file-unwritable].
  FeedCsv(const nc::Interpretation& program, const std::string& path, const std::string& rotary_axes = {});
  void write(std::span<const TimedSample> samples);
  void write(std::span<const TimedSample> samples, std::span<const JointSample> joints);
  void commit() { file_.commit(); }

 private:
  void append(const TimedSample& sample, double feed_mm_per_s);
  void append(const JointSample& joints);

  const nc::Interpretation& program_;
  std::string rotary_axes_;
  OutputFile file_;
  std::string text_;
};

/// Checks the size of the file in advance: error [output-size] if it would not fit on the disk, a warning above some
/// gigabytes. `path`: of the file, which need not be there, nor its folder.
void check_feed_csv_size(const nc::Interpretation& program, const machine::Machine& machine, const std::string& path,
                         Diagnostics& diagnostics);
/// Does the same for motion of `time_s` at `period_s`, with `free_bytes` on the disk.
void check_feed_csv_size(double time_s, double period_s, double free_bytes, const std::string& path,
                         Diagnostics& diagnostics);

}  // namespace camber::feedmodel
