#include "report/path_card.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/json.h"
#include "report/page_parts.h"
#include "report/page_tables.h"

namespace camber::report {
namespace {

std::vector<double> doubles(const std::vector<float>& values) { return {values.begin(), values.end()}; }

}  // namespace

std::string path_card_html(std::string_view title, std::string_view hint) {
  return fmt::format(
      "<div class=\"card\" id=\"path\"><h2>{}</h2>\n"
      "<noscript><p class=\"note\">The picture needs JavaScript; the tables below do without.</p></noscript>\n"
      "<div class=\"bar\" id=\"path-controls\"></div>\n<div class=\"scene\" id=\"scene\"></div>\n"
      "<div class=\"bar\" id=\"path-legend\"></div>\n<p class=\"note screen\">{}</p>\n</div>\n",
      html_text(title), html_text(hint));
}

Json picture_json(PackedArrays& arrays, const PathPicture& picture, std::string_view name) {
  Json out = {{"name", name}, {"place", Json::array()}, {"thinned", picture.thinned}};
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values(picture.points.size());
    std::transform(picture.points.begin(), picture.points.end(), values.begin(),
                   [&](const Vec3& p) { return p[axis]; });
    out["place"].push_back(arrays.add_quantised(values));
  }
  std::vector<std::uint32_t> values(picture.points.size());
  for (std::size_t k = 0; k < values.size(); ++k)
    values[k] = 2 * static_cast<std::uint32_t>(picture.kind[k]) + picture.ends[k];
  out["kind"] = arrays.add_whole(values);
  out["block"] = arrays.add_whole(picture.block);
  if (!picture.tool.empty()) out["tool"] = arrays.add_whole(picture.tool);
  if (!picture.feed_mm_per_min.empty()) out["feed"] = arrays.add_quantised(doubles(picture.feed_mm_per_min));
  if (!picture.speed_mm_per_min.empty()) out["speed"] = arrays.add_quantised(doubles(picture.speed_mm_per_min));
  return out;
}

std::string path_scripts_html(const Json& index, const PackedArrays& arrays) {
  return fmt::format(
      "<script type=\"application/json\" id=\"index\">{}</script>\n"
      "<script type=\"text/plain\" id=\"arrays\">{}</script>\n<script>{}</script>\n",
      script_safe(index.dump()), arrays.text(), path_script());
}

ProgramCard program_card(std::string_view title, const PathPicture& picture) {
  PackedArrays arrays;
  const Json index = {{"paths", Json::array({picture_json(arrays, picture, "")})}, {"motion", true}};
  const std::string hint =
      "Drag to rotate, drag with the right button or Shift to pan, use the wheel or two fingers to zoom, double-click "
      "to reset. The cursor shows line, position and feed.";
  return {path_card_html(title, hint), path_scripts_html(index, arrays)};
}

std::string thinned_note(const PathPicture& picture, std::string_view which) {
  if (!picture.thinned) return {};
  std::string out = fmt::format("{} shows {} points; omitted points lie within {:.2g} mm of it", which,
                                picture.points.size(), picture.chord_mm);
  if (!picture.feed_mm_per_min.empty())
    out += fmt::format(", their feeds within {:.2g} mm/min", picture.feed_step_mm_per_min);
  return out + ".";
}

}  // namespace camber::report
