#pragma once
// Numbers of a delimited text file by column, with the place of each row for messages.
#include <cstddef>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "machine/force_log.h"

namespace camber::calib {

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
