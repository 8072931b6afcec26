// The loops in vectors: wide and narrow ones give the same bits, and both what the closed forms give.
#include "removal/simd/upright_kernels.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "removal/cutter.h"
#include "removal/field/upright/carve.h"

using namespace camber;
using namespace camber::removal;
using namespace camber::removal::upright;

namespace {

constexpr int kColumns = LineCut::kColumns;

CutterShape bull() {
  machine::Tool tool;
  tool.type = machine::ToolType::bull;
  tool.diameter_mm = 10;
  tool.corner_radius_mm = 2;
  tool.flutes = 2;
  return shape_of(tool);
}

/// A line of columns around a bull-nose cutter's flank.
struct Line {
  std::vector<float> distance = std::vector<float>(kColumns * kColumns + 8, -0.5f);
  std::vector<std::int32_t> stamp = std::vector<std::int32_t>(kColumns * kColumns + 8, -1);
  std::vector<float> changeable = std::vector<float>(LineCut::kLine, 1.0f);
  std::vector<std::int16_t> top = std::vector<std::int16_t>(kColumns, kColumns);

  LineCut cut(float dx) {
    LineCut c{};
    c.distance = distance.data(), c.stamp = stamp.data(), c.changeable = changeable.data(), c.top = top.data();
    c.id = 7;
    c.dx = dx, c.dy = -0.35f, c.z = -0.3f, c.voxel = 0.1f, c.band = 0.5f;
    c.flat = 3, c.corner = 2, c.shrink = 0.01f;
    return c;
  }
};

struct Bend {
  std::vector<float> row, outward = std::vector<float>(StampDeflection::kSectors, 0.03f);
  explicit Bend(int nodes, int steps) : row(static_cast<std::size_t>(2 * nodes * steps)) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> deflection(-0.02f, 0.02f);
    for (float& v : row) v = deflection(random);
  }
};

bool has_wide_vectors() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2");
#else
  return false;
#endif
}

}  // namespace

TEST(Kernels, LinesAreCutToTheDistanceOfTheCutter) {
  const CutterShape shape = bull();
  for (const Kernels* kernel : {&kBaseKernels, &kernels()}) {
    Line line;
    const LineCut c = line.cut(4.7f);
    line.top[3] = 0;
    line.changeable[4] = -1;
    const LineResult result = kernel->cut_line(c);
    EXPECT_EQ(result.changed & (1u << 3 | 1u << 4), 0u);
    int changed = 0;
    for (int j = 0; j < kColumns; ++j)
      for (int k = 0; k < kColumns; ++k) {
        const double d = shape.distance_mm({4.7, -0.35 + 0.1 * j, -0.3 + 0.1 * k}) + 0.01;
        const double expected = j == 3 || j == 4 ? -0.5 : std::max(-0.5, std::min(0.5, -d));
        const auto at = static_cast<std::size_t>(j * kColumns + k);
        ASSERT_NEAR(line.distance[at], expected, 2e-6) << j << ' ' << k;
        ASSERT_EQ(line.stamp[at], line.distance[at] > -0.5f ? 7 : -1);
        changed += line.stamp[at] == 7;
      }
    EXPECT_GT(changed, 50);
  }
}

TEST(Kernels, ADeflectedCutterCutsWhereItIs) {
  const CutterShape shape = bull();
  for (const double away_mm : {-0.02, 0.02}) {  // from the line's flank, and into it
    Bend bend(4, 60);
    for (std::size_t i = 0; i < bend.row.size(); ++i) bend.row[i] = i % 2 == 0 ? static_cast<float>(away_mm) : 0.0f;
    std::fill(bend.outward.begin(), bend.outward.end(), static_cast<float>(std::max(0.0, away_mm)));
    const LineDeflection lean{{bend.row.data(), nullptr, 4, 60, 1.5f},
                              0.02f,
                              0.0f,
                              bend.outward.data(),
                              StampDeflection::kSectors,
                              0.1f,
                              19.1f};
    for (const Kernels* kernel : {&kBaseKernels, &kernels()}) {
      Line line;
      LineCut c = line.cut(4.7f);
      c.shrink = 0;
      kernel->cut_line_deflected(c, lean);
      int near = 0;
      for (int j = 0; j < kColumns; ++j)
        for (int k = 0; k < kColumns; ++k) {
          const double d = -shape.distance_mm({4.7 - away_mm, -0.35 + 0.1 * j, -0.3 + 0.1 * k});
          if (std::abs(d) > 0.15) continue;  // cells with a surface in them
          ++near;
          ASSERT_NEAR(line.distance[static_cast<std::size_t>(j * kColumns + k)], d, 2e-4) << j << ' ' << k;
        }
      EXPECT_GT(near, 30);
    }
  }
}

