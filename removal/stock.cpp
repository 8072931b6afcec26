#include "removal/stock.h"
#include "removal/field/tile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/diagnostics.h"
#include "base/folders.h"
#include "base/output_file.h"
#include "base/stage.h"
#include "base/window_buffer.h"

#if OPENVDB_LIBRARY_MAJOR_VERSION_NUMBER == 10  // its library has them: half the time to compile
extern template class openvdb::tree::Tree<openvdb::FloatTree::RootNodeType>;
extern template class openvdb::Grid<openvdb::FloatTree>;
extern template class openvdb::tree::Tree<openvdb::Int32Tree::RootNodeType>;
extern template class openvdb::Grid<openvdb::Int32Tree>;
template void openvdb::Int32Tree::attachAccessor(openvdb::tree::ValueAccessorBase<openvdb::Int32Tree, true>&) const;
#endif

namespace camber::removal {

using openvdb::Coord;
using openvdb::CoordBBox;

namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;

/// Value of the uppermost layer where the value of a layer below counts.
constexpr float kBelow = std::numeric_limits<float>::max();
constexpr std::size_t kMaxBelow = 2;

/// Leaves of a field that are the same at many places, each kept once: along a flat face of a box they differ by
/// nothing. Does not change once it is made; may be read by many threads.
class RepeatedLeaves {
 public:
  /// Value of the field at the place of a leaf that was taken out.
  static constexpr float kHere = std::numeric_limits<float>::lowest();

  /// Takes every leaf whose values and active voxels stand at least twice in the tree out of it.
  static std::shared_ptr<const RepeatedLeaves> take_from(openvdb::FloatTree& tree);

  /// Where the tree has kHere; `at`: any voxel of the leaf. The leaf's own origin is that of one of its places.
  const Leaf& leaf(const openvdb::Coord& at) const {
    return *leaves_[static_cast<std::size_t>(numbers_.at(place(at)))];
  }
  /// Puts the leaves back into a tree, each at all the places at which the tree still has kHere.
  void put_back(openvdb::FloatTree& tree) const;
  std::size_t memory_bytes() const;

 private:
  /// Key of a leaf's place: 21 bits an axis, 16 million voxels.
  static std::uint64_t place(const openvdb::Coord& at) {
    const auto bits = [](openvdb::Int32 i) {
      return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i >> Leaf::LOG2DIM) & 0x1fffffu);
    };
    return bits(at.x()) << 42 | bits(at.y()) << 21 | bits(at.z());
  }

  std::vector<std::unique_ptr<const Leaf>> leaves_;
  std::unordered_map<std::uint64_t, std::int32_t> numbers_;  ///< number of the leaf, by place()
};

/// Calls f(origin) for every place at which a tree has RepeatedLeaves::kHere.
template <class Function>
void for_each_repeated(const openvdb::FloatTree& tree, Function f) {
  auto tile = tree.cbeginValueOff();
  tile.setMaxDepth(openvdb::FloatTree::ValueOffCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile)
    if (tile.getValue() == RepeatedLeaves::kHere) f(tile.getCoord());
}

std::string_view bytes_of(const Leaf& leaf) {
  return {reinterpret_cast<const char*>(leaf.buffer().data()), Leaf::SIZE * sizeof(float)};
}

bool same(const Leaf& a, const Leaf& b) { return a.getValueMask() == b.getValueMask() && bytes_of(a) == bytes_of(b); }

std::shared_ptr<const RepeatedLeaves> RepeatedLeaves::take_from(openvdb::FloatTree& tree) {
  std::vector<const Leaf*> leaves;
  leaves.reserve(tree.leafCount());
  for (auto it = std::as_const(tree).cbeginLeaf(); it; ++it) leaves.push_back(&*it);
  std::vector<std::size_t> hashes(leaves.size());
  tbb::parallel_for(std::size_t{0}, leaves.size(),
                    [&](std::size_t i) { hashes[i] = std::hash<std::string_view>{}(bytes_of(*leaves[i])); });
  // Of every leaf the first one that is the same.
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::unordered_map<std::size_t, std::size_t> first_with;
  std::vector<std::size_t> first(leaves.size(), kNone), count(leaves.size(), 0);
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const std::size_t f = first_with.try_emplace(hashes[i], i).first->second;
    if (!same(*leaves[f], *leaves[i])) continue;
    first[i] = f;
    ++count[f];
  }
  auto out = std::make_shared<RepeatedLeaves>();
  std::vector<std::int32_t> number(leaves.size(), -1);
  openvdb::tree::ValueAccessor<openvdb::FloatTree> field(tree);
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (first[i] == kNone || count[first[i]] < 2) continue;
    const openvdb::Coord origin = leaves[i]->origin();
    if (first[i] == i) {
      number[i] = static_cast<std::int32_t>(out->leaves_.size());
      out->leaves_.push_back(std::make_unique<const Leaf>(*leaves[i]));
    }
    out->numbers_.emplace(place(origin), number[first[i]]);
    field.addTile(1, origin, kHere, false);
  }
  return out;
}

