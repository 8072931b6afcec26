// The contact of every stamp with a target surface.
#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "base/cancel.h"
#include "removal/cutter.h"
#include "simulate/cut.h"

namespace camber::simulate {

using removal::Stamp;
using removal::Stock;

std::vector<Contact> find_contacts(const Stock& target, const machine::Tool& tool, std::span<const Stamp> stamps) {
  const removal::CutterShape shape = removal::shape_of(tool);
  const double top = std::max(shape.corner_radius_mm, target.voxel_mm());
  const double length = shape.profile.length_to_height_mm(top);
  constexpr int kRings = 100;
  constexpr double kDepthBand_mm = 0.001, kOut = -1e9;
  struct Ring {
    double radius, height;
    double slope;  ///< tangent of the normal's angle; 0: the normal points down
  };
  std::array<Ring, kRings> rings;
  for (int r = 0; r < kRings; ++r) {
    const auto p = shape.profile.at((r + 0.5) * length / kRings);
    rings[static_cast<std::size_t>(r)] = {p.radius_mm, p.height_mm,
                                          p.normal_angle_rad > 0 ? std::tan(p.normal_angle_rad) : 0.0};
  }
  struct Candidate {
    double depth;
    Vec3 place;
  };
  std::vector<Contact> out(stamps.size());
  struct Buffers {
    Stock::Probe probe;
    std::vector<Candidate> candidates;
  };
  tbb::enumerable_thread_specific<Buffers> buffers([&] { return Buffers{Stock::Probe(target), {}}; });
  tbb::parallel_for(std::size_t{0}, stamps.size(), [&](std::size_t k) {
    cancellation_point();
    const removal::ToothMotion motion = removal::motion_in_tool(stamps, k);
    const Mat3 frame = tool_frame(stamps[k].pose);
    auto& [probe, candidates] = buffers.local();  // depth: of the nearest voxel
    candidates.clear();
    for (const Ring& ring : rings) {
      const Vec3 f = motion.at({0, 0, ring.height});
      const double horizontal = f.head<2>().norm();
      const Vec2 along = horizontal > 0 ? Vec2(f.head<2>() / horizontal) : Vec2::UnitX(), aside(-along.y(), along.x());
      // The cosine of the angle from the motion at which the normal stands across it.
      const double cosine = ring.slope == 0 ? 0.0 : horizontal > 0 ? f.z() / (horizontal * ring.slope) : 2.0;
      if (std::abs(cosine) > 1) continue;
      const Vec2 ahead = ring.radius * cosine * along, beside = ring.radius * std::sqrt(1 - cosine * cosine) * aside;
      for (const double side : {-1.0, 1.0}) {
        const Vec2 flat = ahead + side * beside;
        candidates.push_back({0, Vec3(flat.x(), flat.y(), ring.height)});
      }
    }
    const auto nearest = [&](const Candidate& c) {
      return -static_cast<double>(probe.nearest(stamps[k].pose.tip_mm + frame * c.place));
    };
    const auto trilinear = [&](const Candidate& c) {
      return -probe.distance_mm(stamps[k].pose.tip_mm + frame * c.place);
    };
    // A trilinear value differs from the nearest voxel's by no more than the mean distance of its corners from it, and
    // voxels from each other by no more than they are apart.
    const double blur = std::sqrt(1.5) * target.voxel_mm(), apart = std::sqrt(3.0) * target.voxel_mm();
    // A few of each side first: where they are far from the deepest, those around are as well.
    constexpr std::size_t kSides = 2, kEvery = 4 * kSides;
    std::size_t top = 0;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      if (c % kEvery >= kSides) continue;
      candidates[c].depth = nearest(candidates[c]);
      if (candidates[c].depth > candidates[top].depth) top = c;
    }
    const double known = candidates.empty() ? kOut : trilinear(candidates[top]);
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      if (c % kEvery < kSides) continue;
      const Candidate& before = candidates[c / kEvery * kEvery + c % kSides];
      const double most = before.depth + (candidates[c].place - before.place).norm() + apart;
      candidates[c].depth = most + blur < known - kDepthBand_mm ? kOut : nearest(candidates[c]);
    }
    double deepest = kOut;
    const auto read = [&](Candidate& c) {
      c.depth = trilinear(c);
      deepest = std::max(deepest, c.depth);
    };
    const auto first = std::ranges::max_element(candidates, {}, &Candidate::depth);
    if (first != candidates.end()) std::swap(*first, candidates.front()), read(candidates.front());
    for (std::size_t c = 1; c < candidates.size(); ++c) {
      if (candidates[c].depth + blur >= deepest - kDepthBand_mm)
        read(candidates[c]);
      else
        candidates[c].depth = kOut;
    }
    Vec3 sum = Vec3::Zero();
    double count = 0;
    for (const auto& c : candidates)
      if (c.depth >= deepest - kDepthBand_mm) {
        sum += c.place;
        ++count;
      }
    if (count > 0) out[k] = {sum.z() / count, std::atan2(sum.y(), sum.x())};
  });
  return out;
}

}  // namespace camber::simulate
