#include "workpiece/elastic.h"

#include <cmath>

#include <Eigen/Cholesky>

namespace camber::workpiece {

namespace {

/// A product of powers 0 or 1 of x, y and z.
struct Power {
  int x, y, z;
};
constexpr std::array<Power, 8> kPowers{
    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}}};

int sign_of(int node, int axis) { return (node >> axis & 1) != 0 ? 1 : -1; }

/// Coefficient of x^p y^q z^r in the shape function of a node, (1 + s_x x)(1 + s_y y)(1 + s_z z) / 8.
double coefficient(int node, const Power& p) {
  return (p.x ? sign_of(node, 0) : 1) * (p.y ? sign_of(node, 1) : 1) * (p.z ? sign_of(node, 2) : 1) / 8.0;
}

/// Coefficient of x^p.x y^p.y z^p.z in its derivative along an axis.
double slope_coefficient(int node, int axis, Power p) {
  int& own = axis == 0 ? p.x : axis == 1 ? p.y : p.z;
  if (own != 0) return 0;
  own = 1;
  return coefficient(node, p);
}

/// Strains xx, yy, zz, xy, yz, zx of a displacement along `along` whose slope along `axis` is `slope`.
template <class Column>
void add_strain(int along, int axis, double slope, Column&& strain) {
  if (along == axis)
    strain[along] += slope;
  else
    strain[3 + (along + axis == 1 ? 0 : along + axis == 3 ? 1 : 2)] += slope;
}

Eigen::Matrix<double, 6, 6> isotropic(double nu) {
  Eigen::Matrix<double, 6, 6> out = Eigen::Matrix<double, 6, 6>::Zero();
  const double factor = 1 / ((1 + nu) * (1 - 2 * nu));
  out.topLeftCorner<3, 3>().setConstant(nu * factor);
  for (int i = 0; i < 3; ++i) out(i, i) = (1 - nu) * factor, out(3 + i, 3 + i) = 1 / (2 * (1 + nu));
  return out;
}

std::size_t sum_index(const Power& p, const Power& q) { return moment_index(p.x + q.x, p.y + q.y, p.z + q.z); }

}  // namespace

Moments moments_of_whole_cell() {
  Moments out{};
  constexpr std::array<double, 3> kLine{2, 0, 2.0 / 3};
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      for (int c = 0; c < 3; ++c)
        out[moment_index(a, b, c)] = kLine[static_cast<std::size_t>(a)] * kLine[static_cast<std::size_t>(b)] *
                                     kLine[static_cast<std::size_t>(c)];
  return out;
}

std::array<double, 8> shape_functions(const Vec3& place) {
  std::array<double, 8> out{};
  for (int n = 0; n < 8; ++n)
    out[static_cast<std::size_t>(n)] =
        (1 + sign_of(n, 0) * place.x()) * (1 + sign_of(n, 1) * place.y()) * (1 + sign_of(n, 2) * place.z()) / 8;
  return out;
}

Hexahedron::Hexahedron(double poisson_ratio) : elasticity_(isotropic(poisson_ratio)) {
  for (std::size_t p = 0; p < kPowers.size(); ++p) {
    Strain& strain = strain_[p];
    strain.setZero();
    for (int node = 0; node < 8; ++node)
      for (int along = 0; along < 3; ++along)
        for (int axis = 0; axis < 3; ++axis)
          add_strain(along, axis, slope_coefficient(node, axis, kPowers[p]), strain.col(3 * node + along));
    // (1 - x^2)' = -2 x.
    for (int along = 0; along < 3; ++along)
      for (int axis = 0; axis < 3; ++axis)
        if (p == (std::size_t{1} << axis)) add_strain(along, axis, -2, strain.col(kNodal + 3 * axis + along));
  }
  for (Whole& k : by_moment_) k.setZero();
  for (std::size_t p = 0; p < kPowers.size(); ++p)
    for (std::size_t q = 0; q < kPowers.size(); ++q)
      by_moment_[sum_index(kPowers[p], kPowers[q])] += strain_[p].transpose() * elasticity_ * strain_[q];
}

CellMatrix Hexahedron::stiffness(const Moments& material) const {
  static const Moments kWhole = moments_of_whole_cell();
  Moments m;
  for (std::size_t i = 0; i < m.size(); ++i) m[i] = material[i] + kVoid * (kWhole[i] - material[i]);
  Whole k = Whole::Zero();
  for (std::size_t i = 0; i < m.size(); ++i) k += m[i] * by_moment_[i];
  Strain sum = Strain::Zero();
  for (std::size_t p = 0; p < kPowers.size(); ++p)
    sum += m[moment_index(kPowers[p].x, kPowers[p].y, kPowers[p].z)] * strain_[p];
  // Less the mean of the inner strains.
  const Eigen::Matrix<double, 6, kInner> mean = sum.rightCols<kInner>() / m[0];
  const Eigen::Matrix<double, kInner, 6> stress = mean.transpose() * elasticity_;
  const Eigen::Matrix<double, kInner, kNodal> coupling =
      k.bottomLeftCorner<kInner, kNodal>() - stress * sum.leftCols<kNodal>();
  Eigen::Matrix<double, kInner, kInner> inner = k.bottomRightCorner<kInner, kInner>() - m[0] * stress * mean;
  constexpr double kRegular = 1e-9;
  inner.diagonal().array() += kRegular * k.bottomRightCorner<kInner, kInner>().trace();
  const CellMatrix out = k.topLeftCorner<kNodal, kNodal>() - coupling.transpose() * inner.ldlt().solve(coupling);
  return (out + out.transpose()) / 2;
}

CellMatrix Hexahedron::bed(const Moments& held) {
  CellMatrix out = CellMatrix::Zero();
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j) {
      double sum = 0;
      for (const Power& p : kPowers)
        for (const Power& q : kPowers) sum += coefficient(i, p) * coefficient(j, q) * held[sum_index(p, q)];
      for (int a = 0; a < 3; ++a) out(3 * i + a, 3 * j + a) = sum;
    }
  return out;
}

}  // namespace camber::workpiece
