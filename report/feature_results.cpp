#include "report/feature_results.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "base/json.h"
#include "base/output_file.h"
#include "inspect/evaluate.h"
#include "report/page_tables.h"

namespace camber::report {
namespace {

using inspect::FeatureResult;

Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

std::string_view kind_word(const FeatureResult& r) {
  return machine::kFeatureKindWords[static_cast<std::size_t>(r.kind)];
}

Json feature_json(const FeatureResult& r) {
  const auto within = r.within();
  Json out{{"feature", r.feature},
           {"kind", kind_word(r)},
           {"nominal_mm", r.nominal_mm},
           {"predicted_mm", number(r.predicted_mm)},
           {"std_mm", number(r.std_mm)},
           {"measured_mm", number(r.measured_mm)},
           {"difference_um", number(r.difference_um())},
           {"form_um", number(r.form_um)},
           {"taper_um", number(r.taper_um)},
           {"lower_mm", number(r.lower_mm)},
           {"upper_mm", number(r.upper_mm)},
           {"within", within ? Json(*within) : Json(nullptr)},
           {"commanded_mm", number(r.commanded_mm)},
           {"contour_um", r.predicted_mm ? Json(r.contour_um) : Json(nullptr)},
           {"deflection_um", r.predicted_mm ? Json(r.deflection_um) : Json(nullptr)},
           {"roundness_um", number(r.roundness_um)},
           {"straightness_um", number(r.straightness_um)},
           {"position_um", Json(nullptr)},
           {"readings", r.readings},
           {"missed", r.missed},
           {"reason", r.reason}};
  if (r.position_um) out["position_um"] = Json::array({r.position_um->x(), r.position_um->y(), r.position_um->z()});
  return out;
}

std::string shown(const std::optional<double>& value, int width, int decimals) {
  return value ? fmt::format("{:>{}.{}f}", *value, width, decimals) : fmt::format("{:>{}}", "-", width);
}

std::string verdict_of(const FeatureResult& r) {
  if (!r.predicted_mm) return r.reason;
  const auto within = r.within();
  return !within ? "" : *within ? "within" : "out of tolerance";
}

constexpr std::size_t kNameWidth = 16;
std::string short_name(const FeatureResult& r) { return r.feature.substr(0, kNameWidth); }

// --- picture

constexpr double kPixelsPerMm = 96 / 25.4;  // CSS: deviations of 1 um drawn 1 mm long
constexpr double kBase_mm = 12, kRoom_mm = 9;
constexpr double kCell = 2 * (kBase_mm + kRoom_mm) * kPixelsPerMm;
constexpr int kPerRow = 4;

/// 1000, or the power of ten below at which the deviations of all features fit.
double magnification(std::span<const FeatureResult> results) {
  double most_um = 0;
  for (const FeatureResult& r : results)
    for (const double d : r.deviations_um) most_um = std::max(most_um, std::abs(d));
  double out = 1000;
  while (most_um / 1000 * out > kRoom_mm) out /= 10;
  return out;
}

/// The readings about a circle (bores, bosses), or along a line.
std::string drawn(const FeatureResult& r, double x, double y, double scale) {
  const bool round = r.kind == machine::FeatureKind::bore || r.kind == machine::FeatureKind::boss;
  const double cx = x + kCell / 2, cy = y + kCell / 2, base = kBase_mm * kPixelsPerMm;
  std::string out =
      round ? fmt::format(
                  "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"none\" "
                  "stroke=\"#9aa5b1\"/>\n",
                  cx, cy, base)
            : fmt::format("<path stroke=\"#9aa5b1\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>\n", cx - base, cy, cx + base);
  const std::size_t n = r.deviations_um.size();
  out += "<path fill=\"none\" stroke=\"#1668b8\" d=\"";
  for (std::size_t i = 0; i < n; ++i) {
    const double off = r.deviations_um[i] / 1000 * scale * kPixelsPerMm;
    const double part = n > 1 ? static_cast<double>(i) / static_cast<double>(round ? n : n - 1) : 0;
    const double a = 2 * kPi * part;
    const double px = round ? cx + (base + off) * std::cos(a) : cx - base + 2 * base * part;
    const double py = round ? cy - (base + off) * std::sin(a) : cy - off;
    fmt::format_to(std::back_inserter(out), "{}{:.1f} {:.1f}", i == 0 ? "M" : "L", px, py);
  }
  out += round && n > 2 ? "Z\"/>\n" : "\"/>\n";
  return out + fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", cx, y + kCell + 12,
                           html_text(r.feature));
}

std::string deviations_svg(std::span<const FeatureResult> results, double scale) {
  std::string body;
  int drawn_count = 0;
  for (const FeatureResult& r : results) {
    if (r.deviations_um.empty()) continue;
    body += drawn(r, drawn_count % kPerRow * kCell, drawn_count / kPerRow * (kCell + 18), scale);
    ++drawn_count;
  }
  if (drawn_count == 0) return {};
  const int rows = (drawn_count + kPerRow - 1) / kPerRow;
  return fmt::format(
             "<svg class=\"histogram\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"Deviations of the "
             "features\">\n",
             kPerRow * kCell, rows * (kCell + 18)) +
         body + "</svg>\n";
}

}  // namespace

