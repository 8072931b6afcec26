// Tool databases of Vectric: .vtdb, SQLite.
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>

#include <fmt/format.h>
#include <sqlite3.h>

#include "base/folders.h"
#include "base/units.h"
#include "machine/job_keys.h"
#include "machine/library_words.h"

namespace camber::machine {
namespace {

/// The meanings of tool_type on which independent readers agree; 4 and 12 are from a vendor's own database.
constexpr std::array<std::string_view, 13> kKinds{
    "ball",        "flat",      "bull",      "vbit", "engraving", "tapered ball", "drill",
    "thread mill", "form tool", "drag tool", "",     "",          "laser"};

struct CloseDatabase {
  void operator()(sqlite3* db) const { sqlite3_close(db); }
};
struct CloseStatement {
  void operator()(sqlite3_stmt* s) const { sqlite3_finalize(s); }
};

class Database {
 public:
  explicit Database(const std::string& path) : path_(path) {
    require_confined(path);
    std::error_code ec;
    if (!std::filesystem::exists(path, ec)) fail_on_file(path, "no such file", "file-missing");
    // Immutable: nothing is written beside the file, not even for a database that its program has open.
    sqlite3* db = nullptr;
    const int opened = sqlite3_open_v2(uri(path).c_str(), &db, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    db_.reset(db);
    if (opened != SQLITE_OK) fail(sqlite3_errmsg(db));
  }

  [[noreturn]] void fail(const std::string& what) const {
    fail_on_file(path_, fmt::format("{}; a tool database of Vectric (.vtdb) was expected", what), "tool-library");
  }

  std::unique_ptr<sqlite3_stmt, CloseStatement> query(const std::string& sql) const {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(db_.get(), sql.c_str(), -1, &statement, nullptr) != SQLITE_OK)
      fail(sqlite3_errmsg(db_.get()));
    return std::unique_ptr<sqlite3_stmt, CloseStatement>(statement);
  }

  /// Steps to the next row; false at the end.
  bool step(sqlite3_stmt* statement) const {
    const int result = sqlite3_step(statement);
    if (result != SQLITE_ROW && result != SQLITE_DONE) fail(sqlite3_errmsg(db_.get()));
    return result == SQLITE_ROW;
  }

  std::set<std::string> columns(const std::string& table) const {
    std::set<std::string> out;
    for (const auto rows = query(fmt::format("PRAGMA table_info({})", table)); step(rows.get());)
      out.insert(reinterpret_cast<const char*>(sqlite3_column_text(rows.get(), 1)));
    return out;
  }

 private:
  static std::string uri(const std::string& path) {
    std::string out = "file:";
    for (const char c : path)
      out += std::isalnum(static_cast<unsigned char>(c)) || c == '/' || c == '.' || c == '_' || c == '-'
                 ? std::string(1, c)
                 : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    return out + "?immutable=1";
  }

  std::string path_;
  std::unique_ptr<sqlite3, CloseDatabase> db_;
};

/// A column of the geometry; NULL in databases of versions that do not have it yet.
std::string geometry(const std::set<std::string>& columns, const std::string& name) {
  return columns.contains(name) ? "g." + name : "NULL";
}

std::optional<double> number_at(sqlite3_stmt* row, int column) {
  const int type = sqlite3_column_type(row, column);
  if (type != SQLITE_INTEGER && type != SQLITE_FLOAT) return std::nullopt;
  return sqlite3_column_double(row, column);
}

std::optional<double> size_at(sqlite3_stmt* row, int column, double unit) {
  const auto value = number_at(row, column);
  return value && *value > 0 ? std::optional(*value * unit) : std::nullopt;
}

std::string text_at(sqlite3_stmt* row, int column) {
  const auto* text = sqlite3_column_text(row, column);
  return text ? reinterpret_cast<const char*>(text) : "";
}

enum Column { type, units, diameter, angle, flat, flutes, flute_length, tip_radius, format, name, number };

ToolProposal tool_of(const Database& database, sqlite3_stmt* row, const std::string& from) {
  ToolProposal tool;
  tool.from = from;
  tool.what = text_at(row, name).empty() ? text_at(row, format) : text_at(row, name);
  const double word = number_at(row, type).value_or(-1), unit_word = number_at(row, units).value_or(-1);
  if (word < 0 || word != std::floor(word))
    database.fail(
        fmt::format("\"{}\" has tool_type {}, where a whole number should be", tool.what, text_at(row, type)));
  if (unit_word != 0 && unit_word != 1)
    database.fail(
        fmt::format("\"{}\" has units {}, where 0 (mm) or 1 (inch) should be", tool.what, text_at(row, units)));
  const double unit = unit_word == 1 ? kMmPerInch : 1;
  tool.kind = word < static_cast<double>(kKinds.size()) ? kKinds[static_cast<std::size_t>(word)] : "";
  if (tool.kind.empty()) tool.kind = fmt::format("tool of type {}", word);
  set_type_by_kind(tool);
  tool.diameter_mm = size_at(row, diameter, unit);
  tool.flute_length_mm = size_at(row, flute_length, unit);
  if (const auto count = number_at(row, flutes); count && *count >= 1)
    tool.flutes = static_cast<int>(std::min(*count, 1e6));
  if (tool.kind == "bull") tool.corner_radius_mm = size_at(row, tip_radius, unit);
  if (tool.kind == "drill" || is_conical(tool.kind)) tool.point_angle_deg = size_at(row, angle, 1);
  if (is_conical(tool.kind)) tool.tip_diameter_mm = size_at(row, flat, unit);
  if (tool.kind == "tapered ball") {
    if (const auto full = size_at(row, angle, 1)) tool.taper_deg = *full / 2;
    if (const auto radius = size_at(row, tip_radius, unit)) tool.diameter_mm = 2 * *radius;  // of the ball
  }
  if (const auto t = number_at(row, number); t && kToolNumber.holds(*t)) tool.number = static_cast<int>(*t);
  return tool;
}

}  // namespace

std::vector<ToolProposal> read_vectric_library(const std::string& path) {
  const Database database(path);
  const std::set<std::string> columns = database.columns("tool_geometry");
  if (columns.empty()) database.fail("there is no table tool_geometry");
  const bool numbered = database.columns("tool_cutting_data").contains("tool_number");
  const std::string number_query =
      numbered ? "(SELECT c.tool_number FROM tool_entity e JOIN tool_cutting_data c ON c.id = e.tool_cutting_data_id "
                 "WHERE e.tool_geometry_id = g.id AND c.tool_number IS NOT NULL ORDER BY e.rowid LIMIT 1)"
               : "NULL";
  const std::string name_query = database.columns("tool_tree_entry").contains("name")
                                     ? "(SELECT t.name FROM tool_tree_entry t WHERE t.tool_geometry_id = g.id LIMIT 1)"
                                     : "NULL";
  const auto rows = database.query(
      fmt::format("SELECT {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {} FROM tool_geometry g ORDER BY g.rowid",
                  geometry(columns, "tool_type"), geometry(columns, "units"), geometry(columns, "diameter"),
                  geometry(columns, "included_angle"), geometry(columns, "flat_diameter"),
                  geometry(columns, "num_flutes"), geometry(columns, "flute_length"), geometry(columns, "tip_radius"),
                  geometry(columns, "name_format"), name_query, number_query));
  std::vector<ToolProposal> out;
  while (database.step(rows.get()))
    out.push_back(tool_of(database, rows.get(), fmt::format("{}, tool {}", path, out.size() + 1)));
  return out;
}

}  // namespace camber::machine
