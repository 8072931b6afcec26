#pragma once
// Leaves of a field that are the same at many places, each kept once: along a flat face of a box they differ by
// nothing.
#include <memory>
#include <vector>

#include <openvdb/openvdb.h>

namespace camber::removal {

/// Does not change once it is made; may be read by many threads.
class RepeatedLeaves {
 public:
  using Leaf = openvdb::FloatTree::LeafNodeType;

  /// What the field has at the place of a leaf that was taken out.
  static constexpr float kHere = std::numeric_limits<float>::lowest();

  /// Takes every leaf whose values and active voxels stand at least twice in the tree out of it.
  static std::shared_ptr<const RepeatedLeaves> take_from(openvdb::FloatTree& tree);

  /// Where the tree has kHere; `at`: any voxel of the leaf. The leaf's own origin is that of one of its places.
  const Leaf& leaf(const openvdb::Coord& at) const {
    return *leaves_[static_cast<std::size_t>(numbers_.getValue(place(at)))];
  }
  /// Puts the leaves back into a tree, each at all the places at which the tree still has kHere.
  void put_back(openvdb::FloatTree& tree) const;
  std::size_t memory_bytes() const;

 private:
  using Numbers = openvdb::tree::Tree4<openvdb::Int32, 3, 3, 3>::Type;  // nodes smaller than the usual ones: 4 kB

  static constexpr openvdb::Int32 kLog2Side = static_cast<openvdb::Int32>(Leaf::LOG2DIM);
  static openvdb::Coord place(const openvdb::Coord& at) { return at >> kLog2Side; }

  std::vector<std::unique_ptr<const Leaf>> leaves_;
  Numbers numbers_{-1};  ///< of the leaf at a place, by place()
};

/// Calls f(origin) for every place at which a tree has RepeatedLeaves::kHere.
template <class Function>
void for_each_repeated(const openvdb::FloatTree& tree, Function f) {
  auto tile = tree.cbeginValueOff();
  tile.setMaxDepth(openvdb::FloatTree::ValueOffCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile)
    if (tile.getValue() == RepeatedLeaves::kHere) f(tile.getCoord());
}

}  // namespace camber::removal
