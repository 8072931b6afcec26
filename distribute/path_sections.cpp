#include "distribute/path_sections.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/cancel.h"
#include "base/stage.h"
#include "distribute/section_stock.h"
#include "removal/engagement.h"
#include "removal/known_run.h"
#include "removal/stock.h"
#include "simulate/contour.h"

namespace camber::distribute {

using namespace motion;
using namespace simulate;

using machine::Job;
using removal::Region;
using removal::Stock;
using removal::StockPart;

namespace {

/// The deepest mark of each point; of equal ones the first.
class DeepestMarks {
 public:
  explicit DeepestMarks(const removal::SurfaceMap& map) : points_(map.points()), error_mm_(points_.size()) {
    stamp_.assign(points_.size(), Stock::kUncut);
  }
  void add(const std::vector<removal::PointMark>& marks) {
    for (const removal::PointMark& mark : marks) {
      if (stamp_[mark.point] != Stock::kUncut && !(mark.error_mm < error_mm_[mark.point])) continue;
      error_mm_[mark.point] = mark.error_mm;
      stamp_[mark.point] = mark.stamp;
    }
  }
  SurfaceMarks marks() const {
    SurfaceMarks out;
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (stamp_[i] != Stock::kUncut) out.push_back({points_[i].place_mm, error_mm_[i], stamp_[i]});
    return out;
  }

 private:
  std::span<const removal::SurfacePoint> points_;
  std::vector<double> error_mm_;
  std::vector<std::int32_t> stamp_;
};

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

std::vector<const StockPart*> pointers_to(const OwnSolution& own) {
  std::vector<const StockPart*> out;
  for (const SolvedPiece& piece : own.pieces) out.push_back(&piece.stock);
  return out;
}
template <class Section>
std::vector<const std::vector<StockPart>*> stocks_of(const std::vector<Section>& sections) {
  std::vector<const std::vector<StockPart>*> out;
  for (const Section& s : sections) out.push_back(&s.stock);
  return out;
}

/// The parts of a section's pieces, joined run by run.
std::vector<StockPart> joined_runs(const SectionPlace& place, const std::vector<const StockPart*>& own) {
  std::vector<StockPart> out;
  for (const RunPieces& r : place.runs(place.section))
    out.emplace_back(std::span(own).subspan(r.pieces.begin - place.own.begin, r.pieces.end - r.pieces.begin));
  return out;
}

/// The section's own pieces.
std::size_t stamps_in(const SectionPlace& place) {
  std::size_t out = 0;
  for (std::size_t p = place.own.begin; p < place.own.end; ++p) out += place.pieces[p].count;
  return out;
}

/// Each of a section's pieces carved alone out of `raw`; `use(run, part)` for each. Returns the volume, mm^3.
template <class Use>
double sweep_pieces(const Stock& raw, const Job& job, const PathStretch& path, const SectionPlace& place,
                    double shrink_mm, SectionWork& work, Stage& stage, const Use& use) {
  double removed_mm3 = 0;
  for (std::size_t p = place.own.begin; p < place.own.end; ++p) {
    cancellation_point();
    const StretchPiece& piece = place.pieces[p];
    const removal::ToolRun& run = path.run_of(piece);
    if (shrink_mm > 0 && run.kind != removal::RunKind::milling) continue;
    Stock scratch(raw);
    removed_mm3 +=
        removal::sweep(scratch, removal::shape_of(job.tools.at(run.tool)), path.stamps_of(piece),
                       {.shrink_mm = shrink_mm, .first_id = static_cast<std::int32_t>(path.begin_of(piece))});
    if (shrink_mm > 0)
      removed_mm3 += sweep_underside(scratch, job.tools.at(run.tool), path.stamps_of(piece), shrink_mm,
                                     static_cast<std::int32_t>(path.begin_of(piece) + piece.count));
    StockPart part(scratch, raw, reach_of(job, path, piece));
    work.stamps += piece.count;
    work.voxels += part.voxels();
    stage.advance(piece.count);
    use(piece.run, std::move(part));
  }
  return removed_mm3;
}

/// `own(part)` for each piece of the section.
template <class Own>
SweptSection swept_path(const Job& job, const Stock& raw, const PathStretch& path, const SectionPlace& place,
                        Stage& stage, const Own& own) {
  SweptSection out;
  removal::JoinedParts joined;
  std::optional<std::size_t> of_run;
  sweep_pieces(raw, job, path, place, 0, out.work, stage, [&](std::size_t run, StockPart part) {
    if (of_run && *of_run != run) out.stock.push_back(joined.take());
    of_run = run;
    own(part);
    joined.add(std::move(part));
  });
  if (of_run) out.stock.push_back(joined.take());
  return out;
}

/// One section of a path, piece after piece.
class SectionSolver {
 public:
  SectionSolver(const Job& job, const PathStretch& path, const Target& target, const SectionPlace& place,
                const SectionParts& parts, const SolveOptions& options)
      : job_(job),
        path_(path),
        target_(target),
        options_(options),
        place_(place),
        joined_(joined_region(job, reach_of(job, path, place_.pieces, place_.own))),
        map_(*target.map),
        parts_(parts),
        again_(!parts.last.empty() && !parts.from_another_path),
        coupling_(job.simulation.coupling),
        bends_(bends_before(place_, parts.last, parts.own_last)),
        earlier_bends_(bends_before(place_, parts.before_last, parts.own_before_last)) {}

