#include "distribute/section_pieces.h"

#include <algorithm>

#include "removal/engagement.h"

namespace camber::distribute {

using namespace motion;
using namespace simulate;

using machine::Job;
using removal::Region;

PieceRange section_pieces(const std::vector<StretchPiece>& pieces, std::size_t section, std::size_t sections) {
  std::size_t total = 0, before = 0;
  for (const StretchPiece& p : pieces) total += p.count;
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

std::vector<RunPieces> runs_of(const std::vector<StretchPiece>& pieces, const PieceRange& range) {
  std::vector<RunPieces> out;
  for (std::size_t p = range.begin; p < range.end; ++p) {
    if (out.empty() || out.back().run != pieces[p].run) out.push_back({pieces[p].run, {p, p}});
    out.back().pieces.end = p + 1;
  }
  return out;
}

namespace {

constexpr double kFar_mm = 1e9;

double around_mm(const Job& job, const removal::ToolRun& run) {
  constexpr double kMaxBandVoxels = 12;
  return removal::shape_of(job.tools.at(run.tool)).radius_mm + kMaxBandVoxels * job.simulation.voxel_mm +
         removal::DeflectedEngager::kMaxDeflection_mm;
}

}  // namespace

Region reach_of_tips(const Job& job, const removal::ToolRun& run, const Region& tips) {
  if (tips.empty()) return tips;
  Region out = tips.wider(around_mm(job, run));
  out.max_mm.z() = kFar_mm;
  return out;
}

Region reach_of(const Job& job, const PathStretch& path, const StretchPiece& piece) {
  Region out;
  const double around = around_mm(job, path.run_of(piece));
  const Vec3 wide(around, around, around);
  for (const removal::Stamp& s : path.stamps_of(piece)) {
    out.add(s.pose.tip_mm - wide);
    out.add(s.pose.tip_mm + wide);
    out.max_mm.z() = kFar_mm;
    if (s.pose.upright()) continue;
    out.add(Vec3::Constant(-kFar_mm));
    out.add(Vec3::Constant(kFar_mm));
    break;
  }
  return out;
}

Region reach_of(const Job& job, const PathStretch& path, const std::vector<StretchPiece>& pieces,
                const PieceRange& range) {
  Region out;
  for (std::size_t p = range.begin; p < range.end; ++p) out.add(reach_of(job, path, pieces[p]));
  return out;
}

Region joined_region(const Job& job, const Region& reach) {
  return reach.empty() ? reach : reach.wider(2 * removal::kTileVoxels * job.simulation.voxel_mm);
}

}  // namespace camber::distribute
