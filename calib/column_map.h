#pragma once
// Column maps: columns and units of traces in other formats.
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"
#include "calib/trace.h"

namespace camber::calib {

/// Their tables in a map.
inline constexpr std::array<std::string_view, kQuantities> kQuantityKeys{"t",     "x_cmd", "y_cmd", "z_cmd", "x_act",
                                                                         "y_act", "z_act", "feed",  "line",  "a_cmd",
                                                                         "b_cmd", "c_cmd", "a_act", "b_act", "c_act"};

/// One column: value = (number in the file * scale + offset) in `unit`.
struct MappedColumn {
  std::string name;          ///< as the file's header or signal list has it; empty: by index
  std::size_t index = 0;     ///< 1-based, where there is no name
  double inside_factor = 1;  ///< of the unit: to s, mm, mm/s, degrees
  double scale = 1, offset = 0;
};

struct ColumnMap {
  std::string path;
  char separator = ',';  ///< ' ': any run of blanks
  bool decimal_comma = false;
  std::size_t skip_lines = 0;      ///< before the header, or before the first row
  bool header = true;              ///< a line of names follows them
  std::optional<double> period_s;  ///< instead of a time column: row k is at k times the period
  std::array<std::optional<MappedColumn>, kQuantities> column;
};

/// Reads a map:
///   separator = ";"            "," (default), ";", "tab", "blank"
///   decimal_comma = true
///   skip_lines = 3
///   header = false             columns by index alone
///   period_ms = 2              instead of [t]
///   [x_cmd]                    likewise t, y_cmd, z_cmd, x_act, y_act, z_act, feed, line, a_cmd .. c_act
///   name = "X set"             or index = 2
///   unit = "um"                time: s (default), ms, us, 100ns; positions: mm (default), um, nm, m, inch;
///                              feed: mm/min (default), mm/s, m/min, m/s, inch/min
///   scale = -1
///   offset = 0.5
/// Throws InputError with file:line:column; [map-position] where it names no position, [map-time] for neither or both
/// of [t] and period_ms (a container that has its own times needs neither), [map-column] for name and index together.
ColumnMap read_column_map(const std::string& path, Diagnostics& diagnostics);

/// Samples of one signal, at its own times.
struct Channel {
  std::vector<std::string> names;  ///< all that the file calls it
  std::vector<double> t_s, value;  ///< t_s ascending
};

/// The mapped channels as one trace, at the times of the position channel that has the most samples. Positions between
/// samples are interpolated, feed and line hold until the next; times before or after a channel's samples are left
/// out. Throws InputError [map-column] for names that are not there, [trace-empty]; warns [trace-gap].
ServoTrace trace_of(const std::string& path, const std::vector<Channel>& channels, const ColumnMap& map,
                    Diagnostics& diagnostics);

/// Lines of separated numbers. Cells that are empty or no number are no sample; lines without any number are left out.
std::vector<Channel> read_text_channels(const SourceText& source, const ColumnMap& map);

/// TwinCAT Scope CSV export: lines of a header, one that begins with Name and names the channels, rows of numbers, and
/// perhaps EOF. Each column named Name holds the times of the channels after it, in ms or in 100 ns since 1601.
/// Throws InputError [twincat-layout].
std::vector<Channel> read_twincat_channels(const SourceText& source, const ColumnMap& map);

/// Sinumerik trace XML (840D sl, 828D, ONE): traceData/dataFrame with dataSignal descriptions and rec rows, where a
/// missing attribute is no sample. Times are seconds. Throws InputError [sinumerik-xml].
std::vector<Channel> read_sinumerik_channels(const SourceText& source);

/// Recording of a Sinumerik Edge: JSON of Header and Payload, whose messages HFData are rows of the header's signals.
/// Times are the counter CYCLE times CycleTimeMs: rows may be missing. Throws InputError [sinumerik-edge].
std::vector<Channel> read_edge_channels(const SourceText& source);

/// Reads any of the four: XML begins with "<", JSON with "{", TwinCAT has a line that begins with Name, the rest are
/// lines of numbers.
ServoTrace read_mapped_trace(const std::string& path, const ColumnMap& map, Diagnostics& diagnostics);

}  // namespace camber::calib
