#pragma once
// The points between which the machine of a rewritten program moves. Internal to repath/post/post_processing.cpp.
#include <span>
#include <vector>

#include "repath/post/post_motions.h"
#include "repath/post/post_processing.h"

namespace camber::repath {

struct PostPoint {
  Vec3 tip_mm = Vec3::Zero();      ///< in the machine frame, carried along by the part
  Vec3 linear_mm = Vec3::Zero();   ///< joints
  Vec3 rotary_deg = Vec3::Zero();  ///< as written
  double from = 0, to = 1;         ///< share of the move that leads here
  double time_s = 0;               ///< 0: a rapid
  bool rapid = false;
  bool extra = false;  ///< of axes that turn back
};

/// The rounding of the written words.
struct PostRounding {
  int decimals_mm = 4, decimals_inch = 5, decimals_deg = 4;
  /// Bound of what rounding moves the tip by.
  double tip_mm(bool inch, const nc::Frame& frame) const;
  Vec3 deg(const Vec3& rotary_rad) const;
};

struct DividedMotion {
  std::vector<PostPoint> points;  ///< the last one is the end of the move
  double bound_mm = 0;            ///< rounding included
  double axis_bound_rad = 0;      ///< of the tool's direction, but for rounding
  std::size_t one_degree_blocks = 0;
  double one_degree_bound_mm = 0;
};

class Divider {
 public:
  Divider(const MotionFrame& frame, const machine::Machine& machine, const PostOptions& options,
          const PostRounding& rounding)
      : frame_(frame), machine_(machine), options_(options), rounding_(rounding) {}

  /// `rounding_mm`: of the tip. The part of a move in its stretches; `turns_back` gets what happens between them.
  DividedMotion divide(const TipMotion& motion, std::span<const PlannedStretch> stretches, double rounding_mm,
                       std::vector<TurnBack>& turns_back) const;

 private:
  void go(const TipMotion& motion, const RotaryChoice& choice, double from, double to, double tolerance_mm, bool extra,
          DividedMotion& out) const;
  std::vector<double> cuts_within(const TipMotion& motion, const RotaryChoice& choice, double from, double to,
                                  double tolerance_mm) const;
  std::vector<double> even_cuts(const TipMotion& motion, const RotaryChoice& choice, double from, double to,
                                double tolerance_mm) const;
  double farthest(const TipMotion& motion, const RotaryChoice& choice, double from, double to,
                  double tolerance_mm) const;
  std::vector<double> one_degree_cuts(const TipMotion& motion, double from, double to) const;
  double bound(const TipMotion& motion, const RotaryChoice& choice, double from, double to) const;
  PostPoint point(const TipMotion& motion, const RotaryChoice& choice, double from, double to) const;
  TurnBack turn_back(const TipMotion& motion, const PlannedStretch& stretch, DividedMotion& out) const;
  double retract_within_travel(const TipMotion& turn, const Vec3& axis) const;

  const MotionFrame& frame_;
  const machine::Machine& machine_;
  const PostOptions& options_;
  const PostRounding& rounding_;
};

}  // namespace camber::repath
