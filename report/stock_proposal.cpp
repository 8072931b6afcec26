#include "report/job_proposal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "machine/program_comments.h"
#include "nc/known_places.h"
#include "nc/summary.h"

namespace camber::report {
namespace {

constexpr double kSide_mm = 2, kBelow_mm = 1, kAboveHighest_mm = 1;
constexpr double kMaxCells = 240;  // along the longer side
constexpr double kMinCell_mm = 0.25;
constexpr double kTouch_mm = 0.02;        // rapids may lie on a surface
constexpr double kUseful = 0.5;           // of what the program could remove: a box with less is no blank
constexpr double kOftenBeside = 0.6;      // of the path: a blank that the program gives for its graphics alone
constexpr double kHalfDiagonal = 0.7072;  // of a cell: the one that a line goes through is always met
constexpr int kTops = 12;                 // heights between the highest pass and the wanted top that are tried
constexpr double kNever = std::numeric_limits<double>::infinity();

bool is_cut(const nc::Move& m) {
  return (m.kind == nc::MoveKind::linear || m.kind == nc::MoveKind::arc) && !m.reference;
}
bool is_rapid(const nc::Move& m) { return m.kind == nc::MoveKind::rapid && !m.reference; }
double across_mm(const nc::Move& m) { return (m.end_mm - m.start_mm).head<2>().norm(); }
bool is_lateral(const nc::Move& m) { return m.kind == nc::MoveKind::arc || across_mm(m) > 0; }

/// The lower end of a cutter: its height above the tip at a distance from the axis.
struct Profile {
  double radius_mm = 0;
  double corner_mm = 0;
  double slope = 0;  ///< of a cone

  double height_mm(double from_axis_mm) const {
    if (slope > 0) return slope * from_axis_mm;
    const double in_corner = from_axis_mm - (radius_mm - corner_mm);
    return in_corner <= 0 ? 0 : corner_mm - std::sqrt(std::max(0.0, corner_mm * corner_mm - in_corner * in_corner));
  }
};

Profile profile_of(const machine::ToolProposal& tool) {
  Profile p;
  p.radius_mm = tool.diameter_mm.value_or(0) / 2;
  if (!tool.type) return p;
  if (*tool.type == machine::ToolType::ball) p.corner_mm = p.radius_mm;
  if (*tool.type == machine::ToolType::bull) p.corner_mm = std::min(tool.corner_radius_mm.value_or(0), p.radius_mm);
  if (*tool.type == machine::ToolType::drill || *tool.type == machine::ToolType::chamfer) {
    const double point_deg = tool.point_angle_deg.value_or(*tool.type == machine::ToolType::drill ? 118 : 90);
    p.slope = 1 / std::tan(point_deg / 2 * kPi / 180);
  }
  return p;
}

struct Rectangle {
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0;  ///< cells, the second ends not included
  bool operator==(const Rectangle&) const = default;
};

/// Heights that the program has cut, and how high the blank may stand in each cell without a rapid touching it.
class Map {
 public:
  Map(const Vec3& low, const Vec3& high) : low_(low) {
    const Vec3 size = high - low;
    cell_ = std::max(kMinCell_mm, size.head<2>().maxCoeff() / kMaxCells);
    nx_ = static_cast<int>(std::ceil(size.x() / cell_));
    ny_ = static_cast<int>(std::ceil(size.y() / cell_));
    cut_.assign(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_), kNever);
    highest_ = cut_;
  }

  /// top_mm: of the blank.
  MetMaterial cut(const Vec3& tip, const Profile& p, double top_mm, double step_mm) {
    MetMaterial met;
    double fresh = 0;  // cells that nothing has cut
    visit(tip, p, 0, [&](std::size_t i, double z) {
      const double depth = std::min(cut_[i], top_mm) - z;
      met.depth_mm = std::max(met.depth_mm, depth);
      if (depth > 0) met.above_tip_mm = std::max(met.above_tip_mm, z + depth - tip.z());
      fresh += depth > 0 && cut_[i] == kNever;
      cut_[i] = std::min(cut_[i], z);
    });
    const double swept_mm2 = 2 * p.radius_mm * std::max(step_mm, cell_);
    if (swept_mm2 > 0) met.width_fraction = fresh * cell_ * cell_ / swept_mm2;
    return met;
  }
  void pass(const Vec3& tip, const Profile& p) {
    visit(tip, p, -cell_, [&](std::size_t i, double z) {
      if (cut_[i] > z + kTouch_mm) highest_[i] = std::min(highest_[i], z);
    });
  }

