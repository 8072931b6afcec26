// Marks of deflected cutters: what height_mm and the vectors say lies on the displaced envelope, and both say the same.
#include "removal/form_error/deflected_envelope.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "removal/simd/upright_mark_kernels.h"
#include "tests/support/cutting.h"

namespace camber::removal {

using namespace upright;

namespace {

constexpr int kSteps = 720, kJump = kSteps / 3, kFlutes = 2;
constexpr double kTop_mm = 6, kLargest_mm = 0.03;

/// Deflections that turn with the edge and grow with height, and of the second row one that jumps, by more than the
/// edge moves on: there the envelope is torn, or overlaps itself.
DeflectionTable deflected_rows() {
  DeflectionTable deflections(2, kSteps, {0, 2, 4, kTop_mm});
  for (int row = 0; row < 2; ++row)
    for (int n = 0; n < 4; ++n)
      for (int m = 0; m < kSteps; ++m) {
        float* v = deflections.row(row) + 2 * (n * kSteps + m);
        const double turn = 2 * kPi * m / kSteps, phi = turn / kFlutes, size = kLargest_mm * (1 - 0.1 * n);
        if (row == 0) {
          v[0] = static_cast<float>(0.6 * size * (1 + 0.3 * std::cos(turn)));
          v[1] = static_cast<float>(0.6 * size * std::sin(turn));
        } else if (m >= kJump) {  // at the first tooth outwards and along the envelope, at the other inwards
          v[0] = static_cast<float>(size * (0.4 * std::cos(phi) - 0.8 * std::sin(phi)));
          v[1] = static_cast<float>(size * (0.4 * std::sin(phi) + 0.8 * std::cos(phi)));
        }
      }
  return deflections;
}

/// The deflection of the envelope's point at an angle and height, by the definition of DeflectionTable.
Vec3 deflection_of(const DeflectionTable& deflections, int row, double phi, double height, double lag_per_mm) {
  double step = (phi - height * lag_per_mm) * kSteps * kFlutes / (2 * kPi);
  step -= kSteps * std::floor(step / kSteps);
  const int m0 = static_cast<int>(step) % kSteps, m1 = (m0 + 1) % kSteps;
  const double f = step - std::floor(step), node = std::clamp(height / 2, 0.0, 3.0);
  const int n0 = std::min(2, static_cast<int>(node));
  const auto at = [&](int n, int m) {
    const float* v = deflections.row(row) + 2 * (n * kSteps + m);
    return Vec3(v[0], v[1], 0);
  };
  const auto along = [&](int n) { return Vec3((1 - f) * at(n, m0) + f * at(n, m1)); };
  return (1 - (node - n0)) * along(n0) + (node - n0) * along(n0 + 1);
}

struct Mark {
  Vec3 point, normal;
  double highest;
  int row;
};

/// Points in the cutter's way near its envelope, normals up to 40 degrees off; where the deflection jumps, beside that.
std::vector<Mark> marks_around(const EnvelopeGrid& envelope, std::size_t count, bool jump) {
  const CutterShape& shape = envelope.shape;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Mark> out;
  while (out.size() < count) {
    // Not at the tip, where a deflection turns a place to another side.
    const double s = (0.6 + 0.4 * unit(random)) * shape.profile.length_to_height_mm(kTop_mm);
    const ProfilePoint p = shape.profile.at(s);
    double phi = kPi * unit(random);
    if (jump) {
      constexpr double kBeside_rad = 0.008;
      const int edge = static_cast<int>(random() % 4), step = (edge & 1) * kJump + (edge >> 1) * kSteps;
      phi = 2 * kPi * step / (kSteps * kFlutes) + p.height_mm * envelope.lag_per_mm + kBeside_rad * unit(random);
    }
    const Vec3 place(p.radius_mm * std::cos(phi), p.radius_mm * std::sin(phi), p.height_mm);
    const Vec3 normal = (-shape.gradient(place) + 0.6 * Vec3(unit(random), unit(random), unit(random))).normalized();
    out.push_back({place + 0.02 * unit(random) * normal, normal, 0.2, jump ? 1 : 0});
  }
  return out;
}

EnvelopeGrid envelope_of(machine::ToolType type) {
  machine::Tool tool = testing::make_tool(type, 6, kFlutes, 30);
  if (type == machine::ToolType::bull) tool.corner_radius_mm = 1;
  return make_envelope(tool, kTop_mm, 0.5, kPi / 9);
}

std::vector<double> heights_by(const MarkKernels& kernels, const EnvelopeGrid& envelope,
                               const DeflectionTable& deflections, const std::vector<Mark>& marks) {
  const std::size_t count = (marks.size() + 7) / 8 * 8;
  std::vector<std::vector<float>> v(9, std::vector<float>(count));
  std::vector<std::int32_t> row(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Mark& m = marks[std::min(i, marks.size() - 1)];
    for (std::size_t a = 0; a < 3; ++a) {
      v[a][i] = static_cast<float>(m.point[static_cast<int>(a)]);
      v[3 + a][i] = static_cast<float>(m.normal[static_cast<int>(a)]);
    }
    v[6][i] = static_cast<float>(m.highest);
    v[7][i] = static_cast<float>(deflections.largest_mm(m.row));
    row[i] = static_cast<std::int32_t>((deflections.row(m.row) - deflections.values.data()) / 2);
  }
  kernels.heights({static_cast<int>(count), v[0].data(), v[1].data(), v[2].data(), v[3].data(), v[4].data(),
                   v[5].data(), v[6].data(), v[7].data(), row.data(), v[8].data()},
                  {{deflections.values.data(), nullptr, 4, kSteps, 2.0f},
                   static_cast<float>(envelope.shape.bottom_length_mm()),
                   static_cast<float>(envelope.shape.corner_radius_mm),
                   static_cast<float>(envelope.lag_per_mm),
                   static_cast<float>(kSteps * kFlutes / (2 * kPi))});
  return {v[8].begin(), v[8].begin() + static_cast<std::ptrdiff_t>(marks.size())};
}

TEST(DeflectedEnvelope, MarksLieOnTheDisplacedEnvelope) {
  const DeflectionTable deflections = deflected_rows();
  for (const auto type : {machine::ToolType::ball, machine::ToolType::bull, machine::ToolType::flat}) {
    const EnvelopeGrid envelope = envelope_of(type);
    const StampDeflections of_stamps(envelope, deflections);
    const StampDeflection deflection = of_stamps.of(0);
    const auto marks = marks_around(envelope, 400, false);
    const DeflectedEnvelope deflected(envelope, deflections, deflection, ToolPose{});
    int met = 0;
    for (const Mark& m : marks) {
      const double h = deflected.height_mm(m.point, m.normal, m.highest);
      if (h >= m.highest) continue;
      // x = q + h n comes from the envelope's point x - deflection: some place there whose own deflection leads to x.
      const Vec3 x = m.point + h * m.normal;
      Vec3 from = x;
      for (int i = 0; i < 30; ++i) {
        const double phi = std::atan2(from.y(), from.x()), rho = from.head<2>().norm();
        from = x - deflection_of(deflections, 0, phi, envelope.shape.profile.nearest({rho, from.z()}).place.y(),
                                 envelope.lag_per_mm);
      }
      EXPECT_NEAR(envelope.shape.distance_mm(from), 0, 2e-5);
      ++met;
    }
    EXPECT_GT(met, 300);
  }
}

TEST(DeflectedEnvelope, VectorsOfAllWidthsMarkTheSame) {
  const DeflectionTable deflections = deflected_rows();
  for (const auto type : {machine::ToolType::ball, machine::ToolType::bull, machine::ToolType::flat})
    for (const bool jump : {false, true}) {
      const EnvelopeGrid envelope = envelope_of(type);
      const StampDeflections of_stamps(envelope, deflections);
      const StampDeflection deflection = of_stamps.of(jump ? 1 : 0);
      const auto marks = marks_around(envelope, 403, jump);
      const auto narrow = heights_by(kBaseMarkKernels, envelope, deflections, marks);
      EXPECT_EQ(narrow, heights_by(mark_kernels(), envelope, deflections, marks));
      const DeflectedEnvelope deflected(envelope, deflections, deflection, ToolPose{});
      std::size_t off = 0;
      for (std::size_t i = 0; i < marks.size(); ++i)
        off += std::abs(narrow[i] - deflected.height_mm(marks[i].point, marks[i].normal, marks[i].highest)) > 2e-5;
      // Where the deflection jumps a rounding may decide on which side a place is.
      EXPECT_LE(off, jump ? 1u : 0u);
    }
}

TEST(MarkKernels, FindTheNearestCutterAndAllWithinTheirReach) {
  const CutterShape shape = envelope_of(machine::ToolType::bull).shape;
  std::mt19937 random(4);
  std::uniform_real_distribution<float> unit(-1, 1);
  constexpr std::size_t kCount = 40, kReal = 37;
  std::vector<float> x(kCount), y(kCount), z(kCount), reach(kCount, -1.0f);
  for (std::size_t k = 0; k < kReal; ++k)
    x[k] = unit(random), y[k] = unit(random), z[k] = unit(random), reach[k] = 0.3f;
  x[11] = 1.5f, y[11] = 0.5f, z[11] = -1.2f;    // the nearest of all for many places,
  x[20] = x[11], y[20] = y[11], z[20] = z[11];  // and another is as near
  for (std::size_t k = kReal; k < kCount; ++k) x[k] = x[11], y[k] = y[11], z[k] = z[11];
  const CutterLanes lanes{static_cast<int>(kCount),
                          x.data(),
                          y.data(),
                          z.data(),
                          reach.data(),
                          static_cast<float>(shape.bottom_length_mm()),
                          static_cast<float>(shape.corner_radius_mm),
                          false};
  std::vector<std::int32_t> within(kCount);
  int some = 0, ties = 0;
  for (int n = 0; n < 300; ++n) {
    const Vec3 p(4 * unit(random), 4 * unit(random), 2 * unit(random));
    std::vector<int> expected;
    int nearest = 0;
    std::vector<double> d(kReal);
    for (std::size_t k = 0; k < kReal; ++k) {
      d[k] = shape.distance_mm(p - Vec3(x[k], y[k], z[k]));
      if (d[k] <= 0.3) expected.push_back(static_cast<int>(k));
      if (d[k] < d[static_cast<std::size_t>(nearest)]) nearest = static_cast<int>(k);
    }
    if (expected.empty()) nearest = -1;
    for (const MarkKernels* kernels : {&kBaseMarkKernels, &mark_kernels()}) {
      NearCutters near{0, 0, within.data()};
      kernels->find_near(lanes, static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()), near);
      EXPECT_EQ(near.nearest, nearest);
      EXPECT_EQ(std::vector<int>(within.begin(), within.begin() + near.count), expected);
      // From all that there are, those near another place.
      const Vec3 q = p + Vec3(0.2, -0.1, 0.1);
      std::vector<int> list, of_list;
      for (int k = 0; k < static_cast<int>(kReal); k += 3) {
        list.push_back(k);
        if (shape.distance_mm(q - Vec3(x[static_cast<std::size_t>(k)], y[static_cast<std::size_t>(k)],
                                       z[static_cast<std::size_t>(k)])) <= 0.3)
          of_list.push_back(k);
      }
      NearCutters kept{-1, static_cast<int>(list.size()), nullptr};
      list.resize(16);
      kept.within = list.data();
      kernels->keep_near(lanes, static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()), kept);
      list.resize(static_cast<std::size_t>(kept.count));
      EXPECT_EQ(list, of_list);
    }
    some += !expected.empty();
    ties += nearest == 11;
  }
  EXPECT_GT(some, 50);
  EXPECT_GT(ties, 3);
}

}  // namespace
}  // namespace camber::removal
