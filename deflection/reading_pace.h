#pragma once
// Decides which tooth passings are read from the stock in static coupling. Where the cut changes slowly, the
// deflections of the others are extrapolated from those that were read.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "removal/tool_path.h"

namespace camber::deflection {

/// The deflection of a tooth passing that is not read lies between the mean of the last two readings and the straight
/// line through them: where that would have fitted the readings before best. The next reading shows
/// the error of the line, and so the number of passings that may be bridged: the error grows with its square. A
/// passing is always read where the tool begins to cut, where its motion changes, where a glance at the stock finds
/// more or less material than the line predicts, and where no equilibrium was found. Each tooth that differs from the
/// others has a line of its own.
class ReadingPace {
 public:
  static constexpr std::size_t kLongest = 8;

  /// `period`: number of teeth that differ from each other, 1 for uniform ones. `longest`: maximum number of turns of
  /// these teeth from reading to reading; 1 reads every passing.
  explicit ReadingPace(std::size_t period, std::size_t longest = kLongest) : longest_(longest), of_tooth_(period) {}

  /// True where the deflection may be extrapolated, as far as path and earlier readings show; in air every passing is
  /// read, which costs little, lest a glance miss the first material. Call it once for each passing, in order.
  bool may_follow(std::size_t passing, const removal::Stamp& stamp);
  /// True after two readings of the tooth; required by follow() and as_much_material().
  bool has_line(std::size_t passing) const;
  /// Writes the extrapolated deflection, a row of removal::DeflectionTable.
  void follow(std::size_t passing, std::span<float> row) const;
  /// True where the glance (removal::DeflectedEngager::glance) finds the material that the line predicts.
  bool as_much_material(std::size_t passing, double glance) const;

  struct Reading {
    double glance = 0;
    double error_um = 0;    ///< error of the extrapolated deflection, rms over the cut
    double allowed_um = 0;  ///< largest permitted error
    bool settled = true;
  };
  void was_read(std::size_t passing, const removal::Stamp& stamp, std::span<const float> row, const Reading& reading);

  /// Errors at the ends of the lines that bridged passings as planned (not cut short by more or less material).
  struct Errors {
    std::size_t count = 0;
    double sum2_um2 = 0, max_um = 0;
    double rms_um() const { return count == 0 ? 0.0 : std::sqrt(sum2_um2 / static_cast<double>(count)); }
    void add(const Errors& more) {
      count += more.count;
      sum2_um2 += more.sum2_um2;
      max_um = std::max(max_um, more.max_um);
    }
  };
  const Errors& errors() const { return errors_; }

 private:
  struct Tooth {
    std::size_t readings = 0;  ///< since the tool began to cut
    std::size_t last = 0, before = 0;
    std::vector<float> last_row, before_row;
    double last_glance = 0, before_glance = 0;
    double slope_fraction = 1;
    Vec3 feed_mm = Vec3::Zero();
    double way_to(std::size_t passing) const;
    void fit_slope(std::size_t passing, std::span<const float> row);
  };
  Tooth& tooth(std::size_t passing) { return of_tooth_[passing % of_tooth_.size()]; }
  const Tooth& tooth(std::size_t passing) const { return of_tooth_[passing % of_tooth_.size()]; }
  std::size_t next_gap(std::size_t turns, const Reading& reading) const;

  std::size_t longest_;
  std::size_t gap_ = 1;  ///< turns from reading to reading
  double error_um_ = 0;  ///< error at the last reading, or a larger one remembered from earlier readings
  std::vector<Tooth> of_tooth_;
  Errors errors_;
};

}  // namespace camber::deflection
