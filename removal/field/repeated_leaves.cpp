#include "removal/field/repeated_leaves.h"

#include <algorithm>
#include <cstring>
#include <string_view>
#include <unordered_map>

#include <tbb/parallel_for.h>

namespace camber::removal {
namespace {

using Leaf = RepeatedLeaves::Leaf;

std::string_view bytes_of(const Leaf& leaf) {
  return {reinterpret_cast<const char*>(leaf.buffer().data()), Leaf::SIZE * sizeof(float)};
}

bool same(const Leaf& a, const Leaf& b) { return a.getValueMask() == b.getValueMask() && bytes_of(a) == bytes_of(b); }

}  // namespace

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
  std::vector<openvdb::Int32> number(leaves.size(), -1);
  openvdb::tree::ValueAccessor<openvdb::FloatTree> field(tree);
  openvdb::tree::ValueAccessor<Numbers> numbers(out->numbers_);
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (first[i] == kNone || count[first[i]] < 2) continue;
    const openvdb::Coord origin = leaves[i]->origin();
    if (first[i] == i) {
      number[i] = static_cast<openvdb::Int32>(out->leaves_.size());
      out->leaves_.push_back(std::make_unique<const Leaf>(*leaves[i]));
    }
    numbers.setValue(place(origin), number[first[i]]);
    field.addTile(1, origin, kHere, false);
  }
  return out;
}

void RepeatedLeaves::put_back(openvdb::FloatTree& tree) const {
  std::vector<openvdb::Coord> origins;
  for_each_repeated(tree, [&](const openvdb::Coord& origin) { origins.push_back(origin); });
  std::vector<std::unique_ptr<Leaf>> copies(origins.size());
  tbb::parallel_for(std::size_t{0}, origins.size(), [&](std::size_t i) {
    copies[i] = std::make_unique<Leaf>(leaf(origins[i]));
    copies[i]->setOrigin(origins[i]);
  });
  for (auto& copy : copies) tree.addLeaf(copy.release());
}

std::size_t RepeatedLeaves::memory_bytes() const {
  return static_cast<std::size_t>(numbers_.memUsage()) + leaves_.size() * (sizeof(Leaf) + Leaf::SIZE * sizeof(float));
}

}  // namespace camber::removal
