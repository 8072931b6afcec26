#pragma once
// The order in which primitives are machined, the faces that are open then, and the features that follow from them.
#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "plan/removal_volume.h"
#include "plan/triangle_solid.h"

namespace camber::plan {

// The removal volume in primitives: boxes and upright cylinders, by one of three ways to divide.

/// After planes parallel to xy (the heights come first): by planes parallel to yz, parallel to zx, or by both, so that
/// each box is as large as possible.
enum class DivisionPlan : unsigned char { yz, zx, largest };
inline constexpr std::array<DivisionPlan, 3> kDivisionPlans{DivisionPlan::yz, DivisionPlan::zx, DivisionPlan::largest};
std::string_view to_string(DivisionPlan plan);

struct VolumePrimitive {
  bool is_hole = false;
  bool free_form = false;        ///< one of its faces is
  bool contoured = false;        ///< a part stays in it, with upright walls
  bool overhang = false;         ///< a free-form face of it looks down
  std::vector<CellIndex> cells;  ///< ascending; none of a hole; all of the box but of slivers that are joined
  std::size_t hole = 0;          ///< among RemovalVolume::holes
  Vec3 min_mm = Vec3::Zero(), max_mm = Vec3::Zero();
  double volume_mm3 = 0;  ///< to be removed
  Vec3 middle() const { return 0.5 * (min_mm + max_mm); }
};

/// Each layer between two neighbouring planes parallel to xy is divided by itself, and in it each connected region by
/// the planes that its own outline has: a pocket is not cut by planes of another one. A region with a free-form face is
/// one primitive, with those above and below it that it touches. `largest` takes the greatest rectangle that is left
/// again and again (equal: less perimeter, then less x, then less y of the middle), or one of the other ways where that
/// gives fewer boxes. A plane parallel to xy does not divide what is alike above and below: it is the floor of another
/// region. A box narrower than the smallest mill that lies along another one is joined to that, and a layer thinner
/// than a tenth of it to the layer below where that is no larger: then a primitive has more than one box. Boxes first,
/// by layer from below; then holes.
std::vector<VolumePrimitive> divide(const RemovalVolume& removal, DivisionPlan plan);

// Where a cutter has room among what stays.

/// Upright, seen from above.
struct Rect {
  double x0 = 0, x1 = 0, y0 = 0, y1 = 0;
  double distance(double x, double y) const;
  double distance(const Rect& other) const;
  bool holds(double x, double y) const { return x >= x0 && x <= x1 && y >= y0 && y <= y1; }
};

/// A grid over a window, with the places where something stands.
class Room {
 public:
  /// Obstacles are the places of `middles` and a radius round it where `stays` is higher than `above_mm`. Steps are a
  /// twelfth of the radius where that makes 200 to 800 of them along the longer side.
  Room(const TriangleSolid& stays, const Rect& middles, double radius_mm, double above_mm);

  /// Area of the places that `wanted` names and where nothing stands, but which no cutter covers whose middle is within
  /// `middles` and which touches no obstacle. Exact to about a step along the outlines.
  double unreached_mm2(const std::function<bool(double, double)>& wanted) const;
  /// Area of what stands where `wanted` says.
  double standing_mm2(const std::function<bool(double, double)>& wanted) const;

 private:
  double x(int i) const { return low_.x() + (i + 0.5) * step_mm_; }
  double y(int j) const { return low_.y() + (j + 0.5) * step_mm_; }
  std::size_t at(int i, int j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(ny_) + static_cast<std::size_t>(j);
  }
  void stand(const TriangleSolid& stays, const Triangle& t, double above_mm);

