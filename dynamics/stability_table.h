#pragma once
// Critical depths of one tool at one speed over arcs of engagement, worked out where they are first asked for.
#include <cstdint>
#include <unordered_map>

#include "dynamics/vibrating_cut.h"
#include "dynamics/zero_order.h"

namespace camber::dynamics {

/// An engagement of a single arc.
struct ArcCut {
  double arc_rad = 0;     ///< angle
  double centre_rad = 0;  ///< centre of the arc, as angles of dynamics/vibrating_cut.h
  double kt_MPa = 0, kr_MPa = 0;
};

/// Standard errors of modes, relative.
struct ModeErrors {
  double frequency = 0, damping = 0, stiffness = 0;  ///< standard deviations of their logarithms
};
/// Process damping (Cut::process_damping_N_per_mm) that nobody knows: a length times kt, and the error of its
/// logarithm. 200 N/mm in a steel of 2000 MPa; 611 were identified in AISI 1045 (Altintas, Eynian, Onozuka 2008).
constexpr double kProcessDamping_mm = 0.1, kProcessDampingError = 0.8;

/// Standard deviations of the logarithms of modes. Measured modes: repeatability of a tap test on another day; modes
/// of a beam with a usual damping: the spread of holders and spindles.
constexpr ModeErrors kMeasuredModeErrors{.frequency = 0.01, .damping = 0.15, .stiffness = 0.1};
constexpr ModeErrors kBeamModeErrors{.frequency = 0.1, .damping = 0.6, .stiffness = 0.25};

class StabilityTable {
 public:
  /// `tool`: its pitches, lag and radius; slices do not matter.
  StabilityTable(std::vector<Mode> modes, Cut tool, double speed_rpm, ModeErrors errors);

  /// Between nodes the reciprocal of the depth is drawn straight, over the arc, its centre and kr / kt. Of a tool that
  /// is alike in x and y the centre does not matter. Where teeth cut less than kShortCut of the time, are unequal or
  /// helical, the nodes are semi-discretised, at up to kLowLobes vibrations a period and from kShortestArc_rad on; else
  /// of zero order.
  CriticalDepth at(const ArcCut& cut);

  /// The exact one, of the same method.
  CriticalDepth exactly_at(const ArcCut& cut) const;
  /// Limit of zero order, whatever the cut.
  CriticalDepth zero_order_at(const ArcCut& cut) const;
  /// Critical depths at other speeds: by semi-discretisation where the cut is short or the teeth unequal, else of
  /// zero order.
  std::vector<CriticalDepth> at_speeds(const ArcCut& cut, const std::vector<double>& speeds_rpm) const;

  /// The probability that a depth is unstable: the fraction of kDraws draws of the modes within their errors, of zero
  /// order, with a drawn process damping: it adds to the damping of the mode that is heard, and the critical depth
  /// grows with that.
  double probability(const ArcCut& cut, double depth_mm) const;
  /// The critical depths of these draws, ascending.
  std::vector<double> drawn_depths(const ArcCut& cut) const;
  /// The critical depth with frequency, damping and stiffness of all modes times these factors, by the method of
  /// exactly_at.
  CriticalDepth with_modes_times(const ModeErrors& factors, const ArcCut& cut) const;
  /// The depth of this probability, of the node next to the cut.
  double depth_of_probability(const ArcCut& cut, double probability);
  static constexpr int kDraws = 100;
  static constexpr double kShortCut = 0.35, kLowLobes = 10, kShortestArc_rad = 0.05;

 private:
  struct Node {
    double flexibility = 0;  ///< kt / 1000 MPa over the critical depth
    double hz = 0;
  };
  struct NodePlace {
    int arc = 0, centre = 0, ratio = 0;
  };
  static std::uint64_t key(const NodePlace& place);
  ArcCut cut_of(const NodePlace& place) const;
  const Node& node(const NodePlace& place);
  Cut cut_with(const ArcCut& cut) const;
  bool needs_semi_discretisation(const ArcCut& cut) const;
  bool short_or_unequal(const ArcCut& cut) const;

  std::vector<Mode> modes_;
  Cut tool_;
  double speed_rpm_;
  ModeErrors errors_;
  bool alike_;  ///< in x and y
  double period_s_, highest_hz_;
  std::unordered_map<std::uint64_t, Node> nodes_;
  std::unordered_map<std::uint64_t, std::vector<double>> draws_;
};

}  // namespace camber::dynamics
