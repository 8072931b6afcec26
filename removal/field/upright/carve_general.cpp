#include "removal/field/upright/carve_general.h"

#include <algorithm>
#include <cmath>

#include "base/vector_clones.h"
#include "removal/form_error/settling.h"

namespace camber::removal::upright {
namespace {

/// A profile in single precision, at most bottom, corner, wall and cylinder.
struct RowProfile {
  struct Line {
    float r, z, along_r, along_z, length;
  };
  struct Arc {
    float r, z, radius;
    float from_r, from_z, to_r, to_z;  ///< normals at its ends
  };
  int lines = 0;
  bool has_arc = false;
  std::array<Line, 4> line{};
  Arc arc{};
};

RowProfile row_profile(const Profile& profile) {
  RowProfile out;
  const auto f = [](double v) { return static_cast<float>(v); };
  for (const auto& p : profile.pieces()) {
    if (p.arc) {
      out.has_arc = true;
      out.arc = {f(p.centre.x()),
                 f(p.centre.y()),
                 f(p.radius_mm),
                 f(std::sin(p.normal_from_rad)),
                 f(-std::cos(p.normal_from_rad)),
                 f(std::sin(p.normal_to_rad)),
                 f(-std::cos(p.normal_to_rad))};
    } else {
      out.line[static_cast<std::size_t>(out.lines++)] = {f(p.start.x()), f(p.start.y()), f(p.along.x()), f(p.along.y()),
                                                         f(p.length_mm)};
    }
  }
  return out;
}

/// Signed distances of voxels above each other at r from the axis, the first at z above the tip: outside the nearest
/// piece's, inside the same with the other sign (profile.h).
CAMBER_VECTOR_CLONES
void row_distances(const RowProfile& p, float r, float z, float voxel, int count, float* __restrict out) {
  std::array<float, Tile::kSide + 7> min_squared, outward;
  for (int k = 0; k < count; ++k) {
    min_squared[k] = 1e30f;
    outward[k] = -(z + static_cast<float>(k) * voxel);
  }
  for (int i = 0; i < p.lines; ++i) {
    const RowProfile::Line l = p.line[i];
    const float dr = r - l.r;
    for (int k = 0; k < count; ++k) {
      const float dz = z + static_cast<float>(k) * voxel - l.z;
      const float along = std::min(std::max(dr * l.along_r + dz * l.along_z, 0.0f), l.length);
      const float er = dr - along * l.along_r, ez = dz - along * l.along_z;
      min_squared[k] = std::min(min_squared[k], er * er + ez * ez);
      outward[k] = std::max(outward[k], dr * l.along_z - dz * l.along_r);
    }
  }
  if (p.has_arc) {
    const RowProfile::Arc a = p.arc;
    const float dr = r - a.r;
    for (int k = 0; k < count; ++k) {
      const float dz = z + static_cast<float>(k) * voxel - a.z;
      const float gap = std::sqrt(dr * dr + dz * dz) - a.radius;
      const bool in_wedge = (a.from_r * dz - a.from_z * dr >= 0) & (dr * a.to_z - dz * a.to_r >= 0);
      min_squared[k] = in_wedge ? std::min(min_squared[k], gap * gap) : min_squared[k];
      outward[k] = in_wedge ? std::max(outward[k], gap) : outward[k];
    }
  }
  for (int k = 0; k < count; ++k) {
    const float d = std::sqrt(min_squared[k]);
    out[k] = outward[k] > 0 ? d : -d;
  }
}

int first_voxel(double height_mm, double row_z_mm, double voxel_mm) {
  return static_cast<int>(
      std::clamp(std::floor((height_mm - row_z_mm) / voxel_mm), 0.0, static_cast<double>(Tile::kSide)));
}

/// Height above the tip from which on a row at r comes within `reach` of the envelope, at least.
double lowest_reached(const Profile& profile, double r, double reach) {
  return profile.height_at_radius_mm(std::max(0.0, r - reach)) - reach;
}

/// The deflection of the envelope's point nearest to a place.
Eigen::Vector2f deflection_at(const EnvelopeGrid& envelope, const DeflectionTable& deflections, const float* row,
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

Vec2 settled_deflection(const EnvelopeGrid& envelope, const DeflectionTable& deflections, const float* row,
                        const Vec3& from_tip, Vec2 guess) {
  constexpr auto close = static_cast<double>(Settling::kFieldClose_mm);
  const auto z = static_cast<float>(from_tip.z());
  for (int step = 0; step < Settling::kFieldSteps; ++step) {
    const Vec2 at = from_tip.head<2>() - guess;
    const Vec2 turned =
        deflection_at(envelope, deflections, row, static_cast<float>(at.x()), static_cast<float>(at.y()), z)
            .cast<double>() -
        guess;
    guess += static_cast<double>(Settling::share_of(step)) * turned;
    if (turned.squaredNorm() <= close * close) break;
  }
  return guess;
}

bool carve_general(Tile& tile, ColumnCover& cover, const Index3& t, double voxel, double band, const CutterShape& shape,
                   const CarveStamp& stamp) {
  const RowProfile profile = row_profile(shape.profile);
  const auto shrink = static_cast<float>(stamp.shrink_mm), top = static_cast<float>(band);
  std::array<float, Tile::kSide> row;
  return for_rows(tile, cover, t, voxel, band, shape.profile, shape.radius_mm, stamp.tip_mm, 0,
                  [&](int i, int j, int k0, int count, double rho, double, double, double z) {
                    row_distances(profile, static_cast<float>(rho), static_cast<float>(z), static_cast<float>(voxel),
                                  count, row.data());
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
  const RowProfile profile = row_profile(exact);
  const auto top = static_cast<float>(band), largest = static_cast<float>(deflection.largest_mm);
  std::array<float, Tile::kSide> row;
  return for_rows(tile, cover, t, voxel, band + deflection.largest_mm, exact, envelope.shape.radius_mm, stamp.tip_mm,
                  deflection.largest_mm,
                  [&](int i, int j, int k0, int count, double rho, double dx, double dy, double z0) {
                    row_distances(profile, static_cast<float>(rho), static_cast<float>(z0), static_cast<float>(voxel),
                                  count, row.data());
                    float* distance = tile.distance.data() + Tile::offset(i, j, k0);
                    std::int32_t* id = tile.stamp.data() + Tile::offset(i, j, k0);
                    bool changed = false;
                    for (int k = 0; k < count; ++k) {
                      if (std::min(largest - row[static_cast<std::size_t>(k)], top) <= distance[k]) continue;
                      const auto x = static_cast<float>(dx), y = static_cast<float>(dy);
                      const auto z = static_cast<float>(z0 + k * voxel);
                      const Vec2 s = settled_deflection(envelope, deflections, deflection.row, {x, y, z}, Vec2::Zero());
                      const double d = exact.distance_mm({std::hypot(dx - s.x(), dy - s.y()), z});
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
