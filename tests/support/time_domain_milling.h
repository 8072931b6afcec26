#pragma once
// Milling with a bending tool as it happens in time, slow and obvious: the edges turn in small steps while the tool
// feeds on continuously; at every step the tool stands where force and bending are in balance; a chip is as long as the
// ray from the edge, against the envelope's normal, to the surface that lies there; what the edges sweep between two
// steps is taken off. No tooth passing, no stamp, no field, no formula for a chip; of Camber nothing is taken.
#include <cmath>
#include <vector>

#include <Eigen/Dense>

#include "tests/support/height_map.h"

namespace camber::testing {

/// Force of an edge by its chip, linear or Kienzle's: K h or K h^(1 - m), MPa (h in mm); edge terms N/mm.
struct EdgeLaw {
  double kt = 2000, kr = 700, ka = 0, kte = 15, kre = 15, kae = 0;
  double mt = 0, mr = 0, ma = 0;
  double ramp_mm = 0.002;  ///< below it edge terms, and a power law, run straight to zero

  /// Force per width, and its slope by h.
  static void component(double k, double m, double ke, double h, double ramp, double& force, double& slope) {
    const double at = m > 0 ? std::max(h, ramp) : h;
    const double power = m > 0 ? std::pow(at, -m) : 1.0;
    force = k * power * h, slope = k * power * (h > ramp ? 1 - m : 1.0);
    force += ke * std::min(1.0, ramp > 0 ? h / ramp : 1.0);
    if (h < ramp) slope += ke / ramp;
  }
};

/// A slender round cutter (rounded cylinder) with helical edges that turns clockwise, seen from above.
struct TurningTool {
  double radius = 3, corner = 3;  ///< corner = radius: ball; 0: flat
  int flutes = 2;
  double helix_rad = 0;
  double bottom = 0, top = 1, edge_step = 0.03;  ///< the edge is followed up to `top`; a flat cutter's from `bottom`
  double run_out_mm = 0, run_out_rad = 0;
  std::vector<double> tooth_rad{};  ///< from the first tooth, against the turning direction; empty: even
  double overhang = 40, bending_stiffness_N_mm2 = 1, root_stiffness_N_per_mm = 1e300;
  int levels = 3;  ///< heights from the tip to `top` between which the bend is a straight line
  double tooth(int j) const {
    return tooth_rad.empty() ? 2 * kPi * j / flutes : tooth_rad[static_cast<std::size_t>(j)];
  }
  /// Textbook cantilever: bend at z_out under a unit force at z_force, both from the tip.
  double compliance(double z_out, double z_force) const {
    const double a = overhang - z_force, x = overhang - z_out;  // from the root
    const double bent = x <= a ? x * x * (3 * a - x) : a * a * (3 * x - a);
    return bent / (6 * bending_stiffness_N_mm2) + 1 / root_stiffness_N_per_mm;
  }
};

/// Loads and deflections of one tooth period.
struct Period {
  Vec3 tip = Vec3::Zero();  ///< at its end
  double lateral_max_N = 0;
  Vec3 mean_N = Vec3::Zero();
  double chip_mm3 = 0;
  Vec2 largest_bend = Vec2::Zero();
  int unsettled = 0;  ///< steps without a balance
};

class TimeDomainMilling {
 public:
  TimeDomainMilling(const TurningTool& tool, const EdgeLaw& law, HeightMap& surface, int steps_per_pitch)
      : tool_(tool), law_(law), surface_(surface), steps_(steps_per_pitch) {
    place_edge();
    const int n = 2 * tool.levels;
    flexibility_ = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i < tool.levels; ++i)
      for (int j = 0; j < tool.levels; ++j)
        for (int a = 0; a < 2; ++a)
          flexibility_(2 * i + a, 2 * j + a) = tool.compliance(level_height(i), level_height(j));
    const std::size_t points = edge_.size() * static_cast<std::size_t>(tool.flutes);
    now_.resize(points), before_.resize(points);
    bend_ = Eigen::VectorXd::Zero(n);
  }

