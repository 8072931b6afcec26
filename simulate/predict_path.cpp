#include "simulate/predict_path.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "base/process_memory.h"
#include "base/stage.h"
#include "base/triangle_mesh.h"
#include "checks/setup_checks.h"
#include "motion/job_checks.h"
#include "motion/operations.h"
#include "motion/path_stretch.h"
#include "nc/interpreter.h"
#include "removal/engagement.h"
#include "removal/tool_path.h"
#include "simulate/chatter.h"
#include "simulate/contour.h"
#include "simulate/job_stock.h"
#include "simulate/memory.h"
#include "simulate/pieces.h"
#include "simulate/region.h"
#include "simulate/validity.h"
#include "simulate/verdict.h"

namespace camber::simulate {

using machine::Job;

namespace {

/// Longest way of a point of the tool in a tooth passing, which no chip is thicker than.
double longest_feed_mm(const machine::Tool& tool, std::span<const removal::Stamp> stamps) {
  double longest = 0;
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    const double tip = stamps[k].feed_per_tooth_mm.norm();
    const double turn = stamps[k].pose.upright() ? 0 : removal::motion_in_tool(stamps, k).turn_rad.norm();
    longest = std::max(longest, tip + turn * tool.flute_length_mm.value_or(tool.overhang_mm));
  }
  return longest;
}

double thickest_chip_mm(const Job& job, const removal::StampPath& path) {
  double out = 0;
  for (const auto& run : path.runs)
    if (run.kind != removal::RunKind::tapping)
      out = std::max(out, longest_feed_mm(job.tools.at(run.tool), std::span(path.stamps).subspan(run.from, run.count)));
  return out;
}

/// Returns the thickest chip of an upright path.
double thickest_chip_mm(const motion::PathOutline& path) {
  double out = 0;
  for (std::size_t r = 0; r < path.runs.size(); ++r)
    if (path.runs[r].kind != removal::RunKind::tapping) out = std::max(out, path.of_runs[r].longest_feed_mm);
  return out;
}

/// Half width of the narrow band: three voxels for the field's sake, and the thickest chip with room for bending.
double band_voxels(const Job& job, double thickest) {
  constexpr double kMin = 4, kMax = 12, kBending_mm = 0.1;
  return std::clamp(std::ceil((thickest + kBending_mm) / job.simulation.voxel_mm) + 1, kMin, kMax);
}

MemoryEstimate check_memory_of(const Job& job, const SimulatedProgram& program, const machine::Box& stock, double band,
                               const TargetWork& work, Diagnostics& diagnostics) {
  const motion::PathStretch path = work.path ? work.path->stretch() : motion::PathStretch(program.path);
  return check_memory(job,
                      memory_factors(job, program.text(), program.moves_in_part(), path,
                                     {stock.min_mm, stock.max_mm, band}, work.within),
                      diagnostics);
}

double band_of(const Job& job, const SimulatedProgram& program, double min_chip_mm, const TargetWork& work) {
  const double chip = work.path ? thickest_chip_mm(work.path->outline) : thickest_chip_mm(job, program.path);
  return band_voxels(job, std::max(min_chip_mm, chip));
}

removal::Stock raw_stock(const Job& job, const SimulatedProgram& program, double min_chip_mm, MemoryEstimate& memory,
                         Diagnostics& diagnostics, const TargetWork& work) {
  const double band = band_of(job, program, min_chip_mm, work);
  const auto require_memory = [&](const Vec3& lo, const Vec3& hi) {
    memory = check_memory_of(job, program, {lo, hi}, band, work, diagnostics);
    diagnostics.throw_if_errors();
  };
  return job_stock(job, band, require_memory, work.within);
}

template <class Function>
void for_each_run(const Job& job, const removal::StampPath& path, Function f) {
  for (const auto& run : path.runs) {
    const std::span<const removal::Stamp> stamps(path.stamps.data() + run.from, run.count);
    f(run, job.tools.at(run.tool), stamps);
  }
}

/// Adds the passings of a run that the model does not cover, before its loads are added.
void add_range(const CutResult& run, CutResult& out) {
  if (!run.beyond_stamps.empty())
    out.deflection_limit_mm = out.beyond_stamps.empty() ? run.deflection_limit_mm
                                                        : std::min(out.deflection_limit_mm, run.deflection_limit_mm);
  out.deflection_max_mm = std::max(out.deflection_max_mm, run.deflection_max_mm);
  const auto before = static_cast<std::uint32_t>(out.loads.size());
  for (const std::uint32_t k : run.beyond_stamps) out.beyond_stamps.push_back(before + k);
  for (const std::uint32_t k : run.unsettled_stamps) out.unsettled_stamps.push_back(before + k);
}

std::vector<Contact> contacts_of(const removal::Stock& target, const machine::Tool& tool,
                                 std::span<const removal::Stamp> stamps, Stage& stage) {
  constexpr std::size_t kTogether = 10000;
  std::vector<Contact> out;
  out.reserve(stamps.size());
  for (std::size_t from = 0; from < stamps.size(); from += kTogether) {
    const auto some = stamps.subspan(from, std::min(kTogether, stamps.size() - from));
    const std::vector<Contact> found = find_contacts(target, tool, some);
    out.insert(out.end(), found.begin(), found.end());
    stage.advance(some.size());
  }
  return out;
}

/// The loads of a single run are not copied, unless there is room for all.
void append(std::vector<StampLoad> run, std::vector<StampLoad>& all) {
  if (all.capacity() == 0)
    all = std::move(run);
  else
    all.insert(all.end(), run.begin(), run.end());
}

void add_holes(removal::RunKind kind, const CutResult& run, HoleFigures& holes) {
  (kind == removal::RunKind::tapping ? holes.tapped_mm3 : holes.drilled_mm3) += run.stock_mm3;
  for (const StampLoad& load : run.loads) {
    holes.thrust_max_N = std::max(holes.thrust_max_N, load.force_max_N.z());
    holes.torque_max_Nmm = std::max(holes.torque_max_Nmm, load.torque_max_Nmm);
  }
}

}  // namespace

