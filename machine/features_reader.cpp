// [[feature]] of a job.
#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/units.h"
#include "machine/features.h"
#include "machine/measured_table.h"
#include "machine/number_key.h"

namespace camber::machine {
namespace {

constexpr NumberRange kPointCount{.min = 1, .max = 100000, .whole = true};
constexpr NumberRange kFeatureTool{.min = 0, .max = 99999999, .whole = true};
constexpr NumberRange kArcDeg{.min = -360, .max = 720};

constexpr std::array kModelErrorKeys{
    NumberKey<ModelError>{"deflection_percent", &ModelError::deflection, kNotNegative, kAsPercent},
    NumberKey<ModelError>{"contour_percent", &ModelError::contour, kNotNegative, kAsPercent},
    NumberKey<ModelError>{"size_um", &ModelError::size_mm, kNotNegative, kMicrometres},
};

bool round(FeatureKind kind) { return kind == FeatureKind::bore || kind == FeatureKind::boss; }

Vec3 vec3(const std::vector<double>& row) { return {row[0], row[1], row[2]}; }

void read_axis(TomlTable& table, Feature& f) {
  constexpr std::string_view kWanted = "[[x, y, z], [x, y, z]], two points,";
  const auto rows = table.number_rows("axis_mm", 2, 3, kAnyNumber, kWanted);
  if (rows) f.axis_mm = {vec3((*rows)[0]), vec3((*rows)[1])};
  if (rows && (f.axis_mm[1] - f.axis_mm[0]).norm() < 1e-6)
    table.error_at("axis_mm", "the two points of axis_mm are the same; two different points were expected",
                   "feature-axis");
  if (!table.has("axis_mm") && f.kind != FeatureKind::points && !table.has("of")) table.missing("axis_mm", kWanted);
}

void read_pair(TomlTable& table, Feature& f) {
  constexpr std::string_view kWanted = "the names of two other features";
  const auto names = table.text_list("of", kWanted);
  if (!names) return;
  if (f.kind != FeatureKind::distance)
    return table.error_at_name("of", "of belongs to kind = \"distance\" alone", "key-unused");
  if (names->size() != 2)
    return table.error_at("of", fmt::format("of has {} names; {} were expected", names->size(), kWanted),
                          "value-count");
  f.of = {(*names)[0], (*names)[1]};
}

void read_points(TomlTable& table, Feature& f) {
  constexpr std::string_view kWanted = "points of the surface, as in [[x, y, z], [x, y, z]],";
  const auto rows = table.number_rows("points_mm", 0, 3, kAnyNumber, kWanted);
  for (const auto& row : rows.value_or(std::vector<std::vector<double>>{})) f.points_mm.push_back(vec3(row));
  const bool wanted = f.kind == FeatureKind::points;
  if (wanted && !table.has("points_mm")) table.missing("points_mm", kWanted);
  if (!wanted && table.has("points_mm"))
    table.error_at_name("points_mm", "points_mm belongs to kind = \"points\" alone", "key-unused");
}

void read_tolerance(TomlTable& table, Feature& f) {
  const auto tol = table.numbers("tol_mm", 2, kAnyNumber, "[lower, upper], deviations from nominal_mm,");
  if (!tol) return;
  f.tol_mm = {(*tol)[0], (*tol)[1]};
  if ((*tol)[0] >= (*tol)[1])
    table.error_at(
        "tol_mm",
        fmt::format("tol_mm = [{:g}, {:g}]; the lower limit must be below the upper one", (*tol)[0], (*tol)[1]),
        "value-range");
}

void read_arc(TomlTable& table, Feature& f) {
  const auto arc = table.numbers("arc_deg", 2, kArcDeg, "[from, to], counter-clockwise from +X,");
  if (!arc) return;
  f.arc_rad = {rad_from_deg((*arc)[0]), rad_from_deg((*arc)[1])};
  if (!round(f.kind)) table.error_at_name("arc_deg", "arc_deg belongs to kinds \"bore\" and \"boss\"", "key-unused");
  if ((*arc)[0] >= (*arc)[1] || (*arc)[1] - (*arc)[0] > 360)
    table.error_at(
        "arc_deg",
        fmt::format("arc_deg = [{:g}, {:g}]; angles that ascend, by 360 at most, were expected", (*arc)[0], (*arc)[1]),
        "value-range");
}

void read_filter(TomlTable& table, Feature& f) {
  f.filter = static_cast<FeatureFilter>(table.choice("filter", kFeatureFilterWords, 0));
  const bool of_circles = f.filter == FeatureFilter::max_inscribed || f.filter == FeatureFilter::min_circumscribed;
  if (of_circles && !round(f.kind))
    table.error_at("filter",
                   fmt::format("filter = \"{}\" is for kinds \"bore\" and \"boss\"; \"least_squares\" or \"min_zone\" "
                               "was expected",
                               kFeatureFilterWords[static_cast<std::size_t>(f.filter)]),
                   "feature-filter");
}

/// measured_mm = [...], measured = "table.csv" with perhaps measured_columns = "map.toml".
void read_measured(TomlTable& table, const std::filesystem::path& folder, Feature& f, Diagnostics& diagnostics) {
  for (const double v : table.number_list("measured_mm", kAnyNumber, "measured values, as in [3.996, 3.998],")
                            .value_or(std::vector<double>{})) {
    f.measured_mm.push_back(v);
    f.measured.push_back({.feature = f.name, .part = {}, .date = {}, .value_mm = v});
  }
  const std::string given = table.text("measured", ""), columns = table.text("measured_columns", "");
  if (given.empty()) return;
  const auto resolved = [&](const std::string& p) { return (folder / p).lexically_normal().string(); };
  std::error_code ec;
  for (const auto& [key, path] : {std::pair{"measured", given}, std::pair{"measured_columns", columns}})
    if (!path.empty() && !std::filesystem::is_regular_file(resolved(path), ec))
      return table.error_at(
          key, fmt::format("{}: no such file: {} (paths are relative to the job's folder)", key, resolved(path)),
          "file-missing");
  std::vector<MeasuredValue> values =
      read_measured_table(resolved(given), columns.empty() ? columns : resolved(columns), diagnostics);
  for (MeasuredValue& v : values)
    if (v.feature == f.name) f.measured.push_back(std::move(v));
  if (f.measured.empty() && !values.empty())
    table.warning_at("measured", fmt::format("{} has no value of \"{}\"", resolved(given), f.name),
                     "feature-unmeasured");
}

Feature read_feature(TomlTable& table, const std::filesystem::path& folder, Diagnostics& diagnostics) {
  Feature f;
  f.name = table.required_text("name");
  if (const auto kind = table.required_choice("kind", kFeatureKindWords)) f.kind = static_cast<FeatureKind>(*kind);
  read_axis(table, f);
  read_pair(table, f);
  read_points(table, f);
  if (f.kind == FeatureKind::points || f.kind == FeatureKind::plane)
    f.nominal_mm = table.number("nominal_mm", kAnyNumber, (f.axis_mm[1] - f.axis_mm[0]).norm());
  else
    f.nominal_mm = table.required_number("nominal_mm", kPositive);
  read_tolerance(table, f);
  f.depth_mm = table.optional_number("depth_mm", kNotNegative);
  read_arc(table, f);
  f.extent_mm = table.number("extent_mm", kPositive, 0);
  f.points = static_cast<int>(table.number("points", kPointCount, 0));
  read_filter(table, f);
  if (const auto tool = table.optional_number("tool", kFeatureTool)) f.tool = static_cast<int>(*tool);
  f.align = table.boolean("align", false);
  read_measured(table, folder, f, diagnostics);
  return f;
}

void check_names(std::vector<TomlTable>& tables, const std::vector<Feature>& features) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < features.size(); ++i)
    if (!features[i].name.empty() && !names.insert(features[i].name).second)
      tables[i].error_at("name",
                         fmt::format("two features are called \"{}\"; different names were expected", features[i].name),
                         "feature-name");
  for (std::size_t i = 0; i < features.size(); ++i)
    for (const std::string& other : features[i].of)
      if (!other.empty() && (!names.contains(other) || other == features[i].name))
        tables[i].error_at("of", fmt::format("of names \"{}\", which is no other feature of the job", other),
                           "feature-name");
}

