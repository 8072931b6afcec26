#pragma once
// Static coupling: cuts the stock with the deflected cutter. Each tooth passing is brought to its static equilibrium of
// force and deflection before the next one is cut.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "deflection/run_out_offsets.h"
#include "deflection/tooth_pass.h"
#include "removal/cutter.h"
#include "removal/deflection_table.h"
#include "removal/engagement.h"
#include "removal/tool_path.h"

namespace camber::deflection {

// Decides which tooth passings are read from the stock in static coupling. Where the cut changes slowly, the
// deflections of the others are extrapolated from those that were read.

/// The deflection of a tooth passing that is not read lies between the mean of the last two readings and the straight
/// line through them: where that would have fitted the readings before best. The next reading shows
/// the error of the line, and so the number of passings that may be bridged: the error grows with its square. A
/// passing is always read where the tool begins to cut, where its motion changes, where a glance at the stock finds
/// more or less material than the line predicts, and where no equilibrium was found. Each tooth that differs from the
/// others has a line of its own.
class ReadingPace {
 public:
  static constexpr std::size_t kLongest = 8;

  /// `period`: number of teeth that differ from each other, 1 for uniform ones. `longest`: maximum number of turns of
  /// these teeth from reading to reading; 1 reads every passing.
  explicit ReadingPace(std::size_t period, std::size_t longest = kLongest) : longest_(longest), of_tooth_(period) {}

  /// True where the deflection may be extrapolated, as far as path and earlier readings show; in air every passing is
  /// read, which costs little, lest a glance miss the first material. Call it once for each passing, in order.
  bool may_follow(std::size_t passing, const removal::Stamp& stamp);
  /// True after two readings of the tooth; required by follow() and as_much_material().
  bool has_line(std::size_t passing) const;
  /// Writes the extrapolated deflection, a row of removal::DeflectionTable.
  void follow(std::size_t passing, std::span<float> row) const;
  /// True where the glance (removal::DeflectedEngager::glance) finds the material that the line predicts.
  bool as_much_material(std::size_t passing, double glance) const;

  struct Reading {
    double glance = 0;
    double error_um = 0;    ///< error of the extrapolated deflection, rms over the cut
    double allowed_um = 0;  ///< largest permitted error
    bool settled = true;
  };
  void was_read(std::size_t passing, const removal::Stamp& stamp, std::span<const float> row, const Reading& reading);

  /// Errors at the ends of the lines that bridged passings as planned (not cut short by more or less material).
  struct Errors {
    std::size_t count = 0;
    double sum2_um2 = 0, max_um = 0;
    double rms_um() const { return count == 0 ? 0.0 : std::sqrt(sum2_um2 / static_cast<double>(count)); }
    void add(const Errors& more) {
      count += more.count;
      sum2_um2 += more.sum2_um2;
      max_um = std::max(max_um, more.max_um);
    }
  };
  const Errors& errors() const { return errors_; }

 private:
  struct Tooth {
    std::size_t readings = 0;  ///< since the tool began to cut
    std::size_t last = 0, before = 0;
    std::vector<float> last_row, before_row;
    double last_glance = 0, before_glance = 0;
    double slope_fraction = 1;
    Vec3 feed_mm = Vec3::Zero();
    double way_to(std::size_t passing) const;
    void fit_slope(std::size_t passing, std::span<const float> row);
  };
  Tooth& tooth(std::size_t passing) { return of_tooth_[passing % of_tooth_.size()]; }
  const Tooth& tooth(std::size_t passing) const { return of_tooth_[passing % of_tooth_.size()]; }
  std::size_t next_gap(std::size_t turns, const Reading& reading) const;

  std::size_t longest_;
  std::size_t gap_ = 1;  ///< turns from reading to reading
  double error_um_ = 0;  ///< error at the last reading, or a larger one remembered from earlier readings
  std::vector<Tooth> of_tooth_;
  Errors errors_;
};

// Static equilibrium of force and deflection, delta = C F(chip(delta)), for one tooth passing.

/// Solves the equilibrium of one tooth passing for chips that were read once. With the deflection, the depth of a point
/// and its motion bound change linearly as read; the bound also depends on the tilt of the deflected envelope, that is
/// on the deflections of the previous and next rotation steps. Force follows from its law, including the edge ramp and
/// loss and start of contact. Newton's method over all rotation steps at once; the lateral deflection that feeds back
/// is taken as a straight line over the height (what is left of delta - C F is that of all heights), the axial one is
/// the same at all heights.
class StaticEquilibrium {
 public:
  StaticEquilibrium(const removal::EnvelopeGrid& envelope, const ToothPassModel& model);