  void solve(Solved& out) {
    if (place_.own.empty()) return;
    const auto swept = [&] { return stocks_of(parts_.swept); };
    const bool solved = !parts_.last.empty();
    StockBefore now(target_.blank, place_, solved ? stocks_of(parts_.last) : swept(),
                    solved ? pieces_of(parts_.own_last) : pieces_of(parts_.own_sweep), joined_);
    std::optional<StockBefore> then;
    if (again_) {
      const bool first = parts_.before_last.empty();
      then.emplace(target_.blank, place_, first ? swept() : stocks_of(parts_.before_last),
                   first ? pieces_of(parts_.own_sweep) : pieces_of(parts_.own_before_last), joined_);
    }
    for (std::size_t p = place_.own.begin; p < place_.own.end; ++p) {
      now.advance_to(p);
      if (then) then->advance_to(p);
      if (then && is_settled(p, now.stock(), then->stock(), out.section.history.back())) {
        out.own.pieces.push_back(parts_.own_last.pieces[p - place_.own.begin]);
        continue;
      }
      out.own.pieces.push_back(solve_piece(p, now, out.section.work));
    }
    join_pieces(out);
  }

 private:
  const BendBefore& bend(std::size_t p) const { return bends_[p - place_.own.begin]; }

  bool is_settled(std::size_t p, const Stock& now, const Stock& then, SolvedSection::Round& round) const {
    const double of_stock_mm = removal::largest_difference_mm(now, then, reach_of(job_, path_, place_.pieces[p]));
    const double change_mm =
        std::max(of_stock_mm, largest_difference_mm(bend(p), earlier_bends_[p - place_.own.begin]));
    round.largest_change_um = std::max(round.largest_change_um, 1000 * change_mm);
    if (change_mm <= kSettled_mm) return true;
    ++round.solved_again;
    return false;
  }

  SolvedPiece solve_piece(std::size_t p, const StockBefore& before, SectionWork& work) {
    const StretchPiece& piece = place_.pieces[p];
    const Region reach = reach_of(job_, path_, piece);
    // What a cutter reads beside its reach is a tile away at most.
    const Region read = joined_region(job_, reach);
    Stock stock = before.stock().copy_within(read.min_mm, read.max_mm);
    const auto done = static_cast<double>(p - place_.own.begin),
               all = static_cast<double>(place_.own.end - place_.own.begin);
    SolvedPiece out;
    out.cut = cut_piece(stock, job_, path_,
                        {.run = piece.run,
                         .from = piece.from,
                         .count = piece.count,
                         .coupling = coupling_,
                         .before_run = &before.before_run(),
                         .surface = &map_,
                         .target = &target_.surface,
                         .turn_from = options_.turn_from,
                         .bend = bend(p).rows.empty() ? nullptr : &bend(p),
                         .known = known_run(piece.run),
                         .progress = [&](double share) {
                           if (options_.progress) options_.progress((done + share) / all);
                         }});
    out.marks = map_.take_marks();
    work.stamps += piece.count;
    if (coupling_ != machine::Coupling::static_) return out;
    const auto first = static_cast<std::int32_t>(path_.runs[piece.run].from + piece.from);
    out.stock =
        StockPart(stock, before.stock(), reach, std::array{first, first + static_cast<std::int32_t>(piece.count)});
    work.voxels += out.stock.voxels();
    return out;
  }

  /// Facts that all pieces of a run share. Null: they look at all its stamps, which then are in memory.
  const removal::KnownRun* known_run(std::size_t r) {
    if (run_ == r) return known_ ? &*known_ : nullptr;
    run_ = r;
    known_.reset();
    const removal::ToolRun& run = path_.runs[r];
    if (run.kind != removal::RunKind::milling) return nullptr;
    if (path_.kept) {
      const removal::Region& tips = options_.outline->of_runs[r].tips;
      known_.emplace(path_.stamps_of(run), tips.min_mm, tips.max_mm, path_.kept_in(run.from, run.count));
    } else if (removal::all_upright(path_.stamps_of(run))) {
      known_.emplace(path_.stamps_of(run));
    }
    return known_ ? &*known_ : nullptr;
  }