double envelope_step_mm(const Job& job, const machine::Tool& tool) {
  if (job.simulation.envelope_step_mm > 0) return job.simulation.envelope_step_mm;
  // A ring counts whole at the angle of its middle: two degrees of lag in one make the peak 2.5 % too high.
  constexpr double kMaxLag_rad = kPi / 180;
  const double lag_per_mm = std::tan(tool.helix_rad) / (tool.diameter_mm / 2);
  const double step = std::clamp(tool.diameter_mm / 100, 0.02, 0.1);
  return lag_per_mm > 0 ? std::min(step, kMaxLag_rad / lag_per_mm) : step;
}

namespace {

/// Curves between the ends of moves, and tools that lie on their side.
void add_turned(const Job& job, const SimulatedProgram& program, checks::Places& places) {
  for (const removal::Stamp& stamp : program.path.stamps) places.tip.add(stamp.pose.tip_mm);
  if (removal::all_upright(program.path.stamps)) return;
  for (const int tool : checks::cutting_tools(program.moves_in_part(), program.selected, program.holes))
    places.radius_mm = std::max(places.radius_mm, job.tools.at(tool).overhang_mm);
}

}  // namespace

MemoryEstimate check_memory_of(const Job& job, const SimulatedProgram& program, const machine::Box& stock,
                               Diagnostics& diagnostics) {
  return check_memory_of(job, program, stock, band_of(job, program, 0, {}), {}, diagnostics);
}

checks::Places places_of(const Job& job, const SimulatedProgram& program, const machine::Box& stock) {
  checks::Places out{checks::tip_extents(program.moves_in_part(), program.selected, program.holes), 0, stock};
  for (const int tool : checks::cutting_tools(program.moves_in_part(), program.selected, program.holes))
    out.radius_mm = std::max(out.radius_mm, job.tools.at(tool).diameter_mm / 2);
  if (program.turns()) add_turned(job, program, out);
  return out;
}

