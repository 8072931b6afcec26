#include "simulate/sections.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/cancel.h"
#include "base/stage.h"
#include "removal/engagement.h"
#include "simulate/contour.h"

namespace camber::simulate {

using machine::Job;
using removal::Region;
using removal::Stock;
using removal::StockPart;

namespace {

/// Where pieces cut, read and mark: a cutter about each tip, and all above it. Everywhere where an axis is tilted.
void add_reach(const Job& job, const removal::StampPath& path, const PathPiece& piece, Region& region) {
  constexpr double kMaxBandVoxels = 12, kFar_mm = 1e9;
  const removal::ToolRun& run = path.runs[piece.run];
  const auto stamps = std::span(path.stamps).subspan(run.from + piece.from, piece.count);
  const double around = removal::shape_of(job.tools.at(run.tool)).radius_mm + kMaxBandVoxels * job.simulation.voxel_mm +
                        removal::DeflectedEngager::kMaxDeflection_mm;
  for (const removal::Stamp& s : stamps) {
    const Vec3 wide(around, around, around);
    region.add(s.pose.tip_mm - wide);
    region.add(s.pose.tip_mm + wide);
    region.max_mm.z() = kFar_mm;
    if (s.pose.upright()) continue;
    region.add(Vec3::Constant(-kFar_mm));
    region.add(Vec3::Constant(kFar_mm));
    return;
  }
}

/// The points that a map without marks before has marked since.
SurfaceMarks marks_of(const removal::SurfaceMap& map) {
  SurfaceMarks out;
  for (const removal::SurfacePoint& p : map.points())
    if (p.machined_stamp != Stock::kUncut) out.push_back({p.place_mm, p.error_mm, p.machined_stamp});
  return out;
}

/// Takes marks to the points of a map without marks, as SurfaceMap::take() returns them: what is left of the blank is
/// the surface where no mark is deeper. Of equal marks the first counts.
void join(const SurfaceMarks& marks, std::vector<removal::SurfacePoint>& points) {
  auto point = points.begin();
  for (const SurfaceMark& mark : marks) {
    while (point != points.end() && point->place_mm != mark.place_mm) ++point;
    if (point == points.end()) throw BytesMissing();
    const bool deeper = mark.error_mm < point->error_mm;
    // A mark that goes to the nominal surface counts even where the blank had gone deeper.
    const bool from_blank = point->machined_stamp == Stock::kUncut && mark.error_mm <= point->error_mm;
    if (deeper || from_blank || (mark.error_mm <= 0 && point->machined_stamp == Stock::kUncut)) {
      point->error_mm = mark.error_mm;
      point->machined_stamp = mark.stamp;
    }
  }
}

/// The parts of all sections, in the order of the path.
std::vector<const StockPart*> stock_parts(const std::vector<SweptSection>& sections) {
  std::vector<const StockPart*> out;
  for (const auto& s : sections)
    for (const StockPart& part : s.stock) out.push_back(&part);
  return out;
}
std::vector<const StockPart*> stock_parts(const std::vector<SolvedSection>& sections) {
  std::vector<const StockPart*> out;
  for (const auto& s : sections)
    for (const SolvedPiece& piece : s.pieces) out.push_back(&piece.stock);
  return out;
}

/// The stock before one piece after the other.
class StockBefore {
 public:
  StockBefore(const Stock& blank, const std::vector<PathPiece>& pieces, std::vector<const StockPart*> parts,
              const Region* within)
      : pieces_(pieces), parts_(std::move(parts)), within_(within) {
    before_run_.emplace(blank);
    stock_.emplace(blank);
  }
  void advance_to(std::size_t piece) {
    while (next_ < piece) {
      parts_[next_]->join_to(*stock_, within_);
      ++next_;
      if (next_ < pieces_.size() && pieces_[next_].run != pieces_[next_ - 1].run) before_run_.emplace(*stock_);
    }
  }
  const Stock& stock() const { return *stock_; }
  const Stock& before_run() const { return *before_run_; }

