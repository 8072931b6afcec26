#pragma once
// How near the tooth passings of a program are to chatter (simulate/chatter.h).
#include <cstddef>
#include <cstdint>
#include <vector>

namespace camber::simulate {

/// The tooth passings of one tool at one spindle speed.
struct ChatterOperation {
  int tool = 0;
  double speed_rpm = 0;
  bool measured = false;  ///< the tool's modes are given; else they are its beam's, with a usual damping
  std::size_t line = 0;   ///< 1-based, of the worst passing
  double margin = 0;      ///< depth over critical depth there; above 1 the cut is unstable
  double chatter_hz = 0;  ///< heard at its border
  double depth_mm = 0, arc_rad = 0, centre_rad = 0, kt_MPa = 0,
         kr_MPa = 0;                       ///< the cut there (dynamics/vibrating_cut.h)
  double probability = 0;                  ///< that it chatters, with the modes at their errors
  double margin_low = 0, margin_high = 0;  ///< of eight of ten draws of the modes within their errors
  double stable_speed_rpm = 0;  ///< nearest speed within the spindle's limits with a margin of kAdvisedMargin; 0: none
  double stable_depth_mm = 0;   ///< critical depth there at the programmed speed
  std::vector<std::size_t> lines{};  ///< with unstable passings, ascending
};
constexpr double kAdvisedMargin = 0.8;

struct ChatterMargins {
  struct Passage {
    float margin = 0;  ///< 0: no cut
    float hz = 0;
  };
  std::vector<Passage> passages{};              ///< one per stamp; empty: nothing is milled
  std::vector<std::uint32_t> invalid_stamps{};  ///< whose forces and errors are not those of a stable cut
  std::vector<ChatterOperation> operations{};   ///< in the order in which they begin

  Passage of(std::size_t stamp) const { return passages.empty() ? Passage{} : passages[stamp]; }
};

}  // namespace camber::simulate