std::string point_text(const Vec3& p) {
  return fmt::format("[{}, {}, {}]", toml_number(p.x(), kAsIs), toml_number(p.y(), kAsIs), toml_number(p.z(), kAsIs));
}

std::string list_text(const std::vector<std::string>& items) { return fmt::format("[{}]", fmt::join(items, ", ")); }

std::string numbers_text(std::string_view key, const std::array<double, 2>& pair, const FileUnit& unit) {
  return fmt::format("{} = [{}, {}]\n", key, toml_number(pair[0], unit), toml_number(pair[1], unit));
}

std::string feature_text(const Feature& f) {
  std::string out = "\n[[feature]]\n" + toml_line("name", f.name);
  out += toml_line("kind", kFeatureKindWords[static_cast<std::size_t>(f.kind)]);
  if (!f.of[0].empty())
    out += fmt::format("of = {}\n", list_text({toml_text(f.of[0]), toml_text(f.of[1])}));
  else if (f.kind != FeatureKind::points)
    out += fmt::format("axis_mm = {}\n", list_text({point_text(f.axis_mm[0]), point_text(f.axis_mm[1])}));
  std::vector<std::string> points, values;
  for (const Vec3& p : f.points_mm) points.push_back(point_text(p));
  if (!points.empty()) out += fmt::format("points_mm = {}\n", list_text(points));
  out += toml_line("nominal_mm", f.nominal_mm, kAsIs);
  if (f.tol_mm) out += numbers_text("tol_mm", *f.tol_mm, kAsIs);
  if (f.depth_mm) out += toml_line("depth_mm", *f.depth_mm, kAsIs);
  if (f.arc_rad) out += numbers_text("arc_deg", *f.arc_rad, kDegrees);
  if (f.extent_mm > 0) out += toml_line("extent_mm", f.extent_mm, kAsIs);
  if (f.points > 0) out += toml_line("points", f.points, kAsIs);
  out += toml_line("filter", kFeatureFilterWords[static_cast<std::size_t>(f.filter)]);
  if (f.tool) out += toml_line("tool", *f.tool, kAsIs);
  if (f.align) out += "align = true\n";
  for (const MeasuredValue& v : f.measured) values.push_back(toml_number(v.value_mm, kAsIs));
  return values.empty() ? out : out + fmt::format("measured_mm = {}\n", list_text(values));
}

}  // namespace