 private:
  const std::vector<PathPiece>& pieces_;
  std::vector<const StockPart*> parts_;
  const Region* within_;
  std::optional<Stock> before_run_, stock_;
  std::size_t next_ = 0;
};

/// How the tool was bent before a piece, as a round has found: the rows of the piece before, the largest of its run.
/// Without rows where the piece begins a run, or the round did not solve it.
BendBefore bend_before(const std::vector<PathPiece>& pieces, std::size_t piece,
                       const std::vector<SolvedSection>& round) {
  BendBefore out;
  std::size_t p = 0;
  for (const SolvedSection& section : round)
    for (const SolvedPiece& solved : section.pieces) {
      if (p >= piece) return out;
      if (pieces[p].run == pieces[piece].run) {
        out.largest_mm = std::max(out.largest_mm, solved.cut.bend.largest_mm);
        if (p + 1 == piece) out.rows = solved.cut.bend.rows;
      }
      ++p;
    }
  return out;
}

double largest_difference_mm(const BendBefore& a, const BendBefore& b) {
  if (a.rows.size() != b.rows.size()) return std::max(a.largest_mm, b.largest_mm);
  float out = 0;
  for (std::size_t i = 0; i < a.rows.size(); ++i) out = std::max(out, std::abs(a.rows[i] - b.rows[i]));
  return static_cast<double>(out);
}

/// Each of a section's pieces carved alone out of `raw`.
std::vector<StockPart> swept_parts(const Stock& raw, const Job& job, const removal::StampPath& path, double shrink_mm,
                                   std::size_t section, std::size_t sections, double& removed_mm3, SectionWork& work,
                                   Stage& stage) {
  const std::vector<PathPiece> pieces = path_pieces(path);
  const PieceRange range = section_pieces(pieces, section, sections);
  std::vector<StockPart> out;
  for (std::size_t p = range.begin; p < range.end; ++p) {
    cancellation_point();
    const removal::ToolRun& run = path.runs[pieces[p].run];
    if (shrink_mm > 0 && run.kind != removal::RunKind::milling) {
      out.emplace_back();
      continue;
    }
    Stock scratch(raw);
    const std::size_t from = run.from + pieces[p].from;
    removed_mm3 += removal::sweep(scratch, removal::shape_of(job.tools.at(run.tool)),
                                  std::span(path.stamps).subspan(from, pieces[p].count),
                                  {.shrink_mm = shrink_mm, .first_id = static_cast<std::int32_t>(from)});
    Region reach;
    add_reach(job, path, pieces[p], reach);
    out.emplace_back(scratch, raw, reach);
    work.stamps += pieces[p].count;
    work.voxels += out.back().voxels();
    stage.advance(pieces[p].count);
  }
  return out;
}

Region reach_of_section(const Job& job, const Programs& programs, std::size_t section, std::size_t sections) {
  Region out;
  for (const removal::StampPath* path : {&programs.program.path, &programs.of_target().path}) {
    const std::vector<PathPiece> pieces = path_pieces(*path);
    const PieceRange range = section_pieces(pieces, section, sections);
    for (std::size_t p = range.begin; p < range.end; ++p) add_reach(job, *path, pieces[p], out);
  }
  return out;
}

/// What a section does not cut is joined this far around it, so that no reading of a neighbour misses it.
Region joined_region(const Job& job, const Region& reach) {
  return reach.wider(2 * removal::kTileVoxels * job.simulation.voxel_mm);
}

}  // namespace

Region section_region(const Job& job, const Programs& programs, std::size_t section, std::size_t sections) {
  const Region reach = reach_of_section(job, programs, section, sections);
  return reach.empty() ? reach : joined_region(job, reach);
}

void keep_within(SweptSection& section, const Region& region, double voxel_mm) {
  for (auto* parts : {&section.stock, &section.target, &section.allowance})
    for (StockPart& part : *parts) part.keep_within(region, voxel_mm);
}

void keep_stock_within(SolvedSection& section, const Region& region, double voxel_mm) {
  for (SolvedPiece& piece : section.pieces) {
    BendBefore bend = std::move(piece.cut.bend);
    piece.cut = {};
    piece.cut.bend = std::move(bend);
    piece.marks = {};
    piece.stock.keep_within(region, voxel_mm);
  }
  section.contour.clear();
}

std::vector<PathPiece> path_pieces(const removal::StampPath& path) {
  std::vector<PathPiece> out;
  for (std::size_t r = 0; r < path.runs.size(); ++r) {
    const removal::ToolRun& run = path.runs[r];
    const std::size_t count =
        run.kind == removal::RunKind::milling ? (run.count + kPieceStamps - 1) / kPieceStamps : std::size_t{1};
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t from = run.count * i / count;
      out.push_back({r, from, run.count * (i + 1) / count - from});
    }
  }
  return out;
}