  double cell_mm() const { return cell_; }
  Rectangle all() const { return {0, nx_, 0, ny_}; }
  /// A cell smaller at the sides that are taken back: rapids are looked at in cells that they reach for certain.
  Rectangle inside(Rectangle r) const {
    const Rectangle whole = all();
    r.x0 += r.x0 > whole.x0;
    r.y0 += r.y0 > whole.y0;
    r.x1 -= r.x1 < whole.x1;
    r.y1 -= r.y1 < whole.y1;
    return r;
  }
  double x_mm(int cell) const { return low_.x() + cell * cell_; }
  double y_mm(int cell) const { return low_.y() + cell * cell_; }

  /// Returns the volume that the program removes below `top_mm` over each rectangle from the corner, cell^2 mm.
  /// Material that it leaves counts for little.
  std::vector<double> removed_sums(double top_mm) const {
    constexpr double kLeft_mm = 1e-3;
    const std::size_t row = static_cast<std::size_t>(nx_) + 1;
    std::vector<double> sums(row * (static_cast<std::size_t>(ny_) + 1), 0.0);
    for (int y = 0; y < ny_; ++y) {
      double so_far = 0;
      for (int x = 0; x < nx_; ++x) {
        so_far += std::max(kLeft_mm, top_mm - cut_[index(x, y)]);
        const std::size_t at = (static_cast<std::size_t>(y) + 1) * row + static_cast<std::size_t>(x) + 1;
        sums[at] = sums[at - row] + so_far;
      }
    }
    return sums;
  }
  double sum_over(const std::vector<double>& sums, const Rectangle& r) const {
    const auto at = [&](int x, int y) {
      return sums[static_cast<std::size_t>(y) * (static_cast<std::size_t>(nx_) + 1) + static_cast<std::size_t>(x)];
    };
    return at(r.x1, r.y1) - at(r.x0, r.y1) - at(r.x1, r.y0) + at(r.x0, r.y0);
  }

  /// Returns the rectangle with the largest sum whose cells may all stand up to `top_mm`, found under the histogram of
  /// each row.
  Rectangle best(double top_mm, const std::vector<double>& sums) const {
    Rectangle best;
    double most = 0;
    std::vector<int> height(static_cast<std::size_t>(nx_) + 1, 0);
    for (int y = 0; y < ny_; ++y) {
      for (int x = 0; x < nx_; ++x) {
        int& h = height[static_cast<std::size_t>(x)];
        h = highest_[index(x, y)] >= top_mm ? h + 1 : 0;
      }
      under_histogram(height, y, [&](const Rectangle& r) {
        const double sum = sum_over(sums, r);
        if (sum > most) best = r, most = sum;
      });
    }
    return best;
  }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(x);
  }

  template <class Do>
  void visit(const Vec3& tip, const Profile& p, double wider_mm, const Do& act) {
    const double r = std::max(0.0, p.radius_mm + wider_mm);
    const auto clamped = [&](double v, double low, int count) {
      return std::clamp(static_cast<int>(std::floor((v - low) / cell_)), 0, count - 1);
    };
    const int x0 = clamped(tip.x() - r, low_.x(), nx_), x1 = clamped(tip.x() + r, low_.x(), nx_);
    const int y0 = clamped(tip.y() - r, low_.y(), ny_), y1 = clamped(tip.y() + r, low_.y(), ny_);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const double d = std::hypot(x_mm(x) + cell_ / 2 - tip.x(), y_mm(y) + cell_ / 2 - tip.y());
        if (d <= std::max(r, kHalfDiagonal * cell_)) act(index(x, y), tip.z() + p.height_mm(std::min(d, p.radius_mm)));
      }
  }

  /// Bars of `height` that end in row y; the last bar is empty.
  template <class Take>
  static void under_histogram(const std::vector<int>& height, int y, const Take& take) {
    std::vector<int> open;  // bars of rising height
    for (int x = 0; x < static_cast<int>(height.size()); ++x) {
      while (!open.empty() && height[static_cast<std::size_t>(open.back())] >= height[static_cast<std::size_t>(x)]) {
        const int h = height[static_cast<std::size_t>(open.back())];
        open.pop_back();
        take({open.empty() ? 0 : open.back() + 1, x, y + 1 - h, y + 1});
      }
      open.push_back(x);
    }
  }

  Vec3 low_;
  double cell_ = 1;
  int nx_ = 0, ny_ = 0;
  std::vector<double> cut_, highest_;
};