double Feature::size_per_diameter() const {
  switch (kind) {
    case FeatureKind::bore:
    case FeatureKind::slot_width:
      return 1;
    case FeatureKind::boss:
    case FeatureKind::wall:
      return -1;
    case FeatureKind::plane:  // a side follows the radius, a bottom does not
      return -0.5 * (axis_mm[1] - axis_mm[0]).normalized().head<2>().norm();
    case FeatureKind::distance:
    case FeatureKind::points:
      break;
  }
  return 0;
}

std::vector<Feature> read_features(TomlTable& top, const std::filesystem::path& folder) {
  std::vector<TomlTable> tables = top.tables("feature");
  std::vector<Feature> out;
  Diagnostics of_tables;
  for (TomlTable& table : tables) {
    out.push_back(read_feature(table, folder, of_tables));
    table.finish();
  }
  of_tables.throw_if_errors();
  check_names(tables, out);
  return out;
}

std::optional<double> measured_mean_mm(const Feature& feature, const std::string& part) {
  double sum = 0;
  int count = 0;
  for (const MeasuredValue& v : feature.measured)
    if (part.empty() || v.part == part) sum += v.value_mm, ++count;
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

std::optional<ModelError> read_model_error(TomlTable& top) {
  auto table = top.table("model_error");
  if (!table) return std::nullopt;
  ModelError out;
  read_numbers<ModelError>(*table, kModelErrorKeys, out);
  table->finish();
  return out;
}

std::string features_text(const std::vector<Feature>& features, const std::optional<ModelError>& error) {
  std::string out;
  if (error) out = "\n[model_error]\n" + toml_lines<ModelError>(kModelErrorKeys, *error);
  for (const Feature& f : features) out += feature_text(f);
  return out;
}

}  // namespace camber::machine
