#pragma once
// Dynamometer logs: from the columns of a file to the forces of steady cuts.
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/geometry.h"
#include "deflection/steady_cut.h"
#include "machine/force_log.h"

namespace camber::calib {

/// A steady cut and its measured forces on the tool, in the frame of the cut (x feed, y left of it, z up).
struct MeasuredCut {
  std::string name;  ///< "log.csv:3", or with its time
  deflection::SteadyCut cut;
  double spindle_speed_rpm = 0;  ///< of waveforms: as found in the signal
  Vec3 mean_N = Vec3::Zero();    ///< components that were not measured are zero
  std::size_t turns = 0;         ///< averaged; 0: a row of a table of means
  /// Mean turn in equal steps of angle, from the cut's first sample on, and the same of every fourth turn, which the
  /// others leave out. Empty: only means.
  std::vector<Vec3> waveform_N, held_out_N;
  std::vector<double> samples;  ///< that each step of waveform_N averages
};

struct MeasuredLog {
  std::string path;
  machine::ForceLog how;
  std::array<bool, 3> has{};  ///< components that were measured
  std::vector<MeasuredCut> cuts;
};

/// Reads a log as its [force_log] says. Separators: comma, semicolon or tab, whichever the header has; a row of units
/// below the header is passed over.
///
/// Samples: a straight line through the idle ranges of each force is taken off (drift); means are over whole turns; for
/// waveforms the spindle's speed is sought within 1 % of the given one as the one at which the turns lie on each other
/// best, and the turns are averaged in up to 180 steps.
///
/// Errors: [file-missing], [trace-empty], [trace-column], [trace-fields], [trace-number], [trace-time], [force-log] (a
/// cut or an idle range without samples, shorter than two turns, too slowly sampled, a depth above the diameter).
/// Warning [force-drift] where samples come without idle_s.
MeasuredLog read_measured_log(const std::string& path, const machine::ForceLog& how, Diagnostics& diagnostics);

class ForceTable {
 public:
  /// Reads the header at `header_line` and all rows below. Separator: tab, semicolon or comma, the first that the
  /// header has. Throws InputError [file-missing], [trace-empty].
  ForceTable(const std::string& path, int header_line, Diagnostics& diagnostics);

  std::size_t rows() const { return rows_.size(); }
  std::size_t line(std::size_t row) const { return rows_[row].line; }
  const std::string& path() const { return source_.name(); }

  /// The column's values times its scale, or its constant for every row. Errors [trace-column], [trace-number],
  /// [trace-fields]; the values are not fit for use then. `key`: of [force_log], for the message.
  std::vector<double> values(const machine::LogQuantity& quantity, const char* key);

  void error_at_row(std::size_t row, std::string message, std::string check);

 private:
  struct Row {
    std::size_t line = 0;
    std::size_t offset = 0;  ///< of the line's first character
  };
  struct Field {
    std::string_view text;
    std::size_t offset = 0;
  };
  std::vector<Field> fields(std::size_t offset) const;
  std::size_t find_column(const machine::LogQuantity& quantity, const char* key);

  SourceText source_;
  Diagnostics& diagnostics_;
  char separator_ = ',';
  std::size_t header_offset_ = 0;
  std::vector<Row> rows_;
};

}  // namespace camber::calib