namespace {

/// The cutters of a nominal path.
struct NominalCutters {
  std::vector<removal::ToolRun> runs;
  std::vector<PathFraction> stamps;  ///< as Target::stamps
  removal::CutterPlaces places;
};

NominalCutters cutters_of(const Job& job, const removal::StampPath& nominal) {
  NominalCutters out{nominal.runs, {}, {}};
  for_each_run(job, nominal, [&](const removal::ToolRun& run, const machine::Tool& tool, auto stamps) {
    out.places.add(static_cast<std::int32_t>(run.from), removal::shape_of(tool), stamps);
  });
  out.stamps.reserve(nominal.stamps.size());
  for (const auto& s : nominal.stamps) out.stamps.push_back({s.move, static_cast<float>(s.fraction)});
  return out;
}

/// The stamps that a path has kept, in order. Returns its runs.
std::vector<removal::ToolRun> take_kept(const motion::SparsePath& path, const removal::TakeNominal& take) {
  auto run = path.outline.runs.begin();
  for (const ListRange& range : path.stamps.kept())
    for (std::size_t k = range.from; k < range.end; ++k) {
      while (k >= run->from + run->count) ++run;
      take(*run, k, path.stamps.all()[k]);
    }
  return path.outline.runs;
}

/// Those that reach into a region, or nearly. Without `stamps`.
NominalCutters cutters_within(const Job& job, const SimulatedProgram& target, const TargetWork& work) {
  const removal::Region& region = *work.within;
  constexpr double kTilesAround = 4;
  NominalCutters out;
  std::vector<removal::Stamp> stretch;
  std::size_t first = 0;
  int tool = 0;
  const auto put = [&] {
    if (!stretch.empty())
      out.places.add(static_cast<std::int32_t>(first), removal::shape_of(job.tools.at(tool)), stretch);
    stretch.clear();
  };
  std::optional<std::size_t> run_from;
  removal::Region near;
  const auto take = [&](const removal::ToolRun& run, std::size_t number, const removal::Stamp& stamp) {
    if (run_from != run.from) {
      put();
      run_from = run.from;
      tool = run.tool;
      near = region.wider(removal::shape_of(job.tools.at(tool)).radius_mm +
                          kTilesAround * removal::kTileVoxels * job.simulation.voxel_mm);
    }
    if (first + stretch.size() != number) put();
    if (!near.contains(stamp.pose.tip_mm)) return put();
    if (stretch.empty()) first = number;
    stretch.push_back(stamp);
  };
  if (work.nominal)
    out.runs = take_kept(*work.nominal, take);
  else
    out.runs =
        removal::follow_nominal_path(target.moves_in_part(), target.selected, target.path, target.part_path(), take);
  put();
  return out;
}

/// Less than this is what fields that touch may differ by.
double nothing_mm3(const Job& job) { return std::pow(job.simulation.voxel_mm, 3); }

}  // namespace

double sweep_underside(removal::Stock& stock, const machine::Tool& tool, std::span<const removal::Stamp> stamps,
                       double allowance_mm, std::int32_t first_id) {
  const removal::CutterShape shape = removal::shape_of(tool);
  machine::Tool bottom;
  bottom.type = machine::ToolType::flat;
  bottom.diameter_mm = 2 * std::min(shape.bottom_length_mm(), shape.radius_mm - allowance_mm);
  if (shape.general || bottom.diameter_mm < stock.voxel_mm()) return 0;
  const double underside_mm = stock.min_mm().z();
  std::vector<removal::Stamp> through;
  for (const removal::Stamp& s : stamps)
    if (s.pose.upright() && std::abs(s.pose.tip_mm.z() - underside_mm) < allowance_mm) {
      through.push_back(s);
      through.back().pose.tip_mm.z() = underside_mm - stock.voxel_mm();
    }
  return through.empty() ? 0 : removal::sweep(stock, removal::shape_of(bottom), through, {.first_id = first_id});
}

double sweep_path(removal::Stock& stock, const Job& job, const removal::StampPath& path, double shrink_mm,
                  const std::string& what) {
  Stage stage(what, path.stamps.size());
  double removed_mm3 = 0;
  for_each_run(job, path, [&](const removal::ToolRun& run, const machine::Tool& tool, auto stamps) {
    if (shrink_mm > 0 && run.kind != removal::RunKind::milling) return;
    removed_mm3 +=
        removal::sweep(stock, removal::shape_of(tool), stamps,
                       {.shrink_mm = shrink_mm, .first_id = static_cast<std::int32_t>(run.from), .stage = &stage});
  });
  auto next_id = static_cast<std::int32_t>(path.stamps.size());
  for_each_run(job, path, [&](const removal::ToolRun& run, const machine::Tool& tool, auto stamps) {
    if (shrink_mm <= 0 || run.kind != removal::RunKind::milling) return;
    removed_mm3 += sweep_underside(stock, tool, stamps, shrink_mm, next_id);
    next_id += static_cast<std::int32_t>(run.count);
  });
  return_freed_memory();  // of tiles
  return removed_mm3;
}

