#include "distribute/path_sections.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "removal/cutter.h"
#include "removal/tool_path.h"

namespace camber::distribute {

using namespace motion;
using namespace simulate;

using machine::Job;
using removal::Region;
using removal::Stamp;
using removal::ToolRun;

namespace {

/// Texts of more blocks are given up once they are interpreted.
constexpr std::size_t kLongestText = 200'000;
constexpr std::size_t kWhole = std::numeric_limits<std::size_t>::max();

/// Goes along the path; of it the program keeps the runs.
void follow_path(SimulatedProgram& program, const Job& job, const removal::StampSink& sink) {
  time_path(program, job, {}, sink);
  program.path.stamps = {};
}

/// The findings of one way along a path.
struct Outlines {
  PathOutline path, nominal;
  bool whole = false;  ///< SimulatedProgram::path has all; `nominal` is empty
};

/// Keeps the whole path where it has no more than `longest` stamps. `target`: the nominal path is wanted.
Outlines time_program(SimulatedProgram& program, const Job& job, std::size_t longest, bool target) {
  Outlines out;
  if (program.turns() || longest == kWhole) {
    time_path(program, job, {});
    out.whole = true;
    return out;
  }
  std::vector<Stamp> stamps;
  stamps.reserve(longest);  // room that is not written to takes no memory
  std::optional<removal::NominalFollower> follower;
  const auto outline_nominal = [&](const ToolRun& run, std::size_t, const Stamp& s) { out.nominal.add(run, s); };
  out.whole = true;
  follow_path(program, job, [&](const ToolRun& run, std::size_t number, const Stamp& stamp) {
    if (out.whole && number < longest) {
      stamps.push_back(stamp);
    } else {
      if (out.whole && target) {
        follower.emplace(program.moves_in_part(), program.selected, nullptr, outline_nominal);
        for (const ToolRun& r : out.path.runs)
          for (std::size_t k = r.from; k < r.from + r.count; ++k) follower->add(r, stamps[k]);
      }
      if (out.whole) stamps = {};
      out.whole = false;
      if (follower) follower->add(run, stamp);
    }
    out.path.add(run, stamp);
  });
  if (follower) follower->finish();
  if (out.whole) program.path.stamps = std::move(stamps);
  return out;
}

/// Numbers of the stamps of some pieces.
ListRange numbers_of(const PathStretch& path, const SectionPlace& place) {
  if (place.own.empty()) return {};
  const StretchPiece& last = place.pieces[place.own.end - 1];
  return {path.begin_of(place.pieces[place.own.begin]), path.begin_of(last) + last.count};
}

/// reach_of() of the pieces of a section, from the boxes of the outline.
Region reach_in(const Job& job, const PathOutline& outline, const SectionPlace& place) {
  const PathStretch path(outline.runs, {}, {});
  Region out;
  for (std::size_t p = place.own.begin; p < place.own.end; ++p) {
    const StretchPiece& piece = place.pieces[p];
    if (piece.count == 0) continue;
    const std::size_t begin = path.begin_of(piece), end = begin + piece.count;
    Region tips;
    for (std::size_t b = begin / PathOutline::kBlock; b <= (end - 1) / PathOutline::kBlock; ++b)
      tips.add(outline.blocks[b]);
    out.add(reach_of_tips(job, path.run_of(piece), tips));
  }
  return out;
}

SectionPlace place_in(const PathOutline& outline, std::size_t section, std::size_t sections) {
  return {PathStretch(outline.runs, {}, {}), section, sections};
}

/// Marks the blocks that a section reads: those of its own pieces, with one more at either end, those near `region`,
/// and the first of each run, where vector kernels look when the stock names no stamp of the run.
std::vector<bool> blocks_near(const Job& job, const PathOutline& outline, const ListRange& own, const Region& region) {
  constexpr double kTilesAround = 4;
  double radius_mm = 0;
  for (const ToolRun& run : outline.runs)
    radius_mm = std::max(radius_mm, removal::shape_of(job.tools.at(run.tool)).radius_mm);
  const Region near = region.wider(radius_mm + kTilesAround * removal::kTileVoxels * job.simulation.voxel_mm);
  std::vector<bool> out(outline.blocks.size());
  for (std::size_t b = 0; b < out.size(); ++b) {
    const std::size_t begin = b * PathOutline::kBlock, end = begin + PathOutline::kBlock;
    const bool is_own =
        own.from < own.end && begin < own.end + PathOutline::kBlock && end + PathOutline::kBlock > own.from;
    const Region& box = outline.blocks[b];
    out[b] = is_own ||
             ((box.min_mm.array() <= near.max_mm.array()).all() && (box.max_mm.array() >= near.min_mm.array()).all());
  }
  for (const ToolRun& run : outline.runs) out[run.from / PathOutline::kBlock] = true;
  return out;
}

/// Puts the stamps of some blocks.
class BlockKeeper {
 public:
  BlockKeeper(SparsePath& path, std::vector<bool> blocks) : stamps_(path.stamps), blocks_(std::move(blocks)) {
    stamps_ = SparseList<Stamp>();  // before there is another one
    stamps_ = SparseList<Stamp>(path.outline.stamps);
  }
  void operator()(const ToolRun&, std::size_t number, const Stamp& stamp) {
    if (blocks_[number / PathOutline::kBlock]) stamps_.put(number, stamp);
  }

