#pragma once
// report.html: one self-contained page that opens without a network. Pictures are drawn by report/web.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "report/machine_view.h"
#include "report/path_rows.h"
#include "report/surface_samples.h"

namespace camber::report {

/// A row of the table of figures. `after` is missing where there is nothing to compare with.
struct Figure {
  std::string name;
  double before = 0;
  std::optional<double> after;
  std::string unit;
  int decimals = 1;
  /// Where summary.json or compensate's --json has it, "form_error_um.rms"; {} stands for before or after where
  /// both are shown ("{}_um.rms"). Empty: nowhere.
  std::string key;
  std::string key_after{};  ///< key of the second value where {} does not do; empty: as `key` says
};

/// Any table of text: a first row of names, then rows of as many cells. Shown in the order given.
struct TextTable {
  std::string title;
  std::vector<std::string> columns;  ///< empty: no head
  std::vector<std::vector<std::string>> rows;
  std::string note;  ///< below the table; empty: none
};

/// A drawing with a line about it, shown before the tables.
struct Picture {
  std::string title;
  std::string svg;
  std::string note;  ///< below it; empty: none
};

/// Whether the run reached what was asked for, and why not; at the page's head.
struct PageVerdict {
  bool success = false;
  std::string headline;
  std::vector<std::string> reasons;
};

struct ReportData {
  std::string title;
  std::string subtitle;  ///< e.g. the files that the page is about
  std::optional<PageVerdict> verdict;
  std::vector<Figure> figures;  ///< the first four are shown large
  SurfaceSamples surface;
  bool compared = false;                                ///< the surface's error_after_um and block_after count
  std::array<std::string, 2> names{"before", "after"};  ///< names of the two programs that are compared
  double voxel_mm = 0.1;                                ///< voxel of the grid that the surface's points lie on
  /// The stock around the machined surface, drawn in grey; on the lines of a grid of stock_cell_mm. Only places and
  /// normals count.
  SurfaceSamples stock;
  double stock_cell_mm = 0;
  SurfaceSamples measured{};  ///< points measured on a part, drawn over the surface; place, normal and error_um count
  std::vector<PathRun> path;  ///< none, one, or before and after
  /// Machine of a program with rotary motion: the page draws the tool and turns the part.
  std::optional<MachineView> machine{};
  std::vector<Picture> pictures{};
  std::vector<TextTable> tables;
  std::vector<std::string> warnings;
  std::vector<std::string> notes;
  /// File name under which the last run's program is offered; empty: not offered.
  std::string download_name;
};

struct ReportOptions {
  /// Above this many vertices, cells of the grid are taken together, each with its error of greatest magnitude; the
  /// page says so. Histogram and figures always hold all points.
  std::size_t max_vertices = 120000;
  /// Above this many rows a run, only those with the extremes of their neighbourhood are drawn; the page says so.
  std::size_t max_rows = 80000;
  /// Above this, deflated and both together, programs are left out, the one before first; the page says so.
  std::size_t max_program_bytes = 3'500'000;
};

/// The page's text, UTF-8. The same data give the same bytes. Does not throw.
std::string html_report(const ReportData& data, const ReportOptions& options = {});

/// Writes the page beside its place and renames it. Throws InputError [file-unwritable].
void write_html_report(const std::string& path, const ReportData& data, const ReportOptions& options = {});

// The numbers behind the page's pictures, packed for its script.

/// Contents of the script element, and notes on data that were left out.
struct PageData {
  std::string index;                  ///< JSON: what lies where in `arrays`, scales, names
  std::string arrays;                 ///< base64, see PackedArrays
  std::vector<std::string> programs;  ///< a run's text each, deflated, as base64; empty: left out
  std::vector<std::string> left_out;  ///< sentences
  double scale_um = 1;                ///< half of the colour scale before
  double scale_after_um = 1;          ///< and after
};

PageData page_data(const ReportData& data, const ReportOptions& options);

}  // namespace camber::report
