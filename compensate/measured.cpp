#include "compensate/measured.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "base/numbers.h"
#include "simulate/setup.h"

namespace camber::compensate {
namespace {

struct Field {
  std::string_view text;
  std::size_t column = 1;
};

std::vector<Field> fields_of(std::string_view line, char separator) {
  std::vector<Field> out;
  std::size_t from = 0;
  const auto trimmed = [&](std::size_t begin, std::size_t end) {
    while (begin < end && (line[begin] == ' ' || line[begin] == '\t')) ++begin;
    while (end > begin && (line[end - 1] == ' ' || line[end - 1] == '\t' || line[end - 1] == '\r')) --end;
    return Field{line.substr(begin, end - begin), begin + 1};
  };
  while (from <= line.size()) {
    const std::size_t end = std::min(line.find(separator, from), line.size());
    const Field f = trimmed(from, end);
    if (separator != ' ' || !f.text.empty()) out.push_back(f);
    from = end + 1;
  }
  return out;
}

constexpr std::array<std::array<std::string_view, 2>, 7> kColumns{
    {{"x_mm", "x"}, {"y_mm", "y"}, {"z_mm", "z"}, {"nx", "nx"}, {"ny", "ny"}, {"nz", "nz"}, {"error_um", "error"}}};

class MeasuredReader {
 public:
  explicit MeasuredReader(const std::string& path) : source_(SourceText::read(path)) {}

  std::vector<MeasuredPoint> read() {
    std::size_t line = 1;
    while (line <= source_.line_count() && fields_of(source_.line(line), ',').front().text.empty()) ++line;
    if (line > source_.line_count())
      fail_on_file(source_.name(), "is empty; measured points were expected", "measured-empty");
    read_header(line);
    std::vector<MeasuredPoint> out;
    for (++line; line <= source_.line_count(); ++line)
      if (const auto p = read_row(line)) out.push_back(*p);
    diagnostics_.throw_if_errors();
    if (out.empty())
      fail_on_file(source_.name(), "has a header, but no row below it; measured points were expected",
                   "measured-empty");
    return out;
  }

 private:
  void error(std::size_t line, std::size_t column, std::string message, const char* check) {
    diagnostics_.add(
        {Severity::error, {source_.name(), line, column}, std::move(message), check, std::string(source_.line(line))});
  }

  void read_header(std::size_t line) {
    const std::string_view text = source_.line(line);
    separator_ = ' ';
    for (const char c : {'\t', ';', ','})
      if (text.find(c) != std::string_view::npos) separator_ = c;
    const auto names = fields_of(text, separator_);
    for (std::size_t c = 0; c < kColumns.size(); ++c) {
      const auto at = std::ranges::find_if(
          names, [&](const Field& f) { return f.text == kColumns[c][0] || f.text == kColumns[c][1]; });
      if (at == names.end())
        error(line, 1,
              fmt::format("no column {}; a header with x_mm y_mm z_mm nx ny nz error_um was expected", kColumns[c][0]),
              "measured-column");
      else
        column_[c] = static_cast<std::size_t>(at - names.begin());
    }
    diagnostics_.throw_if_errors();
  }

  std::optional<MeasuredPoint> read_row(std::size_t line) {
    const auto fields = fields_of(source_.line(line), separator_);
    if (fields.empty() || (fields.size() == 1 && fields[0].text.empty())) return std::nullopt;
    std::array<double, 7> v{};
    for (std::size_t c = 0; c < v.size(); ++c) {
      if (column_[c] >= fields.size()) {
        error(line, 1, fmt::format("the row ends before {}", kColumns[c][0]), "measured-number");
        return std::nullopt;
      }
      const auto number = parse_number(fields[column_[c]].text);
      if (!number) {
        error(line, fields[column_[c]].column,
              fmt::format("{} is \"{}\"; a number was expected", kColumns[c][0], fields[column_[c]].text),
              "measured-number");
        return std::nullopt;
      }
      v[c] = *number;
    }
    const Vec3 normal(v[3], v[4], v[5]);
    if (normal.norm() < 0.5) {
      error(line, fields[column_[3]].column, "the normal has hardly any length; a unit vector was expected",
            "measured-normal");
      return std::nullopt;
    }
    return MeasuredPoint{{v[0], v[1], v[2]}, normal.normalized(), v[6] / 1000};
  }

  SourceText source_;
  Diagnostics diagnostics_;
  char separator_ = ',';
  std::array<std::size_t, 7> column_{};
};

/// The surface points about each measured one.
class Neighbours {
 public:
  Neighbours(const std::vector<removal::SurfacePoint>& surface, const std::vector<MeasuredPoint>& points,
             double reach) {
    using Cell = std::array<long, 3>;
    const auto cell_of = [&](const Vec3& p) {
      return Cell{std::lround(p.x() / reach), std::lround(p.y() / reach), std::lround(p.z() / reach)};
    };
    std::map<Cell, std::vector<std::size_t>> cells;
    for (std::size_t i = 0; i < surface.size(); ++i) cells[cell_of(surface[i].place_mm)].push_back(i);
    constexpr double kSameWay = 0.8, kNear = 0.25;  // a point counts 1/e at this fraction of the reach
    of_.resize(points.size());
    for (std::size_t m = 0; m < points.size(); ++m) {
      const Cell c = cell_of(points[m].place_mm);
      for (long i = -1; i <= 1; ++i)
        for (long j = -1; j <= 1; ++j)
          for (long k = -1; k <= 1; ++k) {
            const auto near = cells.find({c[0] + i, c[1] + j, c[2] + k});
            if (near == cells.end()) continue;
            for (const std::size_t s : near->second) {
              const double away = (surface[s].place_mm - points[m].place_mm).norm() / (kNear * reach);
              if (away < 1 / kNear && surface[s].normal.dot(points[m].normal) > kSameWay)
                of_[m].push_back({s, surface[s].area_mm2 * std::exp(-away * away)});
            }
          }
    }
  }
  bool has(std::size_t m) const { return !of_[m].empty(); }
  /// Mean of the errors about the point; the nearest ones count most, so that bow and cusps are not smoothed away.
  double error_mm(std::size_t m, const std::vector<removal::SurfacePoint>& surface) const {
    double sum = 0, weights = 0;
    for (const auto& [s, weight] : of_[m]) {
      sum += weight * surface[s].error_mm;
      weights += weight;
    }
    return sum / weights;
  }