  /// Runs along a straight row; the tool comes to its start unbent and through air.
  std::vector<Period> run(const Vec3& from, const Vec3& to, double feed_mm) {
    std::vector<Period> out;
    const Vec3 feed = (to - from).normalized() * feed_mm;
    const int periods = static_cast<int>((to - from).norm() / feed_mm);
    const double behind = std::atan2(-feed.y(), -feed.x());
    int unsettled = 0;
    bend_.setZero();
    for (Point& p : before_) p.known = false;
    for (int k = 0; k < periods; ++k) {
      Period period;
      for (int i = 1; i <= steps_; ++i) {
        const double at = k + static_cast<double>(i) / steps_;
        turn_ += 2 * kPi / (tool_.flutes * steps_);
        step(from + at * feed, behind, period);
      }
      period.tip = from + (k + 1) * feed;
      out.push_back(period);
      if ((unsettled += period.unsettled) > give_up_after) break;
    }
    passes_ += 2;
    return out;
  }

  bool rigid = false;           ///< forces are worked out, but bend nothing
  int give_up_after = 1 << 30;  ///< steps of a row without a balance

 private:
  struct Edge {
    double r, z, kappa, width, k1, k2;
    int level;
    double level_fraction;
  };
  struct Point {
    Vec3 straight, place, normal;
    double phi;
    double chip = 0;
    std::int32_t pass = 0;
    bool known = false;
  };

  double level_height(int i) const { return tool_.top * i / (tool_.levels - 1); }

  void place_edge() {
    const double arc = tool_.corner * kPi / 2, flat = tool_.radius - tool_.corner;
    // The flat bottom of a cutter that feeds level cuts nothing.
    const double arc_end = tool_.corner > 0 ? std::acos(std::max(0.0, 1 - tool_.top / tool_.corner)) * tool_.corner : 0;
    const double on_arc = std::min(arc, arc_end), wall = std::max(tool_.corner, tool_.bottom);
    const double length = on_arc + std::max(0.0, tool_.top - wall);
    const int n = static_cast<int>(std::ceil(length / tool_.edge_step - 1e-6));
    for (int i = 0; i < n; ++i) {
      const double s = (i + 0.5) * length / n;
      Edge e{};
      e.width = length / n;
      if (s < on_arc) {
        e.kappa = s / tool_.corner;
        e.r = flat + tool_.corner * std::sin(e.kappa), e.z = tool_.corner * (1 - std::cos(e.kappa));
        e.k1 = 1 / tool_.corner;
      } else {
        e.kappa = kPi / 2, e.r = tool_.radius, e.z = wall + s - on_arc;
      }
      e.k2 = std::sin(e.kappa) / e.r;
      const double at = std::min(e.z / level_height(1), tool_.levels - 1 - 1e-9);
      e.level = static_cast<int>(at), e.level_fraction = at - e.level;
      edge_.push_back(e);
    }
  }

  Vec2 bend_at(const Eigen::VectorXd& bend, const Edge& e) const {
    const Vec2 low = bend.segment<2>(2 * e.level), high = bend.segment<2>(2 * e.level + 2);
    return low + e.level_fraction * (high - low);
  }

  /// Where the edges stand, unbent.
  void place_points(const Vec3& tip, double behind) {
    const double rotation = run_out_direction();
    const Vec3 axis = tip + tool_.run_out_mm * Vec3(std::cos(rotation), std::sin(rotation), 0);
    active_.clear();
    const double reach = surface_.highest() + 0.6;
    for (int j = 0; j < tool_.flutes; ++j)
      for (std::size_t i = 0; i < edge_.size(); ++i) {
        const Edge& e = edge_[i];
        Point& p = now_[static_cast<std::size_t>(j) * edge_.size() + i];
        p.phi = tool_.tooth(j) + e.z * std::tan(tool_.helix_rad) / tool_.radius - turn_;
        const double c = std::cos(p.phi), s = std::sin(p.phi);
        p.straight = axis + Vec3(e.r * c, e.r * s, e.z);
        p.known = surface_.chart().of(p.straight).z() < reach;
        if (!p.known) continue;
        p.normal = Vec3(std::sin(e.kappa) * c, std::sin(e.kappa) * s, -std::cos(e.kappa));
        // A tooth's next pass begins behind the tool, out of the material.
        p.pass = (passes_ - static_cast<std::int32_t>(std::floor((p.phi - behind) / (2 * kPi)))) * tool_.flutes + j;
        active_.push_back(static_cast<std::size_t>(j) * edge_.size() + i);
      }
  }
  double run_out_direction() const { return tool_.run_out_rad - turn_; }

