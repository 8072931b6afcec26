#include "removal/field/blank_edges.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace camber::removal {
namespace {

constexpr int kAround = BlankEdges::kAround;
constexpr float kSmooth = 0.98f, kBent = 0.05f;
constexpr double kUnit = 0.03;      ///< the length of a face's gradient differs from 1 by no more
constexpr double kSameFace = 0.97;  ///< cosine between normals
constexpr double kAbove = 0.15;     ///< voxels that a hollow face may lie above the field nearby
constexpr double kAsWell = 0.005;   ///< voxels
constexpr double kKnown = 0.05;     ///< voxels
constexpr double kFarther = 0.02;   ///< voxels, that a face counts as worse around the cell
constexpr float kNear = 2.7f, kDiagonal = 1.75f, kOutside = 0.4f, kInside = 1.0f;  ///< voxels
constexpr int kCorners = 8;

int around(int i, int j, int k) { return (i * kAround + j) * kAround + k; }

/// An edge bends the field within the cell: it falls slower in the middle than a face's does, or differently along
/// parallel edges of the cell.
bool is_bent(const float* lowest, float voxel_mm) {
  float middle2 = 0;
  for (int a = 0; a < 3; ++a) {
    float least = std::numeric_limits<float>::max(), most = -least, sum = 0;
    for (int c = 0; c < kCorners; ++c) {
      if ((c >> a & 1) != 0) continue;
      const float rise = lowest[cell_corner(c | 1 << a)] - lowest[cell_corner(c)];
      least = std::min(least, rise), most = std::max(most, rise), sum += rise;
    }
    if (most - least > kBent * voxel_mm) return true;
    middle2 += sum * sum / 16;
  }
  return middle2 < kSmooth * kSmooth * voxel_mm * voxel_mm;
}

/// The surface runs through the cell, or close by.
bool is_near(const float* lowest, float voxel_mm) {
  float least = std::numeric_limits<float>::max(), most = -least;
  for (int c = 0; c < kCorners; ++c) {
    least = std::min(least, lowest[cell_corner(c)]);
    most = std::max(most, lowest[cell_corner(c)]);
  }
  return least < kOutside * voxel_mm && most > -kInside * voxel_mm;
}

/// Copies the values around a cell of a tile.
void copy_around(const float* lowest, float* out) {
  for (int i = 0; i < kAround; ++i)
    for (int j = 0; j < kAround; ++j)
      std::copy_n(lowest + Tile::offset(i - 1, j - 1, -1), kAround, out + around(i, j, 0));
}

/// A face of the blank as the voxels on one corner's side have it.
struct Corner {
  Vec3 place;  ///< voxels from the lowest
  double distance_mm;
  Vec3 outwards;
  double above = 0;  ///< above_field
};

/// How far the face through a corner lies above the field around it at most, voxels; where it is
/// more than kAbove, any such value. Material is what lies below all
/// faces that lie nowhere above it: so it is at a convex edge, and not with a gradient that was taken across the edge.
double above_field(const Corner& corner, const float* d, double voxel_mm) {
  const Vec3 step = voxel_mm * corner.outwards;
  const double lowest = corner.distance_mm - step.dot(corner.place + Vec3::Ones());
  double most_mm = 0;
  for (int i = 0; i < kAround; ++i) {
    for (int j = 0; j < kAround; ++j) {
      const double row = lowest + i * step.x() + j * step.y();
      for (int k = 0; k < kAround; ++k)
        most_mm = std::max(most_mm, row + k * step.z() - static_cast<double>(d[around(i, j, k)]));
    }
    if (most_mm > kAbove * voxel_mm) break;
  }
  return most_mm / voxel_mm;
}

/// The gradient at a voxel of the cube, taken away from the cell where the cube has a voxel there.
Vec3 gradient_at(const float* d, const std::array<int, 3>& at, double voxel_mm) {
  const auto value = static_cast<double>(d[around(at[0], at[1], at[2])]);
  Vec3 out;
  for (std::size_t a = 0; a < 3; ++a) {
    std::array<int, 3> next = at;
    const int side = at[a] == 1 || at[a] == kAround - 1 ? -1 : 1;
    next[a] += side;
    out[static_cast<int>(a)] = side * (static_cast<double>(d[around(next[0], next[1], next[2])]) - value) / voxel_mm;
  }
  return out;
}

/// True where the field's gradient is that of one face at all corners of the cell.
bool is_one_face(const float* d, double voxel_mm) {
  const Vec3 first = gradient_at(d, {1, 1, 1}, voxel_mm);
  for (int c = 1; c < kCorners; ++c) {
    const Vec3 g = gradient_at(d, {1 + (c & 1), 1 + (c >> 1 & 1), 1 + (c >> 2 & 1)}, voxel_mm);
    if (g.dot(first) < kSameFace * g.norm() * first.norm()) return false;
  }
  return true;
}

/// The face that a voxel belongs to, if any.
std::optional<Corner> corner_at(const float* d, const std::array<int, 3>& at, double voxel_mm) {
  const Vec3 gradient = gradient_at(d, at, voxel_mm);
  const double length = gradient.norm();
  if (std::abs(length - 1) > kUnit) return std::nullopt;
  Corner corner{Vec3(at[0] - 1, at[1] - 1, at[2] - 1), static_cast<double>(d[around(at[0], at[1], at[2])]),
                gradient / length};
  corner.above = above_field(corner, d, voxel_mm);
  if (corner.above > kAbove) return std::nullopt;
  return corner;
}

/// Those of the cell that lie in material; with `all` those around and outside too, which count as worse: out of the
/// material a distance may be that of the edge itself. Best first.
std::vector<Corner> corners_of(const float* d, double voxel_mm, bool all) {
  std::vector<Corner> out;
  for (int n = 0; n < kAround * kAround * kAround; ++n) {
    const std::array<int, 3> at{n / kAround / kAround, n / kAround % kAround, n % kAround};
    const bool of_cell = std::ranges::all_of(at, [](int i) { return i == 1 || i == 2; }), outside = d[n] > 0;
    if (!all && (!of_cell || outside)) continue;
    if (std::optional<Corner> corner = corner_at(d, at, voxel_mm)) {
      corner->above += kFarther * ((of_cell ? 0 : 1) + (outside ? 2 : 0));
      out.push_back(*corner);
    }
  }
  std::ranges::stable_sort(out, {}, &Corner::above);
  return out;
}

/// Corners of one face.
struct Group {
  Vec3 outwards = Vec3::Zero(), place = Vec3::Zero();
  double distance_mm = 0, above = 0;  ///< values of the first
  int count = 0;