void RepeatedLeaves::put_back(openvdb::FloatTree& tree) const {
  std::vector<openvdb::Coord> origins;
  for_each_repeated(tree, [&](const openvdb::Coord& origin) { origins.push_back(origin); });
  std::vector<std::unique_ptr<Leaf>> copies(origins.size());
  // Apart from what goes on around it, which may be given up half way (a file without room).
  tbb::task_group_context alone(tbb::task_group_context::isolated);
  tbb::parallel_for(
      std::size_t{0}, origins.size(),
      [&](std::size_t i) {
        copies[i] = std::make_unique<Leaf>(leaf(origins[i]));
        copies[i]->setOrigin(origins[i]);
      },
      alone);
  for (auto& copy : copies) tree.addLeaf(copy.release());
}

std::size_t RepeatedLeaves::memory_bytes() const {
  constexpr std::size_t kNode = 32;  // with what the allocator adds
  return numbers_.size() * kNode + numbers_.bucket_count() * sizeof(void*) +
         leaves_.size() * (sizeof(Leaf) + Leaf::SIZE * sizeof(float));
}

/// Layer that copies share and that does not change while they do. Leaves that stand in it more than once are in
/// `repeated`.
struct SharedLayer {
  openvdb::FloatGrid::Ptr grid;
  std::shared_ptr<const RepeatedLeaves> repeated;

  bool alone() const { return grid.use_count() == 1; }
};

}  // namespace

/// Layers: `distance` is this stock's alone and hides those below, which copies share (Stock::share).
struct Stock::Impl {
  openvdb::FloatGrid::Ptr distance;
  openvdb::Int32Grid::Ptr stamp;
  std::vector<SharedLayer> below{};  ///< uppermost first
};

namespace {

/// Reads through the layers. Its accessors are such that the tree does not know of ("unsafe"): making one known takes a
/// lock, and no reader lives while the tree changes.
class LayerReader {
 public:
  explicit LayerReader(const openvdb::FloatGrid& own, std::span<const SharedLayer> below)
      : own_(own.getConstUnsafeAccessor()), count_(below.size()) {
    for (std::size_t i = 0; i < count_; ++i) {
      below_[i].emplace(std::as_const(*below[i].grid).getConstUnsafeAccessor());
      repeated_[i] = below[i].repeated.get();
    }
  }

  struct Found {
    const Leaf* leaf;  ///< null: `constant` throughout
    float constant;
    bool own;  ///< found in the uppermost layer
  };
  Found leaf(const Coord& origin) const {
    if (const Leaf* node = own_.probeConstLeaf(origin)) return {node, 0, true};
    float value = own_.getValue(origin);
    for (std::size_t i = 0; i < count_ && value == kBelow; ++i) {
      if (const Leaf* node = below_[i]->probeConstLeaf(origin)) return {node, 0, false};
      value = below_[i]->getValue(origin);
      if (value == RepeatedLeaves::kHere) return {&repeated_[i]->leaf(origin), 0, false};
    }
    return {nullptr, value, false};
  }
  float getValue(const Coord& at) const {
    float value = own_.getValue(at);
    for (std::size_t i = 0; i < count_ && value == kBelow; ++i) {
      value = below_[i]->getValue(at);
      if (value == RepeatedLeaves::kHere) return repeated_[i]->leaf(at).getValue(at);
    }
    return value;
  }

