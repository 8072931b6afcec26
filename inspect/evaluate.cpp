#include "inspect/evaluate.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/QR>

#include "inspect/evaluation.h"
#include "machine/material_presets.h"

namespace camber::inspect {

std::vector<double> spread(double from, double to, int count) {
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(count > 1 ? from + (to - from) * i / (count - 1) : (from + to) / 2);
  return out;
}

std::vector<double> within_margins(double length, int count) {
  constexpr double kMargin = 0.1;
  return spread(kMargin * length, (1 - kMargin) * length, count);
}

Line fit_line(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sx += x[i], sy += y[i], sxx += x[i] * x[i], sxy += x[i] * y[i];
  const double det = n * sxx - sx * sx;
  if (!(det > 1e-12 * n * sxx)) return {n > 0 ? sy / n : 0, 0};
  const double slope = (n * sxy - sx * sy) / det;
  return {(sy - slope * sx) / n, slope};
}

double spread_of(const std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto [least, greatest] = std::ranges::minmax(values);
  return greatest - least;
}

double size_by(const std::vector<double>& sizes, FeatureFilter filter) {
  if (filter == FeatureFilter::min_zone) return *std::ranges::min_element(sizes);
  return std::accumulate(sizes.begin(), sizes.end(), 0.0) / static_cast<double>(sizes.size());
}

bool Evaluation::failed(const Probing& probing) {
  out.readings += probing.readings.size();
  out.missed += probing.missed;
  if (probing.enough()) return false;
  out.reason = probing.readings.empty() && probing.missed == 0
                   ? "there is no surface of the job's operations"
                   : fmt::format("{} of {} places have no surface of the job's operations, or are beyond the model",
                                 probing.missed, probing.missed + probing.readings.size());
  return true;
}

void Evaluation::set_sizes(double nominal, double contour, double machined) {
  out.commanded_mm = nominal;
  out.contour_um = 1000 * (contour - nominal);
  out.deflection_um = 1000 * (machined - contour);
  out.predicted_mm = machined;
}

namespace {

void evaluate_alone(Evaluation& e) {
  switch (e.feature.kind) {
    case FeatureKind::plane:
      return evaluate_plane(e);
    case FeatureKind::bore:
    case FeatureKind::boss:
      return evaluate_cylinder(e);
    case FeatureKind::slot_width:
      return evaluate_slot(e);
    case FeatureKind::wall:
      return evaluate_wall(e);
    case FeatureKind::points:
      return evaluate_points(e);
    case FeatureKind::distance:
      if (e.feature.of[0].empty()) evaluate_point_distance(e);
      return;
  }
}

/// Returns the nominal middle of a feature that tells a position.
Vec3 nominal_middle(const Evaluation& e) {
  const Feature& f = e.feature;
  const Vec3 axis = (f.axis_mm[1] - f.axis_mm[0]).normalized();
  if (f.kind == FeatureKind::plane) return f.axis_mm[0] + f.nominal_mm * axis;
  if (e.constrained.size() == 2) return f.axis_mm[0] + axis.dot(e.machined_middle_mm() - f.axis_mm[0]) * axis;
  const Vec3 m = (f.axis_mm[0] + f.axis_mm[1]) / 2;
  return f.kind == FeatureKind::slot_width ? Vec3(m.x(), m.y(), e.machined_middle_mm().z()) : m;
}

/// Shift and small turn (about the origin) that bring the features of the alignment nearest to their places.
Eigen::Matrix<double, 6, 1> alignment(const std::vector<Evaluation>& all) {
  std::vector<Eigen::Matrix<double, 1, 6>> rows;
  std::vector<double> off;
  for (const Evaluation& e : all) {
    if (!e.feature.align || !e.placed) continue;
    const Vec3 place = nominal_middle(e);
    for (const Vec3& n : e.constrained) {
      Eigen::Matrix<double, 1, 6> row;
      row << n.transpose(), place.cross(n).transpose();
      rows.push_back(row);
      off.push_back(n.dot(e.machined_middle_mm() - place));
    }
  }
  if (rows.empty()) return Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::MatrixXd a(static_cast<Eigen::Index>(rows.size()), 6);
  for (std::size_t i = 0; i < rows.size(); ++i) a.row(static_cast<Eigen::Index>(i)) = rows[i];
  return a.completeOrthogonalDecomposition().solve(
      Eigen::Map<const Eigen::VectorXd>(off.data(), static_cast<Eigen::Index>(off.size())));
}

void set_positions(std::vector<Evaluation>& all) {
  const Eigen::Matrix<double, 6, 1> motion = alignment(all);
  for (Evaluation& e : all) {
    if (!e.placed) continue;
    const Vec3 place = nominal_middle(e);
    const Vec3 moved = motion.head<3>() + motion.tail<3>().cross(place);
    Vec3 off = Vec3::Zero();
    for (const Vec3& n : e.constrained) off += n.dot(e.machined_middle_mm() - place - moved) * n;
    e.out.position_um = 1000 * off;
  }
}

/// Standard error of what bending, lag and corners change.
double moved_std_mm(const FeatureResult& r, const ModelError& error) {
  return std::hypot(error.deflection * r.deflection_um, error.contour * r.contour_um) / 1000;
}

void set_given(FeatureResult& r, const Feature& f, const ModelError& error) {
  r.feature = f.name;
  r.kind = f.kind;
  r.nominal_mm = f.nominal_mm;
  r.measured_mm = machine::measured_mean_mm(f);
  if (f.tol_mm) r.lower_mm = f.nominal_mm + (*f.tol_mm)[0], r.upper_mm = f.nominal_mm + (*f.tol_mm)[1];
  if (!r.predicted_mm) return;
  r.std_mm = std::hypot(moved_std_mm(r, error), f.size_per_diameter() * error.size_mm);
}

std::string cell(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value + 0.0, decimals) : std::string();
}

/// A name with a comma or a quote stands in quotes.
std::string quoted(const std::string& name) {
  if (name.find_first_of(",\"\n") == std::string::npos) return name;
  std::string out = "\"";
  for (const char c : name) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

}  // namespace

std::vector<FeatureResult> evaluate(const std::vector<Feature>& features,
                                    std::span<const removal::SurfacePoint> surface, double voxel_mm,
                                    const ModelError& error) {
  std::vector<FeatureResult> out(features.size());
  std::vector<Evaluation> all;
  all.reserve(features.size());
  for (std::size_t i = 0; i < features.size(); ++i)
    evaluate_alone(all.emplace_back(Evaluation{features[i], surface, voxel_mm, out[i]}));
  const auto named = [&](const std::string& name) -> const Evaluation& {
    const auto at = std::ranges::find(all, name, [](const Evaluation& e) { return e.feature.name; });
    assert(at != all.end());
    return *at;
  };
  for (Evaluation& e : all)
    if (!e.feature.of[0].empty()) evaluate_distance_of(e, named(e.feature.of[0]), named(e.feature.of[1]));
  set_positions(all);
  for (std::size_t i = 0; i < features.size(); ++i) set_given(out[i], features[i], error);
  // The middle of a part of a circle is as uncertain as its size: axes that lag apart change both.
  for (Evaluation& e : all)
    for (const std::string& end : e.feature.of)
      if (e.out.std_mm && !end.empty() && named(end).feature.arc_rad)
        e.out.std_mm = std::hypot(*e.out.std_mm, moved_std_mm(named(end).out, error));
  return out;
}

std::string features_csv(const std::vector<FeatureResult>& results) {
  std::string out =
      "feature,kind,nominal_mm,predicted_mm,std_mm,measured_mm,difference_um,form_um,taper_um,lower_mm,upper_mm,"
      "within\n";
  for (const FeatureResult& r : results) {
    const auto within = r.within();
    out +=
        fmt::format("{},{},{:.6f},{},{},{},{},{},{},{},{},{}\n", quoted(r.feature),
                    machine::kFeatureKindWords[static_cast<std::size_t>(r.kind)], r.nominal_mm, cell(r.predicted_mm, 6),
                    cell(r.std_mm, 6), cell(r.measured_mm, 6), cell(r.difference_um(), 3), cell(r.form_um, 3),
                    cell(r.taper_um, 3), cell(r.lower_mm, 6), cell(r.upper_mm, 6), within ? (*within ? "1" : "0") : "");
  }
  return out;
}

machine::ModelError model_error_of(const machine::Job& job) {
  constexpr double kOtherSource = 0.25, kSmallTool = 1.5, kSmallTool_mm = 4;
  constexpr double kTypicalRoot = 0.4, kGivenRoot = 0.15, kLag = 0.5, kDiameter_mm = 0.028;
  if (job.model_error) return *job.model_error;
  const machine::MaterialPreset* preset = machine::find_preset(job.material.preset);
  const double force = preset ? preset->scatter_percent / 100 : kOtherSource;
  const auto any = [&](auto test) { return std::ranges::any_of(job.tools, test); };
  const double chips = any([](const auto& t) { return t.second.diameter_mm < kSmallTool_mm; }) ? kSmallTool : 0;
  const double stiffness = any([](const auto& t) { return !t.second.typical.empty(); }) ? kTypicalRoot : kGivenRoot;
  return {.deflection = std::hypot(force, chips, stiffness), .contour = kLag, .size_mm = kDiameter_mm};
}

}  // namespace camber::inspect
