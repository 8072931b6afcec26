#include "removal/carve.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "removal/carve_general.h"
#include "removal/kernels.h"
#include "removal/vector_clones.h"

namespace camber::removal {
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
               double bend_mm, Cut cut) {
  static_assert(LineCut::kColumns == Tile::kSide && LineCut::kLine == ColumnCover::kLine);
  const float reach = line.flat + line.corner + line.band - line.shrink + static_cast<float>(bend_mm);
  std::array<float, ColumnCover::kLine> changeable;
  line.changeable = changeable.data();
  bool any = false;
  for (int i = 0; i < Tile::kSide; ++i) {
    line.dx = static_cast<float>((t[0] * Tile::kCore + i) * voxel - stamp.tip_mm.x());
    if (std::abs(line.dx) > reach) continue;
    if (!cover.changeable(i, stamp.tip_mm, bend_mm, changeable)) continue;
    line.distance = tile.distance.data() + Tile::offset(i, 0, 0);
    line.stamp = tile.stamp.data() + Tile::offset(i, 0, 0);
    line.top = cover.tops(i);
    const LineResult result = cut(line);
    for (int j = 0; j < Tile::kSide; ++j)
      if (result.tried >> j & 1u) cover.cut(tile, i, j, stamp.tip_mm, bend_mm, (result.changed >> j & 1u) != 0);
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

namespace {

/// Middles of the sectors, half a turn more on both sides.
struct SectorTable {
  static_assert((CarveBend::kSectors & (CarveBend::kSectors - 1)) == 0);
  static constexpr int kPadded = 2 * CarveBend::kSectors + 1;
  std::array<float, kPadded> cosine, sine;
  SectorTable() {
    const double sector = 2 * kPi / CarveBend::kSectors;
    for (int o = 0; o < kPadded; ++o) {
      const int i = (o + CarveBend::kSectors / 2) & (CarveBend::kSectors - 1);
      cosine[o] = static_cast<float>(std::cos(-kPi + (i + 0.5) * sector));
      sine[o] = static_cast<float>(std::sin(-kPi + (i + 0.5) * sector));
    }
  }
};

}  // namespace

Bends::Bends(const EnvelopeGrid& envelope, const ShiftTable& shifts)
    : shifts_(shifts), flutes_(envelope.flutes), group_(std::max(1, shifts.steps * envelope.flutes / 360)) {
  const int nodes = static_cast<int>(shifts.nodes());
  const double node_step = nodes > 1 ? shifts.node_height_mm[1] : 0.0;
  const double sector = 2 * kPi / CarveBend::kSectors;
  // A shift between two nodes belongs to a range of lags; one sector more for interpolation between steps.
  spread_ =
      std::min(1 + static_cast<int>(std::ceil(envelope.lag_per_mm * node_step / sector)), CarveBend::kSectors / 2);
  for (int n = 0; n < nodes; ++n)
    for (int m = 0; m < shifts.steps; m += group_)
      for (int j = 0; j < flutes_; ++j) {
        const double turn = static_cast<double>(m + j * shifts.steps) / (shifts.steps * flutes_);
        const double phi = 2 * kPi * turn + shifts.node_height_mm[n] * envelope.lag_per_mm;
        const int centre = static_cast<int>(std::floor((phi + kPi) / sector)) & (CarveBend::kSectors - 1);
        centre_.push_back(static_cast<std::uint8_t>(centre));
      }
}

namespace {

bool all_zero(const float* values, int count) {
  int i = 0;
  for (std::array<std::uint64_t, 4> words{}; i + 8 <= count; i += 8) {
    std::memcpy(words.data(), values + i, sizeof(words));
    if ((words[0] | words[1] | words[2] | words[3]) != 0) return false;
  }
  while (i < count && values[i] == 0) ++i;
  return i == count;
}

}  // namespace

CarveBend Bends::of(std::ptrdiff_t stamp) const {
  CarveBend bend{shifts_.row(stamp), 0, {}};
  float largest2 = 0;
  const auto half_sector = static_cast<float>(kPi / CarveBend::kSectors);
  static const SectorTable table;
  std::array<float, SectorTable::kPadded> outward{};  // from sector -kSectors / 2 on
  const std::uint8_t* centre = centre_.data();
  for (std::size_t n = 0; n < shifts_.nodes(); ++n)
    for (int m = 0; m < shifts_.steps; m += group_, centre += flutes_) {
      const float* v = bend.row + 2 * (static_cast<int>(n) * shifts_.steps + m);
      const int count = std::min(group_, shifts_.steps - m);
      if (all_zero(v, 2 * count)) continue;  // most of a row
      // The others of a group lie within `apart` of its first.
      float longest2 = 0, apart2 = 0;
      for (int i = 0; i < count; ++i) {
        const float x = v[2 * i], y = v[2 * i + 1], dx = x - v[0], dy = y - v[1];
        longest2 = std::max(longest2, x * x + y * y);
        apart2 = std::max(apart2, dx * dx + dy * dy);
      }
      if (longest2 == 0) continue;  // of negative zeros
      largest2 = std::max(largest2, longest2);
      const float more = half_sector * std::sqrt(longest2) + std::sqrt(apart2);
      for (int j = 0; j < flutes_; ++j) {
        const int first = centre[j] - spread_ + CarveBend::kSectors / 2;
        for (int o = first; o <= first + 2 * spread_; ++o)
          outward[o] = std::max(outward[o], v[0] * table.cosine[o] + v[1] * table.sine[o] + more);
      }
    }
  for (int o = 0; o < SectorTable::kPadded; ++o) {
    float& of_sector = bend.outward_mm[(o + CarveBend::kSectors / 2) & (CarveBend::kSectors - 1)];
    of_sector = std::max(of_sector, outward[o]);
  }
  bend.largest_mm = std::sqrt(static_cast<double>(largest2));
  return bend;
}

bool carve_bent(Tile& tile, ColumnCover& cover, const Index3& t, double voxel, double band,
                const EnvelopeGrid& envelope, const CarveStamp& stamp, const ShiftTable& shifts,
                const CarveBend& bend) {
  if (envelope.shape.general) return carve_bent_general(tile, cover, t, voxel, band, envelope, stamp, shifts, bend);
  const LineBend line_bend{{bend.row, nullptr, static_cast<int>(shifts.nodes()), shifts.steps,
                            shifts.nodes() > 1 ? static_cast<float>(shifts.node_height_mm[1]) : 1.0f},
                           static_cast<float>(bend.largest_mm),
                           bend.outward_mm.data(),
                           CarveBend::kSectors,
                           static_cast<float>(envelope.lag_per_mm),
                           static_cast<float>(envelope.steps / (2 * kPi))};
  const auto cut = kernels().cut_line_bent;
  return cut_lines(tile, cover, t, voxel, line_cut(t, voxel, band, envelope.shape, {stamp.tip_mm, stamp.id}), stamp,
                   bend.largest_mm, [&](const LineCut& line) { return cut(line, line_bend); });
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

}  // namespace camber::removal