  struct Step {
    double rms_um = 0;   ///< rms of the change at the tip over the rotation steps in the cut
    double size_um = 0;  ///< the same for the deflection
    bool solved = true;
    int steps = 0;  ///< steps of Newton's method
  };
  struct Motion {
    removal::ToothMotion of_tool;
    bool first = false;  ///< Stamp::first
  };
  /// chips: as read with the displacements in `row` (of a DeflectionTable): deflections, and `run_out` where there is
  /// any: the axis' offset at each rotation step, mm, or empty. Goes `share` of the way from `row` to the equilibrium
  /// row = run_out + C F; the chips' thickness follows.
  /// With a part that yields the row has its deflection as well, and what of it is the part's.
  Step solve(std::span<removal::DeflectedChipSample> chips, std::size_t passing, const Motion& motion, double share,
             std::span<const Vec2> run_out, std::span<float> row);

 private:
  struct Ring {
    removal::NodeWeight weight;  ///< upper: the node above, where there is one
    double height_fraction;      ///< from the first node to the last
    double sine, per_radius;
  };
  struct Element {
    Vec2 normal, tangential, meridian, deeper;
    double normal_z, meridian_z, deeper_z;
    double depth_mm, cap_mm;  ///< as read
    double thickness_mm;      ///< the lesser of them, or a tooth's that is not even
    double by_step,
        by_height;   ///< derivatives of the tilt by the deflections of the neighbouring steps and of the nodes
    double lean_mm;  ///< as read
    double width_mm;
    double solved_mm;  ///< thickness with the deflection as it is
    std::uint32_t ring, chip;
  };
  void place_elements(std::span<const removal::DeflectedChipSample> chips, std::size_t passing, const Motion& motion);
  Element element(const EdgeElement& found, const removal::DeflectedChipSample& chip,
                  const removal::ToothMotion& motion) const;
  void place_deflections();
  void place_axial();
  Vec2 at_ring(const std::vector<double>& deflection, const Ring& ring, std::size_t m) const;
  double lean_mm(const Element& e, std::size_t m) const;
  void balance(std::size_t m);
  /// Derivatives of an element's thickness by the deflections of its own rotation step, and of those beside it.
  struct ThicknessChange {
    std::array<double, 4> own{}, side{};  ///< by the lateral ones, at the first and at the last node
    double own_axial = 0, side_axial = 0;
  };
  /// Contribution of one element to the balance of the axial deflection, and to the derivatives of that balance.
  void balance_axial(std::size_t m, double force_z, double slope_z, const ThicknessChange& by);
  double balance_all();
  void gather_part(const Element& e, std::size_t m, const Vec2& force, double force_z, const Vec2& slope,
                   double slope_z, const ThicknessChange& by);
  void balance_part(std::size_t m);
  void keep_part(double share, std::span<float> row) const;
  template <int kUnknowns>
  void solve_coarse();
  void advance();
  void advance_axial(std::size_t m, std::size_t ahead, std::size_t behind, bool stays);
  void step_from(const std::vector<double>& from, const std::vector<double>& axial_from, double way);
  void creep(Step& out);

  const removal::EnvelopeGrid& envelope_;
  const ToothPassModel& model_;
  std::size_t steps_, nodes_;
  std::vector<Ring> rings_;
  std::vector<EdgeElement> found_;
  std::vector<std::size_t> place_;  ///< indices of the elements found, in elements_
  std::vector<Element> elements_;   ///< rotation step by rotation step
  std::vector<std::size_t> first_;  ///< first element of each rotation step
  double max_lean_mm_ = 0;
  bool first_stamp_ = false;
  std::span<const Vec2> run_out_;  ///< run-out at the rotation steps, mm; empty: none
  bool axial_;                     ///< the tool, or the part, yields along the axis
  // The part, where it yields: compliance of this passing; of rings and nodes their share of its heights; by rotation
  // step what its heights take, [steps][size], how that changes with the coarse deflections and the axial one of its
  // own step and of those beside it, [steps][size][5], and how they move, [steps][size].
  const PartCompliance* part_;
  Eigen::MatrixXd part_mm_per_N_;
  std::vector<HeightWeight> part_ring_;
  std::vector<double> part_N_, part_by_own_, part_by_side_, part_mm_;
  // [steps]: the axial deflection, as the lateral ones below.
  std::vector<double> axial_read_, axial_deflection_, axial_moved_, axial_side_, axial_left_, axial_step_;
  std::vector<double> axial_coarse_;
  /// [steps][5]: of C F along the axis, by the lateral deflections at the first and last node and by the axial one.
  std::vector<double> axial_by_own_, axial_by_side_;
  /// [steps][nodes][2]: of the lateral C F by the axial deflections.
  std::vector<double> by_own_axial_, by_side_axial_;
  // [steps][nodes][2]:
  std::vector<double> read_, deflection_;
  std::vector<double> moved_, side_;  ///< deflection less the one that was read; of the step ahead less of that behind
  std::vector<double> left_;          ///< C F - delta
  std::vector<double> step_;          ///< Newton's
  std::vector<double> by_own_,
      by_side_;                  ///< [steps][nodes][2][4]: of C F, by the deflections at the first and last node
  std::vector<double> coarse_;   ///< [steps][4]: Newton's step there
  std::vector<double> damping_;  ///< [steps]: how much slower than Newton's step a deflection follows
  std::vector<double> norm_;     ///< [steps]: largest of left_
  std::vector<char> stale_;      ///< [steps]: deflections have changed since left_ was worked out
};

/// Why no static equilibrium was found for a tooth passing.
enum class NoEquilibrium {
  pulled_in,   ///< the force grows faster with the chip than the restoring force: the deflection into the material
               ///< diverges
  pushed_out,  ///< the tool deflects away by more than removal::DeflectedEngager::kMaxDeflection_mm
  swings,      ///< the deflection alternates from reading to reading
};

struct SettleOptions {
  int max_rounds = 40;     ///< maximum number of readings of the chips of a stamp
  double settle_um = 0.1;  ///< converged if the next reading changes the deflection by less than this, rms over the
                           ///< cut, or by less than ...
  double settle_fraction = 0.01;                    ///< ... this fraction of its rms
  double follow_um = 0.1, follow_fraction = 0.02;   ///< permitted error of an extrapolated deflection, likewise
  std::size_t longest_gap = ReadingPace::kLongest;  ///< largest number of passings from reading to reading
};

/// The surface left by one tooth passing determines the next one. Each is brought to its equilibrium by reading its
/// chips and solving for them (StaticEquilibrium), repeatedly, and then cut. Run-out of equally spaced teeth is an
/// offset of the axis that turns with the tool: the rows contain deflection plus offset, and the chip of each tooth
/// follows from the surface left by the previous ones. Where the cut changes slowly, only some passings are read, and
/// the deflections of the others are extrapolated (ReadingPace). These are glanced at together, before the passing that
/// was read is carved, and carved together with it.
class StaticCut {
 public:
  /// The whole run.
  struct Path {
    std::span<const removal::Stamp> stamps;
    std::int32_t first_id = 0;  ///< of the first stamp
    const removal::KnownRun* known = nullptr;
  };
  StaticCut(removal::Stock& stock, const removal::Stock& blank, const removal::EnvelopeGrid& envelope,
            const ToothPassModel& model, const Path& path, const SettleOptions& options, const RunOutOffsets& run_out,
            std::size_t different_teeth = 1)
      : stamps_(path.stamps),
        options_(options),
        run_out_(run_out),
        envelope_(envelope),
        engager_(stock, blank, envelope, path.stamps, path.first_id, path.known),
        equilibrium_(envelope, model),
        pace_(different_teeth, options.longest_gap) {}