 private:
  using Accessor = openvdb::FloatGrid::ConstUnsafeAccessor;
  Accessor own_;
  std::array<std::optional<Accessor>, kMaxBelow> below_;
  std::array<const RepeatedLeaves*, kMaxBelow> repeated_{};
  std::size_t count_;
};

constexpr int kLeafBits = 3, kLeaf = 1 << kLeafBits;
constexpr double kRounding = 1e-3;  // voxels

Coord coord(const Index3& i) { return {i[0], i[1], i[2]}; }

int floor_div(int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

void initialize_openvdb() {
  static const bool done = (openvdb::initialize(), true);
  (void)done;
}

/// Fills one leaf with the distance.
template <class Distance>
void sample_leaf(openvdb::FloatTree::LeafNodeType& leaf, double voxel, double band, const Distance& distance) {
  for (openvdb::Index n = 0; n < openvdb::FloatTree::LeafNodeType::SIZE; ++n) {
    const Coord c = leaf.offsetToGlobalCoord(n);
    const double d = std::clamp(distance(Vec3(c.x() * voxel, c.y() * voxel, c.z() * voxel)), -band, band);
    leaf.setValueOnly(n, static_cast<float>(d));
    leaf.setActiveState(n, std::abs(d) < band);
  }
}

/// Leaves of one value become tiles at once: a whole box has half as many leaves again as its surface.
template <class Accessor>
void drop_constant(const std::vector<Leaf*>& leaves, Accessor& access) {
  for (Leaf* leaf : leaves) {
    float value = 0;
    bool active = false;
    if (leaf->isConstant(value, active) && !active) access.addTile(1, leaf->origin(), value, false);
  }
}

}  // namespace

Stock::Stock(const std::function<double(const Vec3&)>& distance, const Vec3& min_mm, const Vec3& max_mm,
             double voxel_mm, double band_voxels)
    : voxel_mm_(voxel_mm),
      band_mm_(static_cast<float>(band_voxels * voxel_mm)),
      min_mm_(min_mm),
      max_mm_(max_mm),
      impl_(std::make_unique<Impl>()) {
  initialize_openvdb();
  const auto band = static_cast<float>(band_mm_);
  impl_->distance = openvdb::FloatGrid::create(band);
  impl_->distance->setTransform(openvdb::math::Transform::createLinearTransform(voxel_mm));
  impl_->distance->setGridClass(openvdb::GRID_LEVEL_SET);
  impl_->distance->setName("stock");
  impl_->stamp = openvdb::Int32Grid::create(kUncut);

  Coord lo, hi;
  for (int a = 0; a < 3; ++a) {
    lo[a] = floor_div(static_cast<int>(std::floor((min_mm[a] - band_mm_) / voxel_mm)), kLeaf);
    hi[a] = floor_div(static_cast<int>(std::ceil((max_mm[a] + band_mm_) / voxel_mm)), kLeaf);
  }
  auto access = impl_->distance->getAccessor();
  const double half = 0.5 * (kLeaf - 1), reach = band_mm_ + std::sqrt(3.0) * (half + kRounding) * voxel_mm;
  Stage stage("making the blank", static_cast<std::size_t>(hi.x() - lo.x() + 1));
  std::vector<Leaf*> leaves;
  for (int i = lo.x(); i <= hi.x(); ++i) {
    leaves.clear();
    for (int j = lo.y(); j <= hi.y(); ++j)
      for (int k = lo.z(); k <= hi.z(); ++k) {
        const Coord origin(i * kLeaf, j * kLeaf, k * kLeaf);
        const Vec3 centre = voxel_mm * Vec3(origin.x() + half, origin.y() + half, origin.z() + half);
        const double d = distance(centre);
        if (d > reach) continue;
        if (d < -reach)
          access.addTile(1, origin, -band, false);
        else
          leaves.push_back(access.touchLeaf(origin));
      }
    tbb::parallel_for(std::size_t{0}, leaves.size(),
                      [&](std::size_t n) { sample_leaf(*leaves[n], voxel_mm, band_mm_, distance); });
    drop_constant(leaves, access);
    stage.advance();
  }
  impl_->distance->pruneGrid(0.0f);
}

Stock::Stock(const Stock& o)
    : voxel_mm_(o.voxel_mm_),
      band_mm_(o.band_mm_),
      min_mm_(o.min_mm_),
      max_mm_(o.max_mm_),
      impl_(std::make_unique<Impl>(Impl{o.impl_->distance->deepCopy(), o.impl_->stamp->deepCopy(), o.impl_->below})) {}
Stock::Stock(Stock&&) noexcept = default;
Stock::~Stock() = default;

namespace {

template <class Accessor>
double trilinear(Accessor&& access, const Vec3& g) {
  const Index3 b{static_cast<int>(std::floor(g.x())), static_cast<int>(std::floor(g.y())),
                 static_cast<int>(std::floor(g.z()))};
  double sum = 0;
  for (int c = 0; c < 8; ++c) {
    double w = 1;
    Coord at;
    for (int a = 0; a < 3; ++a) {
      const double f = g[a] - b[a];
      const int up = (c >> a) & 1;
      w *= up ? f : 1 - f;
      at[a] = b[a] + up;
    }
    sum += w * access.getValue(at);
  }
  return sum;
}

}  // namespace

double Stock::distance_mm(const Vec3& p) const {
  return trilinear(LayerReader(*impl_->distance, impl_->below), p / voxel_mm_);
}

/// Remembers the leaves that were met lately, by their place among their neighbours.
struct Stock::Probe::Access {
  struct Known {
    Coord origin = Coord::max();
    const float* values = nullptr;  ///< null: `constant` throughout
    float constant = 0;
  };
  static constexpr int kSideBits = 2, kSides = 1 << kSideBits;

  LayerReader reader;
  std::array<Known, kSides * kSides * kSides> leaves{};