Blank make_blank(const Job& job, const SimulatedProgram& target, Diagnostics& diagnostics, double min_chip_mm) {
  return make_blank(job, target, diagnostics, min_chip_mm, {});
}

Blank make_blank(const Job& job, const SimulatedProgram& target, Diagnostics& diagnostics, double min_chip_mm,
                 const TargetWork& work) {
  MemoryEstimate memory;
  removal::Stock blank = raw_stock(job, target, min_chip_mm, memory, diagnostics, work);
  blank.share();
  checks::Places places = places_of(job, target, {blank.min_mm(), blank.max_mm()});
  if (!removal::all_upright(target.path.stamps))  // a tilted tool reaches down past its tip
    places.tip.add(places.tip.min_mm - Vec3(0, 0, places.radius_mm));
  checks::check_places(target.text().source.name(), places, diagnostics);
  diagnostics.throw_if_errors();
  std::optional<removal::Stock> whole;
  if (job.stock.allowance_mm > 0) {
    whole.emplace(blank);
    const double removed_mm3 =
        work.allowance ? work.allowance(blank)
                       : sweep_path(blank, job, target.path, job.stock.allowance_mm, "cutting up to the allowance");
    if (removed_mm3 < nothing_mm3(job)) checks::report_allowance(job, diagnostics);
    diagnostics.throw_if_errors();
    blank.clear_stamps();
    blank.share();
  }
  return {std::move(blank), std::move(whole), memory};
}

namespace {

std::shared_ptr<const PartSurvey> survey_of(const Job& job, const Target& target, const removal::StampPath& path) {
  PartSurveyOptions options;
  options.cell_mm = part_cell_mm(job, target.surface, target.map->points());
  return std::make_shared<const PartSurvey>(survey_part(job, target.blank, path, options));
}

}  // namespace

Target make_target(const Job& job, const SimulatedProgram& target, Diagnostics& diagnostics) {
  return make_target(job, target, diagnostics, {});
}

Target make_target(const Job& job, const SimulatedProgram& target, Diagnostics& diagnostics, const TargetWork& work) {
  auto [blank, whole, memory] = make_blank(job, target, diagnostics, 0, work);
  const checks::Places where = places_of(job, target, {blank.min_mm(), blank.max_mm()});
  removal::Stock surface(blank);
  NominalCutters cutters;
  double removed_mm3 = 0;
  if (work.within) {
    removed_mm3 = work.surface(surface);
    cutters = cutters_within(job, target, work);
  } else {
    const removal::StampPath nominal =
        removal::nominal_path(target.moves_in_part(), target.selected, target.path, target.part_path());
    removed_mm3 = work.surface ? work.surface(surface) : sweep_path(surface, job, nominal, 0, "cutting as the target");
    cutters = cutters_of(job, nominal);
  }
  if (removed_mm3 < nothing_mm3(job)) checks::report_nothing_removed(target.text().source.name(), where, diagnostics);
  diagnostics.throw_if_errors();
  std::optional<removal::PartMesh> part;
  if (!job.part.mesh.empty() && work.judged) {
    part.emplace(closed_mesh(machine::part_mesh(job.part), job.part.mesh));
    checks::check_part_size(job.part.mesh, {part->min_mm(), part->max_mm()}, where.stock, diagnostics);
    diagnostics.throw_if_errors();
  }
  Target out{std::move(blank), std::move(surface),
             std::move(part),  HoleStamps(removal::StampPath{{}, cutters.runs, {}}),
             std::move(whole), std::move(cutters.stamps)};
  out.critical_depths = std::make_shared<CriticalDepths>();
  out.map.emplace(out.surface, cutters.places, out.blank, &out.solid());
  cutters = {};
  out.unseen_mm2 = out.map->unseen_mm2();
  if (work.contour)
    work.contour(out);
  else
    mark_contour(job, target.path, out);
  if (work.judged && !work.within) part_contour(job, target, out);
  if (work.judged) mark_region(job, target, out.map->points(), out);
  if (job.workpiece && !work.within) out.part_yields = survey_of(job, out, target.path);
  out.memory = memory;
  return out;
}

