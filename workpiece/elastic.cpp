#include "workpiece/elastic.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <unordered_map>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>

#include "base/cancel.h"
#include "base/tool_pose.h"
#include "base/vector_clones.h"

namespace camber::workpiece {

namespace {

constexpr std::size_t kLoads = 8;        ///< solved side by side
constexpr std::size_t kFewBodies = 200;  ///< at most this many on the coarsest level, solved directly
constexpr std::int32_t kAside = 3;       ///< nodes that become one body, along each axis
constexpr int kSmoothing = 3;            ///< degree of the polynomial
constexpr double kSmoothedRange = 16;    ///< largest eigenvalue against the least that is smoothed
constexpr int kInnerSteps = 2;           ///< on levels between

using Place = std::array<std::int32_t, 3>;
/// [unknowns][lanes].
using Field = std::vector<double>;

/// K x of a cell for several loads side by side: x and y [24][kLanes].
template <std::size_t kLanes>
inline void times_cell(const double* k, const double* x, double* y) {
  if constexpr (kLanes == 1) {
    std::array<double, 24> sum{};
    for (std::size_t c = 0; c < 24; ++c)
      for (std::size_t r = 0; r < 24; ++r) sum[r] += k[24 * c + r] * x[c];
    std::copy(sum.begin(), sum.end(), y);
  } else {
    constexpr std::size_t kRows = 3;
    for (std::size_t r = 0; r < 24; r += kRows) {
      std::array<std::array<double, kLanes>, kRows> sum{};
      for (std::size_t c = 0; c < 24; ++c)
        for (std::size_t i = 0; i < kRows; ++i) {
          const double f = k[24 * c + r + i];
          for (std::size_t l = 0; l < kLanes; ++l) sum[i][l] += f * x[c * kLanes + l];
        }
      for (std::size_t i = 0; i < kRows; ++i)
        for (std::size_t l = 0; l < kLanes; ++l) y[(r + i) * kLanes + l] = sum[i][l];
    }
  }
}

/// Adds K x of cells.
template <std::size_t kLanes>
CAMBER_VECTOR_CLONES void add_cells(const Solid::Cell* cells, std::size_t count, const CellMatrix* kinds,
                                    const double* x, double* y) {
  std::array<double, 24 * kLanes> in, out;
  for (std::size_t i = 0; i < count; ++i) {
    const Solid::Cell& cell = cells[i];
    for (std::size_t n = 0; n < 8; ++n) {
      const double* from = x + static_cast<std::size_t>(cell.node[n]) * 3 * kLanes;
      for (std::size_t j = 0; j < 3 * kLanes; ++j) in[n * 3 * kLanes + j] = from[j];
    }
    times_cell<kLanes>(kinds[cell.kind].data(), in.data(), out.data());
    for (std::size_t n = 0; n < 8; ++n) {
      double* to = y + static_cast<std::size_t>(cell.node[n]) * 3 * kLanes;
      for (std::size_t j = 0; j < 3 * kLanes; ++j) to[j] += out[n * 3 * kLanes + j];
    }
  }
}

/// y = blocks x, or y += it: blocks [rows][size][size] of the diagonal.
template <std::size_t kLanes, std::size_t kSize>
CAMBER_VECTOR_CLONES void times_block(const double* block, const double* x, double* y) {
  for (std::size_t r = 0; r < kSize; ++r) {
    std::array<double, kLanes> sum{};
    for (std::size_t c = 0; c < kSize; ++c)
      for (std::size_t l = 0; l < kLanes; ++l) sum[l] += block[kSize * r + c] * x[c * kLanes + l];
    for (std::size_t l = 0; l < kLanes; ++l) y[r * kLanes + l] += sum[l];
  }
}

/// Sums over the unknowns, one per lane, of parts that do not depend on the number of threads.
template <std::size_t kLanes>
std::array<double, kLanes> dot(const Field& x, const Field& y) {
  std::array<double, kLanes> sum{};
  for (std::size_t i = 0; i < x.size(); i += kLanes)
    for (std::size_t l = 0; l < kLanes; ++l) sum[l] += x[i + l] * y[i + l];
  return sum;
}

/// y += a x, lane by lane.
template <std::size_t kLanes>
void add_scaled(const std::array<double, kLanes>& a, const Field& x, Field& y) {
  for (std::size_t i = 0; i < x.size(); i += kLanes)
    for (std::size_t l = 0; l < kLanes; ++l) y[i + l] += a[l] * x[i + l];
}

/// x = y + a x.
template <std::size_t kLanes>
void scale_and_add(const std::array<double, kLanes>& a, const Field& y, Field& x) {
  for (std::size_t i = 0; i < x.size(); i += kLanes)
    for (std::size_t l = 0; l < kLanes; ++l) x[i + l] = y[i + l] + a[l] * x[i + l];
}

using Body = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

/// Displacement of a node, or of a body with its turns, by those of the body that it belongs to; r from this one's
/// middle.
template <int kSize>
Eigen::Matrix<double, kSize, 6> rigid_motion(const Vec3& r) {
  Eigen::Matrix<double, kSize, 6> out = Eigen::Matrix<double, kSize, 6>::Zero();
  out.template topLeftCorner<3, 3>().setIdentity();
  out.template topRightCorner<3, 3>() << 0, r.z(), -r.y(), -r.z(), 0, r.x(), r.y(), -r.x(), 0;
  if constexpr (kSize == 6) out.template bottomRightCorner<3, 3>().setIdentity();
  return out;
}

/// Symmetric, by block rows.
struct BlockRows {
  std::vector<std::size_t> first;
  std::vector<std::int32_t> column;
  std::vector<Body, Eigen::aligned_allocator<Body>> block;
};

/// Collects blocks.
class BlockSum {
 public:
  explicit BlockSum(std::size_t rows) : rows_(rows) {}
  void add(std::int32_t row, std::int32_t column, const Body& block) {
    auto& of_row = rows_[static_cast<std::size_t>(row)];
    for (auto& [c, sum] : of_row)
      if (c == column) {
        sum += block;
        return;
      }
    of_row.emplace_back(column, block);
  }
  BlockRows take() {
    BlockRows out;
    out.first.push_back(0);
    for (auto& row : rows_) {
      std::ranges::sort(row, {}, [](const auto& e) { return e.first; });
      for (const auto& [c, b] : row) out.column.push_back(c), out.block.push_back(b);
      out.first.push_back(out.column.size());
      row = {};
    }
    return out;
  }