PieceRange section_pieces(const std::vector<PathPiece>& pieces, std::size_t section, std::size_t sections) {
  std::size_t total = 0, before = 0;
  for (const PathPiece& p : pieces) total += p.count;
  PieceRange out{pieces.size(), pieces.size()};
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    // The section in which the piece's middle lies.
    const std::size_t of = (2 * before + pieces[i].count) * sections / std::max<std::size_t>(2 * total, 1);
    before += pieces[i].count;
    if (of >= section && out.begin == pieces.size()) out.begin = i;
    if (of > section) {
      out.end = i;
      break;
    }
  }
  if (out.begin > out.end) out.begin = out.end;
  return out;
}

SweptSection sweep_section(const Job& job, const Programs& programs, std::size_t section, std::size_t sections,
                           Diagnostics& diagnostics) {
  SweptSection out;
  const SimulatedProgram& of_target = programs.of_target();
  const removal::StampPath nominal =
      removal::nominal_path(of_target.moves, of_target.selected, of_target.path, of_target.part_path());
  // The blank before any allowance: what lies above it is a part as any other.
  const TargetWork nothing{.allowance = [](Stock&) { return 1e300; }};
  const Blank raw = make_blank(job, of_target, diagnostics, 0, nothing);
  diagnostics.throw_if_errors();
  Stage stage("carving the section", (programs.program.path.stamps.size() + nominal.stamps.size()) / sections + 1);
  double ignored_mm3 = 0;
  out.stock = swept_parts(raw.stock, job, programs.program.path, 0, section, sections, ignored_mm3, out.work, stage);
  out.target = swept_parts(raw.stock, job, nominal, 0, section, sections, out.target_mm3, out.work, stage);
  if (job.stock.allowance_mm > 0)
    out.allowance = swept_parts(raw.stock, job, of_target.path, job.stock.allowance_mm, section, sections,
                                out.allowance_mm3, out.work, stage);
  return out;
}

TargetWork joined_target(const SectionParts& parts, const Region* within) {
  TargetWork out;
  out.allowance = [&parts, within](Stock& blank) {
    double removed_mm3 = 0;
    for (const SweptSection& s : parts.swept) {
      for (const StockPart& part : s.allowance) part.join_to(blank, within, false);
      removed_mm3 += s.allowance_mm3;
    }
    return removed_mm3;
  };
  out.surface = [&parts, within](Stock& surface) {
    double removed_mm3 = 0;
    for (const SweptSection& s : parts.swept) {
      for (const StockPart& part : s.target) part.join_to(surface, within);
      removed_mm3 += s.target_mm3;
    }
    return removed_mm3;
  };
  out.contour = [&parts](Target& target) {
    std::vector<removal::SurfacePoint> points = removal::SurfaceMap(*target.map).take();
    for (const SolvedSection& s : parts.last)
      for (const SurfaceMarks& marks : s.contour) join(marks, points);
    target.contour_mm.reserve(points.size());
    for (const removal::SurfacePoint& p : points) target.contour_mm.push_back(static_cast<float>(p.error_mm));
  };
  return out;
}