  /// See removal::DeflectedEngager::remember.
  void remember(std::size_t from, std::span<const float> rows, std::size_t row_size, double largest_mm) {
    engager_.remember(from, rows, row_size, largest_mm);
  }
  /// Starts the stretch stamps[from] ... stamps[from + count - 1]. Row -1 of `deflections` belongs to the stamp before;
  /// the other rows are filled as their stamps are cut. `must_read(k)`: true for passings that have to be read.
  void start(std::size_t from, std::size_t count, removal::DeflectionTable& deflections,
             std::function<bool(std::size_t k)> must_read);

  struct Passing {
    int rounds = 0;  ///< 0: not read; the deflection was extrapolated
    bool settled = true;
    NoEquilibrium reason = NoEquilibrium::swings;  ///< why it has not settled
    std::span<const removal::ChipSample> chips;    ///< as they were read; valid until the call after the next reading
  };
  /// Cuts stamps[from + k], for k = 0, 1 ... in order. If the static deflection does not converge, the closest
  /// approximation is used; if it exceeds removal::DeflectedEngager::kMaxDeflection_mm, that of the previous stamp.
  Passing cut(std::size_t k);
  /// Returns the errors of the extrapolated deflections, as the readings after them show.
  const ReadingPace::Errors& extrapolation_errors() const { return pace_.errors(); }
  /// Writes the cut to the stock. Returns the volume removed since the last commit, mm^3.
  double commit() { return engager_.commit(); }

 private:
  NoEquilibrium beyond_reach(std::span<const float> row) const;
  void start_from_before(std::size_t k, std::span<float> row) const;
  bool follow(std::size_t k);
  std::size_t followers(std::size_t k);
  void carve_to(std::size_t end);
  bool rests(std::span<const float> row, const StaticEquilibrium::Step& step) const;

  std::span<const removal::Stamp> stamps_;
  SettleOptions options_;
  const RunOutOffsets& run_out_;
  const removal::EnvelopeGrid& envelope_;
  removal::DeflectedEngager engager_;
  StaticEquilibrium equilibrium_;
  ReadingPace pace_;
  std::size_t from_ = 0, count_ = 0;
  std::function<bool(std::size_t)> must_read_;
  std::size_t carved_ = 0;     ///< number of stamps of the stretch that are carved
  std::size_t reglanced_ = 0;  ///< where the last glance found other material than predicted
  removal::DeflectionTable* deflections_ = nullptr;
  std::vector<removal::DeflectedChipSample> read_;
  std::array<std::vector<removal::ChipSample>, 2> chips_;  ///< this reading's and the previous one's, alternating
  std::size_t readings_ = 0;
  int unsettled_in_a_row_ = 0;  ///< number of readings
  std::vector<float> swing_;    ///< the deflection a few readings ago
};

}  // namespace camber::deflection