  void add(const Corner& c) { outwards += c.outwards, place += c.place, distance_mm += c.distance_mm, ++count; }
  Vec3 middle() const { return place / count; }
  EdgeFace face(double voxel_mm) const {
    const Vec3 n = outwards.normalized();
    return {n, distance_mm / count - voxel_mm * n.dot(middle())};
  }
};

bool is_known(std::span<const Group> groups, const Vec3& place, double distance_mm, double voxel_mm) {
  return std::ranges::any_of(
      groups, [&](const Group& g) { return g.face(voxel_mm).at(place, voxel_mm) > distance_mm - kKnown * voxel_mm; });
}

/// By faces, those that fit the field best first. Where the faces so far say what the field is, a corner of another
/// normal was taken a little across the edge.
std::vector<Group> groups_of(std::span<const Corner> corners, double voxel_mm) {
  std::vector<Group> out;
  for (const Corner& c : corners) {
    const auto same =
        std::ranges::find_if(out, [&](const Group& g) { return g.outwards.normalized().dot(c.outwards) > kSameFace; });
    if (same != out.end()) {
      if (c.above < same->above + kAsWell) same->add(c);
    } else if (!is_known(out, c.place, c.distance_mm, voxel_mm)) {
      out.emplace_back().above = c.above, out.back().add(c);
    }
  }
  return out;
}

/// The faces that meet in the cell: most often its own corners know them all.
std::vector<Group> faces_of(const float* d, double voxel_mm) {
  std::vector<Group> own = groups_of(corners_of(d, voxel_mm, false), voxel_mm);
  bool all_known = own.size() > 1;
  for (int c = 0; c < kCorners && all_known; ++c) {
    const Vec3 place(c & 1, c >> 1 & 1, c >> 2 & 1);
    all_known =
        is_known(own, place, static_cast<double>(d[around(1 + (c & 1), 1 + (c >> 1 & 1), 1 + (c >> 2 & 1))]), voxel_mm);
  }
  return all_known ? own : groups_of(corners_of(d, voxel_mm, true), voxel_mm);
}

}  // namespace

void BlankEdges::clear() {
  cell_.clear();
  from_.clear();
  face_.clear();
}

void BlankEdges::find(const float* distance, double voxel_mm, double band_mm, const ReadAround& read) {
  clear();
  for (int i = 0; i < Tile::kCore; ++i) find_in_layer(i, distance, voxel_mm, band_mm, read);
}

void BlankEdges::find_in_layer(int i, const float* distance, double voxel_mm, double band_mm, const ReadAround& read) {
  // Nothing clipped, and near the surface: deeper chips are hardly wrong.
  const auto voxel = static_cast<float>(voxel_mm), most = kNear * voxel,
             least = std::max(-most, kDiagonal * voxel - static_cast<float>(band_mm));
  std::array<float, kAround * kAround * kAround> d;
  std::vector<EdgeFace> faces;
  for (int j = 0; j < Tile::kCore; ++j)
    for (int k = 0; k < Tile::kCore; ++k) {
      const int cell = Tile::offset(i, j, k);
      const float* lowest = distance + cell;
      if (!(*lowest > least && *lowest < most) || !is_near(lowest, voxel) || !is_bent(lowest, voxel)) continue;
      if (std::min({i, j, k}) > 0 && std::max({i, j, k}) + 2 < Tile::kSide)
        copy_around(lowest, d.data());
      else
        read({i, j, k}, d.data());
      if (is_one_face(d.data(), voxel_mm)) continue;
      const std::vector<Group> groups = faces_of(d.data(), voxel_mm);
      if (groups.size() < 2) continue;
      faces.clear();
      for (const Group& g : groups) faces.push_back(g.face(voxel_mm));
      cell_.push_back(cell);
      from_.push_back(static_cast<std::uint32_t>(face_.size()));
      face_.insert(face_.end(), faces.begin(), faces.end());
    }
}

std::span<const EdgeFace> BlankEdges::faces(int cell) const {
  if (cell_.empty()) return {};
  const auto found = std::ranges::lower_bound(cell_, cell);
  if (found == cell_.end() || *found != cell) return {};
  const auto i = static_cast<std::size_t>(found - cell_.begin());
  const std::size_t end = i + 1 < from_.size() ? from_[i + 1] : face_.size();
  return std::span(face_).subspan(from_[i], end - from_[i]);
}

double BlankCell::distance_mm(double up_mm, const Vec3& axis) const {
  if (faces.empty()) {
    const auto here = static_cast<double>(trilinear(lowest, share));
    return up_mm == 0 ? here : here + up_mm * trilinear_gradient(lowest, share, voxel_mm).dot(axis);
  }
  double most = -std::numeric_limits<double>::infinity();
  for (const EdgeFace& f : faces) most = std::max(most, f.distance_mm(share, voxel_mm) + up_mm * f.outwards.dot(axis));
  return most;
}

}  // namespace camber::removal