namespace {

/// How the runs of a path are cut.
struct PathCut {
  machine::Coupling coupling = machine::Coupling::static_;
  double chip_ratio = 0;
  std::optional<std::size_t> turn_from{};
  const std::function<void(double)>& progress;
  removal::SurfaceMap* surface = nullptr;
  std::vector<std::vector<Contact>> contacts{};  ///< one per run, or empty
  const PartSurvey* part_yields = nullptr;       ///< along the path
  removal::SurfaceMap* tool_surface = nullptr;   ///< see CutOptions
  LeadingRuns* leading = nullptr;                ///< see PredictOptions
  bool begun = false;                            ///< the stock, the surface and the loads are those after `leading`
};

CutOptions cut_options_of(const Job& job, const PathCut& how, const machine::Tool& tool) {
  CutOptions out;
  out.surface = how.surface;
  out.tool_surface = how.tool_surface;
  out.coupling = how.coupling;
  out.chip_ratio = how.chip_ratio;
  out.axis_compliance_mm_per_N = {1 / job.machine.axis[0].stiffness_N_per_mm,
                                  1 / job.machine.axis[1].stiffness_N_per_mm,
                                  1 / job.machine.axis[2].stiffness_N_per_mm};
  out.envelope_step_mm = envelope_step_mm(job, tool);
  out.rotation_step_rad = job.simulation.rotation_step_rad;
  return out;
}

/// Adds the figures of a run, but for its loads and its turn.
void add_figures(const CutResult& run, removal::RunKind kind, CutResult& out) {
  out.chip_mm3 += run.chip_mm3;
  if (kind != removal::RunKind::tapping) out.stock_mm3 += run.stock_mm3;
  out.rounds_max = std::max(out.rounds_max, run.rounds_max);
  out.read += run.read;
  out.extrapolation.add(run.extrapolation);
  out.unsettled += run.unsettled;
  add_range(run, out);
  out.unsettled_moves.insert(out.unsettled_moves.end(), run.unsettled_moves.begin(), run.unsettled_moves.end());
  out.unsettled_reasons.insert(out.unsettled_reasons.end(), run.unsettled_reasons.begin(), run.unsettled_reasons.end());
}

CutResult cut_run_of(removal::Stock& stock, const Job& job, const removal::ToolRun& run,
                     std::span<const removal::Stamp> stamps, const std::vector<Contact>& contacts,
                     const CutOptions& options) {
  const machine::Tool& tool = job.tools.at(run.tool);
  const auto first_id = static_cast<std::int32_t>(run.from);
  if (run.kind == removal::RunKind::milling) return cut(stock, tool, job.material, stamps, contacts, first_id, options);
  if (run.kind == removal::RunKind::drilling) return drill(stock, tool, job.material, stamps, first_id, options);
  return tap(stock, tool, stamps, first_id, options);
}

/// Tooth passings without a static equilibrium: about half a minute of them.
constexpr std::size_t kGiveUpAfter = 2000;

/// Keeps the state after the first runs of a path. From now on it shares the stock.
void keep(removal::Stock& stock, const removal::StampPath& path, const PathLoads& loads, const PathCut& how) {
  const std::size_t runs = how.leading->runs, stamps = path.runs[runs - 1].from + path.runs[runs - 1].count;
  stock.share();
  how.leading->cut.emplace(LeadingRuns::Cut{{path.stamps.begin(), path.stamps.begin() + std::ptrdiff_t(stamps)},
                                            {path.runs.begin(), path.runs.begin() + std::ptrdiff_t(runs)},
                                            removal::Stock(stock),
                                            removal::SurfaceMap(*how.surface),
                                            loads});
}

/// Cuts every run of the path out of `stock`, which is `blank` before the first one.
PathLoads cut_path(removal::Stock& stock, const removal::Stock& blank, const Job& job, const SimulatedProgram& program,
                   PathCut how) {
  PathLoads out = how.begun ? how.leading->cut->loads : PathLoads();
  const std::size_t known = how.begun ? how.leading->cut->runs.size() : 0;
  const auto all = static_cast<double>(program.path.stamps.size());
  auto next_contacts = how.contacts.begin();
  std::size_t run_index = 0, yielding_run = 0;
  out.holes.count = removal::count_holes(program.moves_in_part(), program.holes);
  for_each_run(job, program.path, [&](const removal::ToolRun& run, const machine::Tool& tool, auto stamps) {
    const std::size_t from = run.from;
    const std::vector<Contact> contacts = how.contacts.empty() ? std::vector<Contact>() : std::move(*next_contacts++);
    if (run_index++ < known) return;
    CutOptions options = cut_options_of(job, how, tool);
    if (from == program.path.runs.front().from) options.blank = &blank;
    const std::optional<deflection::PartCompliance> part =
        how.part_yields ? how.part_yields->along(program.path, yielding_run++) : std::nullopt;
    if (part) options.part = &*part;
    if (how.progress)
      options.progress = [&](double fraction) {
        how.progress((static_cast<double>(from) + fraction * static_cast<double>(stamps.size())) / all);
      };
    if (how.turn_from && *how.turn_from >= from && *how.turn_from < from + stamps.size())
      options.turn_from = *how.turn_from - from;
    options.give_up_after = kGiveUpAfter;
    CutResult cut_run;
    try {
      cut_run = cut_run_of(stock, job, run, stamps, contacts, options);
    } catch (const NoRest& given_up) {
      throw BeyondModel(no_rest_sentence(program, given_up));
    }
    if (how.chip_ratio > 0) cut_run.loads_at_ratio.resize(stamps.size());
    add_piece(run, std::move(cut_run), out);
    if (how.leading && !how.begun && run_index == how.leading->runs) keep(stock, program.path, out, how);
  });
  return out;
}

}  // namespace

