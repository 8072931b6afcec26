#pragma once
// Axes and lines of a small plot.
#include <string>
#include <vector>

namespace camber::report {

/// A plot of fixed size with linear axes; `y_log`: the vertical one counts powers of ten.
class PlotFrame {
 public:
  PlotFrame(double x_least, double x_greatest, double y_least, double y_greatest, bool y_log = false);

  double x_px(double value) const;
  double y_px(double value) const;
  /// The opening tag, the marks and both names.
  std::string begin(const std::string& label, const std::string& x_name, const std::string& y_name) const;
  /// A line through values; NaN breaks it. What lies above the frame is drawn at its upper edge.
  std::string line(const std::vector<double>& x, const std::vector<double>& y, const char* colour) const;
  std::string dot(double x, double y, const char* colour, const std::string& title) const;
  static std::string end() { return "</svg>\n"; }

 private:
  struct Range {
    double least = 0, greatest = 1, step = 1;
  };
  static Range range_over(double least, double greatest);

  Range x_, y_;
  bool y_log_;
};

}  // namespace camber::report