  float getValue(const Coord& at) {
    const Coord origin = at & ~(kLeaf - 1);
    const auto place = [](int v) { return v >> kLeafBits & (kSides - 1); };
    Known& leaf =
        leaves[static_cast<std::size_t>((place(at.x()) << kSideBits | place(at.y())) << kSideBits | place(at.z()))];
    if (leaf.origin != origin) {
      const LayerReader::Found found = reader.leaf(origin);
      leaf = {origin, found.leaf ? found.leaf->buffer().data() : nullptr, found.constant};
    }
    if (!leaf.values) return leaf.constant;
    constexpr int kIn = kLeaf - 1;
    return leaf.values[((at.x() & kIn) << kLeafBits | (at.y() & kIn)) << kLeafBits | (at.z() & kIn)];
  }
};
Stock::Probe::Probe(const Stock& stock)
    : access_(std::make_unique<Access>(Access{LayerReader(*stock.impl_->distance, stock.impl_->below)})),
      voxel_mm_(stock.voxel_mm()),
      per_mm_(1 / stock.voxel_mm()) {}
Stock::Probe::Probe(Probe&&) noexcept = default;
Stock::Probe::~Probe() = default;
float Stock::Probe::nearest(const Vec3& p) const {
  return access_->getValue({static_cast<int>(std::floor(p.x() * per_mm_ + 0.5)),
                            static_cast<int>(std::floor(p.y() * per_mm_ + 0.5)),
                            static_cast<int>(std::floor(p.z() * per_mm_ + 0.5))});
}

double Stock::Probe::distance_mm(const Vec3& p) const { return trilinear(*access_, p / voxel_mm_); }

float Stock::voxel(const Index3& i) const { return LayerReader(*impl_->distance, impl_->below).getValue(coord(i)); }
std::int32_t Stock::stamp(const Index3& i) const { return impl_->stamp->tree().getValue(coord(i)); }

namespace {

/// Copies the part of a cube of `side` voxels from `base` on that lies in one leaf. `values` null: the leaf has one
/// value throughout, `constant`.
template <class Value>
void copy_from(const Value* values, Value constant, const Coord& leaf_origin, const Coord& base, int side, Value* out) {
  std::array<int, 3> from{}, to{};  // in the leaf
  for (int a = 0; a < 3; ++a) {
    from[a] = std::max(0, base[a] - leaf_origin[a]);
    to[a] = std::min(kLeaf, base[a] + side - leaf_origin[a]);
  }
  const Coord at = leaf_origin - base;
  const int count = to[2] - from[2];
  for (int i = from[0]; i < to[0]; ++i)
    for (int j = from[1]; j < to[1]; ++j) {
      Value* row = out + ((at.x() + i) * side + at.y() + j) * side + at.z() + from[2];
      if (values)
        std::copy_n(values + (i << 6 | j << 3 | from[2]), count, row);
      else
        std::fill_n(row, count, constant);
    }
}

template <class Function>
void for_each_leaf_of_tile(const Coord& base, Function f) {
  for (int i = 0; i < Tile::kSide; i += kLeaf)
    for (int j = 0; j < Tile::kSide; j += kLeaf)
      for (int k = 0; k < Tile::kSide; k += kLeaf) f(base.offsetBy(i, j, k));
}

}  // namespace

void Stock::load(const Index3& tile, Tile& out) const {
  read({tile[0] * Tile::kCore, tile[1] * Tile::kCore, tile[2] * Tile::kCore}, Tile::kSide, out.distance.data(),
       out.stamp.data());
}

void Stock::read(const Index3& first, int side, float* distance, std::int32_t* stamp) const {
  const Coord base = coord(first);
  const openvdb::Int32Grid& stamp_grid = *impl_->stamp;
  const LayerReader distances(*impl_->distance, impl_->below);
  const auto stamps = stamp_grid.getConstUnsafeAccessor();
  Coord lo, hi;
  for (int a = 0; a < 3; ++a) {
    lo[a] = floor_div(base[a], kLeaf) * kLeaf;
    hi[a] = base[a] + side;
  }
  for (int i = lo.x(); i < hi.x(); i += kLeaf)
    for (int j = lo.y(); j < hi.y(); j += kLeaf)
      for (int k = lo.z(); k < hi.z(); k += kLeaf) {
        const Coord at(i, j, k);
        const LayerReader::Found found = distances.leaf(at);
        copy_from(found.leaf ? found.leaf->buffer().data() : nullptr, found.constant, at, base, side, distance);
        if (!stamp) continue;
        const auto* marks = stamps.probeConstLeaf(at);
        copy_from(marks ? marks->buffer().data() : nullptr, marks ? kUncut : stamps.getValue(at), at, base, side,
                  stamp);
      }
}

bool Stock::is_cut(const Index3& tile) const {
  const openvdb::Int32Grid& stamps = *impl_->stamp;
  const auto access = stamps.getConstUnsafeAccessor();
  for (int i = 0; i < Tile::kCore; i += kLeaf)
    for (int j = 0; j < Tile::kCore; j += kLeaf)
      for (int k = 0; k < Tile::kCore; k += kLeaf)
        if (access.probeConstLeaf({tile[0] * Tile::kCore + i, tile[1] * Tile::kCore + j, tile[2] * Tile::kCore + k}))
          return true;
  return false;
}

bool Stock::is_air(const Index3& tile) const {
  const Coord base(tile[0] * Tile::kCore, tile[1] * Tile::kCore, tile[2] * Tile::kCore);
  const LayerReader reader(*impl_->distance, impl_->below);
  bool air = true;
  for_each_leaf_of_tile(base, [&](const Coord& leaf) {
    if (!air) return;
    const LayerReader::Found found = reader.leaf(leaf);
    air = !found.leaf && found.constant > 0;
  });
  return air;
}

bool Stock::is_solid(const Index3& tile) const {
  const Coord base(tile[0] * Tile::kCore, tile[1] * Tile::kCore, tile[2] * Tile::kCore);
  const LayerReader reader(*impl_->distance, impl_->below);
  bool solid = true;
  for_each_leaf_of_tile(base, [&](const Coord& leaf) {
    if (!solid) return;
    const LayerReader::Found found = reader.leaf(leaf);
    solid = !found.leaf && found.constant < 0;
  });
  return solid;
}

namespace {

struct RowFacts {
  bool air = true, solid = true, cut = false;
};
RowFacts row_facts(const float* d, const std::int32_t* s, float band) {
  RowFacts facts;
  for (int k = 0; k < kLeaf; ++k) {
    facts.air &= d[k] >= band;
    facts.solid &= d[k] <= -band;
    facts.cut |= s[k] != Stock::kUncut;
  }
  return facts;
}

/// A leaf's part of a tile that is stored.
struct StoredLeaf {
  Coord origin;
  const float* distance;  ///< distance at its first voxel in the tile
  const std::int32_t* stamp;
  RowFacts facts{};
  bool same_below = false;  ///< as a shared leaf has it: nothing is stored
  Leaf* leaf = nullptr;     ///< null: the same throughout
  openvdb::Int32Tree::LeafNodeType* marks = nullptr;