 private:
  std::vector<std::vector<std::pair<std::int32_t, Body>, Eigen::aligned_allocator<std::pair<std::int32_t, Body>>>>
      rows_;
};

/// Joins what hangs together.
class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  std::int32_t of(std::int32_t i) {
    while (parent_[static_cast<std::size_t>(i)] != i)
      i = parent_[static_cast<std::size_t>(i)] =
          parent_[static_cast<std::size_t>(parent_[static_cast<std::size_t>(i)])];
    return i;
  }
  void join(std::int32_t a, std::int32_t b) {
    a = of(a), b = of(b);
    parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::vector<std::int32_t> parent_;
};

Place coarser(const Place& p) { return {p[0] / kAside, p[1] / kAside, p[2] / kAside}; }

/// Groups of nodes that are rigid on the next level.
struct Bodies {
  std::vector<std::int32_t> of;  ///< number of the group of each node
  std::vector<Vec3> middle;      ///< in cells of the finest level
  std::vector<Place> place;      ///< in steps of kAside
};

/// `pairs(join)` calls join(a, b) for neighbours.
template <class Pairs>
Bodies join_bodies(const std::vector<Place>& places, const std::vector<Vec3>& middles, Pairs pairs) {
  Groups groups(places.size());
  pairs([&](std::int32_t a, std::int32_t b) {
    if (coarser(places[static_cast<std::size_t>(a)]) == coarser(places[static_cast<std::size_t>(b)])) groups.join(a, b);
  });
  Bodies out;
  out.of.assign(places.size(), -1);
  std::vector<double> count;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto root = static_cast<std::size_t>(groups.of(static_cast<std::int32_t>(i)));
    if (out.of[root] < 0) {
      out.of[root] = static_cast<std::int32_t>(out.middle.size());
      out.middle.push_back(Vec3::Zero());
      out.place.push_back(coarser(places[i]));
      count.push_back(0);
    }
    out.of[i] = out.of[root];
    out.middle[static_cast<std::size_t>(out.of[i])] += middles[i];
    count[static_cast<std::size_t>(out.of[i])] += 1;
  }
  for (std::size_t b = 0; b < count.size(); ++b) out.middle[b] /= count[b];
  return out;
}

/// Returns the inverse of a symmetric block, made regular first where turns of a node, or of a line, have no stiffness.
template <int kSize>
Eigen::Matrix<double, kSize, kSize> inverse_of(Eigen::Matrix<double, kSize, kSize> m) {
  constexpr double kTiny = 1e-9;
  const double least = kTiny * m.trace() + 1e-300;
  for (int i = 0; i < kSize; ++i) m(i, i) += m(i, i) > least ? kTiny * m(i, i) : m.trace();
  return m.ldlt().solve(Eigen::Matrix<double, kSize, kSize>::Identity());
}

constexpr std::size_t kParts = 64;

/// Calls f(from, end) for parts of 0 ... count, at once.
template <class Function>
void for_parts(std::size_t count, std::size_t worth, Function f) {
  if (count < worth) return f(std::size_t{0}, count);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, count / kParts + 1),
                    [&](const auto& range) { f(range.begin(), range.end()); });
}

}  // namespace