 private:
  SparseList<Stamp>& stamps_;
  std::vector<bool> blocks_;
};

}  // namespace

SectionPrograms::SectionPrograms(const Job& job, const SectionProgramsOptions& options, const SetupFindings& findings)
    : job_(job) {
  const auto give_up = [&](SimulatedProgram& program) {
    if (options.longest_path < kWhole && program.text().blocks.size() > std::min(kLongestText, options.longest_path))
      program.give_up_text();
  };
  read_.program = read_moves(SourceText::read(job.program), job, findings.program);
  if (options.check) options.check(read_.program);
  findings.program.throw_if_errors();
  give_up(read_.program);
  if (!job.part.program.empty() || job.part.operations) {
    Job of_target = job;
    if (job.part.operations) of_target.operations = *job.part.operations;
    read_.original = read_moves(SourceText::read(job.part.program.empty() ? job.program : job.part.program), of_target,
                                findings.original);
    give_up(*read_.original);
  }
  time_all(options.longest_path);
}

void SectionPrograms::time_all(std::size_t longest_path) {
  Outlines path = time_program(read_.program, job_, longest_path, !read_.original), original;
  if (read_.original) original = time_program(*read_.original, job_, path.whole ? longest_path : 0, true);
  if (path.whole && (!read_.original || original.whole)) return;
  if (path.whole) path = time_program(read_.program, job_, 0, false);
  if (path.whole || !path.path.upright || (read_.original && (original.whole || !original.path.upright)))
    return time_all(kWhole);
  thin_.emplace();
  thin_->path.outline = std::move(path.path);
  thin_->nominal.outline = std::move(read_.original ? original.nominal : path.nominal);
  if (read_.original) thin_->original.emplace().outline = std::move(original.path);
}

void SectionPrograms::go_to(std::size_t section, std::size_t sections) {
  if (!thin_ || (thin_->section == section && thin_->sections == sections)) return;
  thin_->section = section;
  thin_->sections = sections;
  Region region = reach(section, sections);
  region.add(reach_in(job_, thin_->nominal.outline, place_in(thin_->nominal.outline, section, sections)));
  region = joined_region(job_, joined_region(job_, region));
  // What was cut far below cuts here with its flank.
  region.min_mm.z() = std::min(region.min_mm.z(), -1e9);
  const auto keeper = [&](SparsePath& path) {
    const PathOutline& outline = path.outline;
    const ListRange own = numbers_of(PathStretch(outline.runs, {}, {}), place_in(outline, section, sections));
    return BlockKeeper(path, blocks_near(job_, outline, own, region));
  };
  BlockKeeper keep = keeper(thin_->path), keep_nominal = keeper(thin_->nominal);
  const auto target = [&](SimulatedProgram& program, BlockKeeper& keep_path) {
    removal::NominalFollower follower(program.moves_in_part(), program.selected, nullptr, std::ref(keep_nominal));
    follow_path(program, job_, [&](const ToolRun& run, std::size_t number, const Stamp& stamp) {
      keep_path(run, number, stamp);
      follower.add(run, stamp);
    });
    follower.finish();
  };
  if (!thin_->original) return target(read_.program, keep);
  follow_path(read_.program, job_, std::ref(keep));
  BlockKeeper keep_original = keeper(*thin_->original);
  target(*read_.original, keep_original);
}

PathStretch SectionPrograms::path() const { return thin_ ? thin_->path.stretch() : PathStretch(read_.program.path); }

PathStretch SectionPrograms::target_path() const {
  return thin_ ? thin_->target().stretch() : PathStretch(read_.of_target().path);
}

Region SectionPrograms::reach(std::size_t section, std::size_t sections) const {
  Region out;
  if (thin_) {
    for (const SparsePath* path : {&std::as_const(thin_->path), &thin_->target()})
      out.add(reach_in(job_, path->outline, place_in(path->outline, section, sections)));
    return out;
  }
  for (const PathStretch& path : {this->path(), target_path()}) {
    const std::vector<StretchPiece> pieces = path_pieces(path);
    out.add(reach_of(job_, path, pieces, section_pieces(pieces, section, sections)));
  }
  return out;
}

/// The path is gone through twice: where a section lies is known when all of it is counted.
NominalSection SectionPrograms::nominal(std::size_t section, std::size_t sections) const {
  if (thin_) return {.thin = &thin_->nominal, .place = place_in(thin_->nominal.outline, section, sections)};
  const SimulatedProgram& program = of_target();
  const auto follow = [&](const removal::TakeNominal& take) {
    return removal::follow_nominal_path(program.moves_in_part(), program.selected, program.path, program.part_path(),
                                        take);
  };
  removal::StampPath path;
  path.runs = follow([](const ToolRun&, std::size_t, const Stamp&) {});
  SectionPlace place(path, section, sections);
  const ListRange own = numbers_of(path, place);
  path.stamps.reserve(own.end - own.from);
  if (!place.own.empty())
    follow([&](const ToolRun&, std::size_t number, const Stamp& stamp) {
      if (number >= own.from && number < own.end) path.stamps.push_back(stamp);
    });
  return {.path = std::move(path), .first = own.from, .place = std::move(place)};
}

void SectionPrograms::add_to(TargetWork& work) const {
  if (!thin_) return;
  work.path = &thin_->target();
  work.nominal = &thin_->nominal;
}

std::optional<Programs> SectionPrograms::take() {
  const bool texts = !read_.program.text().blocks.empty();
  if (thin_ || !texts) return std::nullopt;
  return std::move(read_);
}

}  // namespace camber::distribute