  template <class Function>
  static void for_each_row(Function f) {
    for (int n = 0; n < kLeaf * kLeaf; ++n) f(n, Tile::offset(n / kLeaf, n % kLeaf, 0));
  }
  void find_facts(float band) {
    for_each_row([&](int, int at) {
      const RowFacts row = row_facts(distance + at, stamp + at, band);
      facts.air &= row.air;
      facts.solid &= row.solid;
      facts.cut |= row.cut;
    });
  }
  openvdb::util::NodeMask<kLeafBits> active(float band) const {
    openvdb::util::NodeMask<kLeafBits> out;
    for_each_row([&](int n, int at) {
      for (int k = 0; k < kLeaf; ++k)
        if (std::abs(distance[at + k]) < band) out.setOn(static_cast<openvdb::Index32>(kLeaf * n + k));
    });
    return out;
  }
  void compare(const LayerReader::Found& found, float band) {
    if (facts.cut || facts.air || facts.solid || found.own || !found.leaf) return;
    const float* d = found.leaf->buffer().data();
    same_below = found.leaf->getValueMask() == active(band);
    for_each_row([&](int n, int at) {
      same_below = same_below && std::equal(distance + at, distance + at + kLeaf, d + kLeaf * n);
    });
  }
  void fill(float band) const {
    if (!leaf) return;
    float* d = leaf->buffer().data();
    std::int32_t* s = marks ? marks->buffer().data() : nullptr;
    for_each_row([&](int n, int at) {
      std::copy_n(distance + at, kLeaf, d + kLeaf * n);
      if (s) std::copy_n(stamp + at, kLeaf, s + kLeaf * n);
    });
    leaf->setValueMask(active(band));
  }
};

}  // namespace

void Stock::store(std::span<const StoredTile> tiles) {
  const auto band = static_cast<float>(band_mm_);
  std::vector<StoredLeaf> parts;
  parts.reserve(8 * tiles.size());
  for (const StoredTile& t : tiles)
    for (int i = 0; i < Tile::kCore; i += kLeaf)
      for (int j = 0; j < Tile::kCore; j += kLeaf)
        for (int k = 0; k < Tile::kCore; k += kLeaf)
          parts.push_back(
              {Coord(t.index[0] * Tile::kCore + i, t.index[1] * Tile::kCore + j, t.index[2] * Tile::kCore + k),
               t.tile->distance.data() + Tile::offset(i, j, k), t.tile->stamp.data() + Tile::offset(i, j, k)});
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, parts.size()), [&](const auto& range) {
    const LayerReader before(*impl_->distance, impl_->below);
    for (std::size_t p = range.begin(); p < range.end(); ++p) {
      parts[p].find_facts(band);
      if (!impl_->below.empty()) parts[p].compare(before.leaf(parts[p].origin), band);
    }
  });
  auto distances = impl_->distance->getAccessor();
  auto stamps = impl_->stamp->getAccessor();
  for (StoredLeaf& p : parts) {
    if (p.facts.air || p.facts.solid) {
      distances.addTile(1, p.origin, p.facts.air ? band : -band, false);
      stamps.addTile(1, p.origin, kUncut, false);
    } else if (!p.same_below) {
      p.leaf = distances.touchLeaf(p.origin);
      p.marks = p.facts.cut ? stamps.touchLeaf(p.origin) : stamps.probeLeaf(p.origin);
    }
  }
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t p) { parts[p].fill(band); });
}