void add_piece(const removal::ToolRun& run, CutResult piece, PathLoads& out) {
  const bool milling = run.kind == removal::RunKind::milling;
  if (!milling) add_holes(run.kind, piece, out.holes);
  add_figures(piece, run.kind, out.cut);
  append(std::move(piece.loads), out.cut.loads);
  if (!piece.loads_at_ratio.empty()) append(std::move(piece.loads_at_ratio), out.cut.loads_at_ratio);
  if (!piece.turn.teeth.empty()) out.cut.turn = std::move(piece.turn);
}

CutResult cut_piece(removal::Stock& stock, const Job& job, const motion::PathStretch& path, const PieceCut& piece) {
  const removal::ToolRun& run = path.runs[piece.run];
  const machine::Tool& tool = job.tools.at(run.tool);
  const std::span<const removal::Stamp> stamps = path.stamps_of(run);
  const std::function<void(double)> progress = piece.progress;
  CutOptions options =
      cut_options_of(job, {.coupling = piece.coupling, .progress = progress, .surface = piece.surface}, tool);
  options.blank = piece.before_run;
  options.progress = progress;
  options.known = piece.known;
  if (run.kind != removal::RunKind::milling) {
    assert(piece.from == 0 && piece.count == run.count);
    return cut_run_of(stock, job, run, stamps, {}, options);
  }
  if (piece.turn_from && *piece.turn_from >= run.from) options.turn_from = *piece.turn_from - run.from;
  const std::vector<Contact> contacts = find_contacts(*piece.target, tool, stamps.subspan(piece.from, piece.count));
  return cut_range(stock, tool, job.material,
                   {stamps, piece.from, piece.count, contacts, static_cast<std::int32_t>(run.from), piece.bend},
                   options);
}

namespace {

/// Returns the survey that is known, or that of the target's path, or one of the program's own where that takes other
/// ways.
std::shared_ptr<const PartSurvey> part_under(const Job& job, const Target& target, const SimulatedProgram& program,
                                             const std::shared_ptr<const PartSurvey>& known) {
  if (!target.part_yields) return nullptr;
  if (known && known->fits(program.path)) return known;
  if (target.part_yields->fits(program.path)) return target.part_yields;
  PartSurveyOptions options;
  options.cell_mm = target.part_yields->cell_mm;
  return std::make_shared<const PartSurvey>(survey_part(job, target.blank, program.path, options));
}

Prediction::DeflectionFigures deflection_figures(const std::vector<removal::SurfacePoint>& surface,
                                                 std::shared_ptr<const PartSurvey> survey) {
  std::vector<double> tool, part, area;
  for (const removal::SurfacePoint& p : surface) {
    if (!p.valid) continue;
    part.push_back(1000 * static_cast<double>(p.part_mm));
    tool.push_back(1000 * (p.error_mm - p.contour_mm) - part.back());
    area.push_back(p.area_mm2);
  }
  return {removal::error_figures(tool, area), removal::error_figures(part, area), std::move(survey)};
}

}  // namespace