class Proposer {
 public:
  Proposer(const nc::Program& text, const nc::Interpretation& moves, const ToolsByNumber& tools)
      : text_(text), moves_(moves) {
    for (const auto& [number, tool] : tools) profiles_[number] = profile_of(tool);
    tools_ = tools;
  }

  std::optional<StockProposal> run() {
    const nc::Extents swept = swept_box();
    if (swept.empty()) return std::nullopt;
    if (auto told = told_box(swept)) return told;
    low_ = swept.min_mm - Vec3(kSide_mm, kSide_mm, kBelow_mm);
    high_ = swept.max_mm + Vec3(kSide_mm, kSide_mm, 0);
    StockProposal out;
    const double pass = highest_pass_mm();
    const bool below_zero = pass < -kTouch_mm;
    const double wanted = below_zero ? 0 : pass + kAboveHighest_mm;
    out.top = below_zero ? "the program's Z0, below which all cutting lies"
                         : fmt::format("{:g} mm above the highest pass", kAboveHighest_mm);
    Map map(low_, high_);
    run_through(map, wanted);
    choose(map, pass, wanted, out);
    look_at_depths(out);
    return out;
  }

 private:
  /// The blank that the program or a comment gives.
  std::optional<StockProposal> told_box(const nc::Extents& swept) {
    bool inch = false;
    for (const nc::ModalState& state : moves_.states) inch = inch || state.inch;
    StockProposal out;
    if (moves_.stock) {
      const nc::Block& line = text_.blocks[moves_.stock->block];
      out.told = fmt::format("{}:{}: {}", text_.source.name(), moves_.stock->block + 1,
                             text_.source.text().substr(line.offset, line.length));
      out.box = {moves_.stock->min_mm, moves_.stock->max_mm};
    } else if (const auto comment = machine::stock_in_comments(text_.source, inch)) {
      out.told = fmt::format("{}: ({})", comment->from, comment->what);
      out.box = comment->box ? *comment->box : placed(*comment, out.placed);
    } else {
      return std::nullopt;
    }
    const Vec3 low = out.box.min_mm.cwiseMax(swept.min_mm);
    Vec3 high = out.box.max_mm.cwiseMin(swept.max_mm);
    high.z() = out.box.max_mm.z();  // cutters reach up from their tips
    if (((high - low).array() <= 0).any()) return std::nullopt;
    low_ = swept.min_mm - Vec3(kSide_mm, kSide_mm, kBelow_mm);
    high_ = swept.max_mm + Vec3(kSide_mm, kSide_mm, 0);
    Map map(low_, high_);
    const double top = out.box.max_mm.z();
    run_through(map, top);
    const auto sums = map.removed_sums(top);
    out.in_the_way = map.best(top, sums) != map.all();
    const double beside = share_beside(out.box);
    if (beside > kOftenBeside && out.placed.empty())
      out.placed = fmt::format("CHECK: {:.0f} % of the cutting path runs beside or above it", 100 * beside);
    look_at_depths(out);
    return out;
  }

  /// Returns the share of the cutting path, ways straight up and down apart, on which the cutter is beside or above
  /// the box; of a program without any other, the share of these.
  double share_beside(const machine::Box& box) {
    const bool across = std::ranges::any_of(moves_.moves, [](const nc::Move& m) { return is_cut(m) && is_lateral(m); });
    double beside_mm = 0, all_mm = 0;
    for (const nc::Move& m : moves_.moves) {
      if (!is_cut(m) || (across && !is_lateral(m))) continue;
      const double r = profile_of_move(m).radius_mm - kTouch_mm, length_mm = nc::length_mm(moves_, m);
      const int steps = std::clamp(static_cast<int>(std::ceil(length_mm / std::max(r, 1.0))), 1, 1000);
      all_mm += length_mm;
      for (int i = 0; i < steps; ++i) {
        const Vec3 tip = nc::point_at(moves_, m, (i + 0.5) / steps);
        const Vec3 out = (box.min_mm - tip).cwiseMax(tip - box.max_mm).cwiseMax(0.0);
        if (tip.z() >= box.max_mm.z() || std::hypot(out.x(), out.y()) >= std::max(r, kTouch_mm))
          beside_mm += length_mm / steps;
      }
    }
    return all_mm > 0 ? beside_mm / all_mm : 0;
  }

