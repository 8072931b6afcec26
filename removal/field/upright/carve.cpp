#include "removal/field/upright/carve.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/vector_clones.h"
#include "removal/field/profile_rows.h"
#include "removal/form_error/settling.h"
#include "removal/simd/upright_kernels.h"

namespace camber::removal::upright {
namespace {

/// First voxel of the row that the cutter may reach.
int first_reached(double lowest_mm, double row_z_mm, double voxel_mm) {
  return std::clamp(static_cast<int>(std::floor((lowest_mm - row_z_mm) / voxel_mm)), 0, Tile::kSide);
}

LineCut line_cut(const Index3& t, double voxel, double band, const CutterShape& shape, const CarveStamp& stamp) {
  LineCut line{};
  line.id = stamp.id;
  line.lowest = first_reached(stamp.tip_mm.z() - band, t[2] * Tile::kCore * voxel, voxel);
  line.dy = static_cast<float>(t[1] * Tile::kCore * voxel - stamp.tip_mm.y());
  line.z = static_cast<float>(t[2] * Tile::kCore * voxel - stamp.tip_mm.z());
  line.voxel = static_cast<float>(voxel);
  line.band = static_cast<float>(band);
  line.flat = static_cast<float>(shape.bottom_length_mm());
  line.corner = static_cast<float>(shape.corner_radius_mm);
  line.shrink = static_cast<float>(stamp.shrink_mm);
  return line;
}

/// Calls cut(line) for the lines of columns that a stamp may change; true where a voxel changed.
template <class Cut>
bool cut_lines(Tile& tile, ColumnCover& cover, const Index3& t, double voxel, LineCut line, const CarveStamp& stamp,
               double deflection_mm, Cut cut) {
  static_assert(LineCut::kColumns == Tile::kSide && LineCut::kLine == ColumnCover::kLine);
  const float reach = line.flat + line.corner + line.band - line.shrink + static_cast<float>(deflection_mm);
  std::array<float, ColumnCover::kLine> changeable;
  line.changeable = changeable.data();
  bool any = false;
  for (int i = 0; i < Tile::kSide; ++i) {
    line.dx = static_cast<float>((t[0] * Tile::kCore + i) * voxel - stamp.tip_mm.x());
    if (std::abs(line.dx) > reach) continue;
    if (!cover.changeable(i, stamp.tip_mm, deflection_mm, changeable)) continue;
    line.distance = tile.distance.data() + Tile::offset(i, 0, 0);
    line.stamp = tile.stamp.data() + Tile::offset(i, 0, 0);
    line.top = cover.tops(i);
    const LineResult result = cut(line);
    for (int j = 0; j < Tile::kSide; ++j)
      if (result.tried >> j & 1u) cover.cut(tile, i, j, stamp.tip_mm, deflection_mm, (result.changed >> j & 1u) != 0);
    any |= result.changed != 0;
  }
  return any;
}

/// The same below a height. What a column remembers may have been cut by an edge that ended lower: all are tried.
template <class Cut>
bool cut_lines_below(Tile& tile, ColumnCover& cover, const Index3& t, double voxel, LineCut line,
                     const CarveStamp& stamp, double deflection_mm, double end_mm, Cut cut) {
  const float reach = line.flat + line.corner + line.band - line.shrink + static_cast<float>(deflection_mm);
  const int end = std::clamp(static_cast<int>(std::floor(end_mm / voxel)) - t[2] * Tile::kCore + 1, 0, Tile::kSide);
  std::array<float, ColumnCover::kLine> changeable;
  changeable.fill(1.0f);
  line.changeable = changeable.data();
  std::array<std::int16_t, Tile::kSide> top;
  line.top = top.data();
  bool any = false;
  for (int i = 0; i < Tile::kSide; ++i) {
    line.dx = static_cast<float>((t[0] * Tile::kCore + i) * voxel - stamp.tip_mm.x());
    if (std::abs(line.dx) > reach) continue;
    for (std::size_t j = 0; j < top.size(); ++j) top[j] = std::min(cover.tops(i)[j], static_cast<std::int16_t>(end));
    line.distance = tile.distance.data() + Tile::offset(i, 0, 0);
    line.stamp = tile.stamp.data() + Tile::offset(i, 0, 0);
    const LineResult result = cut(line);
    for (int j = 0; j < Tile::kSide; ++j)
      if (result.tried >> j & 1u) cover.cut(tile, i, j, stamp.tip_mm, deflection_mm, (result.changed >> j & 1u) != 0);
    any |= result.changed != 0;
  }
  return any;
}

}  // namespace

bool carve(Tile& tile, ColumnCover& cover, const Index3& t, double voxel, double band, const CutterShape& shape,
           const CarveStamp& stamp) {
  if (shape.general) return carve_general(tile, cover, t, voxel, band, shape, stamp);
  return cut_lines(tile, cover, t, voxel, line_cut(t, voxel, band, shape, stamp), stamp, 0, kernels().cut_line);
}

bool carve_deflected(Tile& tile, ColumnCover& cover, const Index3& t, double voxel, double band,
                     const EnvelopeGrid& envelope, const CarveStamp& stamp, const DeflectionTable& deflections,
                     const StampDeflection& deflection) {
  if (envelope.shape.general)
    return carve_deflected_general(tile, cover, t, voxel, band, envelope, stamp, deflections, deflection);
  const LineDeflection line_deflection{
      {deflection.row, nullptr, static_cast<int>(deflections.nodes()), deflections.steps,
       deflections.nodes() > 1 ? static_cast<float>(deflections.node_height_mm[1]) : 1.0f, deflections.axial},
      static_cast<float>(deflection.largest_mm),
      static_cast<float>(deflection.axial_mm),
      deflection.outward_mm.data(),
      StampDeflection::kSectors,
      static_cast<float>(envelope.lag_per_mm),
      static_cast<float>(envelope.steps / (2 * kPi))};
  const auto cut = kernels().cut_line_deflected;
  LineCut straight = line_cut(t, voxel, band, envelope.shape, {stamp.tip_mm, stamp.id});
  straight.lowest = first_reached(stamp.tip_mm.z() - band - deflection.axial_mm, t[2] * Tile::kCore * voxel, voxel);
  if (std::isfinite(deflections.edges_end_mm)) {
    const double end = stamp.tip_mm.z() + deflections.edges_end_mm;
    return cut_lines_below(tile, cover, t, voxel, straight, stamp, deflection.largest_mm, end,
                           [&](const LineCut& line) { return cut(line, line_deflection); });
  }
  return cut_lines(tile, cover, t, voxel, straight, stamp, deflection.largest_mm,
                   [&](const LineCut& line) { return cut(line, line_deflection); });
}

CAMBER_VECTOR_CLONES
double material_voxels(const Tile& tile, double voxel_mm) {
  const auto scale = static_cast<float>(0.5 / voxel_mm);
  double sum = 0;
  for (int i = 0; i < Tile::kCore; ++i) {
    std::array<float, Tile::kCore> share{};
    for (int j = 0; j < Tile::kCore; ++j) {
      const float* d = tile.distance.data() + Tile::offset(i, j, 0);
      for (int k = 0; k < Tile::kCore; ++k) share[k] += std::min(std::max(0.5f - scale * d[k], 0.0f), 1.0f);
    }
    for (const float v : share) sum += static_cast<double>(v);
  }
  return sum;
}

double tile_distance_mm(const Index3& t, double voxel, const CutterShape& shape, const Vec3& tip) {
  const auto gap = [&](int a) {
    const double lo = t[a] * Tile::kCore * voxel, hi = lo + Tile::kCore * voxel;
    return std::max({lo - tip[a], tip[a] - hi, 0.0});
  };
  const double top = (t[2] + 1) * Tile::kCore * voxel - tip.z();
  return shape.distance_mm({std::sqrt(gap(0) * gap(0) + gap(1) * gap(1)), 0, top});
}

namespace {

int first_voxel(double height_mm, double row_z_mm, double voxel_mm) {
  return static_cast<int>(
      std::clamp(std::floor((height_mm - row_z_mm) / voxel_mm), 0.0, static_cast<double>(Tile::kSide)));
}

/// Height above the tip from which on a row at r comes within `reach` of the envelope, at least.
double lowest_reached(const Profile& profile, double r, double reach) {
  return profile.height_at_radius_mm(std::max(0.0, r - reach)) - reach;
}

/// The deflection of the envelope's point nearest to a place.
Eigen::Vector3f deflection_at(const EnvelopeGrid& envelope, const DeflectionTable& deflections, const float* row,
                              float x, float y, float z) {
  const double height = envelope.shape.profile.nearest({std::hypot(x, y), z}).place.y();
  const double step = deflections.step_at(std::atan2(y, x), height, envelope.lag_per_mm, envelope.flutes);
  return deflections.at(row, height, step).cast<float>();
}

/// Calls change(i, j, k0, count, rho, dx, dy, z) for every row that the stamp may change; it tells whether it did.
/// True where one did.
template <class Change>
bool for_rows(const Tile& tile, ColumnCover& cover, const Index3& t, double voxel, double reach, const Profile& profile,
              double largest_radius, const Vec3& tip, double deflection, Change change) {
  const double z0 = t[2] * Tile::kCore * voxel;
  std::array<float, ColumnCover::kLine> changeable;
  bool any = false;
  for (int i = 0; i < Tile::kSide; ++i) {
    const double dx = (t[0] * Tile::kCore + i) * voxel - tip.x();
    if (std::abs(dx) > reach + largest_radius) continue;
    if (!cover.changeable(i, tip, deflection, changeable)) continue;
    for (int j = 0; j < Tile::kSide; ++j) {
      if (!(changeable[static_cast<std::size_t>(j)] > 0)) continue;
      const double dy = (t[1] * Tile::kCore + j) * voxel - tip.y();
      const double rho = std::sqrt(dx * dx + dy * dy);
      if (rho > reach + largest_radius) continue;
      const int k0 = first_voxel(tip.z() + lowest_reached(profile, rho, reach), z0, voxel);
      const int count = cover.top(i * Tile::kSide + j) - k0;
      if (count <= 0) continue;
      const bool changed = change(i, j, k0, count, rho, dx, dy, z0 + k0 * voxel - tip.z());
      cover.cut(tile, i, j, tip, deflection, changed);
      any |= changed;
    }
  }
  return any;
}

}  // namespace

Vec3 settled_deflection(const EnvelopeGrid& envelope, const DeflectionTable& deflections, const float* row,
                        const Vec3& from_tip, Vec3 guess) {
  constexpr auto close = static_cast<double>(Settling::kFieldClose_mm);
  for (int step = 0; step < Settling::kFieldSteps; ++step) {
    const Eigen::Vector3f at = (from_tip - guess).cast<float>();
    const Vec3 turned = deflection_at(envelope, deflections, row, at.x(), at.y(), at.z()).cast<double>() - guess;
    guess += static_cast<double>(Settling::share_of(step)) * turned;
    if (turned.squaredNorm() <= close * close) break;
  }
  return guess;
}

bool carve_general(Tile& tile, ColumnCover& cover, const Index3& t, double voxel, double band, const CutterShape& shape,
                   const CarveStamp& stamp) {
  const ProfileRows profile(shape.profile);
  const auto shrink = static_cast<float>(stamp.shrink_mm), top = static_cast<float>(band);
  std::array<float, Tile::kSide> row;
  return for_rows(tile, cover, t, voxel, band, shape.profile, shape.radius_mm, stamp.tip_mm, 0,
                  [&](int i, int j, int k0, int count, double rho, double, double, double z) {
                    profile.column(static_cast<float>(rho), static_cast<float>(z), static_cast<float>(voxel), count,
                                   row.data());
                    float* distance = tile.distance.data() + Tile::offset(i, j, k0);
                    std::int32_t* id = tile.stamp.data() + Tile::offset(i, j, k0);
                    bool changed = false;
                    for (int k = 0; k < count; ++k) {
                      const float v = std::min(-(row[static_cast<std::size_t>(k)] + shrink), top);
                      if (v <= distance[k]) continue;
                      distance[k] = v;
                      id[k] = stamp.id;
                      changed = true;
                    }
                    return changed;
                  });
}

bool carve_deflected_general(Tile& tile, ColumnCover& cover, const Index3& t, double voxel, double band,
                             const EnvelopeGrid& envelope, const CarveStamp& stamp, const DeflectionTable& deflections,
                             const StampDeflection& deflection) {
  const Profile& exact = envelope.shape.profile;
  const ProfileRows profile(exact);
  const auto top = static_cast<float>(band), largest = static_cast<float>(deflection.largest_mm);
  std::array<float, Tile::kSide> row;
  return for_rows(
      tile, cover, t, voxel, band + deflection.largest_mm, exact, envelope.shape.radius_mm, stamp.tip_mm,
      deflection.largest_mm, [&](int i, int j, int k0, int count, double rho, double dx, double dy, double z0) {
        profile.column(static_cast<float>(rho), static_cast<float>(z0), static_cast<float>(voxel), count, row.data());
        float* distance = tile.distance.data() + Tile::offset(i, j, k0);
        std::int32_t* id = tile.stamp.data() + Tile::offset(i, j, k0);
        bool changed = false;
        for (int k = 0; k < count; ++k) {
          if (std::min(largest - row[static_cast<std::size_t>(k)], top) <= distance[k]) continue;
          const auto x = static_cast<float>(dx), y = static_cast<float>(dy);
          const auto z = static_cast<float>(z0 + k * voxel);
          const Vec3 s = settled_deflection(envelope, deflections, deflection.row, {x, y, z}, Vec3::Zero());
          const double d = exact.distance_mm({std::hypot(dx - s.x(), dy - s.y()), z - s.z()});
          const float v = std::min(static_cast<float>(-d), top);
          if (v <= distance[k]) continue;
          distance[k] = v;
          id[k] = stamp.id;
          changed = true;
        }
        return changed;
      });
}

}  // namespace camber::removal::upright
