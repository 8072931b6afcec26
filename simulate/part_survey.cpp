#include "simulate/part_survey.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "base/diagnostics.h"
#include "base/stage.h"
#include "removal/cutter.h"
#include "removal/engagement.h"
#include "simulate/cut.h"
#include "simulate/tooth_loads.h"
#include "workpiece/elastic.h"

namespace camber::simulate {

using deflection::PartCompliance;
using removal::Stamp;
using removal::Stock;

namespace {

/// Stamps from ... end - 1 of a run, without a rapid between them.
struct StampStretch {
  std::size_t from = 0, end = 0;
  double share_of(std::size_t stamp) const {
    return end - from > 1 ? static_cast<double>(stamp - from) / static_cast<double>(end - from - 1) : 0;
  }
  std::size_t stamp_at(double share) const {
    return from + static_cast<std::size_t>(std::lround(share * static_cast<double>(end - from - 1)));
  }
};

std::vector<StampStretch> stretches_of(std::span<const Stamp> stamps) {
  std::vector<StampStretch> out;
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    if (k == 0 || stamps[k].first) out.push_back({k, k});
    out.back().end = k + 1;
  }
  return out;
}

/// A point of the tool that touches the part.
struct Touch {
  Vec3 in_part_mm;
  double height_mm;
  double weight;
};

/// Points of a coarse envelope where the tool cuts, or slides along what it has cut.
class Toucher {
 public:
  Toucher(const machine::Tool& tool, double top_mm)
      : envelope_(removal::make_envelope(tool, top_mm, std::max(0.1, top_mm / 60), kTurn_rad)) {}

  std::vector<Touch> find(const Stock& stock, std::span<const Stamp> stamps, std::size_t k) const {
    constexpr double kTouching_mm = 0.03, kSteep = 0.3, kBehind = -0.02, kSlides = 0.01;
    const Stock::Probe probe(stock);
    const removal::ToothMotion motion = removal::motion_in_tool(stamps, k);
    const double feed = motion.tip_mm.norm();
    std::vector<Touch> out;
    for (std::size_t i = 0; i < envelope_.size(); ++i) {
      const Vec3 place(envelope_.x[i], envelope_.y[i], envelope_.z[i]),
          normal(envelope_.nx[i], envelope_.ny[i], envelope_.nz[i]);
      const double ahead = motion.at(place).dot(normal);
      if (ahead < kBehind * feed) continue;
      const Vec3 in_part = point_in_part(stamps[k].pose, place);
      const double depth = -probe.distance_mm(in_part);
      const bool wall = normal.head<2>().norm() > kSteep;
      if (depth < (wall ? -kTouching_mm : 0.0)) continue;
      const auto& ring = envelope_.rings[i / static_cast<std::size_t>(envelope_.steps)];
      const double chip = std::max(0.0, std::min(depth, ahead)) + (wall ? kSlides * feed : 0);
      if (chip > 0) out.push_back({in_part, place.z(), chip * ring.width_mm * ring.profile.radius_mm});
    }
    return out;
  }

 private:
  static constexpr double kTurn_rad = 5 * kPi / 180;
  removal::EnvelopeGrid envelope_;
};

/// Touching points gathered at heights of their own.
struct Patches {
  double low_mm = 0, high_mm = 0;  ///< of the points
  std::vector<double> height_mm;   ///< of the middle of each
  std::vector<workpiece::NodeWeights> where;
};

/// One height where the points are nearly level, up to three where they are far apart.
Patches gather(const workpiece::Solid& solid, std::span<const Touch> touches) {
  constexpr double kLevel_mm = 0.5, kNear_mm = 2.5;
  const auto [low, high] = std::ranges::minmax(touches, {}, &Touch::height_mm);
  const double from = low.height_mm, range = high.height_mm - from;
  const std::size_t count = range < kLevel_mm ? 1 : range < kNear_mm ? 2 : 3;
  Patches all;
  std::vector<double> weight(count);
  all.height_mm.resize(count), all.where.resize(count);
  for (const Touch& t : touches) {
    const double at = count == 1 ? 0 : (t.height_mm - from) / range * static_cast<double>(count - 1);
    for (std::size_t i = 0; i < count; ++i) {
      const double share = t.weight * std::max(0.0, 1 - std::abs(at - static_cast<double>(i)));
      if (share <= 0) continue;
      weight[i] += share;
      all.height_mm[i] += share * t.height_mm;
      all.where[i].add(solid.at(t.in_part_mm), share);
    }
  }
  Patches out{from, high.height_mm, {}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    double nodes = 0;
    for (const auto& w : all.where[i].nodes) nodes += w.weight;
    if (!(nodes > 0)) continue;
    out.height_mm.push_back(all.height_mm[i] / weight[i]);
    for (auto& w : all.where[i].nodes) w.weight /= nodes;
    out.where.push_back(std::move(all.where[i]));
  }
  return out;
}

/// Displacements at a run's heights by those at the patches' own: linear between these, and beyond them up to where the
/// points end. [2 heights + 1][2 patches + 1]
Eigen::MatrixXd spread_over(const std::vector<double>& heights, const Patches& patches) {
  const std::vector<double>& own = patches.height_mm;
  const std::size_t n = heights.size(), p = own.size();
  Eigen::MatrixXd out =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(2 * n + 1), static_cast<Eigen::Index>(2 * p + 1));
  out(out.rows() - 1, out.cols() - 1) = 1;
  for (std::size_t i = 0; i < n; ++i) {
    const double z = std::clamp(heights[i], patches.low_mm, patches.high_mm);
    std::size_t lower = 0;
    while (lower + 2 < p && z > own[lower + 1]) ++lower;
    const double way = p < 2 ? 0 : (z - own[lower]) / (own[lower + 1] - own[lower]);
    for (int a = 0; a < 2; ++a) {
      const auto row = static_cast<Eigen::Index>(2 * i) + a, column = static_cast<Eigen::Index>(2 * lower) + a;
      out(row, column) = 1 - way;
      if (p > 1) out(row, column + 2) = way;
    }
  }
  return out;
}

