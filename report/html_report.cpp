#include "report/html_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/output_file.h"
#include "report/base64.h"
#include "report/decimate.h"
#include "report/page_parts.h"
#include "report/page_tables.h"

namespace camber::report {
namespace {

using nlohmann::json;
using Samples = std::vector<SurfaceSample>;

/// Share of the surface whose error the colour scale is to hold.
constexpr double kScaleShare = 0.995;
constexpr int kHistogramBins = 80;

std::vector<double> errors_of(const Samples& samples) {
  std::vector<double> out(samples.size());
  std::transform(samples.begin(), samples.end(), out.begin(), [](const auto& s) { return s.error_um; });
  return out;
}

/// Half of a symmetric scale that holds kScaleShare of the points, a round number of um.
double scale_um(const Samples& samples) {
  if (samples.empty()) return 1;
  std::vector<double> size(samples.size());
  std::transform(samples.begin(), samples.end(), size.begin(), [](const auto& s) { return std::abs(s.error_um); });
  const auto at = size.begin() + static_cast<std::ptrdiff_t>(kScaleShare * static_cast<double>(size.size() - 1));
  std::nth_element(size.begin(), at, size.end());
  return nice_limit(*at);
}

bool same_places(const Samples& a, const Samples& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const auto& p, const auto& q) {
           return p.x == q.x && p.y == q.y && p.z == q.z;
         });
}

template <class Field>
std::string packed(const Samples& samples, const std::vector<std::size_t>& kept, std::initializer_list<Field> fields) {
  std::string bytes;
  bytes.reserve(kept.size() * fields.size() * sizeof(float));
  for (const std::size_t i : kept)
    for (const Field f : fields) append_little_endian(bytes, static_cast<float>(samples[i].*f));
  return base64(bytes);
}

/// Side of the square that each drawn point stands for.
double spacing_mm(const Samples& samples, std::size_t drawn) {
  double area = 0;
  for (const auto& s : samples) area += s.area_mm2;
  return drawn > 0 ? std::sqrt(area / static_cast<double>(drawn)) : 1;
}

json map_json(const Samples& samples, const std::vector<std::size_t>& kept, bool with_places) {
  using S = SurfaceSample;
  json map;
  map["spacing"] = spacing_mm(samples, kept.size());
  map["error"] = packed(samples, kept, {&S::error_um});
  if (!with_places) return map;
  map["xyz"] = packed(samples, kept, {&S::x, &S::y, &S::z});
  map["normal"] = packed(samples, kept, {&S::nx, &S::ny, &S::nz});
  return map;
}

json maps_json(const ReportData& data, std::size_t most) {
  json maps = json::array();
  if (data.before.empty()) return maps;
  const auto kept = keep_extremes(errors_of(data.before), most);
  maps.push_back(map_json(data.before, kept, true));
  if (data.after.empty()) return maps;
  if (same_places(data.before, data.after))
    maps.push_back(map_json(data.after, kept, false));
  else
    maps.push_back(map_json(data.after, keep_extremes(errors_of(data.after), most), true));
  return maps;
}

/// Per cent of the area in each bin from -limit to limit; what lies beyond is in the first and the last.
std::vector<double> histogram(const Samples& samples, double limit_um) {
  std::vector<double> bins(kHistogramBins, 0.0);
  double area = 0;
  for (const auto& s : samples) {
    const double at = std::floor((s.error_um / limit_um + 1) / 2 * kHistogramBins);
    bins[static_cast<std::size_t>(std::clamp(at, 0.0, kHistogramBins - 1.0))] += s.area_mm2;
    area += s.area_mm2;
  }
  for (double& b : bins) b = area > 0 ? std::round(1e5 * b / area) / 1e3 : 0;
  return bins;
}

json feed_json(const std::vector<FeedSample>& samples, std::size_t most) {
  std::vector<double> feed(samples.size());
  std::transform(samples.begin(), samples.end(), feed.begin(), [](const auto& s) { return s.feed_mm_per_min; });
  std::string t, command, actual;
  for (const std::size_t i : keep_extremes(feed, most)) {
    append_little_endian(t, static_cast<float>(samples[i].t_s));
    append_little_endian(command, static_cast<float>(samples[i].feed_command_mm_per_min));
    append_little_endian(actual, static_cast<float>(samples[i].feed_mm_per_min));
  }
  return {{"t", base64(t)}, {"command", base64(command)}, {"feed", base64(actual)}};
}

json page_data(const ReportData& data, const ReportOptions& options, const std::vector<double>& scales) {
  json out;
  out["maps"] = maps_json(data, options.most_points);
  out["scales"] = scales;
  out["histogram"] = {{"limit", scales.front()}, {"before", histogram(data.before, scales.front())}};
  if (!data.after.empty()) out["histogram"]["after"] = histogram(data.after, scales.front());
  out["feed"] = json::array();
  for (const auto* run : {&data.feed, &data.feed_after})
    if (!run->empty()) out["feed"].push_back(feed_json(*run, options.most_feed_samples));
  return out;
}

/// What a script element may hold: no end tag inside.
std::string script_safe(std::string text) {
  for (std::size_t at = text.find("</"); at != std::string::npos; at = text.find("</", at + 3))
    text.insert(at + 1, "\\");
  return text;
}

}  // namespace

std::string html_report(const ReportData& data, const ReportOptions& options) {
  std::vector<double> scales{scale_um(data.before)};
  if (!data.after.empty() && scale_um(data.after) < scales.front()) scales.push_back(scale_um(data.after));
  const std::string title = html_text(data.title);
  std::string out = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  out += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  out += fmt::format("<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n<main>\n", title, kPageStyle);
  out += fmt::format("<h1>{}</h1>\n<p class=\"sub\">{}</p>\n", title, html_text(data.subtitle));
  out += tiles_html(data) + map_html(data, options, scales) + charts_html(data, options) + tables_html(data);
  out += "</main>\n<script type=\"application/json\" id=\"data\">";
  out += script_safe(page_data(data, options, scales).dump(-1, ' ', false, json::error_handler_t::replace));
  out += fmt::format("</script>\n<script>'use strict';\n{}{}{}</script>\n</body>\n</html>\n", kMapScript, kPlotScript,
                     kPageScript);
  return out;
}

void write_html_report(const std::string& path, const ReportData& data, const ReportOptions& options) {
  write_file(path, html_report(data, options));
}

}  // namespace camber::report