  Rect middles_;
  double radius_mm_, step_mm_;
  Vec2 low_;
  int nx_, ny_;
  std::vector<char> stands_;
};

enum class Feature : unsigned char {
  closed_pocket,
  open_pocket,
  closed_slot,
  open_slot,
  face,
  step,
  through_hole,
  blind_hole,
  free_form
};
inline constexpr std::size_t kFeatures = 9;
std::string_view to_string(Feature feature);

/// Faces of a primitive that touch air.
struct OpenFaces {
  std::array<bool, 4> side{};  ///< -x, +x, -y, +y
  bool top = false, bottom = false;
  int count() const { return side[0] + side[1] + side[2] + side[3] + top + bottom; }
  int sides() const { return side[0] + side[1] + side[2] + side[3]; }
};

/// A primitive at the time when it is machined.
struct Step {
  std::size_t primitive = 0;
  OpenFaces open;
  Feature feature = Feature::face;
  double width_mm = 0;   ///< pocket: the shorter side; slot: across its run; hole: the diameter; else the shorter side
  double length_mm = 0;  ///< the other side
};

/// A primitive that no order reaches from above.
struct Unreachable {
  std::size_t primitive = 0;
  std::string reason;
};

struct Order {
  std::vector<Step> steps;
  std::vector<Unreachable> unreachable;
};

/// Keeps what is air already.
class MachinedSpace {
 public:
  MachinedSpace(const RemovalVolume& removal, const std::vector<VolumePrimitive>& primitives);

  /// A side is open where 98 % of it touches air; the top where all of it does.
  OpenFaces open_faces(std::size_t primitive) const;
  /// Empty where the tool gets to the primitive from above.
  std::string blocked(std::size_t primitive) const;
  void remove(std::size_t primitive);
  bool is_removed(std::size_t primitive) const { return removed_[primitive]; }
  /// Top of what stands within a distance of the primitive's outline, or inside it; its own bottom where nothing does.
  double highest_near_mm(std::size_t primitive, double distance_mm) const;
  /// Area of the primitive, seen from above, that a tool of this radius does not reach: its axis may be anywhere
  /// inside and beyond open sides, as far as part and fixtures above the primitive's bottom leave it room.
  double unreached_mm2(std::size_t primitive, const OpenFaces& open, double radius_mm) const;
  /// Area of the primitive's box in which part or fixtures stand above its bottom.
  double stands_within_mm2(std::size_t primitive) const;
  /// True where that is no more than the inner corners between sides that are not open, and 0.5 % of the primitive.
  bool has_room(std::size_t primitive, const OpenFaces& open, double radius_mm) const;
  /// Area of the primitive's faces that are faces of the part.
  double wall_mm2(std::size_t primitive) const;
  double floor_mm2(std::size_t primitive) const;

 private:
  enum Owner : int { kAir = -1, kPart = -2, kFixture = -3, kMachined = -4 };  ///< or the number of a primitive
  int owner(const CellIndex& c) const { return owners_[removal_.grid.place(c)]; }
  bool is_air(const CellIndex& c) const;
  double open_share(const VolumePrimitive& p, int axis, int step) const;
  double part_area_mm2(const VolumePrimitive& p, int axis, int step) const;
  std::vector<std::array<int, 2>> columns_of(const Hole& hole) const;
  OpenFaces open_faces_of_hole(const Hole& hole, std::size_t primitive) const;
  std::string blocked_hole(const Hole& hole, std::size_t primitive) const;

  const RemovalVolume& removal_;
  const std::vector<VolumePrimitive>& primitives_;
  std::vector<int> owners_;
  std::vector<bool> removed_;
};

/// Area that a round tool leaves in four sharp inner corners.
double sharp_corners_mm2(double radius_mm);

/// By (1) greater height of the top, (2) greater volume, (3) more open faces, (4) less distance from the middle of the
/// removal volume; (5) holes last whatever the others say. Of primitives that the tool reaches the first by these rules
/// is taken, its open faces are noted, and those of the others are looked at again.
Order put_in_order(const RemovalVolume& removal, const std::vector<VolumePrimitive>& primitives);

/// From the open faces. Box: by the sides that are open besides the top: none, closed pocket; one, closed slot; two
/// that meet, open pocket; two opposite ones, open slot; three, step; four, face. An open bottom (a window) does not
/// count.
Feature feature_of(const VolumePrimitive& primitive, const OpenFaces& open);

/// How primitives compare, without their open faces' search: for the order and its tests.
struct Rank {
  bool is_hole = false;
  double top_mm = 0, volume_mm3 = 0;
  int open_faces = 0;
  double from_middle_mm = 0;
};
/// True where `a` comes first; neither comes first where all rules are tied.
bool comes_before(const Rank& a, const Rank& b);

}  // namespace camber::plan