void Stock::clear_stamps() { impl_->stamp = openvdb::Int32Grid::create(kUncut); }

namespace {

openvdb::FloatGrid::Ptr layer_like(const openvdb::FloatGrid& grid, float background) {
  auto out = openvdb::FloatGrid::create(background);
  out->setTransform(grid.transform().copy());
  out->setGridClass(grid.getGridClass());
  out->setName(grid.getName());
  return out;
}

/// Values of `upper` into `lower`; `upper` is empty afterwards.
void put_over(openvdb::FloatTree& upper, openvdb::FloatTree& lower) {
  auto tile = upper.cbeginValueAll();
  tile.setMaxDepth(openvdb::FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile)
    if (tile.getValue() != kBelow) lower.addTile(tile.getLevel(), tile.getCoord(), tile.getValue(), false);
  std::vector<Leaf*> leaves;
  upper.stealNodes(leaves);
  for (Leaf* leaf : leaves) lower.addLeaf(leaf);
}

/// One layer of several, uppermost first. Layers that nobody else has are used up.
SharedLayer merged(std::vector<SharedLayer> layers) {
  SharedLayer out = std::move(layers.back());
  layers.pop_back();
  for (; !layers.empty(); layers.pop_back()) {
    SharedLayer& upper = layers.back();
    if (!out.alone()) out.grid = out.grid->deepCopy();
    if (!upper.alone()) upper.grid = upper.grid->deepCopy();
    if (upper.repeated) upper.repeated->put_back(upper.grid->tree());
    put_over(upper.grid->tree(), out.grid->tree());
  }
  return out;
}

}  // namespace

void Stock::share() {
  if (impl_->below.size() >= kMaxBelow || impl_->distance->tree().empty()) return;
  auto own = layer_like(*impl_->distance, kBelow);
  SharedLayer shared{std::exchange(impl_->distance, std::move(own)), nullptr};
  shared.repeated = RepeatedLeaves::take_from(shared.grid->tree());
  impl_->below.insert(impl_->below.begin(), std::move(shared));
}

void Stock::share_as_one() {
  if (impl_->below.empty()) return share();
  auto own = layer_like(*impl_->distance, kBelow);
  std::vector<SharedLayer> layers = std::exchange(impl_->below, {});
  layers.insert(layers.begin(), {std::exchange(impl_->distance, std::move(own)), nullptr});
  impl_->below = {merged(std::move(layers))};
}

Stock Stock::copy_within(const Vec3& min_mm, const Vec3& max_mm) const {
  if (impl_->below.empty()) return *this;
  auto impl = std::make_unique<Impl>(
      Impl{layer_like(*impl_->distance, kBelow), openvdb::Int32Grid::create(kUncut), impl_->below});
  Coord lo, hi;
  for (int a = 0; a < 3; ++a) {
    const double from = std::max(min_mm[a], min_mm_[a] - band_mm_), to = std::min(max_mm[a], max_mm_[a] + band_mm_);
    if (to < from) return {voxel_mm_, band_mm_, min_mm_, max_mm_, std::move(impl)};
    lo[a] = floor_div(static_cast<int>(std::floor(from / voxel_mm_)), Tile::kCore) * Tile::kCore;
    hi[a] = floor_div(static_cast<int>(std::ceil(to / voxel_mm_)), Tile::kCore) * Tile::kCore + Tile::kSide;
  }
  const auto distances = std::as_const(*impl_->distance).getConstUnsafeAccessor();
  const auto stamps = std::as_const(*impl_->stamp).getConstUnsafeAccessor();
  auto distance = impl->distance->getAccessor();
  auto stamp = impl->stamp->getAccessor();
  for (int i = lo.x(); i < hi.x(); i += kLeaf)
    for (int j = lo.y(); j < hi.y(); j += kLeaf)
      for (int k = lo.z(); k < hi.z(); k += kLeaf) {
        const Coord at(i, j, k);
        if (const Leaf* leaf = distances.probeConstLeaf(at))
          distance.addLeaf(new Leaf(*leaf));
        else if (const float value = distances.getValue(at); value != kBelow)
          distance.addTile(1, at, value, false);
        if (const auto* leaf = stamps.probeConstLeaf(at)) stamp.addLeaf(new openvdb::Int32Tree::LeafNodeType(*leaf));
      }
  return {voxel_mm_, band_mm_, min_mm_, max_mm_, std::move(impl)};
}