struct Elastic::Impl {
  struct Level {
    std::size_t size = 3;  ///< unknowns of a node
    std::size_t nodes = 0;
    std::vector<Vec3> middle;
    BlockRows matrix;             ///< matrix of all levels but the finest
    std::vector<double> inverse;  ///< [nodes][size][size], of the diagonal's blocks
    std::vector<std::int32_t> body;
    std::vector<Vec3> arm;  ///< from the body's middle to the node
    double largest = 1;     ///< eigenvalue of inverse times matrix
  };

  explicit Impl(const Solid& of_part) : solid(of_part) {
    Bodies bodies = start();
    levels.push_back(coarse_of_cells(bodies));
    while (levels.back().nodes > kFewBodies && refine(bodies)) {
    }
    factorize();
    for (Level& level : levels) level.largest = largest_eigenvalue(level);
  }

  const Solid& solid;
  std::vector<Level> levels;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> coarsest;

  static void set_bodies(const Bodies& bodies, Level& level) {
    level.body = bodies.of;
    level.arm.resize(level.nodes);
    for (std::size_t i = 0; i < level.nodes; ++i)
      level.arm[i] = level.middle[i] - bodies.middle[static_cast<std::size_t>(level.body[i])];
  }

  Bodies start() {
    Level fine;
    fine.nodes = solid.node_count();
    for (const Place& p : solid.node_places()) fine.middle.emplace_back(p[0], p[1], p[2]);
    std::vector<Mat3> diagonal(fine.nodes, Mat3::Zero());
    for (const Solid::Cell& cell : solid.cells())
      for (int n = 0; n < 8; ++n)
        diagonal[static_cast<std::size_t>(cell.node[static_cast<std::size_t>(n)])] +=
            solid.kinds()[static_cast<std::size_t>(cell.kind)].block<3, 3>(3 * n, 3 * n);
    fine.inverse.resize(9 * fine.nodes);
    for (std::size_t i = 0; i < fine.nodes; ++i)
      Eigen::Map<Mat3>(fine.inverse.data() + 9 * i) = inverse_of<3>(diagonal[i]);
    Bodies bodies = join_bodies(solid.node_places(), fine.middle, [&](auto join) {
      for (const Solid::Cell& cell : solid.cells())
        for (std::size_t a = 0; a < 8; ++a)
          for (std::size_t b = a + 1; b < 8; ++b) join(cell.node[a], cell.node[b]);
    });
    set_bodies(bodies, fine);
    levels.push_back(std::move(fine));
    return bodies;
  }

  static Level level_of(BlockSum& sum, const Bodies& bodies) {
    Level out;
    out.size = 6;
    out.nodes = bodies.middle.size();
    out.middle = bodies.middle;
    out.matrix = sum.take();
    out.inverse.resize(36 * out.nodes);
    for (std::size_t r = 0; r < out.nodes; ++r)
      for (std::size_t i = out.matrix.first[r]; i < out.matrix.first[r + 1]; ++i)
        if (out.matrix.column[i] == static_cast<std::int32_t>(r))
          Eigen::Map<Body>(out.inverse.data() + 36 * r) = inverse_of<6>(out.matrix.block[i]);
    return out;
  }