workpiece::SolidOptions solid_options(const machine::Workpiece& part, double cell_mm,
                                      const removal::MeshDistance* held) {
  workpiece::SolidOptions out;
  out.cell_mm = cell_mm;
  out.youngs_modulus_MPa = part.youngs_modulus_MPa;
  out.poisson_ratio = part.poisson_ratio;
  out.bottom = part.fixed_bottom;
  if (std::isfinite(part.fixture_stiffness_N_per_mm)) out.fixture_stiffness_N_per_mm = part.fixture_stiffness_N_per_mm;
  if (held)
    out.held = [held](const Vec3& p) { return held->distance_mm(p) <= 0; };
  else if (!part.fixed_boxes.empty())
    out.held = [&boxes = part.fixed_boxes](const Vec3& p) {
      return std::ranges::any_of(boxes, [&](const machine::Box& b) {
        return (p.array() >= b.min_mm.array()).all() && (p.array() <= b.max_mm.array()).all();
      });
    };
  return out;
}

[[noreturn]] void loose(const machine::Job& job, std::string message) {
  Diagnostic d = job.workpiece->place;
  d.message = std::move(message);
  d.check = "workpiece-loose";
  throw InputError({d});
}

/// A run, and how its places are solved.
struct RunToSurvey {
  const machine::Job& job;
  std::span<const Stamp> stamps;
  const PartSurveyOptions& options;
  const workpiece::SolidOptions& solid;
  removal::CutterShape shape;
  const Toucher& toucher;
  const std::vector<double>& height_mm;
};

/// Surveys one stretch of a run.
class StretchSurvey {
 public:
  struct Found {
    std::vector<PartSurvey::Place> places;  ///< in the order of the path
    std::size_t cells = 0;                  ///< at most
    double cell_mm = 0, compliance_max_um_per_N = 0;
  };

  /// `stock`: before the stretch.
  StretchSurvey(const RunToSurvey& run, std::size_t index, StampStretch stretch, Stock stock)
      : run_(run), index_(index), stretch_(stretch), stock_(std::move(stock)) {}

  void survey(Stage& stage) {
    std::size_t at = stretch_.from;
    const std::size_t last = stretch_.end - 1;
    Compliance here = solve(stock_, at);
    while (at < last) {
      std::size_t next = at;
      for (double way = 0; next < last && way < run_.options.apart_mm; ++next) way += way_mm(next, next + 1);
      Stock after(stock_);
      sweep(after, at, next);
      Compliance there = solve(after, next);
      refine(stock_, at, here, next, there);
      sweep(stock_, at, next);
      stage.advance(next - at);
      at = next;
      here = std::move(there);
    }
    stage.advance();
    std::ranges::sort(found_.places, {}, &PartSurvey::Place::share);
  }

  const Found& found() const { return found_; }

 private:
  using Compliance = std::optional<Eigen::MatrixXd>;

  void sweep(Stock& stock, std::size_t from, std::size_t end) const {
    if (end > from) removal::sweep(stock, run_.shape, run_.stamps.subspan(from, end - from), {});
  }

  double way_mm(std::size_t from, std::size_t end) const {
    double sum = 0;
    for (std::size_t k = from; k < end; ++k)
      sum += (run_.stamps[k + 1].pose.tip_mm - run_.stamps[k].pose.tip_mm).norm();
    return sum;
  }