void Stock::unshare() {
  if (impl_->below.empty()) return;
  std::vector<SharedLayer> layers = std::exchange(impl_->below, {});
  layers.insert(layers.begin(), {std::exchange(impl_->distance, nullptr), nullptr});
  SharedLayer one = merged(std::move(layers));
  if (one.repeated) one.repeated->put_back(one.grid->tree());
  impl_->distance = std::move(one.grid);
}

void Stock::clear() {
  impl_->below.clear();
  impl_->distance = layer_like(*impl_->distance, static_cast<float>(band_mm_));
  clear_stamps();
}

double material_fraction(double d, double voxel) { return std::clamp(0.5 - 0.5 * d / voxel, 0.0, 1.0); }

double Stock::volume_mm3() const {
  if (!impl_->below.empty()) {
    Stock whole(*this);
    whole.unshare();
    return whole.volume_mm3();
  }
  double fraction = 0;
  for (auto it = impl_->distance->tree().cbeginLeaf(); it; ++it)
    for (openvdb::Index n = 0; n < 512; ++n) fraction += material_fraction(it->getValue(n), voxel_mm_);
  // Below leaf level only inactive tiles of one value are left.
  for (auto it = impl_->distance->tree().cbeginValueOff(); it; ++it)
    if (!it.isVoxelValue() && it.getValue() < 0) fraction += static_cast<double>(it.getVoxelCount());
  return fraction * std::pow(voxel_mm_, 3);
}

std::vector<Index3> Stock::surface_tiles() const {
  std::vector<Index3> tiles;
  const LayerReader reader(*impl_->distance, impl_->below);
  const auto add_tile_of = [&](const Coord& o) {
    tiles.push_back({floor_div(o.x(), Tile::kCore), floor_div(o.y(), Tile::kCore), floor_div(o.z(), Tile::kCore)});
  };
  const auto add = [&](const openvdb::FloatGrid& layer) {
    for (auto it = layer.tree().cbeginLeaf(); it; ++it)
      if (reader.leaf(it->origin()).leaf == &*it) add_tile_of(it->origin());
  };
  add(*impl_->distance);
  for (const SharedLayer& layer : impl_->below) {
    add(*layer.grid);
    for_each_repeated(layer.grid->tree(), [&](const Coord& origin) {
      if (reader.leaf(origin).leaf == &layer.repeated->leaf(origin)) add_tile_of(origin);
    });
  }
  std::sort(tiles.begin(), tiles.end());
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
  return tiles;
}

std::size_t Stock::memory_bytes() const {
  std::size_t bytes = impl_->distance->memUsage() + impl_->stamp->memUsage();
  for (const SharedLayer& layer : impl_->below) bytes += layer.grid->memUsage() + layer.repeated->memory_bytes();
  return bytes;
}

namespace {

/// The format has a random identifier behind magic number, three versions and a flag; ours is the same for the same
/// stock.
constexpr std::streamoff kIdentifierAt = 8 + 3 * 4 + 1;
constexpr const char* kIdentifier = "00000000-0000-0000-0000-000000000000";

/// io::File::write does not tell whether the disk took everything; a stream does.
struct VdbArchive : openvdb::io::Archive {
  void write_to(std::ostream& out, const openvdb::GridCPtrVec& grids) const {
    constexpr bool kSeekable = true;
    write(out, grids, kSeekable, {});
    out.seekp(kIdentifierAt).write(kIdentifier, static_cast<std::streamsize>(std::strlen(kIdentifier)));
  }
};

}  // namespace

void Stock::save(const std::string& path) const {
  if (!impl_->below.empty()) {
    Stock whole(*this);
    whole.unshare();
    return whole.save(path);
  }
  OutputFile file(path);
  // The library seeks after every leaf, which would empty a file stream's buffer.
  WindowBuffer window(file.stream());
  std::ostream out(&window);
  VdbArchive().write_to(out, {impl_->distance});
  window.finish();
  file.commit();
}

