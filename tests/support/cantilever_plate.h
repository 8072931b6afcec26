#pragma once
// A thin plate that is clamped along its foot, by Kirchhoff's theory and Ritz' method: what elastic walls are compared
// with.
#include <cmath>
#include <functional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace camber::test {

namespace plate {

/// Legendre's polynomials on -1 ... 1 with their first two derivatives.
struct Legendre {
  std::vector<double> value, first, second;
  Legendre(double x, int count) : value(count), first(count), second(count) {
    for (int n = 0; n < count; ++n) {
      const auto i = static_cast<std::size_t>(n);
      if (n == 0) {
        value[i] = 1;
        continue;
      }
      if (n == 1) {
        value[i] = x, first[i] = 1;
        continue;
      }
      const double a = (2.0 * n - 1) / n, b = (n - 1.0) / n;
      value[i] = a * x * value[i - 1] - b * value[i - 2];
      first[i] = a * (value[i - 1] + x * first[i - 1]) - b * first[i - 2];
      second[i] = a * (2 * first[i - 1] + x * second[i - 1]) - b * second[i - 2];
    }
  }
};

struct GaussPoint {
  double at, weight;
};

/// Gauss' rule of `count` points on -1 ... 1, by Newton's method from Chebyshev's points.
inline std::vector<GaussPoint> gauss(int count) {
  std::vector<GaussPoint> out;
  for (int i = 0; i < count; ++i) {
    double x = std::cos(M_PI * (i + 0.75) / (count + 0.5)), slope = 0;
    for (int step = 0; step < 50; ++step) {
      const Legendre p(x, count + 1);
      slope = p.first.back();
      x -= p.value.back() / slope;
    }
    out.push_back({x, 2 / ((1 - x * x) * slope * slope)});
  }
  return out;
}

/// The rule over the pieces between breaks.
inline std::vector<GaussPoint> over(double end, const std::vector<double>& breaks, int count) {
  std::vector<double> ends{0};
  for (const double b : breaks)
    if (b > ends.back() && b < end) ends.push_back(b);
  ends.push_back(end);
  std::vector<GaussPoint> out;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i)
    for (const GaussPoint& g : gauss(count)) {
      const double half = (ends[i + 1] - ends[i]) / 2;
      out.push_back({ends[i] + half * (1 + g.at), half * g.weight});
    }
  return out;
}

}  // namespace plate

/// x along the plate from 0 to `length`, z up from the clamped foot, 0, to `height`. The thickness may change along
/// both; it is constant between the levels `x_breaks` and `z_breaks`. Its middle plane is taken as flat.
/// Deflections are sums of Legendre polynomials along x and z^2 times such along z; with 14 of each the deflection
/// under a load spread over a few millimetres is right within half a percent. Source: Timoshenko & Woinowsky-Krieger,
/// Theory of Plates and Shells, 2nd ed., energy of bending (eq. 117).
class CantileverPlate {
 public:
  struct Description {
    double length = 60, height = 30;
    double youngs_modulus_MPa = 68900, poisson_ratio = 0.33;
    std::function<double(double x, double z)> thickness;
    std::vector<double> x_breaks, z_breaks;  ///< without the ends
    int terms = 14;
  };

  explicit CantileverPlate(const Description& d);

  struct Load {
    double x = 0, z = 0, force_N = 0;
  };
  /// Deflection at a place under point loads, mm.
  double deflection_mm(double x, double z, const std::vector<Load>& loads) const;

 private:
  /// Values of all shapes and of their second derivatives.
  struct Shapes {
    Eigen::VectorXd value, xx, zz, xz;
  };
  Shapes shapes_at(double x, double z) const;

  double length_, height_;
  int terms_;
  Eigen::LDLT<Eigen::MatrixXd> stiffness_;
};

inline CantileverPlate::CantileverPlate(const Description& d) : length_(d.length), height_(d.height), terms_(d.terms) {
  const int size = terms_ * terms_;
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(size, size);
  const double nu = d.poisson_ratio;
  const int points = terms_ + 2;
  for (const plate::GaussPoint& x : plate::over(length_, d.x_breaks, points))
    for (const plate::GaussPoint& z : plate::over(height_, d.z_breaks, points)) {
      const Shapes s = shapes_at(x.at, z.at);
      const double stiffness =
          x.weight * z.weight * d.youngs_modulus_MPa * std::pow(d.thickness(x.at, z.at), 3) / (12 * (1 - nu * nu));
      const Eigen::VectorXd sum = s.xx + s.zz;
      // (w_xx + w_zz)^2 - 2 (1 - nu) (w_xx w_zz - w_xz^2)
      k.noalias() += stiffness * sum * sum.transpose();
      k.noalias() -= stiffness * (1 - nu) * (s.xx * s.zz.transpose() + s.zz * s.xx.transpose());
      k.noalias() += 2 * stiffness * (1 - nu) * s.xz * s.xz.transpose();
    }
  stiffness_.compute(k);
}

inline CantileverPlate::Shapes CantileverPlate::shapes_at(double x, double z) const {
  const plate::Legendre px(2 * x / length_ - 1, terms_), pz(2 * z / height_ - 1, terms_);
  const double per_x = 2 / length_, per_z = 2 / height_;
  Shapes out;
  for (auto* v : {&out.value, &out.xx, &out.zz, &out.xz}) v->resize(terms_ * terms_);
  for (int j = 0; j < terms_; ++j) {
    const auto b = static_cast<std::size_t>(j);
    const double v = pz.value[b], v1 = per_z * pz.first[b], v2 = per_z * per_z * pz.second[b];
    const double f = z * z * v, f1 = 2 * z * v + z * z * v1, f2 = 2 * v + 4 * z * v1 + z * z * v2;
    for (int i = 0; i < terms_; ++i) {
      const auto a = static_cast<std::size_t>(i);
      const int at = j * terms_ + i;
      out.value[at] = px.value[a] * f;
      out.xx[at] = per_x * per_x * px.second[a] * f;
      out.zz[at] = px.value[a] * f2;
      out.xz[at] = per_x * px.first[a] * f1;
    }
  }
  return out;
}

inline double CantileverPlate::deflection_mm(double x, double z, const std::vector<Load>& loads) const {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(terms_ * terms_);
  for (const Load& l : loads) force += l.force_N * shapes_at(l.x, l.z).value;
  return stiffness_.solve(force).dot(shapes_at(x, z).value);
}

}  // namespace camber::test
