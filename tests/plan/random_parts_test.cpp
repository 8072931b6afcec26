#include <cstdlib>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "plan/order.h"
#include "tests/support/random_part.h"

namespace camber::plan {
namespace {

/// CAMBER_RANDOM_PARTS, else twenty (bench/plan/random-parts runs two hundred).
unsigned part_count() {
  constexpr unsigned kParts = 20;
  const char* given = std::getenv("CAMBER_RANDOM_PARTS");
  return given ? static_cast<unsigned>(std::atoi(given)) : kParts;
}

bool holds(const RemovalVolume& removal, const VolumePrimitive& p, const Vec3& at) {
  if (!((at.array() > p.min_mm.array()).all() && (at.array() < p.max_mm.array()).all())) return false;
  if (!p.is_hole) return true;
  const Hole& h = removal.holes[p.hole];
  return (Vec2(at.x(), at.y()) - h.centre_mm).norm() < h.diameter_mm / 2;
}

/// Between the facets of a hole and its circle: either answer is right.
bool at_a_hole(const RemovalVolume& removal, const Vec3& at) {
  for (const Hole& h : removal.holes) {
    const double r = (Vec2(at.x(), at.y()) - h.centre_mm).norm() / h.diameter_mm * 2;
    if (r > 0.99 && r < 1) return true;
  }
  return false;
}

class RandomParts : public ::testing::TestWithParam<unsigned> {
 protected:
  RandomParts()
      : made(tests::random_part(GetParam())),
        part(solid_of(made.part.mesh())),
        removal(removal_volume({.blank = solid_of(made.blank), .part = part})) {}

  Vec3 anywhere() {
    Vec3 at;
    for (int a = 0; a < 3; ++a)
      at[a] = std::uniform_real_distribution(made.blank.min_mm[a], made.blank.max_mm[a])(random);
    return at;
  }

  tests::RandomPart made;
  TriangleSolid part;
  RemovalVolume removal;
  std::mt19937 random{GetParam()};
};

TEST_P(RandomParts, AreAddedUpByPrimitivesWithoutOverlap) {
  ASSERT_TRUE(made.part.mesh().closed());
  const double wanted = (made.blank.max_mm - made.blank.min_mm).prod() - made.part.volume_mm3();
  EXPECT_NEAR(removal.removal_mm3(), wanted, 1e-3 * wanted);
  EXPECT_NEAR(removal.balance(), 0, 1e-3);
  std::map<DivisionPlan, std::size_t> counts;
  for (const DivisionPlan division : kDivisionPlans) {
    const auto primitives = divide(removal, division);
    counts[division] = primitives.size();
    double sum = 0;
    for (const VolumePrimitive& p : primitives) sum += p.volume_mm3;
    EXPECT_NEAR(sum, wanted, 1e-3 * wanted);
    for (int i = 0; i < 600; ++i) {
      const Vec3 at = anywhere();
      if (at_a_hole(removal, at)) continue;
      int in = 0;
      for (const VolumePrimitive& p : primitives) in += holds(removal, p, at);
      EXPECT_EQ(in, contains(part, at) ? 0 : 1) << to_string(division) << " " << at.transpose();
    }
  }
  EXPECT_LE(counts[DivisionPlan::largest], counts[DivisionPlan::yz]);
  EXPECT_LE(counts[DivisionPlan::largest], counts[DivisionPlan::zx]);
}

TEST_P(RandomParts, AreOrderedSoThatEveryStepIsOpenFromAbove) {
  for (const DivisionPlan division : kDivisionPlans) {
    const auto primitives = divide(removal, division);
    const Order order = put_in_order(removal, primitives);
    EXPECT_EQ(order.steps.size() + order.unreachable.size(), primitives.size());
    EXPECT_TRUE(order.unreachable.empty());
    bool hole_before = false;
    std::vector<bool> gone(primitives.size(), false);
    for (const Step& step : order.steps) {
      const VolumePrimitive& p = primitives[step.primitive];
      EXPECT_TRUE(step.open.top);
      EXPECT_TRUE(p.is_hole || !hole_before);
      hole_before = hole_before || p.is_hole;
      // Over a point of the primitive nothing is left, up to the top of the blank.
      for (int i = 0; i < 20; ++i) {
        Vec3 at;
        for (int a = 0; a < 3; ++a) at[a] = std::uniform_real_distribution(p.min_mm[a], p.max_mm[a])(random);
        for (at.z() = p.max_mm.z() + 0.01; at.z() < made.blank.max_mm.z(); at.z() += 0.7) {
          if (at_a_hole(removal, at)) continue;
          if (p.is_hole && !holds(removal, p, {at.x(), at.y(), 0.5 * (p.min_mm.z() + p.max_mm.z())})) continue;
          EXPECT_FALSE(contains(part, at)) << at.transpose();
          for (std::size_t o = 0; o < primitives.size(); ++o)
            if (o != step.primitive && holds(removal, primitives[o], at)) {
              EXPECT_TRUE(gone[o]) << at.transpose();
            }
        }
      }
      gone[step.primitive] = true;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, RandomParts, ::testing::Range(1U, part_count() + 1));

}  // namespace
}  // namespace camber::plan
