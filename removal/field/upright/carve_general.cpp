#include "removal/field/upright/carve_general.h"

#include <algorithm>
#include <cmath>

#include "removal/field/profile_rows.h"
#include "removal/form_error/settling.h"

namespace camber::removal::upright {
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
