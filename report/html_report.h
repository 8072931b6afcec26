#pragma once
// report.html: one self-contained page that opens without a network.
#include <optional>
#include <string>
#include <vector>

namespace camber::report {

/// A row of the table of figures. `after` is missing where there is nothing to compare with.
struct Figure {
  std::string name;
  double before = 0;
  std::optional<double> after;
  std::string unit;
  int decimals = 1;
};

/// A point of the machined surface, mm, with its unit normal and its form error.
struct SurfaceSample {
  double x = 0, y = 0, z = 0;
  double nx = 0, ny = 0, nz = 1;
  double error_um = 0;  ///< positive: material is left
  double area_mm2 = 1;  ///< weight in the histogram
};

struct FeedSample {
  double t_s = 0;
  double feed_command_mm_per_min = 0;
  double feed_mm_per_min = 0;
};

/// One round of the compensation; round 0 is the program as given.
struct RoundRow {
  int round = 0;
  double p95_um = 0, rms_um = 0, min_um = 0, max_um = 0;
  double largest_shift_um = 0;
};

struct ReportData {
  std::string title;
  std::string subtitle;         ///< e.g. the files that the page is about
  std::vector<Figure> figures;  ///< the first four are shown large
  std::vector<SurfaceSample> before;
  std::vector<SurfaceSample> after;    ///< empty: one map only. At the points of `before` in their order, or at others.
  std::vector<FeedSample> feed;        ///< in time order; empty: no plot
  std::vector<FeedSample> feed_after;  ///< of the compensated program; empty: none
  std::vector<RoundRow> rounds;        ///< empty: no table
  std::vector<std::string> notes;      ///< warnings and what could not be done
};

struct ReportOptions {
  /// Above this, of each run of neighbouring points only the first and those with the least and the greatest error
  /// are drawn; the page says so. The histogram always holds all points.
  std::size_t most_points = 120000;
  /// Above this, of each run of samples only the slowest and the fastest are drawn.
  std::size_t most_feed_samples = 40000;
};

/// The page's text, UTF-8. The same data give the same bytes. Does not throw.
std::string html_report(const ReportData& data, const ReportOptions& options = {});

/// Writes the page beside its place and renames it. Throws InputError [file-unwritable].
void write_html_report(const std::string& path, const ReportData& data, const ReportOptions& options = {});

}  // namespace camber::report