  /// A cell within one body has no energy there, but where it is held.
  Level coarse_of_cells(const Bodies& bodies) const {
    const Level& fine = levels.front();
    BlockSum sum(bodies.middle.size());
    for (const Solid::Cell& cell : solid.cells()) {
      std::array<std::int32_t, 8> own{};
      std::size_t count = 0;
      for (std::size_t n = 0; n < 8; ++n) {
        const std::int32_t body = fine.body[static_cast<std::size_t>(cell.node[n])];
        if (std::find(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(count), body) ==
            own.begin() + static_cast<std::ptrdiff_t>(count))
          own[count++] = body;
      }
      Eigen::Matrix<double, 24, Eigen::Dynamic, Eigen::ColMajor, 24, 48> motion(24,
                                                                                6 * static_cast<Eigen::Index>(count));
      motion.setZero();
      for (std::size_t n = 0; n < 8; ++n) {
        const auto node = static_cast<std::size_t>(cell.node[n]);
        const auto b = std::find(own.begin(), own.end(), fine.body[node]) - own.begin();
        motion.block<3, 6>(3 * static_cast<Eigen::Index>(n), 6 * b) = rigid_motion<3>(fine.arm[node]);
      }
      const Eigen::Matrix<double, 24, Eigen::Dynamic, Eigen::ColMajor, 24, 48> force =
          solid.kinds()[static_cast<std::size_t>(cell.kind)] * motion;
      for (std::size_t a = 0; a < count; ++a)
        for (std::size_t b = 0; b < count; ++b)
          sum.add(own[a], own[b],
                  motion.middleCols<6>(6 * static_cast<Eigen::Index>(a)).transpose() *
                      force.middleCols<6>(6 * static_cast<Eigen::Index>(b)));
    }
    return level_of(sum, bodies);
  }

  /// Adds a level below the last one. False where that would join nothing.
  bool refine(Bodies& bodies) {
    Level& last = levels.back();
    Bodies next = join_bodies(bodies.place, bodies.middle, [&](auto join) {
      for (std::size_t r = 0; r < last.nodes; ++r)
        for (std::size_t i = last.matrix.first[r]; i < last.matrix.first[r + 1]; ++i)
          join(static_cast<std::int32_t>(r), last.matrix.column[i]);
    });
    if (next.middle.size() >= last.nodes) return false;
    set_bodies(next, last);
    BlockSum sum(next.middle.size());
    for (std::size_t r = 0; r < last.nodes; ++r)
      for (std::size_t i = last.matrix.first[r]; i < last.matrix.first[r + 1]; ++i) {
        const auto c = static_cast<std::size_t>(last.matrix.column[i]);
        sum.add(last.body[r], last.body[c],
                rigid_motion<6>(last.arm[r]).transpose() * last.matrix.block[i] * rigid_motion<6>(last.arm[c]));
      }
    levels.push_back(level_of(sum, next));
    bodies = std::move(next);
    return true;
  }

