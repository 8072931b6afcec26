#pragma once
// Tables of measured values: CSV with a column map, and QIF 2 results.
#include <string>
#include <vector>

#include "machine/features.h"

namespace camber::machine {

/// Columns of a CSV by the names in its header.
struct MeasuredColumns {
  std::string feature = "feature", part = "part", date = "date", value = "value_mm";
  std::string nominal = "nominal_mm", lower = "lower_mm", upper = "upper_mm";  ///< used where the header has them
  char separator = 0;      ///< 0: a semicolon or a tab where the header has one, else a comma
  double mm_per_unit = 1;  ///< unit of value, nominal and limits
};

/// Rows of a CSV; lines that begin with # are comments. `feature` and `value` must be there; a row without a value
/// (nothing, dashes, n/a) is left out: a feature that was not measured is no zero. Decimal points or commas. Throws
/// InputError with file:line:column [measured-table].
std::vector<MeasuredValue> read_measured_csv(const std::string& path, const MeasuredColumns& columns);

/// A column map: `feature = "Feature name"`, likewise part, date, value, nominal, lower, upper; `separator`; `unit` =
/// "mm", "um" or "inch". Throws InputError.
MeasuredColumns read_measured_columns(const std::string& path, Diagnostics& diagnostics);

/// Every measured size and distance of a QIF 2 results file, in the order of the file: a ...CharacteristicActual with a
/// value, its item, that one's nominal, and that one's definition. Characteristics without a measured value make no
/// row. Angles are left out. Values are millimetres unless FileUnits names inches.
/// Source: ANSI QIF 2.1 (2016), part 6 (results); ids as in its schema.
/// Throws InputError [qif-results], with what was expected.
std::vector<MeasuredValue> read_qif(const std::string& path);

/// By the name's end: .qif, else CSV. `columns`: a column map of the CSV; empty: the names above.
std::vector<MeasuredValue> read_measured_table(const std::string& path, const std::string& columns,
                                               Diagnostics& diagnostics);

}  // namespace camber::machine