bool LeadingRuns::begin(const removal::StampPath& path) const {
  if (!cut || path.runs.size() < cut->runs.size() || path.stamps.size() < cut->stamps.size()) return false;
  const auto same_run = [](const removal::ToolRun& a, const removal::ToolRun& b) {
    return a.tool == b.tool && a.from == b.from && a.count == b.count && a.kind == b.kind;
  };
  const auto same_stamp = [](const removal::Stamp& a, const removal::Stamp& b) {
    return a.t_s == b.t_s && a.pose.tip_mm == b.pose.tip_mm && a.pose.axis == b.pose.axis &&
           a.pose.spin_rad == b.pose.spin_rad && a.feed_per_tooth_mm == b.feed_per_tooth_mm &&
           a.fraction == b.fraction && a.first == b.first && a.move == b.move;
  };
  return std::equal(cut->runs.begin(), cut->runs.end(), path.runs.begin(), same_run) &&
         std::equal(cut->stamps.begin(), cut->stamps.end(), path.stamps.begin(), same_stamp);
}

PathLoads predict_loads(const Job& job, const removal::Stock& blank, const SimulatedProgram& program,
                        const LoadOptions& options) {
  removal::Stock stock(blank);
  return cut_path(stock, blank, job, program,
                  {.coupling = options.coupling, .chip_ratio = options.chip_ratio, .progress = options.progress});
}

Prediction predict(const Job& job, const Target& target, const SimulatedProgram& program,
                   const PredictOptions& options) {
  const std::shared_ptr<const PartSurvey> part_yields = part_under(job, target, program, options.part_yields);
  LeadingRuns* leading = part_yields || options.turn_from || options.chip_ratio > 0 ? nullptr : options.leading;
  const bool begun = leading && leading->begin(program.path);
  const std::size_t begun_stamps = begun ? leading->cut->stamps.size() : 0;
  std::vector<std::vector<Contact>> contacts_of_runs;
  std::optional<Stage> stage(std::in_place, "finding the contacts", program.path.stamps.size());
  for_each_run(job, program.path, [&](const removal::ToolRun& run, const machine::Tool& tool, auto stamps) {
    auto& contacts = contacts_of_runs.emplace_back();
    if (options.contacts && run.kind == removal::RunKind::milling && run.from >= begun_stamps)
      contacts = contacts_of(target.surface, tool, stamps, *stage);
  });
  stage.reset();
  if (options.surface_read) options.surface_read();
  removal::SurfaceMap map = begun ? leading->cut->marks : options.take_map ? options.take_map() : *target.map;
  auto machined = std::make_unique<removal::Stock>(begun ? leading->cut->stock : target.blank);
  std::optional<removal::SurfaceMap> tool_surface;
  if (part_yields) tool_surface.emplace(map);
  PathLoads loads = cut_path(*machined, target.blank, job, program,
                             {.coupling = job.simulation.coupling,
                              .chip_ratio = options.chip_ratio,
                              .turn_from = options.turn_from,
                              .progress = options.progress,
                              .surface = &map,
                              .contacts = std::move(contacts_of_runs),
                              .part_yields = part_yields.get(),
                              .tool_surface = tool_surface ? &*tool_surface : nullptr,
                              .leading = leading,
                              .begun = begun});
  std::vector<removal::SurfacePoint> surface = map.take();
  if (tool_surface) {
    const std::vector<float> of_tool = tool_surface->take_errors_mm();
    for (std::size_t i = 0; i < surface.size(); ++i)
      surface[i].part_mm = static_cast<float>(surface[i].error_mm) - of_tool[i];
  }
  Prediction out = judge(job, target, program, std::move(loads), std::move(surface), std::move(machined));
  if (part_yields) out.deflection_parts_um = deflection_figures(out.surface, part_yields);
  return out;
}

