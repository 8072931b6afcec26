#pragma once
// How far a compensation has come as a whole, by the rounds that it is likely to take.
#include <string>
#include <string_view>

namespace camber::cli {

/// Every step of a compensation is a prediction of a whole program and takes about as long as the others. How many
/// rounds it takes is known at the end only: 3 are expected, or as many as max_rounds allows, and one more whenever
/// there is another.
class RoundsProgress {
 public:
  /// further: predictions after the rounds, for other voxels and the uncertainty.
  RoundsProgress(int max_rounds, int further);

  struct Whole {
    std::string what;  ///< "round 2 of about 3 (8 at most)"
    double share = 0;  ///< fraction of all that is expected, 0 to 1
  };
  /// A step as compensate() names it ("as given", "round 2"), and the share of it that is done.
  Whole at(std::string_view what, double share);

 private:
  int max_rounds_, further_;
  int expected_rounds_;
  int begun_ = 0;   ///< steps, the one that goes on included
  int before_ = 0;  ///< steps before the first round
  int rounds_ = 0;  ///< begun
  std::string step_;
};

}  // namespace camber::cli