namespace {

/// The first float grid of a file, or one named "stock".
openvdb::FloatGrid::Ptr read_float_grid(const std::string& path) {
  require_confined(path);
  if (!std::filesystem::exists(path)) fail_on_file(path, "no such file", "file-missing");
  openvdb::FloatGrid::Ptr found;
  try {
    // Read at once: the library seeks before every leaf, which empties a file stream's buffer.
    std::ifstream file(path, std::ios::binary);
    std::string bytes(std::filesystem::file_size(path), '\0');
    if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) throw openvdb::IoError("cannot be read");
    std::istringstream in(std::move(bytes), std::ios::binary);
    const openvdb::GridPtrVecPtr grids = openvdb::io::Stream(in, false).getGrids();
    for (const auto& grid : *grids)
      if (auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(grid);
          floats && (!found || grid->getName() == "stock"))
        found = floats;
  } catch (const std::exception& e) {
    fail_on_file(path, std::string("cannot be read as .vdb: ") + e.what(), "vdb-format");
  }
  if (!found || found->getGridClass() != openvdb::GRID_LEVEL_SET || !(found->background() > 0))
    fail_on_file(path, "has no level set of floats; a stock.vdb that predict wrote was expected", "vdb-format");
  return found;
}

void require_voxels(const openvdb::FloatGrid& grid, const std::string& path, double voxel_mm) {
  constexpr double kSame = 1e-6;
  const openvdb::Vec3d origin = grid.indexToWorld(openvdb::Vec3d(0, 0, 0));
  const openvdb::Vec3d corner = grid.indexToWorld(openvdb::Vec3d(1, 1, 1)) - origin;
  const bool straight = origin.length() < kSame * voxel_mm && grid.transform().isLinear();
  for (int a = 0; a < 3; ++a)
    if (!straight || std::abs(corner[a] - voxel_mm) > kSame * voxel_mm)
      fail_on_file(path,
                   fmt::format("its voxels are {:g} mm wide{}; {:g} mm (voxel_mm of the job), from zero, were expected",
                               corner[a], straight ? "" : " and shifted or turned", voxel_mm),
                   "vdb-voxel");
}

/// Clips a leaf to the new band; what the old band had cut off ("at least this deep") is beyond the new one as well.
void clip_leaf(openvdb::FloatTree::LeafNodeType& leaf, float old_band, float band) {
  float* values = leaf.buffer().data();
  openvdb::util::NodeMask<kLeafBits> active;
  for (openvdb::Index32 n = 0; n < openvdb::FloatTree::LeafNodeType::SIZE; ++n) {
    const float d = values[n];
    values[n] = std::abs(d) >= 0.9999f * old_band ? std::copysign(band, d) : std::clamp(d, -band, band);
    if (std::abs(values[n]) < band) active.setOn(n);
  }
  leaf.setValueMask(active);
}

}  // namespace

Stock::Stock(double voxel, double band, const Vec3& lo, const Vec3& hi, std::unique_ptr<Impl> impl)
    : voxel_mm_(voxel), band_mm_(band), min_mm_(lo), max_mm_(hi), impl_(std::move(impl)) {}

Stock Stock::load(const std::string& path, double voxel_mm, double band_voxels) {
  initialize_openvdb();
  const auto grid = read_float_grid(path);
  require_voxels(*grid, path, voxel_mm);
  const auto band = static_cast<float>(band_voxels * voxel_mm), old_band = grid->background();
  const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
  if (box.empty()) fail_on_file(path, "has no surface: nothing is left of the stock", "vdb-format");
  Vec3 lo, hi;
  for (int a = 0; a < 3; ++a) {
    lo[a] = (box.min()[a] - 1) * voxel_mm + old_band;
    hi[a] = (box.max()[a] + 1) * voxel_mm - old_band;
  }
  auto& tree = grid->tree();
  openvdb::tree::LeafManager<openvdb::FloatTree>(tree).foreach (
      [&](openvdb::FloatTree::LeafNodeType& leaf, std::size_t) { clip_leaf(leaf, old_band, band); });
  openvdb::tools::changeLevelSetBackground(tree, band);
  auto impl = std::make_unique<Impl>();
  impl->distance = openvdb::FloatGrid::create(grid->treePtr());  // without what else the file says of it
  impl->distance->setTransform(openvdb::math::Transform::createLinearTransform(voxel_mm));
  impl->distance->setGridClass(openvdb::GRID_LEVEL_SET);
  impl->distance->setName("stock");
  impl->stamp = openvdb::Int32Grid::create(kUncut);
  return Stock(voxel_mm, band, lo, hi, std::move(impl));
}

double cylinder_distance_mm(const Vec3& p, const Vec3& base, double radius, double height) {
  const double q = std::hypot(p.x() - base.x(), p.y() - base.y()) - radius;
  const double v = std::abs(p.z() - base.z() - height / 2) - height / 2;
  return std::hypot(std::max(q, 0.0), std::max(v, 0.0)) + std::min(std::max(q, v), 0.0);
}

double box_distance_mm(const Vec3& p, const Vec3& lo, const Vec3& hi) {
  const Vec3 q = (p - 0.5 * (lo + hi)).cwiseAbs() - 0.5 * (hi - lo);
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

}  // namespace camber::removal