  /// Places a blank of known size: Z0 on top, or below where cuts lie above it; X0 Y0 in the middle or in the corner,
  /// whichever holds the path of the tips.
  machine::Box placed(const machine::CommentedStock& stock, std::string& how) {
    const Vec3& size = *stock.size_mm;
    nc::Extents tips;
    for (const nc::Move& m : moves_.moves)
      if (is_cut(m)) {
        const nc::Extents e = nc::extents_of(moves_, m);
        tips.add(e.min_mm);
        tips.add(e.max_mm);
      }
    const auto outside = [&](const Vec3& low) {
      return (low - tips.min_mm).head<2>().cwiseMax(0.0).sum() +
             (tips.max_mm - low - size).head<2>().cwiseMax(0.0).sum();
    };
    const Vec3 corner(0, 0, 0), middle(-size.x() / 2, -size.y() / 2, 0);
    const bool centred = stock.zero_in_centre.value_or(outside(middle) < outside(corner));
    const bool on_table = stock.zero_on_table.value_or(highest_pass_mm() > kTouch_mm);
    if (!stock.zero_in_centre || !stock.zero_on_table)
      how = fmt::format("X0 Y0 {}, Z0 {}, where it holds the path",
                        centred ? "in the middle" : "in the lower left corner", on_table ? "on the table" : "on top");
    machine::Box box{centred ? middle : corner, {}};
    box.min_mm.z() = on_table ? 0 : -size.z();
    box.max_mm = box.min_mm + size;
    return box;
  }

  const Profile& profile_of_move(const nc::Move& m) { return profiles_[moves_.state_of(m).tool]; }

  nc::Extents swept_box() {
    nc::Extents box;
    for (const nc::Move& m : moves_.moves) {
      if (!is_cut(m)) continue;
      const nc::Extents e = nc::extents_of(moves_, m);
      const double r = profile_of_move(m).radius_mm;
      box.add(e.min_mm - Vec3(r, r, 0));
      box.add(e.max_mm + Vec3(r, r, 0));
    }
    return box;
  }

  /// Height at which half of the way of all level rapids lies, or more; where there are none, the lowest end of a
  /// rapid.
  double travel_height_mm() const {
    nc::KnownPlaces places(text_, moves_);
    std::vector<std::pair<double, double>> levels;
    double all = 0, lowest = kNever;
    for (const nc::Move& m : moves_.moves) {
      const nc::KnownPlaces::Ends known = places.next(m);
      if (!is_rapid(m) || !known.end) continue;
      lowest = std::min(lowest, m.end_mm.z());
      if (!known.start || std::abs(m.end_mm.z() - m.start_mm.z()) > kTouch_mm || across_mm(m) == 0) continue;
      levels.emplace_back(m.end_mm.z(), across_mm(m));
      all += across_mm(m);
    }
    std::ranges::sort(levels);
    double so_far = 0;
    for (const auto& [z, length] : levels)
      if ((so_far += length) >= all / 2) return z;
    return lowest;
  }

  /// Returns the height of the highest cutting move across, by its lower end; with plunges alone the deepest.
  double highest_pass_mm() const {
    const double travel = travel_height_mm();
    double pass = -kNever, lowest = kNever;
    for (const nc::Move& m : moves_.moves) {
      if (!is_cut(m)) continue;
      const double z = std::min(m.start_mm.z(), m.end_mm.z());
      lowest = std::min(lowest, z);
      if (is_lateral(m) && z < travel - kTouch_mm) pass = std::max(pass, z);
    }
    return pass > -kNever ? pass : lowest;
  }

  void look_at_depths(StockProposal& out) const {
    if (!depths_.finishing_alone()) return;
    out.finishes = depths_.deepest();
    out.allowance_mm = depths_.usual_allowance_mm();
  }