  /// Length of the ray from a place against the normal to the surface, and how it changes with the place.
  double chip(const Vec3& place, const Vec3& normal, std::int32_t pass, Vec3& change) const {
    constexpr double kExact = 1e-8;
    const Chart& chart = surface_.chart();
    HeightMap::Reading r{};
    const auto above = [&](double length) {
      const Vec3 at = chart.of(place - length * normal);
      r = surface_.read(at.x(), at.y(), pass);
      return at.z() - r.height;
    };
    double a = 0, fa = above(0);
    if (fa >= 0) return 0;
    double fall = -chart.gradient(place, r.by_u, r.by_v).dot(normal);
    double b = -fa / std::clamp(fall, 0.2, 2.0), fb = above(b);
    for (int i = 0; i < 30 && std::abs(fb) > kExact; ++i) {
      if (fb > 1e8) return last_in_material(place, normal, pass, a, b);
      double next = fb != fa ? b - fb * (b - a) / (fb - fa) : b;
      if (!(next > 0)) next = b / 2;
      if (next > 2 * b + 0.1) next = 2 * b + 0.1;
      a = b, fa = fb, b = next, fb = above(b);
    }
    const Vec3 gradient = chart.gradient(place - b * normal, r.by_u, r.by_v);
    const double along = gradient.dot(normal);
    if (std::abs(along) > 0.05) change = gradient / along;
    return b;
  }
  /// The material ends at an edge of the map.
  double last_in_material(const Vec3& place, const Vec3& normal, std::int32_t pass, double a, double b) const {
    for (int i = 0; i < 30; ++i) {
      const double middle = (a + b) / 2;
      const Vec3 at = surface_.chart().of(place - middle * normal);
      (at.z() < surface_.read(at.x(), at.y(), pass).height ? a : b) = middle;
    }
    return a;
  }

  /// Force at the levels with a bend, and its slope; `sum`: all of it.
  void load(const Eigen::VectorXd& bend, Eigen::VectorXd& force, Eigen::MatrixXd* slope, Vec3* sum) {
    force.setZero(bend.size());
    if (slope) slope->setZero(bend.size(), bend.size());
    if (sum) sum->setZero();
    for (const std::size_t k : active_) {
      const Edge& e = edge_[k % edge_.size()];
      Point& p = now_[k];
      const Vec2 bent = bend_at(bend, e);
      p.place = p.straight + Vec3(bent.x(), bent.y(), 0);
      Vec3 change = p.normal;
      p.chip = chip(p.place, p.normal, p.pass, change);
      if (p.chip <= 0) continue;
      const double c = std::cos(p.phi), s = std::sin(p.phi), sk = std::sin(e.kappa), ck = std::cos(e.kappa);
      const Vec3 motion(s, -c, 0), meridian(ck * c, ck * s, sk);
      double ft, fr, fa, dt, dr, da;
      EdgeLaw::component(law_.kt, law_.mt, law_.kte, p.chip, law_.ramp_mm, ft, dt);
      EdgeLaw::component(law_.kr, law_.mr, law_.kre, p.chip, law_.ramp_mm, fr, dr);
      EdgeLaw::component(law_.ka, law_.ma, law_.kae, p.chip, law_.ramp_mm, fa, da);
      const Vec3 f = -e.width * (ft * motion + fr * p.normal + fa * meridian);
      if (sum) *sum += f;
      const double low = 1 - e.level_fraction, high = e.level_fraction;
      force.segment<2>(2 * e.level) += low * f.head<2>();
      force.segment<2>(2 * e.level + 2) += high * f.head<2>();
      if (!slope) continue;
      const Vec3 d = -e.width * (dt * motion + dr * p.normal + da * meridian);
      const Eigen::Matrix2d m = d.head<2>() * change.head<2>().transpose();
      for (int x = 0; x < 2; ++x)
        for (int y = 0; y < 2; ++y)
          slope->block<2, 2>(2 * (e.level + x), 2 * (e.level + y)) += (x ? high : low) * (y ? high : low) * m;
    }
  }