std::vector<FeatureResult> features_of(const machine::Job& job, std::span<const removal::SurfacePoint> surface) {
  if (job.features.empty()) return {};
  return inspect::evaluate(job.features, surface, job.simulation.voxel_mm, inspect::model_error_of(job));
}

std::string with_features(std::string json, std::initializer_list<NamedFeatures> lists) {
  for (const NamedFeatures& list : lists) {
    if (list.results.empty()) continue;
    Json rows = Json::array();
    for (const FeatureResult& r : list.results) rows.push_back(feature_json(r));
    const std::size_t end = json.rfind("\n}");
    json.insert(end, fmt::format(",\n  \"{}\": {}", list.key, rows.dump()));
  }
  return json;
}

std::string features_text(std::span<const FeatureResult> results) {
  if (results.empty()) return {};
  std::string out = fmt::format("{:<{}}{:>10}{:>10}{:>8}{:>10}{:>8}{:>8}  {}\n", "feature, mm", kNameWidth, "nominal",
                                "predicted", "std um", "measured", "diff um", "form um", "");
  for (const FeatureResult& r : results) {
    const auto std_um = r.std_mm ? std::optional(1000 * *r.std_mm) : std::nullopt;
    fmt::format_to(std::back_inserter(out), "{:<{}}{:>10.4f}{}{}{}{}{}  {}\n", short_name(r), kNameWidth, r.nominal_mm,
                   shown(r.predicted_mm, 10, 4), shown(std_um, 8, 1), shown(r.measured_mm, 10, 4),
                   shown(r.difference_um(), 8, 1), shown(r.form_um, 8, 1), verdict_of(r));
  }
  return out;
}

std::string features_text(std::span<const FeatureResult> before, std::span<const FeatureResult> after) {
  if (before.empty()) return {};
  std::string out = fmt::format("{:<{}}{:>10}{:>10}{:>10}{:>8}{:>8}  {}\n", "feature, mm", kNameWidth, "nominal",
                                "before", "after", "std um", "form um", "");
  for (std::size_t i = 0; i < before.size(); ++i) {
    const FeatureResult &b = before[i], &a = after[i];
    const auto std_um = a.std_mm ? std::optional(1000 * *a.std_mm) : std::nullopt;
    fmt::format_to(std::back_inserter(out), "{:<{}}{:>10.4f}{}{}{}{}  {}\n", short_name(a), kNameWidth, a.nominal_mm,
                   shown(b.predicted_mm, 10, 4), shown(a.predicted_mm, 10, 4), shown(std_um, 8, 1),
                   shown(a.form_um, 8, 1), verdict_of(a));
  }
  return out;
}

void add_features(ReportData& data, std::span<const FeatureResult> results, const std::string& title) {
  if (results.empty()) return;
  TextTable table{title,
                  {"feature", "kind", "nominal, mm", "predicted, mm", "std, µm", "measured, mm", "difference, µm",
                   "lag, µm", "bending, µm", "form, µm", "taper, µm", "limits, mm", ""},
                  {},
                  "Size as the instrument would find it on the predicted surface. Lag and bending are what they change "
                  "the size by; the difference is measured minus predicted."};
  const auto text = [](const std::optional<double>& v, int decimals) {
    return v ? number_text(*v, decimals) : std::string();
  };
  for (const FeatureResult& r : results)
    table.rows.push_back(
        {r.feature, std::string(kind_word(r)), number_text(r.nominal_mm, 4), text(r.predicted_mm, 4),
         text(r.std_mm ? std::optional(1000 * *r.std_mm) : std::nullopt, 1), text(r.measured_mm, 4),
         text(r.difference_um(), 1), r.predicted_mm ? number_text(r.contour_um, 1) : "",
         r.predicted_mm ? number_text(r.deflection_um, 1) : "", text(r.form_um, 1), text(r.taper_um, 1),
         r.lower_mm && r.upper_mm ? number_text(*r.lower_mm, 3) + " … " + number_text(*r.upper_mm, 3) : "",
         verdict_of(r)});
  data.tables.insert(data.tables.begin(), std::move(table));
  const double scale = magnification(results);
  if (std::string svg = deviations_svg(results, scale); !svg.empty())
    data.pictures.push_back({title + ": deviations", std::move(svg),
                             fmt::format("Deviation from the nominal shape × {:g}: readings about the circle of a bore "
                                         "or boss (outward: larger), along the others.",
                                         scale)});
}

void write_features_csv(const std::string& path, const std::vector<FeatureResult>& results) {
  const std::string text = inspect::features_csv(results);
  std::error_code ec;
  if (std::filesystem::exists(path, ec)) {
    std::string first;
    std::ifstream file(path);
    std::getline(file, first);
    if (text.substr(0, text.find('\n')) != first)
      fail_on_file(path, "is a table of somebody else; a free name was expected", "file-unwritable");
  }
  write_file(path, text);
}

}  // namespace camber::report