  void run_through(Map& map, double top_mm) {
    nc::KnownPlaces places(text_, moves_);
    for (const nc::Move& m : moves_.moves) {
      const nc::KnownPlaces::Ends known = places.next(m);
      if (!is_cut(m) && !(is_rapid(m) && known.end)) continue;
      const Profile& p = profile_of_move(m);
      const double step = std::max(map.cell_mm() / 2, std::min(p.radius_mm / 4, 2.0));
      const int steps = std::clamp(static_cast<int>(std::ceil(nc::length_mm(moves_, m) / step)), 1, 20000);
      for (int i = is_rapid(m) && !known.start ? steps : 0; i <= steps; ++i) {
        const Vec3 tip = nc::point_at(moves_, m, static_cast<double>(i) / steps);
        if (is_rapid(m) && !over_box(tip, p.radius_mm)) continue;
        if (is_rapid(m) || lands_beside(m, p)) map.pass(tip, p);
        if (is_rapid(m)) continue;
        const double step_mm = nc::length_mm(moves_, m) / steps;
        const MetMaterial met = map.cut(tip, p, top_mm, step_mm);
        if (is_lateral(m)) depths_.add(tools_[moves_.state_of(m).tool], met, step_mm);
      }
    }
  }

  /// A feed straight down with a milling cutter so large that its edges do not reach the axis: as a rapid, it goes down
  /// where there is no material.
  bool lands_beside(const nc::Move& m, const Profile& p) const {
    constexpr double kLarge_mm = 12;
    return p.radius_mm >= kLarge_mm && p.slope == 0 && p.corner_mm < p.radius_mm && !is_lateral(m) &&
           m.end_mm.z() < m.start_mm.z();
  }

  bool over_box(const Vec3& tip, double radius) const {
    return ((tip - low_).head<2>().array() > -radius).all() && ((high_ - tip).head<2>().array() > -radius).all();
  }

  /// The box of which the program removes most, with its top above the highest pass.
  void choose(const Map& map, double pass, double wanted, StockProposal& out) {
    std::vector<double> tops{wanted};
    for (int i = 1; i <= kTops; ++i) tops.push_back(wanted - (wanted - pass) * i / kTops);
    Rectangle best;
    double top = wanted, removed = 0, of_all = 0;
    for (const double z : tops) {
      const auto sums = map.removed_sums(z);
      of_all = std::max(of_all, map.sum_over(sums, map.all()));
      const Rectangle r = map.best(z, sums);
      const double sum = map.sum_over(sums, r);
      if (sum > removed) best = r, top = z, removed = sum;
    }
    if (removed < kUseful * of_all) {
      out.in_the_way = true;
      best = map.all(), top = wanted;
    }
    if (top < wanted) out.top = "the rapids that run over material that is not cut yet";
    out.trimmed = best != map.all();
    if (out.trimmed) best = map.inside(best);
    out.box = box_of(map, best, top);
  }

  machine::Box box_of(const Map& map, const Rectangle& r, double top) const {
    const auto up = [](double v) { return std::ceil(v * 10 - 1e-6) / 10; };
    const auto down = [](double v) { return std::floor(v * 10 + 1e-6) / 10; };
    const Rectangle all = map.all();
    machine::Box b;
    b.min_mm = Vec3(r.x0 > 0 ? up(map.x_mm(r.x0)) : down(low_.x()), r.y0 > 0 ? up(map.y_mm(r.y0)) : down(low_.y()),
                    down(low_.z()));
    b.max_mm = Vec3(r.x1 < all.x1 ? down(map.x_mm(r.x1)) : up(high_.x()),
                    r.y1 < all.y1 ? down(map.y_mm(r.y1)) : up(high_.y()), down(top));
    return b;
  }

  const nc::Program& text_;
  const nc::Interpretation& moves_;
  std::map<int, Profile> profiles_;
  ToolsByNumber tools_;
  CutDepths depths_;
  Vec3 low_ = Vec3::Zero(), high_ = Vec3::Zero();
};

}  // namespace

std::optional<StockProposal> propose_stock(const nc::Program& text, const nc::Interpretation& moves,
                                           const ToolsByNumber& tools) {
  return Proposer(text, moves, tools).run();
}

}  // namespace camber::report