  /// Newton's method with shortened steps; false: no balance was found.
  bool settle(Vec3& sum) {
    const Eigen::Index n = bend_.size();
    Eigen::VectorXd force;
    Eigen::MatrixXd slope;
    if (rigid) {
      bend_.setZero();
      load(bend_, force, nullptr, &sum);
      return true;
    }
    constexpr double kExact_mm = 1e-6, kFar_mm = 1;
    Eigen::VectorXd trial = bend_;
    for (int start = 0; start < 2; ++start) {
      load(trial, force, &slope, &sum);
      Eigen::VectorXd left = flexibility_ * force - trial;
      for (int i = 0; i < 60; ++i) {
        if (left.lpNorm<Eigen::Infinity>() < kExact_mm) {
          bend_ = trial;
          return true;
        }
        if (trial.lpNorm<Eigen::Infinity>() > kFar_mm) break;
        const Eigen::VectorXd step =
            (Eigen::MatrixXd::Identity(n, n) - flexibility_ * slope).partialPivLu().solve(left);
        double fraction = 1;
        const double before = left.norm();
        const Eigen::VectorXd from = trial;
        for (int half = 0; half < 7; ++half, fraction /= 2) {
          trial = from + fraction * step;
          load(trial, force, &slope, &sum);
          left = flexibility_ * force - trial;
          if (left.norm() < (1 - 0.1 * fraction) * before) break;
        }
      }
      trial.setZero();  // once more from the unbent tool
    }
    load(bend_, force, nullptr, &sum);
    return false;
  }

  void step(const Vec3& tip, double behind, Period& period) {
    place_points(tip, behind);
    Vec3 sum = Vec3::Zero();
    if (active_.empty()) {
      bend_.setZero();
    } else if (!settle(sum)) {
      ++period.unsettled;
    }
    period.mean_N += sum / steps_;
    period.lateral_max_N = std::max(period.lateral_max_N, sum.head<2>().norm());
    if (bend_.head<2>().norm() > period.largest_bend.norm()) period.largest_bend = bend_.head<2>();
    for (const std::size_t k : active_)
      if (k % edge_.size() > 0 && now_[k - 1].known && before_[k].known && before_[k - 1].known) cut(k, period);
    std::swap(now_, before_);
  }

  /// Area that the edge between points k - 1 and k has swept since the step before.
  void cut(std::size_t k, Period& period) {
    const Point &a = before_[k - 1], &b = before_[k], &c = now_[k - 1], &d = now_[k];
    const Chart& chart = surface_.chart();
    const Vec3 ca = chart.of(a.place), cb = chart.of(b.place), cc = chart.of(c.place), cd = chart.of(d.place);
    surface_.cut(ca, cb, cc, c.pass);
    surface_.cut(cb, cd, cc, c.pass);
    const double h = (a.chip + b.chip + c.chip + d.chip) / 4;
    if (h <= 0) return;
    const Edge& e = edge_[k % edge_.size()];
    const Vec3 area = 0.5 * (d.place - a.place).cross(b.place - c.place);
    const double mean_square = (a.chip * a.chip + b.chip * b.chip + c.chip * c.chip + d.chip * d.chip) / 4;
    const double fraction = 1 - 0.5 * (e.k1 + e.k2) * mean_square / h + e.k1 * e.k2 * h * h / 3;
    period.chip_mm3 += h * fraction * std::abs(area.dot(c.normal));
  }

  TurningTool tool_;
  EdgeLaw law_;
  HeightMap& surface_;
  int steps_;
  double turn_ = 0;
  std::int32_t passes_ = 0;  ///< a row's passes are new
  std::vector<Edge> edge_;
  std::vector<Point> now_, before_;  ///< tooth by tooth
  std::vector<std::size_t> active_;  ///< points that may touch
  Eigen::MatrixXd flexibility_;
  Eigen::VectorXd bend_;
};

}  // namespace camber::testing