TEST(Kernels, WideAndNarrowVectorsCutTheSameBits) {
  if (!has_wide_vectors()) GTEST_SKIP() << "no AVX2 here";
  Bend deflection(4, 60);
  const LineDeflection lean{{deflection.row.data(), nullptr, 4, 60, 1.5f},
                            0.03f,
                            0.0f,
                            deflection.outward.data(),
                            StampDeflection::kSectors,
                            0.1f,
                            19.1f};
  for (const float dx : {0.0f, 2.9f, 4.6f, 5.2f}) {
    Line narrow, wide;
    for (Line* line : {&narrow, &wide}) line->top[5] = 9;
    kBaseKernels.cut_line(narrow.cut(dx));
    kernels().cut_line(wide.cut(dx));
    EXPECT_EQ(narrow.distance, wide.distance);
    const LineResult a = kBaseKernels.cut_line_deflected(narrow.cut(dx + 0.05f), lean);
    const LineResult b = kernels().cut_line_deflected(wide.cut(dx + 0.05f), lean);
    EXPECT_EQ(narrow.distance, wide.distance);
    EXPECT_EQ(narrow.stamp, wide.stamp);
    EXPECT_EQ(a.changed, b.changed);
  }
}

namespace {

/// Points around a bull-nose cutter of 10 mm, some of stamps with deflections, some without.
struct Pairs {
  static constexpr int kCount = 27, kWhole = 32;
  std::vector<float> x, y, z, nx, ny, nz, guess, known, farther, thickness = std::vector<float>(kWhole);
  std::vector<std::int32_t> row = std::vector<std::int32_t>(kWhole, 0);
  Bend bend{4, 60};

  Pairs() {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> place(-1.0f, 1.0f);
    for (int i = 0; i < kWhole; ++i) {
      x.push_back(4.6f + 0.5f * place(random)), y.push_back(place(random)), z.push_back(1 + place(random));
      const Vec3 normal = Vec3(0.8, 0.1 * static_cast<double>(place(random)), -0.5).normalized();
      nx.push_back(static_cast<float>(normal.x())), ny.push_back(static_cast<float>(normal.y()));
      nz.push_back(static_cast<float>(normal.z()));
      guess.push_back(0), known.push_back(i % 3 == 0 ? 1.0f : 0.0f);
      farther.push_back(known.back() > 0 ? 0.0f : 0.01f * place(random));
    }
  }
  PairLanes lanes() {
    return {kCount,
            x.data(),
            y.data(),
            z.data(),
            nx.data(),
            ny.data(),
            nz.data(),
            guess.data(),
            guess.data(),
            guess.data(),
            known.data(),
            row.data(),
            farther.data(),
            {bend.row.data(), nullptr, 4, 60, 1.5f},
            0.1f,
            19.1f,
            thickness.data()};
  }
};

}  // namespace

TEST(Kernels, WideAndNarrowVectorsReadTheSameThicknesses) {
  if (!has_wide_vectors()) GTEST_SKIP() << "no AVX2 here";
  Pairs narrow, wide;
  kBaseKernels.thin_pairs(narrow.lanes(), 3, 2, 0.25f);
  kernels().thin_pairs(wide.lanes(), 3, 2, 0.25f);
  for (std::size_t i = 0; i < Pairs::kCount; ++i) {
    EXPECT_EQ(narrow.thickness[i], wide.thickness[i]);
    EXPECT_EQ(narrow.x[i], wide.x[i]);
  }
}

TEST(Kernels, ThicknessIsDistanceOverSlope) {
  const CutterShape shape = bull();
  for (const Kernels* kernel : {&kBaseKernels, &kernels()}) {
    Pairs pairs;
    const Pairs before = pairs;
    kernel->thin_pairs(pairs.lanes(), 3, 2, 0.25f);
    int moved = 0;
    for (std::size_t i = 0; i < Pairs::kCount; ++i) {
      const Vec3 from_tip(pairs.x[i], pairs.y[i], pairs.z[i]), normal(pairs.nx[i], pairs.ny[i], pairs.nz[i]);
      const double fall = std::clamp(shape.gradient(from_tip).dot(normal), 0.25, 1.0);
      EXPECT_NEAR(pairs.thickness[i], (shape.distance_mm(from_tip) - static_cast<double>(pairs.farther[i])) / fall,
                  1e-5);
      moved += pairs.x[i] != before.x[i];
    }
    EXPECT_EQ(moved, 9);  // each third has a deflection
  }
}
