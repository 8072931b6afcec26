#include "base/sparse_list.h"

#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/process_memory.h"

namespace camber {
namespace {

TEST(SparseList, HasWhatWasPut) {
  constexpr std::size_t kSize = 3'000'000;
  SparseList<std::int64_t> list(kSize);
  const std::vector<ListRange> ranges{{5, 6}, {1000, 60'000}, {60'200, 60'201}, {2'999'999, 3'000'000}};
  for (const ListRange& r : ranges)
    for (std::size_t i = r.from; i < r.end; ++i) list.put(i, -static_cast<std::int64_t>(i));
  EXPECT_EQ(list.size(), kSize);
  EXPECT_EQ(list.kept_count(), 1 + 59'000 + 1 + 1u);
  ASSERT_EQ(list.kept().size(), ranges.size());
  const SparseList<std::int64_t> moved = std::move(list);
  for (std::size_t r = 0; r < ranges.size(); ++r) {
    EXPECT_EQ(moved.kept()[r].from, ranges[r].from);
    EXPECT_EQ(moved.kept()[r].end, ranges[r].end);
    for (std::size_t i = ranges[r].from; i < ranges[r].end; ++i)
      ASSERT_EQ(moved.all()[i], -static_cast<std::int64_t>(i));
  }
}

TEST(SparseList, TakesMemoryForWhatWasPutOnly) {
  const double before = used_memory_bytes();
  SparseList<std::int64_t> list(1'000'000'000);  // 8 GB of addresses
  for (std::size_t i = 500'000'000; i < 500'001'000; ++i) list.put(i, 1);
  EXPECT_LT(used_memory_bytes() - before, 5e6);
}

TEST(SparseListDeathTest, DoesNotAnswerForWhatWasNotPut) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  SparseList<std::int64_t> list(1'000'000);
  list.put(10, 1);
  EXPECT_DEATH(
      {
        volatile std::int64_t value = list.all()[900'000];
        (void)value;
      },
      "");
}

}  // namespace
}  // namespace camber