namespace {

/// Volume of the allowance in which cutters stand right after a rapid, mm^3, less the chips that are counted there. A
/// cutter that reaches deeper into the blank than the allowance does not count.
double allowance_at_rapids_mm3(const Job& job, const removal::Stock& blank, const removal::StampPath& path,
                               std::span<const StampLoad> loads) {
  constexpr double kDeeper = 0.1;  // of what it takes
  const double allowance_mm = job.stock.allowance_mm;
  removal::Stock stock(blank);
  double sum = 0;
  for_each_run(job, path, [&](const removal::ToolRun& run, const machine::Tool& tool, auto stamps) {
    const removal::CutterShape shape = removal::shape_of(tool);
    const auto take = [&](std::size_t from, std::size_t count, double shrink_mm) {
      return removal::sweep(stock, shape, stamps.subspan(from, count),
                            {.shrink_mm = shrink_mm, .first_id = static_cast<std::int32_t>(run.from + from)});
    };
    for (std::size_t from = 0; from < stamps.size();) {
      std::size_t end = from + 1;
      while (end < stamps.size() && !stamps[end].first) ++end;
      if (run.kind == removal::RunKind::milling && stamps[from].first) {
        const double deeper = take(from, 1, allowance_mm), taken = take(from, 1, 0);
        if (deeper <= kDeeper * taken) sum += std::max(0.0, taken - loads[run.from + from].chip_mm3);
      }
      take(from, end - from, 0);
      from = end;
    }
  });
  return sum;
}

Prediction::ContourFigures contour_figures(const std::vector<removal::SurfacePoint>& surface) {
  std::vector<double> lag, tolerance, corner, area;
  for (const removal::SurfacePoint& p : surface) {
    if (!p.valid) continue;
    lag.push_back(1000 * static_cast<double>(p.lag_mm));
    tolerance.push_back(1000 * static_cast<double>(p.path_tolerance_mm));
    corner.push_back(1000 * p.contour_mm - lag.back() - tolerance.back());
    area.push_back(p.area_mm2);
  }
  return {removal::error_figures(lag, area), removal::error_figures(tolerance, area),
          removal::error_figures(corner, area)};
}

}  // namespace

Prediction judge(const Job& job, const Target& target, const SimulatedProgram& program, PathLoads loads,
                 std::vector<removal::SurfacePoint> surface, std::unique_ptr<removal::Stock> machined) {
  Prediction out;
  out.machined = std::move(machined);
  out.cut = std::move(loads.cut);
  out.holes = loads.holes;
  out.surface = std::move(surface);
  for (std::size_t i = 0; i < out.surface.size(); ++i)
    out.surface[i].contour_mm = static_cast<double>(target.contour_mm[i]);
  if (target.contour_parts)
    for (std::size_t i = 0; i < out.surface.size(); ++i) {
      out.surface[i].lag_mm = target.contour_parts->lag_mm[i];
      out.surface[i].path_tolerance_mm = target.contour_parts->path_tolerance_mm[i];
    }
  drop_left_out(target.region, out.surface);
  out.border_mm2 = target.region.border_mm2;
  out.not_judged_mm2 = target.region.not_judged_mm2;
  out.between = target.region.between;
  out.unseen_mm2 = target.unseen_mm2;
  out.holes.surface_mm2 = target.holes.drop_from(out.surface);
  CriticalDepths own;
  out.chatter = find_chatter(job, program, out.cut.loads, target.critical_depths ? *target.critical_depths : own);
  out.validity = find_validity(job, program, out.cut, out.chatter.invalid_stamps, out.surface);
  if (job.stock.allowance_mm > 0 && out.validity.all() && !program.path.stamps.empty() &&
      imbalance(out.cut.chip_mm3, out.cut.stock_mm3, job.simulation.voxel_mm) < -kMaxImbalance)
    out.cut.rapid_mm3 = allowance_at_rapids_mm3(job, target.blank, program.path, out.cut.loads);
  std::vector<double> error_um, deflection_um, contour_um, area;
  for (auto* values : {&error_um, &deflection_um, &contour_um, &area}) values->reserve(out.surface.size());
  for (const auto& p : out.surface) {
    if (!p.valid) continue;
    error_um.push_back(1000 * p.error_mm);
    deflection_um.push_back(1000 * (p.error_mm - p.contour_mm));
    contour_um.push_back(1000 * p.contour_mm);
    area.push_back(p.area_mm2);
  }
  if (target.part) {
    out.total_error_mm.resize(out.surface.size());
    tbb::parallel_for(std::size_t{0}, out.surface.size(), [&](std::size_t i) {
      const removal::SurfacePoint& p = out.surface[i];
      out.total_error_mm[i] = target.part->distance_mm(p.place_mm + p.error_mm * p.normal);
    });
  }
  out.form_error_um = removal::error_figures(error_um, area);
  out.deflection_um = removal::error_figures(deflection_um, area);
  out.contour_um = removal::error_figures(contour_um, area);
  if (target.contour_parts && out.contour_um.p95 >= kWorthParting_um)
    out.contour_parts_um = contour_figures(out.surface);
  return out;
}

}  // namespace camber::simulate