  /// Solves between two places until the line between them is near enough. `stock`: before stamp a.
  void refine(const Stock& stock, std::size_t a, const Compliance& at_a, std::size_t b, const Compliance& at_b) {
    constexpr double kShort_mm = 1;
    if (b - a < 2 || (!at_a && !at_b) || way_mm(a, b) < kShort_mm) return;
    const std::size_t k = (a + b) / 2;
    Stock between(stock);
    sweep(between, a, k);
    const Compliance here = solve(between, k);
    if (at_a && at_b && here) {
      const double way = static_cast<double>(k - a) / static_cast<double>(b - a);
      const double off = (*here - (1 - way) * *at_a - way * *at_b).norm();
      // What is left between is a quarter of it, if the compliance bends evenly.
      if (off < std::max(4 * run_.options.tolerance * here->norm(), run_.options.negligible_mm_per_N)) return;
    }
    refine(stock, a, at_a, k, here);
    refine(between, k, here, b, at_b);
  }

  /// Empty where the tool touches nothing.
  Compliance solve(const Stock& stock, std::size_t k) {
    const std::vector<Touch> touches = run_.toucher.find(stock, run_.stamps, k);
    if (touches.empty()) return std::nullopt;
    const workpiece::Solid solid(stock, run_.solid);
    if (solid.held_mm3() <= 0)
      loose(run_.job, "fixed holds nothing of the part's material; a part that is held in the stock was expected");
    const Patches patches = gather(solid, touches);
    if (patches.where.empty()) return std::nullopt;
    const ToolPose& pose = run_.stamps[k].pose;
    const Mat3 frame = tool_frame(pose);
    std::vector<workpiece::Load> loads;
    for (const auto& where : patches.where)
      for (int a = 0; a < 2; ++a) loads.push_back({where, frame.col(a)});
    loads.push_back({patches.where.front(), frame.col(2)});
    const workpiece::Elastic elastic(solid);
    workpiece::ElasticSummary summary;
    constexpr double kTolerance = 1e-4;
    const auto moved = elastic.solve(loads, {kTolerance, 300}, &summary);
    if (!summary.solved)
      loose(run_.job,
            fmt::format("under the tool at X{:.1f} Y{:.1f} Z{:.1f} the part hangs on next to nothing that is held; "
                        "a part in one piece was expected",
                        pose.tip_mm.x(), pose.tip_mm.y(), pose.tip_mm.z()));
    const auto size = static_cast<Eigen::Index>(loads.size());
    Eigen::MatrixXd own(size, size);
    for (Eigen::Index i = 0; i < size; ++i)
      for (Eigen::Index j = 0; j < size; ++j) {
        const workpiece::Load& read = loads[static_cast<std::size_t>(i)];
        own(i, j) = read.direction.dot(displacement_mm(read.where, moved[static_cast<std::size_t>(j)]));
      }
    const Eigen::MatrixXd spread = spread_over(run_.height_mm, patches);
    const Eigen::MatrixXd here = spread * ((own + own.transpose()) / 2) * spread.transpose();
    found_.places.push_back({index_, stretch_.share_of(k), here});
    found_.cells = std::max(found_.cells, solid.cells().size());
    found_.cell_mm = solid.cell_mm();
    found_.compliance_max_um_per_N = std::max(found_.compliance_max_um_per_N, 1000 * own.diagonal().maxCoeff());
    return here;
  }

  const RunToSurvey& run_;
  std::size_t index_;  ///< of the run's stretches
  StampStretch stretch_;
  Stock stock_;
  Found found_;
};

double top_of(const Stock& stock, const machine::Tool& tool, std::span<const Stamp> stamps) {
  double rise = 0;
  for (const Stamp& s : stamps) {
    const Vec3 corner = (s.pose.axis.array() > 0).select(stock.max_mm(), stock.min_mm());
    rise = std::max(rise, (corner - s.pose.tip_mm).dot(s.pose.axis));
  }
  return engaged_top_mm(stock, tool, rise);
}

std::vector<double> run_heights_mm(double top_mm) {
  constexpr double kApart_mm = 4;
  const std::size_t count = std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(top_mm / kApart_mm)) + 1, 2, 6);
  std::vector<double> out;
  for (std::size_t i = 0; i < count; ++i)
    out.push_back(top_mm * static_cast<double>(i) / static_cast<double>(count - 1));
  return out;
}

void add(const StretchSurvey::Found& found, PartSurvey& all, PartSurvey::Run& out) {
  out.places.insert(out.places.end(), found.places.begin(), found.places.end());
  all.solved += found.places.size();
  all.cells = std::max(all.cells, found.cells);
  if (found.cell_mm > 0) all.cell_mm = found.cell_mm;
  all.compliance_max_um_per_N = std::max(all.compliance_max_um_per_N, found.compliance_max_um_per_N);
}

