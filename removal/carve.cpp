#include "removal/carve.h"

#include <algorithm>
#include <cmath>

#include "removal/carve_general.h"
#include "removal/kernels.h"
#include "removal/vector_clones.h"

namespace camber::removal {
namespace {

/// The envelope in single precision, as rows of voxels need it.
struct RoundedCylinder {
  float flat, corner, shrink;
};

/// Cuts `count` voxels of a row upwards. qx: distance from the axis less the flat's radius; z: of the first voxel
/// above the tip. True when one changed.
CAMBER_VECTOR_CLONES
bool carve_row(float* distance, std::int32_t* stamp, int count, float qx, float z, float voxel, float band,
               RoundedCylinder p, std::int32_t id) {
  const float a = std::max(qx, 0.0f);
  const float a2 = a * a;
  int any = 0;
  for (int k = 0; k < count; ++k) {
    const float qz = p.corner - (z + static_cast<float>(k) * voxel);
    const float b = std::max(qz, 0.0f);
    const float d = std::min(std::max(qx, qz), 0.0f) + std::sqrt(a2 + b * b) - p.corner + p.shrink;
    const float v = std::min(-d, band);
    const bool cut = v > distance[k];
    distance[k] = cut ? v : distance[k];
    stamp[k] = cut ? id : stamp[k];
    any |= cut;
  }
  return any != 0;
}

/// Distances of a row of voxels to the straight envelope; true where a voxel could be cut with a shift that moves the
/// envelope outwards by no more than `slack`.
CAMBER_VECTOR_CLONES
bool row_may_be_cut(const float* distance, float* out, int count, float qx, float z, float voxel, float band,
                    RoundedCylinder p, float slack) {
  const float a = std::max(qx, 0.0f);
  const float a2 = a * a;
  int any = 0;
  for (int k = 0; k < count; ++k) {
    const float qz = p.corner - (z + static_cast<float>(k) * voxel);
    const float b = std::max(qz, 0.0f);
    const float d = std::min(std::max(qx, qz), 0.0f) + std::sqrt(a2 + b * b) - p.corner;
    out[k] = std::min(slack - d, band);
    any |= out[k] > distance[k];
  }
  return any != 0;
}

/// Height above the tip from which on a row at qx outside the flat comes within `reach` of the envelope.
float lowest_reached(float qx, float corner, float reach) {
  if (qx <= 0) return corner - reach;
  const float left = reach * reach - qx * qx;
  return left > 0 ? corner - std::sqrt(left) : corner;
}

/// First voxel of the row that the cutter may reach.
int first_reached(double lowest_mm, double row_z_mm, double voxel_mm) {
  return std::clamp(static_cast<int>(std::floor((lowest_mm - row_z_mm) / voxel_mm)), 0, Tile::kSide);
}

/// atan2 to 1e-5 rad: enough to find a rotation step.
float fast_atan2(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float a = std::min(ax, ay) / std::max(std::max(ax, ay), 1e-20f);
  const float s = a * a;
  float r = ((((0.0208351f * s - 0.085133f) * s + 0.180141f) * s - 0.3302995f) * s + 0.999866f) * a;
  if (ay > ax) r = static_cast<float>(kPi / 2) - r;
  if (x < 0) r = static_cast<float>(kPi) - r;
  return y < 0 ? -r : r;
}

}  // namespace

bool carve(Tile& tile, ColumnCover& cover, const Index3& t, double voxel, double band, const CutterShape& shape,
           const CarveStamp& stamp) {
  if (shape.general) return carve_general(tile, cover, t, voxel, band, shape, stamp);
  const RoundedCylinder p{static_cast<float>(shape.bottom_length_mm()), static_cast<float>(shape.corner_radius_mm),
                          static_cast<float>(stamp.shrink_mm)};
  const double z0 = t[2] * Tile::kCore * voxel;
  const int k0 = first_reached(stamp.tip_mm.z() - band, z0, voxel);
  const float reach = static_cast<float>(band) + p.corner - p.shrink;
  const float z = static_cast<float>((t[2] * Tile::kCore + k0) * voxel - stamp.tip_mm.z());
  const auto per_voxel = static_cast<float>(1 / voxel);
  std::array<float, ColumnCover::kLine> changeable;
  bool any = false;
  for (int i = 0; i < Tile::kSide; ++i) {
    const float dx = static_cast<float>((t[0] * Tile::kCore + i) * voxel - stamp.tip_mm.x());
    if (std::abs(dx) > reach + p.flat) continue;
    if (!cover.changeable(i, stamp.tip_mm, 0, changeable)) continue;
    for (int j = 0; j < Tile::kSide; ++j) {
      if (!(changeable[static_cast<std::size_t>(j)] > 0)) continue;
      const float dy = static_cast<float>((t[1] * Tile::kCore + j) * voxel - stamp.tip_mm.y());
      const float qx = std::sqrt(dx * dx + dy * dy) - p.flat;
      if (qx > reach) continue;
      const int up = std::max(0, static_cast<int>((lowest_reached(qx, p.corner, reach) - z) * per_voxel));
      const int count = cover.top(i * Tile::kSide + j) - (k0 + up);
      if (count <= 0) continue;
      const int at = Tile::offset(i, j, k0 + up);
      const bool changed = carve_row(tile.distance.data() + at, tile.stamp.data() + at, count, qx,
                                     z + static_cast<float>(up) * static_cast<float>(voxel), static_cast<float>(voxel),
                                     static_cast<float>(band), p, stamp.id);
      cover.cut(tile, i, j, stamp.tip_mm, 0, changed);
      any |= changed;
    }
  }
  return any;
}

CarveBend make_bend(const EnvelopeGrid& envelope, const ShiftTable& shifts, std::ptrdiff_t stamp) {
  CarveBend bend{shifts.row(stamp), shifts.largest_mm(stamp), {}};
  const int nodes = static_cast<int>(shifts.nodes());
  const double node_step = nodes > 1 ? shifts.node_height_mm[1] : 0.0;
  const double sector = 2 * kPi / CarveBend::kSectors;
  // A shift between two nodes belongs to a range of lags; one sector more for interpolation between steps.
  const int spread = 1 + static_cast<int>(std::ceil(envelope.lag_per_mm * node_step / sector));
  const float half_sector = static_cast<float>(sector / 2);
  std::array<float, CarveBend::kSectors> cosine, sine;
  for (int i = 0; i < CarveBend::kSectors; ++i) {
    cosine[i] = static_cast<float>(std::cos(-kPi + (i + 0.5) * sector));
    sine[i] = static_cast<float>(std::sin(-kPi + (i + 0.5) * sector));
  }
  for (int n = 0; n < nodes; ++n)
    for (int m = 0; m < shifts.steps; ++m) {
      const float* v = bend.row + 2 * (n * shifts.steps + m);
      if (v[0] == 0 && v[1] == 0) continue;
      const float length = std::sqrt(v[0] * v[0] + v[1] * v[1]);
      for (int j = 0; j < envelope.flutes; ++j) {
        const double phi =
            2 * kPi * (m + j * shifts.steps) / envelope.steps + shifts.node_height_mm[n] * envelope.lag_per_mm;
        const int centre = static_cast<int>(std::floor((phi + kPi) / sector));
        for (int o = centre - spread; o <= centre + spread; ++o) {
          const int i = (o % CarveBend::kSectors + CarveBend::kSectors) % CarveBend::kSectors;
          const float outward = v[0] * cosine[i] + v[1] * sine[i] + half_sector * length;
          bend.outward_mm[i] = std::max(bend.outward_mm[i], outward);
        }
      }
    }
  return bend;
}

bool carve_bent(Tile& tile, ColumnCover& cover, const Index3& t, double voxel, double band,
                const EnvelopeGrid& envelope, const CarveStamp& stamp, const ShiftTable& shifts,
                const CarveBend& bend) {
  if (envelope.shape.general) return carve_bent_general(tile, cover, t, voxel, band, envelope, stamp, shifts, bend);
  const RoundedCylinder p{static_cast<float>(envelope.shape.bottom_length_mm()),
                          static_cast<float>(envelope.shape.corner_radius_mm), 0};
  const auto top = static_cast<float>(band), step = static_cast<float>(voxel);
  const auto largest = static_cast<float>(bend.largest_mm);
  const float sectors_per_rad = static_cast<float>(CarveBend::kSectors / (2 * kPi));
  // Near the axis a shift turns a place into another direction.
  const float axis_zone2 = 25 * largest * largest;
  const double z0 = t[2] * Tile::kCore * voxel;
  const int k0 = first_reached(stamp.tip_mm.z() - band, z0, voxel);
  BentRow row{};
  row.voxel = step;
  row.flat = p.flat, row.corner = p.corner, row.band = top;
  row.shift = {bend.row, nullptr, static_cast<int>(shifts.nodes()), shifts.steps,
               shifts.nodes() > 1 ? static_cast<float>(shifts.node_height_mm[1]) : 1.0f};
  row.lag_per_mm = static_cast<float>(envelope.lag_per_mm);
  row.steps_per_rad = static_cast<float>(envelope.steps / (2 * kPi));
  const Kernels& kernel = kernels();
  std::array<float, ColumnCover::kLine> moved;
  std::array<float, Tile::kSide> candidate;
  std::array<float, ColumnCover::kLine> changeable;
  bool any = false;
  for (int i = 0; i < Tile::kSide; ++i) {
    const float dx = static_cast<float>((t[0] * Tile::kCore + i) * voxel - stamp.tip_mm.x());
    if (std::abs(dx) > p.flat + p.corner + top + largest) continue;
    if (!cover.changeable(i, stamp.tip_mm, bend.largest_mm, changeable)) continue;
    for (int j = 0; j < Tile::kSide; ++j) {
      if (!(changeable[static_cast<std::size_t>(j)] > 0)) continue;
      const float dy = static_cast<float>((t[1] * Tile::kCore + j) * voxel - stamp.tip_mm.y());
      const float rho2 = dx * dx + dy * dy;
      float slack = largest;
      if (rho2 > axis_zone2) {
        const int sector = static_cast<int>((fast_atan2(dy, dx) + static_cast<float>(kPi)) * sectors_per_rad);
        slack = std::min(slack, bend.outward_mm[std::clamp(sector, 0, CarveBend::kSectors - 1)]);
      }
      const float limit = p.flat + p.corner + top + slack;
      if (rho2 > limit * limit) continue;
      const float qx = std::sqrt(rho2) - p.flat;
      const double low = stamp.tip_mm.z() + lowest_reached(qx, p.corner, p.corner + top + slack);
      const int k1 = std::max(k0, first_reached(low, z0, voxel));
      const float z1 = static_cast<float>((t[2] * Tile::kCore + k1) * voxel - stamp.tip_mm.z());
      float* distance = tile.distance.data() + Tile::offset(i, j, k1);
      std::int32_t* id = tile.stamp.data() + Tile::offset(i, j, k1);
      const int count = cover.top(i * Tile::kSide + j) - k1;
      if (count <= 0 || !row_may_be_cut(distance, candidate.data(), count, qx, z1, step, top, p, slack)) continue;
      int first = 0, last = count - 1;
      while (candidate[static_cast<std::size_t>(first)] <= distance[first]) ++first;
      while (candidate[static_cast<std::size_t>(last)] <= distance[last]) --last;
      row.dx = dx, row.dy = dy;
      row.z = z1 + static_cast<float>(first) * step;
      row.count = last - first + 1;
      kernel.bent_row(row, moved.data());
      bool changed = false;
      for (int k = first; k <= last; ++k) {
        const float v = moved[static_cast<std::size_t>(k - first)];
        if (candidate[static_cast<std::size_t>(k)] <= distance[k] || v <= distance[k]) continue;
        distance[k] = v;
        id[k] = stamp.id;
        changed = true;
      }
      cover.cut(tile, i, j, stamp.tip_mm, bend.largest_mm, changed);
      any |= changed;
    }
  }
  return any;
}

double tile_distance_mm(const Index3& t, double voxel, const CutterShape& shape, const Vec3& tip) {
  const auto gap = [&](int a) {
    const double lo = t[a] * Tile::kCore * voxel, hi = lo + Tile::kCore * voxel;
    return std::max({lo - tip[a], tip[a] - hi, 0.0});
  };
  const double top = (t[2] + 1) * Tile::kCore * voxel - tip.z();
  return shape.distance_mm({std::sqrt(gap(0) * gap(0) + gap(1) * gap(1)), 0, top});
}

}  // namespace camber::removal