SolvedSection solve_section(const Job& job, const Programs& programs, const SectionParts& parts,
                            const SolveOptions& options, Diagnostics& diagnostics) {
  SolvedSection out;
  const removal::StampPath& path = programs.program.path;
  const removal::StampPath& target_path = programs.of_target().path;
  const std::vector<PathPiece> pieces = path_pieces(path), target_pieces = path_pieces(target_path);
  const PieceRange range = section_pieces(pieces, options.section, options.sections),
                   target_range = section_pieces(target_pieces, options.section, options.sections);
  const bool again = !parts.last.empty();
  if (again) {
    out.contour = parts.last[options.section].contour;
    out.history = parts.last[options.section].history;
    out.history.emplace_back();
  }
  const Region region = reach_of_section(job, programs, options.section, options.sections);
  if (region.empty()) return out;
  const Region joined = joined_region(job, region);
  TargetWork work = joined_target(parts, &joined);
  work.judged = false;
  work.contour = [&](Target& target) {
    for (std::size_t p = target_range.begin; p < target_range.end && !again; ++p) {
      const PathPiece& piece = target_pieces[p];
      removal::SurfaceMap map(*target.map);
      mark_contour_of(job, target_path, target_path.runs[piece.run], piece.from, piece.count, map);
      out.contour.push_back(marks_of(map));
      out.work.stamps += piece.count;
    }
  };
  Target target = make_target(job, programs.of_target(), diagnostics, work);
  StockBefore now(target.blank, pieces, again ? stock_parts(parts.last) : stock_parts(parts.swept), &joined);
  std::optional<StockBefore> then;
  if (again)
    then.emplace(target.blank, pieces,
                 parts.before_last.empty() ? stock_parts(parts.swept) : stock_parts(parts.before_last), &joined);
  const machine::Coupling coupling = job.simulation.coupling;
  for (std::size_t p = range.begin; p < range.end; ++p) {
    now.advance_to(p);
    Region reach;
    add_reach(job, path, pieces[p], reach);
    const BendBefore bend = bend_before(pieces, p, parts.last);
    if (again) {
      then->advance_to(p);
      const double change_mm = std::max(removal::largest_difference_mm(now.stock(), then->stock(), reach),
                                        largest_difference_mm(bend, bend_before(pieces, p, parts.before_last)));
      out.history.back().largest_change_um = std::max(out.history.back().largest_change_um, 1000 * change_mm);
      if (change_mm <= kSettled_mm) {
        out.pieces.push_back(parts.last[options.section].pieces[p - range.begin]);
        continue;
      }
      ++out.history.back().solved_again;
    }
    Stock stock(now.stock());
    removal::SurfaceMap map(*target.map);
    SolvedPiece solved;
    const std::size_t done = p - range.begin, all = range.end - range.begin;
    solved.cut = cut_piece(stock, job, path,
                           {.run = pieces[p].run,
                            .from = pieces[p].from,
                            .count = pieces[p].count,
                            .coupling = coupling,
                            .before_run = &now.before_run(),
                            .surface = &map,
                            .target = &target.surface,
                            .turn_from = options.turn_from,
                            .bend = bend.rows.empty() ? nullptr : &bend,
                            .progress = [&](double share) {
                              if (options.progress)
                                options.progress((static_cast<double>(done) + share) / static_cast<double>(all));
                            }});
    solved.marks = marks_of(map);
    if (coupling == machine::Coupling::static_) {
      const auto first = static_cast<std::int32_t>(path.runs[pieces[p].run].from + pieces[p].from);
      solved.stock =
          StockPart(stock, now.stock(), reach, std::array{first, first + static_cast<std::int32_t>(pieces[p].count)});
      out.work.voxels += solved.stock.voxels();
    }
    out.work.stamps += pieces[p].count;
    out.pieces.push_back(std::move(solved));
  }
  return out;
}

Prediction merge_sections(const Job& job, Target& target, const SimulatedProgram& program, const SectionParts& parts) {
  PathLoads loads;
  loads.holes.count = removal::count_holes(program.moves, program.holes);
  const std::vector<PathPiece> pieces = path_pieces(program.path);
  auto machined = std::make_unique<Stock>(target.blank);
  std::vector<removal::SurfacePoint> surface = std::exchange(target.map, std::nullopt)->take();
  const auto stocks =
      job.simulation.coupling == machine::Coupling::static_ ? stock_parts(parts.last) : stock_parts(parts.swept);
  for (const StockPart* part : stocks) part->join_to(*machined);
  std::size_t p = 0;
  for (const SolvedSection& section : parts.last)
    for (const SolvedPiece& piece : section.pieces) {
      join(piece.marks, surface);
      add_piece(job, program.path.runs[pieces[p++].run], piece.cut, loads);
    }
  return judge(target, std::move(loads), std::move(surface), std::move(machined));
}

}  // namespace camber::simulate