/// Surveys one run, several stretches at once; leaves `stock` as the run does.
void survey_run(const RunToSurvey& run, Stock& stock, Stage& stage, PartSurvey& all, PartSurvey::Run& out) {
  const std::vector<StampStretch> stretches = stretches_of(run.stamps);
  out.stretches = stretches.size();
  using Work = std::shared_ptr<StretchSurvey>;
  using tbb::filter_mode;
  std::size_t next = 0;
  const auto begin = [&](tbb::flow_control& flow) -> Work {
    if (next == stretches.size()) {
      flow.stop();
      return nullptr;
    }
    const StampStretch& s = stretches[next];
    Work work = std::make_shared<StretchSurvey>(run, next++, s, stock);
    removal::sweep(stock, run.shape, run.stamps.subspan(s.from, s.end - s.from), {});
    return work;
  };
  const auto solve = [&](Work work) {
    work->survey(stage);
    return work;
  };
  const auto end = [&](const Work& work) { add(work->found(), all, out); };
  tbb::parallel_pipeline(static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()),
                         tbb::make_filter<void, Work>(filter_mode::serial_in_order, begin) &
                             tbb::make_filter<Work, Work>(filter_mode::parallel, solve) &
                             tbb::make_filter<Work, void>(filter_mode::serial_in_order, end));
}

std::span<const Stamp> stamps_of(const removal::StampPath& path, const removal::ToolRun& run) {
  return std::span(path.stamps).subspan(run.from, run.count);
}

}  // namespace

double part_cell_mm(const machine::Job& job, const Stock& target, std::span<const removal::SurfacePoint> points) {
  if (job.workpiece->cell_mm > 0) return job.workpiece->cell_mm;
  constexpr double kMost = 20000, kThickest_mm = 25, kOfThickness = 1, kAcross = 8;
  const Vec3 size = target.max_mm() - target.min_mm();
  const double as_few = std::cbrt(size.prod() / kMost);
  const auto thin = thin_part(target, points, kThickest_mm);
  const double as_thin = thin ? kOfThickness * thin->thin_mm : kThickest_mm;
  return std::max({as_few, 2 * target.voxel_mm(), std::min(as_thin, size.maxCoeff() / kAcross)});
}

PartSurvey survey_part(const machine::Job& job, const Stock& blank, const removal::StampPath& path,
                       const PartSurveyOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  PartSurvey out;
  out.runs.resize(path.runs.size());
  std::unique_ptr<removal::MeshDistance> held;
  if (!job.workpiece->fixed_mesh.empty())
    held = std::make_unique<removal::MeshDistance>(job.workpiece->fixed_mesh, blank.voxel_mm(), 2 * blank.voxel_mm());
  const workpiece::SolidOptions solid = solid_options(*job.workpiece, options.cell_mm, held.get());
  Stock stock(blank);
  Stage stage("solving for the part's compliance", path.stamps.size());
  for (std::size_t r = 0; r < path.runs.size(); ++r) {
    const removal::ToolRun& run = path.runs[r];
    const machine::Tool& tool = job.tools.at(run.tool);
    const std::span<const Stamp> stamps = stamps_of(path, run);
    if (run.kind != removal::RunKind::milling) {
      removal::sweep(stock, removal::shape_of(tool), stamps, {});
      continue;
    }
    const double top_mm = top_of(stock, tool, stamps);
    const Toucher toucher(tool, top_mm);
    out.runs[r].height_mm = run_heights_mm(top_mm);
    survey_run({job, stamps, options, solid, removal::shape_of(tool), toucher, out.runs[r].height_mm}, stock, stage,
               out, out.runs[r]);
  }
  if (out.solved == 0)
    loose(job, "nothing that is held of the part is under the tool anywhere; a part that it cuts was expected");
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return out;
}

bool PartSurvey::fits(const removal::StampPath& path) const {
  if (path.runs.size() != runs.size()) return false;
  for (std::size_t r = 0; r < runs.size(); ++r)
    if (path.runs[r].kind == removal::RunKind::milling &&
        stretches_of(stamps_of(path, path.runs[r])).size() != runs[r].stretches)
      return false;
  return true;
}

std::optional<PartCompliance> PartSurvey::along(const removal::StampPath& path, std::size_t run) const {
  const Run& own = runs[run];
  if (own.places.empty()) return std::nullopt;
  const std::vector<StampStretch> stretches = stretches_of(stamps_of(path, path.runs[run]));
  PartCompliance out;
  out.height_mm = own.height_mm;
  for (const Place& p : own.places) {
    const std::size_t stamp = stretches[p.stretch].stamp_at(p.share);
    if (!out.places.empty() && stamp <= out.places.back().stamp) continue;
    out.places.push_back({stamp, p.mm_per_N});
  }
  return out;
}

}  // namespace camber::simulate