  void factorize() {
    const Level& last = levels.back();
    const auto n = static_cast<Eigen::Index>(6 * last.nodes);
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t r = 0; r < last.nodes; ++r)
      for (std::size_t i = last.matrix.first[r]; i < last.matrix.first[r + 1]; ++i) {
        const auto c = static_cast<std::size_t>(last.matrix.column[i]);
        if (c > r) continue;
        const Body& b = last.matrix.block[i];
        for (int a = 0; a < 6; ++a)
          for (int d = 0; d < 6; ++d) {
            double v = b(a, d);
            // Turns that move nothing.
            if (c == r && a == d) v += 1e-10 * v + (v > 1e-9 * b.trace() ? 0.0 : b.trace() + 1e-300);
            entries.emplace_back(static_cast<int>(6 * r) + a, static_cast<int>(6 * c) + d, v);
          }
      }
    Eigen::SparseMatrix<double> m(n, n);
    m.setFromTriplets(entries.begin(), entries.end());
    coarsest.compute(m);
  }

  template <std::size_t kLanes>
  void multiply(std::size_t at, const Field& x, Field& y) const {
    const Level& level = levels[at];
    std::fill(y.begin(), y.end(), 0.0);
    constexpr std::size_t kWorth = 500;
    if (at > 0) {
      for_parts(level.nodes, kWorth, [&](std::size_t from, std::size_t end) {
        for (std::size_t r = from; r < end; ++r)
          for (std::size_t i = level.matrix.first[r]; i < level.matrix.first[r + 1]; ++i)
            times_block<kLanes, 6>(level.matrix.block[i].data(),
                                   x.data() + static_cast<std::size_t>(level.matrix.column[i]) * 6 * kLanes,
                                   y.data() + r * 6 * kLanes);
      });
      return;
    }
    // Layers of cells that share no node at once.
    const std::vector<std::size_t>& first = solid.layers();
    const std::size_t count = first.size() - 1;
    for (const std::size_t odd : {0, 1}) {
      const auto layer = [&](std::size_t i) {
        const std::size_t l = 2 * i + odd;
        if (l < count)
          add_cells<kLanes>(solid.cells().data() + first[l], first[l + 1] - first[l], solid.kinds().data(), x.data(),
                            y.data());
      };
      const std::size_t layers = (count + 1) / 2;
      if (solid.cells().size() < kWorth)
        for (std::size_t i = 0; i < layers; ++i) layer(i);
      else
        tbb::parallel_for(std::size_t{0}, layers, layer);
    }
  }

  /// y = the diagonal's inverse times x.
  template <std::size_t kLanes>
  static void precondition(const Level& level, const Field& x, Field& y) {
    std::fill(y.begin(), y.end(), 0.0);
    for_parts(level.nodes, 2000, [&](std::size_t from, std::size_t end) {
      for (std::size_t i = from; i < end; ++i)
        if (level.size == 3)
          times_block<kLanes, 3>(level.inverse.data() + 9 * i, x.data() + i * 3 * kLanes, y.data() + i * 3 * kLanes);
        else
          times_block<kLanes, 6>(level.inverse.data() + 36 * i, x.data() + i * 6 * kLanes, y.data() + i * 6 * kLanes);
    });
  }

  /// By the power method, and a tenth more.
  double largest_eigenvalue(const Level& level) const {
    const auto at = static_cast<std::size_t>(&level - levels.data());
    Field x(level.size * level.nodes), y(x.size()), z(x.size());
    std::uint32_t random = 12345;
    for (double& v : x) v = static_cast<double>((random = random * 1664525u + 1013904223u) >> 8) / (1 << 24) - 0.5;
    double out = 1;
    constexpr int kTimes = 12;
    for (int i = 0; i < kTimes; ++i) {
      multiply<1>(at, x, y);
      precondition<1>(level, y, z);
      out = std::sqrt(dot<1>(z, z)[0] / std::max(dot<1>(x, x)[0], 1e-300));
      const double scale = 1 / std::sqrt(std::max(dot<1>(z, z)[0], 1e-300));
      for (std::size_t k = 0; k < x.size(); ++k) x[k] = scale * z[k];
    }
    return 1.1 * out;
  }

  /// Chebyshev's polynomial for matrix x = right, from x on. `zero`: x is zero.
  template <std::size_t kLanes>
  void smooth(std::size_t at, const Field& right, Field& x, bool zero) const {
    const Level& level = levels[at];
    const double high = level.largest, low = high / kSmoothedRange, middle = (high + low) / 2, half = (high - low) / 2;
    Field residual = right, step(x.size()), product(x.size());
    double rho = half / middle;
    for (int i = 0; i < kSmoothing; ++i) {
      if (i > 0 || !zero) {
        multiply<kLanes>(at, i == 0 ? x : step, product);
        for (std::size_t k = 0; k < x.size(); ++k) residual[k] -= product[k];
      }
      precondition<kLanes>(level, residual, product);
      if (i == 0) {
        for (std::size_t k = 0; k < x.size(); ++k) step[k] = product[k] / middle;
      } else {
        const double next = 1 / (2 * middle / half - rho);
        const double keep = next * rho, take = 2 * next / half;
        for (std::size_t k = 0; k < x.size(); ++k) step[k] = keep * step[k] + take * product[k];
        rho = next;
      }
      for (std::size_t k = 0; k < x.size(); ++k) x[k] += step[k];
    }
  }

  template <std::size_t kLanes>
  void restrict_to(const Level& level, const Field& x, Field& coarse) const {
    std::fill(coarse.begin(), coarse.end(), 0.0);
    for (std::size_t i = 0; i < level.nodes; ++i) {
      const double* f = x.data() + i * level.size * kLanes;
      double* to = coarse.data() + static_cast<std::size_t>(level.body[i]) * 6 * kLanes;
      const Vec3& r = level.arm[i];
      for (std::size_t l = 0; l < kLanes; ++l) {
        const double fx = f[l], fy = f[kLanes + l], fz = f[2 * kLanes + l];
        to[l] += fx, to[kLanes + l] += fy, to[2 * kLanes + l] += fz;
        to[3 * kLanes + l] += r.y() * fz - r.z() * fy;
        to[4 * kLanes + l] += r.z() * fx - r.x() * fz;
        to[5 * kLanes + l] += r.x() * fy - r.y() * fx;
      }
      if (level.size == 6)
        for (std::size_t j = 3 * kLanes; j < 6 * kLanes; ++j) to[j] += f[j];
    }
  }

  template <std::size_t kLanes>
  void add_prolonged(const Level& level, const Field& coarse, Field& x) const {
    for (std::size_t i = 0; i < level.nodes; ++i) {
      const double* of = coarse.data() + static_cast<std::size_t>(level.body[i]) * 6 * kLanes;
      double* to = x.data() + i * level.size * kLanes;
      const Vec3& r = level.arm[i];
      for (std::size_t l = 0; l < kLanes; ++l) {
        const double wx = of[3 * kLanes + l], wy = of[4 * kLanes + l], wz = of[5 * kLanes + l];
        to[l] += of[l] + wy * r.z() - wz * r.y();
        to[kLanes + l] += of[kLanes + l] + wz * r.x() - wx * r.z();
        to[2 * kLanes + l] += of[2 * kLanes + l] + wx * r.y() - wy * r.x();
      }
      if (level.size == 6)
        for (std::size_t j = 3 * kLanes; j < 6 * kLanes; ++j) to[j] += of[j];
    }
  }

  /// out = about the inverse of the level's matrix times right.
  template <std::size_t kLanes>
  void cycle(std::size_t at, const Field& right, Field& out) const {
    if (at + 1 == levels.size()) {
      using Rows = Eigen::Matrix<double, Eigen::Dynamic, static_cast<int>(kLanes),
                                 kLanes == 1 ? Eigen::ColMajor : Eigen::RowMajor>;
      const Eigen::Map<const Rows> b(right.data(), static_cast<Eigen::Index>(right.size() / kLanes),
                                     static_cast<Eigen::Index>(kLanes));
      Eigen::Map<Rows> x(out.data(), b.rows(), b.cols());
      x = coarsest.solve(Eigen::MatrixXd(b));
      return;
    }
    const Level& level = levels[at];
    std::fill(out.begin(), out.end(), 0.0);
    smooth<kLanes>(at, right, out, true);
    Field residual(right.size());
    multiply<kLanes>(at, out, residual);
    for (std::size_t k = 0; k < right.size(); ++k) residual[k] = right[k] - residual[k];
    const std::size_t below = 6 * levels[at + 1].nodes * kLanes;
    Field coarse(below), correction(below);
    restrict_to<kLanes>(level, residual, coarse);
    if (at + 2 == levels.size())
      cycle<kLanes>(at + 1, coarse, correction);
    else
      iterate<kLanes>(at + 1, coarse, correction, 0.2, kInnerSteps);
    add_prolonged<kLanes>(level, correction, out);
    smooth<kLanes>(at, right, out, false);
  }

  /// Conjugate gradients, with a direction that keeps apart from the last one whatever the preconditioner was.
  /// Starts from zero; returns steps and the largest residual.
  template <std::size_t kLanes>
  ElasticSummary iterate(std::size_t at, const Field& right, Field& x, double tolerance, int max_steps) const {
    std::fill(x.begin(), x.end(), 0.0);
    const auto size = dot<kLanes>(right, right);
    Field r = right, z(x.size()), p(x.size()), q(x.size()), last(x.size());
    std::array<double, kLanes> rz{};
    ElasticSummary out;
    const auto left = [&] {
      const auto now = dot<kLanes>(r, r);
      double most = 0;
      for (std::size_t l = 0; l < kLanes; ++l)
        if (size[l] > 0) most = std::max(most, std::sqrt(now[l] / size[l]));
      return most;
    };
    for (out.residual = left(); out.residual > tolerance && out.iterations < max_steps; ++out.iterations) {
      cancellation_point();
      cycle<kLanes>(at, r, z);
      const auto now = dot<kLanes>(r, z), before = dot<kLanes>(last, z);
      std::array<double, kLanes> beta{}, alpha{};
      for (std::size_t l = 0; l < kLanes; ++l)
        if (out.iterations > 0 && rz[l] > 0) beta[l] = (now[l] - before[l]) / rz[l];
      scale_and_add<kLanes>(beta, z, p);
      multiply<kLanes>(at, p, q);
      const auto pq = dot<kLanes>(p, q), pr = dot<kLanes>(p, r);
      std::array<double, kLanes> minus{};
      for (std::size_t l = 0; l < kLanes; ++l) {
        alpha[l] = pq[l] > 0 ? pr[l] / pq[l] : 0;
        minus[l] = -alpha[l];
      }
      last = r;
      rz = now;
      add_scaled<kLanes>(alpha, p, x);
      add_scaled<kLanes>(minus, q, r);
      out.residual = left();
    }
    out.solved = out.residual <= tolerance;
    return out;
  }

  template <std::size_t kLanes>
  void solve(std::span<const Load> loads, const ElasticOptions& options, std::vector<Displacements>& out,
             ElasticSummary& summary) const {
    const std::size_t unknowns = 3 * solid.node_count();
    Field right(unknowns * kLanes, 0.0), x(right.size());
    for (std::size_t l = 0; l < loads.size(); ++l)
      for (const auto& [node, weight] : loads[l].where.nodes)
        for (std::size_t a = 0; a < 3; ++a)
          right[(3 * static_cast<std::size_t>(node) + a) * kLanes + l] +=
              weight * loads[l].direction[static_cast<Eigen::Index>(a)] / solid.stiffness_unit_N_per_mm();
    const ElasticSummary own = iterate<kLanes>(0, right, x, options.tolerance, options.max_iterations);
    summary.iterations = std::max(summary.iterations, own.iterations);
    summary.residual = std::max(summary.residual, own.residual);
    summary.solved &= own.solved;
    for (std::size_t l = 0; l < loads.size(); ++l) {
      Displacements& u = out.emplace_back(unknowns);
      for (std::size_t i = 0; i < unknowns; ++i) u[i] = x[i * kLanes + l];
    }
  }
};

