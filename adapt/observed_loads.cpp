#include "adapt/observed_loads.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "deflection/edge_force.h"
#include "machine/force_law.h"

namespace camber::adapt {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kMinSpeed_mm_per_s = 1e-3;

/// d ln F / d ln h of the tangential force without its edge term.
double exponent_at(const machine::Material& material, double chip_mm) {
  if (machine::is_affine(material.law) || chip_mm <= 0) return 1;
  const double force = deflection::edge_force(material, chip_mm, 1).tangential_N - material.kte_N_per_mm;
  const double slope = deflection::edge_force_slope(material, chip_mm).tangential_N;
  return force > 0 ? std::clamp(slope * chip_mm / force, 0.05, 1.0) : 1;
}

/// The values of kLoads at the observed feed; that of the form error is not known here.
std::array<double, kLoads> values_of(const simulate::StampLoad& load, double rpm) {
  std::array<double, kLoads> out{};
  out[index_of(Load::force)] = load.lateral_max_N;
  out[index_of(Load::torque)] = load.torque_max_Nmm;
  out[index_of(Load::deflection)] = load.deflection_max_mm;
  out[index_of(Load::chip)] = load.chip_max_mm;
  out[index_of(Load::power)] = simulate::power_W(load.torque_mean_Nmm, rpm);
  return out;
}

/// The form error with the largest magnitude of each stamp: what deflection makes of it, and the rest.
struct StampError {
  float deflection_mm = 0, contour_mm = 0;
};
std::vector<StampError> worst_errors(std::span<const removal::SurfacePoint> surface, std::size_t stamps) {
  std::vector<StampError> out(stamps);
  for (const removal::SurfacePoint& p : surface) {
    if (!p.valid || p.machined_stamp < 0 || static_cast<std::size_t>(p.machined_stamp) >= stamps) continue;
    StampError& worst = out[static_cast<std::size_t>(p.machined_stamp)];
    if (std::abs(p.error_mm) <= std::abs(static_cast<double>(worst.deflection_mm + worst.contour_mm))) continue;
    worst = {static_cast<float>(p.error_mm - p.contour_mm), static_cast<float>(p.contour_mm)};
  }
  return out;
}

/// Share of the edge in the lateral force at the observed feed.
template <class EdgeShare>
ObservedLoads observe_with(const ObservedRun& run, const FeedCells& cells, EdgeShare edge_share) {
  ObservedLoads out;
  const auto& stamps = run.program.path.stamps;
  const std::vector<double> speed = speeds_of(run.job, run.program);
  const auto errors = worst_errors(run.surface, run.surface.empty() ? 0 : stamps.size());
  out.points.reserve(stamps.size());
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    const auto place = run.map.given(stamps[k].move, stamps[k].fraction);
    PlacedLoad p{cells.find(place.move, place.fraction), {}};
    p.load.feed_mm_per_s = std::max(speed[k], kMinSpeed_mm_per_s);
    p.load.exponent = static_cast<float>(exponent_at(run.job.material, run.loads[k].chip_max_mm));
    const double rpm =
        run.program.moves_in_part().state_of(run.program.moves_in_part().moves[stamps[k].move]).spindle_speed_rpm;
    const auto values = values_of(run.loads[k], rpm);
    for (std::size_t l = 0; l < kLoads; ++l) {
      const double share = l == index_of(Load::chip) ? 0 : edge_share(k, p, l, values[l]);
      p.load.curve[l] = {static_cast<float>(share * values[l]), static_cast<float>((1 - share) * values[l])};
    }
    if (!errors.empty()) {
      const auto share = static_cast<float>(edge_share(k, p, index_of(Load::force), values[index_of(Load::force)]));
      const StampError& e = errors[k];
      // The axes' lag at a bend of the path, and with it the contour error, is proportional to the speed.
      p.load.curve[index_of(Load::form_error)] = {share * e.deflection_mm,
                                                  e.contour_mm + (1 - share) * e.deflection_mm};
    }
    out.points.push_back(p);
  }
  return out;
}

}  // namespace

std::vector<double> speeds_of(const machine::Job& job, const simulate::SimulatedProgram& program) {
  const auto& stamps = program.path.stamps;
  std::vector<double> out(stamps.size(), 0.0);
  for (const removal::ToolRun& run : program.path.runs) {
    const int flutes = job.tools.at(run.tool).flutes;
    for (std::size_t k = run.from; k < run.from + run.count; ++k) {
      const auto& state = program.moves_in_part().state_of(program.moves_in_part().moves[stamps[k].move]);
      out[k] = stamps[k].feed_per_tooth_mm.norm() * flutes * state.spindle_speed_rpm / 60;
    }
    for (std::size_t k = run.from + run.count; k-- > run.from;)
      if (stamps[k].first) out[k] = k + 1 < run.from + run.count ? out[k + 1] : 0;
  }
  return out;
}

ObservedLoads observe(const ObservedRun& run, const FeedCells& cells, std::span<const simulate::StampLoad> at_ratio,
                      double chip_ratio) {
  return observe_with(run, cells, [&](std::size_t k, const PlacedLoad& p, std::size_t l, double value) {
    // The deflection is proportional to the force.
    const bool by_force = l == index_of(Load::deflection) || l == index_of(Load::form_error);
    const double whole = by_force ? run.loads[k].lateral_max_N : value;
    if (whole <= 0) return 0.0;
    const std::size_t of = by_force ? index_of(Load::force) : l;
    const double part =
        values_of(at_ratio[k], 1)[of] / (of == index_of(Load::power) ? values_of(run.loads[k], 1)[of] : whole);
    const double x = std::pow(chip_ratio, static_cast<double>(p.load.exponent));
    return std::clamp((part - x) / (1 - x), 0.0, 1.0);
  });
}

