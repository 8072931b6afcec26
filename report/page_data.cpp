#include "report/html_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/json.h"
#include "base/units.h"
#include "report/base64.h"
#include "report/decimate.h"
#include "report/packed_arrays.h"
#include "report/surface_mesh.h"

namespace camber::report {
namespace {

/// Share of the surface whose error the colour scale is to hold.
constexpr double kScaleFraction = 0.95;

/// Half of a symmetric scale that holds kScaleFraction of the points, a round number of um.
double scale_um(const SurfaceSamples& samples, double SurfaceSample::*error) {
  if (samples.empty()) return 1;
  std::vector<double> size;
  size.reserve(samples.size());
  for (const SurfaceSample& s : samples.all())
    if (s.area_mm2 > 0) size.push_back(std::abs(s.*error));
  if (size.empty()) return 1;
  const auto at = size.begin() + static_cast<std::ptrdiff_t>(kScaleFraction * static_cast<double>(size.size() - 1));
  std::nth_element(size.begin(), at, size.end());
  return nice_limit(*at);
}

/// From where the picture looks first: against the mean normal of the surface, from a little aside and above. Nothing
/// where the surface faces all ways or upwards: the usual view shows it as well as any.
Json view_of(const SurfaceSamples& samples) {
  constexpr double kOneWay = 0.3, kUpwards = 0.7, kAside_rad = 0.35, kAbove = 0.6;
  Vec3 sum = Vec3::Zero();
  double area = 0;
  for (const SurfaceSample& s : samples.all()) {
    sum += s.area_mm2 * s.normal;
    area += s.area_mm2;
  }
  if (area <= 0 || sum.norm() < kOneWay * area || sum.z() > kUpwards * sum.norm()) return nullptr;
  const double towards = std::atan2(sum.y(), sum.x()) - kAside_rad;
  const auto rounded = [](double v) { return std::round(1000 * v) / 1000; };
  return {rounded(std::cos(towards)), rounded(std::sin(towards)), sum.z() < -kUpwards * sum.norm() ? -kAbove : kAbove};
}

template <class Row, class Get>
std::vector<double> column(const std::vector<Row>& rows, Get get) {
  std::vector<double> out(rows.size());
  std::transform(rows.begin(), rows.end(), out.begin(), get);
  return out;
}

template <class Row, class Get>
Json triple(PackedArrays& arrays, const std::vector<Row>& rows, Get get) {
  Json out = Json::array();
  for (int a = 0; a < 3; ++a)
    out.push_back(arrays.add_quantised(column(rows, [&](const Row& r) { return get(r)[a]; })));
  return out;
}

template <class Row>
Json whole(PackedArrays& arrays, const std::vector<Row>& rows, std::uint32_t Row::*field) {
  std::vector<std::uint32_t> values(rows.size());
  std::transform(rows.begin(), rows.end(), values.begin(), [&](const Row& r) { return r.*field; });
  return arrays.add_whole(values);
}

/// Places of the vertices, and quadrangles: the first corner as a step from the one before, the others as steps from
/// the first.
Json mesh_json(const SurfaceMesh& mesh, PackedArrays& arrays) {
  Json out;
  out["place"] = triple(arrays, mesh.vertices, [](const SurfaceSample& s) -> const Vec3& { return s.place_mm; });
  out["quad"] = Json::array();
  for (std::size_t corner = 0; corner < 4; ++corner) {
    std::vector<std::uint32_t> values;
    values.reserve(mesh.quads.size());
    for (const auto& q : mesh.quads) values.push_back(corner == 0 ? q[0] : q[corner] - q[0]);
    out["quad"].push_back(arrays.add_whole(values));
  }
  out["cell"] = mesh.cell_mm;
  return out;
}

Json stock_json(const ReportData& data, PackedArrays& arrays, PageData& page) {
  const SurfaceMesh mesh = surface_mesh(data.stock, data.stock_cell_mm, 4 * data.stock.size());
  page.left_out.push_back(
      fmt::format("Grey is the remaining stock, in cells of {:.3g} mm; features thinner than a cell may be missing.",
                  mesh.cell_mm));
  return mesh_json(mesh, arrays);
}

Json surface_json(const ReportData& data, const ReportOptions& options, PackedArrays& arrays, PageData& page) {
  const SurfaceMesh mesh = surface_mesh(data.surface, data.voxel_mm, options.max_vertices);
  if (mesh.cell_mm > 1.5 * data.voxel_mm)
    page.left_out.push_back(
        fmt::format("The surface is drawn in cells of {:.3g} mm ({} vertices for {} points); each shows the error of "
                    "largest magnitude in it.",
                    mesh.cell_mm, mesh.vertices.size(), data.surface.size()));
  using S = SurfaceSample;
  Json out = mesh_json(mesh, arrays);
  out["normal"] = triple(arrays, mesh.vertices, [](const S& s) -> const Vec3& { return s.normal; });
  out["error"] = Json::array({arrays.add_quantised(column(mesh.vertices, [](const S& s) { return s.error_um; }))});
  out["block"] = Json::array({whole(arrays, mesh.vertices, &S::block)});
  if (data.compared) {
    out["error"].push_back(arrays.add_quantised(column(mesh.vertices, [](const S& s) { return s.error_after_um; })));
    out["block"].push_back(whole(arrays, mesh.vertices, &S::block_after));
  }
  if (std::ranges::any_of(mesh.vertices, [](const S& s) { return s.contour_um != 0; }))
    out["contour"] = arrays.add_quantised(column(mesh.vertices, [](const S& s) { return s.contour_um; }));
  out["points"] = data.surface.size();
  return out;
}

Json measured_json(const SurfaceSamples& measured, PackedArrays& arrays) {
  std::vector<SurfaceSample> points;
  for (const SurfaceSample& s : measured.all()) points.push_back(s);
  return {{"place", triple(arrays, points, [](const SurfaceSample& s) -> const Vec3& { return s.place_mm; })},
          {"error", arrays.add_quantised(column(points, [](const SurfaceSample& s) { return s.error_um; }))}};
}

/// Tool and rotary axes along the path.
void add_poses(Json& out, const std::vector<PathRow>& rows, PackedArrays& arrays) {
  out["axis"] = triple(arrays, rows, [](const PathRow& r) -> const Vec3& { return r.axis; });
  for (int i = 0; i < 3; ++i)
    out[std::string(1, "abc"[i])] =
        arrays.add_quantised(column(rows, [&](const PathRow& r) { return deg_from_rad(r.rotary_rad[i]); }));
  out["tool"] = whole(arrays, rows, &PathRow::tool);
}

Json run_json(const PathRun& run, const ReportOptions& options, bool poses, PackedArrays& arrays, PageData& page) {
  const auto kept = rows_to_draw(run.rows, options.max_rows);
  if (kept.size() < run.rows.size())
    page.left_out.push_back(
        fmt::format("Path and plots{} are drawn through {} of {} rows: of each group of neighbours the first and, for "
                    "every quantity, the minimum and the maximum.",
                    run.name.empty() ? "" : " " + run.name, kept.size(), run.rows.size()));
  std::vector<PathRow> rows;
  rows.reserve(kept.size());
  for (const std::size_t i : kept) rows.push_back(run.rows[i]);
  Json out{{"name", run.name}};
  out["t"] = arrays.add_floats(column(rows, [](const PathRow& r) { return r.t_s; }));
  out["place"] = triple(arrays, rows, [](const PathRow& r) -> const Vec3& { return r.place_mm; });
  out["block"] = whole(arrays, rows, &PathRow::block);
  out["cutting"] = arrays.add_quantised(column(rows, [](const PathRow& r) { return r.cutting ? 1.0 : 0.0; }));
  constexpr std::pair<const char*, double PathRow::*> kColumns[] = {{"command", &PathRow::feed_command_mm_per_min},
                                                                    {"feed", &PathRow::feed_mm_per_min},
                                                                    {"force", &PathRow::force_N},
                                                                    {"deflection", &PathRow::deflection_um},
                                                                    {"chip", &PathRow::chip_um},
                                                                    {"margin", &PathRow::margin},
                                                                    {"error", &PathRow::error_um},
                                                                    {"shift", &PathRow::shift_um}};
  for (const auto& [name, field] : kColumns) {
    const auto values = column(rows, [&](const PathRow& r) { return r.*field; });
    if (std::any_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
      out[name] = arrays.add_quantised(values);
  }
  if (poses) add_poses(out, rows, arrays);
  return out;
}

/// The last program matters most: it is the one that is offered.
void add_programs(const ReportData& data, const ReportOptions& options, PageData& page) {
  page.programs.assign(data.path.size(), {});
  std::size_t room = options.max_program_bytes;
  for (std::size_t i = data.path.size(); i-- > 0;) {
    if (data.path[i].program_text.empty()) continue;
    const std::string small = deflated(data.path[i].program_text);
    if (small.size() > room) {
      page.left_out.push_back(
          fmt::format("The text of the program{} is too large for this page; lines are named by "
                      "their numbers.",
                      data.path[i].name.empty() ? "" : " " + data.path[i].name));
      continue;
    }
    room -= small.size();
    page.programs[i] = base64(small);
  }
}

}  // namespace

PageData page_data(const ReportData& data, const ReportOptions& options) {
  PageData page;
  PackedArrays arrays;
  Json index;
  page.scale_um = scale_um(data.surface, &SurfaceSample::error_um);
  page.scale_after_um = data.compared ? scale_um(data.surface, &SurfaceSample::error_after_um) : page.scale_um;
  index["scales"] = {page.scale_um, page.scale_after_um};
  if (const Json view = view_of(data.surface); !view.is_null()) index["view"] = view;
  if (!data.surface.empty()) index["surface"] = surface_json(data, options, arrays, page);
  if (!data.measured.empty()) index["measured"] = measured_json(data.measured, arrays);
  if (!data.stock.empty()) index["stock"] = stock_json(data, arrays, page);
  if (data.compared && data.names[0] != "before") index["names"] = data.names;
  index["runs"] = Json::array();
  for (const auto& run : data.path)
    index["runs"].push_back(run_json(run, options, data.machine.has_value(), arrays, page));
  if (data.machine) index["machine"] = machine_json(*data.machine);
  add_programs(data, options, page);
  if (!data.download_name.empty()) index["download"] = data.download_name;
  page.index = index.dump();
  page.arrays = arrays.text();
  return page;
}

}  // namespace camber::report