  /// Joins what others need of the pieces.
  void join_pieces(Solved& out) const {
    DeepestMarks marks(*target_.map);
    for (const SolvedPiece& piece : out.own.pieces) {
      marks.add(piece.marks);
      CutResult& cut = out.section.cuts.emplace_back(piece.cut);
      cut.bend = {};
    }
    out.section.marks = marks.marks();
    if (coupling_ != machine::Coupling::static_) {
      out.own = {};  // there is no other round
      return;
    }
    out.section.stock = joined_runs(place_, pointers_to(out.own));
    for (const RunPieces& r : place_.runs(place_.section)) {
      double largest_mm = 0;
      for (std::size_t p = r.pieces.begin; p < r.pieces.end; ++p)
        largest_mm = std::max(largest_mm, out.own.pieces[p - place_.own.begin].cut.bend.largest_mm);
      out.section.largest_bend_mm.push_back(largest_mm);
    }
    out.section.last_bend = out.own.pieces.back().cut.bend.rows;
  }

  const Job& job_;
  PathStretch path_;
  const Target& target_;
  const SolveOptions& options_;
  const SectionPlace& place_;
  Region joined_;
  removal::SurfaceMap map_;  ///< without marks between pieces
  const SectionParts& parts_;
  bool again_;
  machine::Coupling coupling_;
  std::vector<BendBefore> bends_, earlier_bends_;
  std::optional<std::size_t> run_;  ///< the last one
  std::optional<removal::KnownRun> known_;
};

/// Contour and history of the round before, if there was one.
SolvedSection begin_round(const SectionParts& parts, std::size_t section) {
  SolvedSection out;
  if (parts.last.empty() || parts.from_another_path) return out;
  out.contour = parts.last[section].contour;
  out.history = parts.last[section].history;
  out.history.emplace_back();
  return out;
}

}  // namespace

Region section_region(const Job& job, const SectionPrograms& programs, std::size_t section, std::size_t sections) {
  return joined_region(job, programs.reach(section, sections));
}

Region section_region(const Job& job, const PathStretch& path, const SectionPlace& place, std::size_t section) {
  return joined_region(job, reach_of(job, path, place.pieces, place.ranges[section]));
}

SweptSection sweep_section(const Job& job, const SectionPrograms& programs, std::size_t section, std::size_t sections,
                           const std::function<void(const StockPart&)>& own, Diagnostics& diagnostics) {
  const SimulatedProgram& of_target = programs.of_target();
  const NominalSection nominal = programs.nominal(section, sections);
  Region reach = programs.reach(section, sections);
  reach.add(reach_of(job, nominal.stretch(), nominal.place.pieces, nominal.place.own));
  const Region within = joined_region(job, reach);
  // The blank before any allowance: what lies above it is a part as any other.
  TargetWork nothing{.allowance = [](Stock&) { return 1e300; }, .within = &within};
  programs.add_to(nothing);
  const Blank raw = make_blank(job, of_target, diagnostics, 0, nothing);
  diagnostics.throw_if_errors();
  const PathStretch path = programs.path();
  const SectionPlace place(path, section, sections);
  Stage stage("carving the section", stamps_in(place) + stamps_in(nominal.place) + 1);
  SweptSection out = swept_path(job, raw.stock, path, place, stage, own);
  const auto joined = [&](const PathStretch& of, const SectionPlace& where, double shrink_mm, double& removed_mm3) {
    removal::JoinedParts parts;
    removed_mm3 += sweep_pieces(raw.stock, job, of, where, shrink_mm, out.work, stage,
                                [&](std::size_t, StockPart part) { parts.add(std::move(part)); });
    return parts.take();
  };
  out.target = joined(nominal.stretch(), nominal.place, 0, out.target_mm3);
  if (job.stock.allowance_mm > 0)
    out.allowance = joined(programs.target_path(), SectionPlace(programs.target_path(), section, sections),
                           job.stock.allowance_mm, out.allowance_mm3);
  return out;
}

Swept sweep_path_section(const Job& job, const Stock& blank, const PathStretch& path, const SectionPlace& place) {
  Stage stage("carving the section", stamps_in(place) + 1);
  Swept out;
  out.section = swept_path(job, blank, path, place, stage, [&](const StockPart& part) { out.own.add(part); });
  return out;
}

EachSwept each_of(const std::vector<SweptSection>& swept) {
  return [&swept](const auto& use) {
    for (const SweptSection& section : swept) use(section);
  };
}

EachSolved each_of(std::vector<SolvedSection>& solved) {
  return [&solved](const auto& use) {
    for (SolvedSection& section : solved) use(section);
  };
}

TargetWork joined_target(EachSwept swept, EachSolved solved, const Region* within) {
  TargetWork out;
  out.allowance = [swept, within](Stock& blank) {
    double removed_mm3 = 0;
    swept([&](const SweptSection& s) {
      s.allowance.join_to(blank, within, false);
      removed_mm3 += s.allowance_mm3;
    });
    return removed_mm3;
  };
  out.surface = [swept, within](Stock& surface) {
    double removed_mm3 = 0;
    swept([&](const SweptSection& s) {
      s.target.join_to(surface, within);
      removed_mm3 += s.target_mm3;
    });
    return removed_mm3;
  };
  out.contour = [solved = std::move(solved)](Target& target) {
    std::vector<removal::SurfacePoint> points = removal::SurfaceMap(*target.map).take();
    solved([&](const SolvedSection& s) { join(s.contour, points); });
    target.contour_mm.reserve(points.size());
    for (const removal::SurfacePoint& p : points) target.contour_mm.push_back(static_cast<float>(p.error_mm));
  };
  return out;
}

Solved solve_section(const Job& job, const SectionPrograms& programs, const SectionParts& parts,
                     const SolveOptions& options, Diagnostics& diagnostics, std::optional<Target>* kept) {
  Solved out;
  out.section = begin_round(parts, options.section);
  std::optional<Target> own;
  std::optional<Target>& target = kept ? *kept : own;
  const PathStretch path = programs.path();
  const SectionPlace own_place(path, options.section, options.sections);
  SolveOptions solving = options;
  solving.outline = programs.outline();
  if (target) {
    SectionSolver(job, path, *target, own_place, parts, solving).solve(out);
    return out;
  }
  const Region joined = section_region(job, programs, options.section, options.sections);
  if (joined.empty()) return out;
  TargetWork work = joined_target(each_of(parts.swept), {}, &joined);
  const Region within = joined_region(job, joined);
  work.within = &within;
  programs.add_to(work);
  work.judged = false;
  work.contour = [&](Target& made) {
    if (!parts.last.empty()) return;
    const PathStretch of_target = programs.target_path();
    const SectionPlace place(of_target, options.section, options.sections);
    removal::SurfaceMap& map = *made.map;
    DeepestMarks marks(map);
    for (std::size_t p = place.own.begin; p < place.own.end; ++p) {
      const StretchPiece& piece = place.pieces[p];
      mark_contour_of(job, of_target, piece, map);
      marks.add(map.take_marks());
      out.section.work.stamps += piece.count;
    }
    out.section.contour = marks.marks();
  };
  target.emplace(make_target(job, programs.of_target(), diagnostics, work));
  SectionSolver(job, path, *target, own_place, parts, solving).solve(out);
  return out;
}

Solved solve_path_section(const Job& job, const Target& target, const PathStretch& path, const SectionPlace& place,
                          const SectionParts& parts, const std::function<void(double)>& progress) {
  Solved out;
  out.section = begin_round(parts, place.section);
  const SolveOptions options{
      .section = place.section, .sections = place.ranges.size(), .turn_from = {}, .progress = progress};
  SectionSolver(job, path, target, place, parts, options).solve(out);
  return out;
}

Prediction merge_sections(const Job& job, Target& target, const SimulatedProgram& program, const EachSwept& swept,
                          const EachSolved& solved) {
  removal::SurfaceMap map = std::move(*target.map);
  target.map.reset();
  return merge_sections(job, target, std::move(map), program, swept, solved);
}

Prediction merge_sections(const Job& job, const Target& target, removal::SurfaceMap map,
                          const SimulatedProgram& program, const EachSwept& swept, const EachSolved& solved) {
  PathLoads loads;
  loads.holes.count = removal::count_holes(program.moves_in_part(), program.holes);
  loads.cut.loads.reserve(program.path.stamps.size());
  auto machined = std::make_unique<Stock>(target.blank);
  std::vector<removal::SurfacePoint> surface = map.take();
  const auto join_stock = [&](const std::vector<StockPart>& parts) {
    for (const StockPart& part : parts) part.join_to(*machined);
  };
  const bool is_static = job.simulation.coupling == machine::Coupling::static_;
  if (!is_static) swept([&](const SweptSection& section) { join_stock(section.stock); });
  const std::vector<StretchPiece> pieces = path_pieces(program.path);
  std::size_t p = 0;
  solved([&](SolvedSection& section) {
    if (is_static) join_stock(section.stock);
    join(section.marks, surface);
    for (CutResult& cut : section.cuts) add_piece(program.path.runs[pieces[p++].run], std::move(cut), loads);
    section = {};
  });
  return judge(job, target, program, std::move(loads), std::move(surface), std::move(machined));
}

}  // namespace camber::distribute