Elastic::Elastic(const Solid& solid) : impl_(std::make_unique<Impl>(solid)) {}
Elastic::~Elastic() = default;
Elastic::Elastic(Elastic&&) noexcept = default;

std::vector<Displacements> Elastic::solve(std::span<const Load> loads, const ElasticOptions& options,
                                          ElasticSummary* summary) const {
  std::vector<Displacements> out;
  ElasticSummary own;
  for (std::size_t from = 0; from < loads.size();) {
    const std::size_t count = std::min(kLoads, loads.size() - from);
    if (count == 1)
      impl_->solve<1>(loads.subspan(from, count), options, out, own);
    else if (count <= kLoads / 2)
      impl_->solve<kLoads / 2>(loads.subspan(from, count), options, out, own);
    else
      impl_->solve<kLoads>(loads.subspan(from, count), options, out, own);
    from += count;
  }
  if (summary) *summary = own;
  return out;
}

double Elastic::energy_Nmm(const Displacements& u) const {
  Field product(u.size());
  impl_->multiply<1>(0, u, product);
  return impl_->solid.stiffness_unit_N_per_mm() * dot<1>(u, product)[0] / 2;
}

Vec3 displacement_mm(const NodeWeights& where, const Displacements& u) {
  Vec3 out = Vec3::Zero();
  for (const auto& [node, weight] : where.nodes)
    out += weight * Eigen::Map<const Vec3>(u.data() + 3 * static_cast<std::size_t>(node));
  return out;
}

std::size_t elastic_memory_bytes(std::size_t cells, std::size_t loads) {
  // Cells, places and blocks of the diagonal; 12 fields; aggregates of 27 nodes with 27 blocks each.
  constexpr std::size_t kOfCell = 48 + 60 + 72, kFields = 12, kOfBody = 27 * (36 + 1) * 8;
  return cells * (kOfCell + kFields * 3 * 8 * std::max<std::size_t>(1, loads) + kOfBody / 27);
}

}  // namespace camber::workpiece