 private:
  struct Near {
    std::size_t point;
    double weight;
  };
  std::vector<std::vector<Near>> of_;
};

}  // namespace

std::vector<MeasuredPoint> read_measured(const std::string& path) { return MeasuredReader(path).read(); }

machine::Job softened(const machine::Job& job, double scale) {
  machine::Job out = job;
  for (auto& [number, tool] : out.tools) {
    tool.youngs_modulus_MPa /= scale;
    tool.root_stiffness_N_per_mm /= scale;
    tool.root_axial_stiffness_N_per_mm /= scale;
    tool.root_rotational_stiffness_Nmm_per_rad /= scale;
    if (tool.axial_stiffness_N_per_mm) *tool.axial_stiffness_N_per_mm /= scale;
  }
  for (auto& axis : out.machine.axis) axis.stiffness_N_per_mm /= scale;
  return out;
}

MeasuredFit fit_measured(const machine::Job& job, const std::string& path, const std::vector<MeasuredPoint>& points,
                         const std::string& program, Diagnostics& diagnostics, const simulate::Progress& progress,
                         const simulate::Predictor& predictor) {
  Diagnostics repeated;
  const simulate::Setup setup =
      simulate::set_up(job, {.program = program, .predictor = predictor},
                       {.program = program.empty() ? repeated : diagnostics, .original = repeated, .target = repeated});

  MeasuredFit out;
  std::optional<Neighbours> near;
  std::vector<double> measured;
  const auto predicted_at = [&](double scale) {
    const auto prediction =
        simulate::predict_surface(setup.predictor, softened(job, scale), setup.target, setup.program, progress,
                                  fmt::format("measured points, deflection x {:.3f}", scale));
    ++out.predictions;
    if (!near) {
      near.emplace(prediction.surface, points, 1.5 * job.simulation.voxel_mm);
      for (std::size_t m = 0; m < points.size(); ++m)
        if (near->has(m)) measured.push_back(points[m].error_mm);
    }
    std::vector<double> errors;
    for (std::size_t m = 0; m < points.size(); ++m)
      if (near->has(m)) errors.push_back(near->error_mm(m, prediction.surface));
    return errors;
  };
  const auto rms_um = [&](const std::vector<double>& predicted) {
    double sum = 0;
    for (std::size_t i = 0; i < predicted.size(); ++i)
      sum += (measured[i] - predicted[i]) * (measured[i] - predicted[i]);
    return 1000 * std::sqrt(sum / static_cast<double>(predicted.size()));
  };
  const auto refuse = [&](const std::string& why) { fail_on_file(path, why, "measured-not-identifiable"); };

  constexpr double kProbe = 1.15, kSame = 0.005, kMin = 0.2, kMax = 5, kVague = 0.25;
  constexpr int kPredictions = 6;
  double c0 = 1, c1 = kProbe;
  std::vector<double> e0 = predicted_at(c0);
  out.points = measured.size();
  out.left_out = points.size() - out.points;
  if (out.points < 3)
    refuse(fmt::format("{} of {} points lie on a surface that the job machines; three or more were expected",
                       out.points, points.size()));
  out.rms_before_um = rms_um(e0);
  std::vector<double> e1 = predicted_at(c1);
  for (;;) {
    double jj = 0, jr = 0;
    for (std::size_t i = 0; i < e1.size(); ++i) {
      const double slope = (e1[i] - e0[i]) / (c1 - c0);
      jj += slope * slope;
      jr += slope * (measured[i] - e1[i]);
    }
    constexpr double kFlat_mm = 1e-4;  // a deflection twice as large would move the surface by less
    if (std::sqrt(jj / static_cast<double>(e1.size())) < kFlat_mm)
      refuse(
          "the predicted error at the points hardly depends on the deflection; points where the tool deflects normal "
          "to the surface were expected");
    const double next = std::clamp(c1 + jr / jj, kMin, kMax);
    double left = 0;
    for (std::size_t i = 0; i < e1.size(); ++i) {
      const double slope = (e1[i] - e0[i]) / (c1 - c0), r = measured[i] - e1[i] - slope * (next - c1);
      left += r * r;
    }
    out.scale = next;
    out.std_error = std::sqrt(left / static_cast<double>(e1.size() - 1) / jj);
    out.rms_after_um = 1000 * std::sqrt(left / static_cast<double>(e1.size()));
    if (std::abs(next - c1) < kSame || out.predictions >= kPredictions) break;
    c0 = c1;
    e0 = std::move(e1);
    c1 = next;
    e1 = predicted_at(c1);
  }
  if (out.std_error > kVague * out.scale)
    refuse(
        fmt::format("the points do not determine the deflection: {:.2f} +- {:.2f} times the predicted one; a standard "
                    "error below a quarter of it was expected",
                    out.scale, out.std_error));
  return out;
}

}  // namespace camber::compensate