ObservedLoads observe(const ObservedRun& run, const FeedCells& cells, const ObservedLoads& before) {
  // By cell: the parts of the passing with the greatest force.
  std::vector<const LoadPoint*> of_cell(cells.size(), nullptr);
  const std::size_t force = index_of(Load::force);
  const auto size = [&](const LoadPoint& p) { return p.curve[force].edge + p.curve[force].shear; };
  for (const PlacedLoad& p : before.points) {
    if (p.cell == FeedCells::kNone) continue;
    const LoadPoint*& best = of_cell[p.cell];
    if (!best || size(p.load) > size(*best)) best = &p.load;
  }
  for (std::size_t i = 1; i < of_cell.size(); ++i)
    if (!of_cell[i] && !cells[i].first) of_cell[i] = of_cell[i - 1];
  return observe_with(run, cells, [&](std::size_t, const PlacedLoad& p, std::size_t l, double) {
    constexpr double kUnknown = 0.3;
    if (p.cell == FeedCells::kNone || !of_cell[p.cell]) return kUnknown;
    const LoadPoint& old = *of_cell[p.cell];
    const std::size_t of = l == index_of(Load::form_error) ? index_of(Load::force) : l;
    const double ratio = p.load.feed_mm_per_s / old.feed_mm_per_s;
    const double edge = static_cast<double>(old.curve[of].edge),
                 whole = old.curve[of].at(ratio, static_cast<double>(old.exponent));
    return whole > 0 ? std::clamp(edge / whole, 0.0, 1.0) : kUnknown;
  });
}

namespace {

/// Most passings leave no point of the surface: in the cut they have the least feed of the nearest ones before and
/// behind them that did.
std::vector<double> allowed_by_surface(const ObservedLoads& loads, const LoadLimit& limit) {
  const auto& points = loads.points;
  std::vector<double> out(points.size(), kInf);
  const auto spread = [&](double& last, std::size_t k) {
    const auto& curve = points[k].load.curve;
    const LoadCurve& error = curve[index_of(Load::form_error)];
    if (curve[index_of(Load::chip)].shear <= 0) last = kInf;
    if (error.edge != 0 || error.shear != 0) last = points[k].load.max_feed_mm_per_s(limit);
    out[k] = std::min(out[k], last);
  };
  double last = kInf;
  for (std::size_t k = 0; k < points.size(); ++k) spread(last, k);
  last = kInf;
  for (std::size_t k = points.size(); k-- > 0;) spread(last, k);
  return out;
}

}  // namespace

std::vector<double> allowed_feeds(const FeedCells& cells, const ObservedLoads& loads, std::span<const LoadLimit> limits,
                                  std::span<const int> flutes_of_cell) {
  const auto& points = loads.points;
  std::vector<double> of_point(points.size(), kInf);
  for (const LoadLimit& limit : limits) {
    if (limit.load == Load::chip_min) continue;
    const bool by_surface = limit.load == Load::form_error;
    const std::vector<double> of_surface = by_surface ? allowed_by_surface(loads, limit) : std::vector<double>();
    for (std::size_t k = 0; k < points.size(); ++k)
      of_point[k] = std::min(of_point[k], by_surface ? of_surface[k] : points[k].load.max_feed_mm_per_s(limit));
  }
  std::vector<double> out(cells.size(), -1);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::size_t c = points[k].cell;
    if (c == FeedCells::kNone) continue;
    const auto turn = static_cast<std::size_t>(std::max(1, flutes_of_cell[c]) - 1);
    double least = kInf;
    for (std::size_t i = k - std::min(k, turn); i <= std::min(points.size() - 1, k + turn); ++i)
      least = std::min(least, of_point[i]);
    out[c] = out[c] < 0 ? least : std::min(out[c], least);
  }
  for (const auto& [from, end] : cells.chains()) {
    std::vector<double> next(end - from, -1);
    for (std::size_t i = end; i-- > from;)
      next[i - from] = out[i] >= 0 ? out[i] : i + 1 < end ? next[i + 1 - from] : -1;
    double last = -1;
    for (std::size_t i = from; i < end; ++i) {
      if (out[i] >= 0) {
        last = out[i];
        continue;
      }
      const double ahead = next[i - from];
      out[i] = last < 0 ? ahead : ahead < 0 ? last : std::min(last, ahead);
    }
  }
  return out;
}

std::vector<Contact> contacts_of(const FeedCells& cells, const ObservedLoads& loads) {
  std::vector<Contact> out(cells.size(), Contact::unknown);
  for (const PlacedLoad& p : loads.points) {
    if (p.cell == FeedCells::kNone) continue;
    const LoadCurve& chip = p.load.curve[index_of(Load::chip)];
    if (chip.shear > 0)
      out[p.cell] = Contact::cut;
    else if (out[p.cell] == Contact::unknown)
      out[p.cell] = Contact::air;
  }
  return out;
}

std::vector<double> greatest(const FeedCells& cells, const ObservedLoads& loads, Load load) {
  std::vector<double> out(cells.size(), 0.0);
  for (const PlacedLoad& p : loads.points)
    if (p.cell != FeedCells::kNone) out[p.cell] = std::max(out[p.cell], p.load.at(load, p.load.feed_mm_per_s));
  return out;
}

}  // namespace camber::adapt
