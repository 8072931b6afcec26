#include "posture/posture_program.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

#include "base/triangle_mesh.h"
#include "base/units.h"
#include "deflection/beam.h"
#include "deflection/edge_force.h"
#include "kinematics/control_options.h"
#include "nc/emit/number_style.h"
#include "posture/path_cost.h"
#include "posture/rotary_path.h"
#include "repath/post/post_writer.h"
#include "repath/post/tip_motion.h"

namespace camber::posture {
namespace {

constexpr int kLeastDecimals = 4;
constexpr double kOrdinaryChip_mm = 0.2;  ///< width
constexpr double kLeastError_mm = 0.01;   ///< a tool that bends less counts as one that bends so much

/// The fixtures that stand still in the part's frame, and the part.
Surroundings surroundings_of(const machine::Job& job, const TriangleMesh& part, const Vec3& origin_mm) {
  Surroundings out;
  out.add(part);
  for (const machine::Body& body : job.machine.bodies) {
    const bool still = body.axes == 0 || (body.axes == 1 && body.on.size() == 1 && body.on[0] < 'x');
    if (!still) continue;
    if (body.box_mm)
      out.add_box((*body.box_mm)[0] + origin_mm, (*body.box_mm)[1] + origin_mm);
    else
      out.add(read_mesh(body.mesh), origin_mm);
  }
  return out;
}

class Maker {
 public:
  Maker(const PostureRequest& request, Diagnostics& diagnostics)
      : request_(request),
        job_(*request.job),
        program_(*request.program),
        moves_(*request.moves),
        diagnostics_(diagnostics) {}

  /// False: refused.
  bool ready() {
    if (!tool_and_job_fit() || !moves_fit()) return false;
    part_ = machine::part_mesh(job_.part);
    if (!moves_.machine_origin_mm) moves_.machine_origin_mm = Vec3::Zero();
    surroundings_ = surroundings_of(job_, part_, *moves_.machine_origin_mm);
    if (request_.options.stock) add_stock(job_, program_, moves_, first_, surroundings_, diagnostics_);
    surroundings_.finish();
    points_ = path_points(moves_, first_, end_, tool(), part_, request_.step_mm);
    return true;
  }

  std::vector<Postured> run() {
    std::vector<machine::Tool> tools(std::max<std::size_t>(1, request_.overhangs_mm.size()), tool());
    std::vector<ToolShape> shapes;
    for (std::size_t i = 0; i < tools.size(); ++i) {
      if (!request_.overhangs_mm.empty()) tools[i].overhang_mm = request_.overhangs_mm[i];
      shapes.push_back(tool_shape(tools[i], job_.machine, request_.options.clearance_mm));
      shapes.back().error_mm = std::max(
          kLeastError_mm, deflection::beam_of(tools[i]).compliance_mm_per_N(0, 0) * ordinary_force_N(tools[i]));
    }
    lag_.emplace(job_.machine, *moves_.machine_origin_mm, tool_length_mm(), shapes[0].pivot_mm);
    const std::vector<Postures> postures =
        choose_postures(points_, surroundings_, shapes, job_.machine, *lag_, request_.options);
    std::vector<Postured> out(tools.size());
    tbb::parallel_for(std::size_t{0}, tools.size(),
                      [&](std::size_t i) { finish(tools[i], shapes[i], postures[i], out[i]); });
    return out;
  }

 private:
  const machine::Tool& tool() const { return job_.tools.at(request_.tool); }

  void finish(const machine::Tool& tool, const ToolShape& shape, const Postures& postures, Postured& out) const {
    out.points = points_;
    out.tool = request_.tool;
    out.origin_mm = -*moves_.machine_origin_mm;
    out.upright = figures_of(this->tool(), std::vector<Vec3>(points_.size(), Vec3::UnitZ()));
    if (postures.blocked) {
      out.blocked_move = points_[*postures.blocked].move;
      return;
    }
    out.axes = postures.axes;
    out.figures = figures_of(tool, postures.axes);
    out.rotary_rad = rotary_path(job_.machine, points_, out.axes);
    const auto unclear = unclear_points(points_, out.axes, out.rotary_rad, surroundings_, shape, job_.machine);
    out.figures.unclear = unclear.size();
    if (!unclear.empty()) out.unclear_move = points_[unclear.front()].move;
    for (std::size_t i = 1; i < points_.size(); ++i)
      out.figures.rotary_motion_deg += deg_from_rad((out.rotary_rad[i] - out.rotary_rad[i - 1]).lpNorm<1>());
    write(out);
  }
  void write(Postured& out) const;

  /// Returns the distance from the spindle's gauge line to the tip in the first cut; if it is not known, the length of
  /// holder and overhang.
  double tool_length_mm() const {
    double length = tool().overhang_mm;
    for (const machine::HolderPart& part : tool().holder) length += part.length_mm;
    return moves_.state_of(moves_.moves[first_]).tool_length_mm.value_or(length);
  }

  /// Returns the force of an edge whose chip is as thick as the feed per tooth of the first cut and kOrdinaryChip_mm
  /// wide.
  double ordinary_force_N(const machine::Tool& tool) const {
    for (std::size_t i = first_; i < end_; ++i) {
      const nc::Move& m = moves_.moves[i];
      const double teeth_per_s = moves_.state_of(m).spindle_speed_rpm / 60 * tool.flutes;
      if (m.feed_mm_per_s <= 0 || teeth_per_s <= 0) continue;
      const deflection::EdgeForce force =
          deflection::edge_force(job_.material, m.feed_mm_per_s / teeth_per_s, kOrdinaryChip_mm);
      return std::hypot(force.tangential_N, force.radial_N);
    }
    return 0;
  }

  double lag_um(const std::vector<Vec3>& axes) const {
    const std::vector<AxisStep> steps = axis_steps(points_, axes, *lag_, job_.machine);
    double sum = 0, way = 0;
    for (std::size_t i = 1; i < points_.size(); ++i) {
      if (!points_[i].contact) continue;
      sum += points_[i].way_mm * std::abs(steps[i].lag_error_mm);
      way += points_[i].way_mm;
    }
    return way > 0 ? 1000 * sum / way : 0;
  }

  void say(std::size_t offset, const char* check, std::string message) {
    diagnostics_.add(program_.source.diagnostic(Severity::error, offset, std::move(message), check));
  }

  bool tool_and_job_fit() {
    const auto refuse = [&](std::string message, const char* check) {
      diagnostics_.add({Severity::error, {job_.path, 0, 0}, std::move(message), check, {}});
      return false;
    };
    if (!job_.machine.kinematics.given())
      return refuse("the machine has no [kinematics]; rotary axes were expected", "kinematics");
    if (job_.part.mesh.empty()) return refuse("[part] has no mesh; the STL file of the part was expected", "no-part");
    const auto found = job_.tools.find(request_.tool);
    if (found == job_.tools.end())
      return refuse(
          fmt::format("the job has no [tool.{}]; the tool of the finishing moves was expected", request_.tool),
          "no-tool");
    using machine::ToolType;
    if (const std::string message = frame_refused(); !message.empty()) return refuse(message, "no-frame");
    if (found->second.type != ToolType::ball && found->second.type != ToolType::bull)
      return refuse(
          fmt::format("[tool.{}] is neither a ball nor a bull-nose cutter; one of these was expected", request_.tool),
          "not-ball");
    return true;
  }

  /// Why one direction cannot be written as asked for; empty: it can.
  std::string frame_refused() const {
    if (!request_.options.indexed) return {};
    const nc::Dialect& dialect = nc::dialect_of_text(program_, this->dialect());
    const bool dynamic = request_.written == nc::OneDirection::dynamic;
    const nc::FiveAxisWords words = nc::five_axis_words(dialect);
    if (!words.writes(request_.written))
      return fmt::format("{} has no {}; {}joints or tip was expected for one direction of the tool", dialect.title,
                         dynamic ? "dynamic work offset (G254)" : "tilted frames (G68.2)",
                         words.tilted_frames ? "tilted, " : "");
    if (dynamic && !table_alone())
      return "the head of the machine turns; G254 turns with the table, and tilted, joints or tip was expected";
    return {};
  }

  const nc::Dialect& dialect() const { return kinematics::dialect_of(job_.machine.control.kind); }

  bool table_alone() const {
    const auto options = kinematics::rotary_options(job_.machine);
    return std::all_of(options.begin(), options.end(), [](const nc::RotaryOption& axis) { return axis.on_table; });
  }

  bool moves_fit() {
    first_ = end_ = moves_.moves.size();
    for (std::size_t i = 0; i < moves_.moves.size(); ++i) {
      const nc::Move& m = moves_.moves[i];
      if (moves_.state_of(m).tool != request_.tool || m.reference) continue;
      if (first_ == moves_.moves.size()) first_ = i;
      end_ = i + 1;
    }
    if (first_ == moves_.moves.size()) {
      say(0, "no-moves",
          fmt::format("tool T{} has no moves in this program; finishing moves were expected", request_.tool));
      return false;
    }
    for (std::size_t i = first_; i < end_; ++i)
      if (!may_be_postured(i)) return false;
    return true;
  }

  bool turned_frame(const nc::Move& m) const {
    const nc::Frame& frame = moves_.frame_of(m);
    return request_.options.indexed && !frame.plain && !frame.shift_only;
  }

  bool may_be_postured(std::size_t i) {
    const nc::Move& m = moves_.moves[i];
    const nc::ModalState& state = moves_.state_of(m);
    const std::size_t offset = program_.blocks[m.block].offset;
    if (state.tip_control != nc::TipControl::off || state.work_frame != nc::WorkFrame::machine ||
        std::any_of(moves_.rotary.begin(), moves_.rotary.end(), [&](const auto& t) { return t.move == i; })) {
      say(offset, "rotary-axis", "this move has directions of its own; moves of three axes were expected");
      return false;
    }
    if (turned_frame(m)) {
      say(offset, "no-frame",
          "this move has turned, mirrored or scaled coordinates; a frame for one direction of the "
          "tool was expected to be the only one");
      return false;
    }
    const bool alone = (i == 0 || moves_.moves[i - 1].block != m.block) &&
                       (i + 1 == moves_.moves.size() || moves_.moves[i + 1].block != m.block);
    if (m.kind == nc::MoveKind::dwell || (m.editable && alone && !m.canned && !m.reference)) return true;
    say(offset, "not-editable",
        "this move is made by a loop, a subprogram that is called more than once, an expression or a cycle, or goes to "
        "a reference point, so that its coordinates cannot be rewritten; lines and arcs were expected");
    return false;
  }

  PostureFigures figures_of(const machine::Tool& tool, const std::vector<Vec3>& axes) const {
    PostureFigures out;
    out.points = points_.size();
    out.overhang_mm = tool.overhang_mm;
    double way = 0, share = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!points_[i].contact) continue;
      const double angle = angle_between(axes[i], points_[i].normal);
      ++out.contacts;
      way += points_[i].way_mm;
      share += points_[i].way_mm * error_share(angle);
      out.mean_angle_rad += points_[i].way_mm * angle;
      out.max_angle_rad = std::max(out.max_angle_rad, angle);
    }
    if (way <= 0) return out;
    out.mean_angle_rad /= way;
    out.lag_um = lag_um(axes);
    out.compliance_um_per_N = 1000 * deflection::beam_of(tool).compliance_mm_per_N(0, 0) * share / way;
    out.error_um = out.compliance_um_per_N * ordinary_force_N(tool) + out.lag_um;
    return out;
  }

  const PostureRequest& request_;
  const machine::Job& job_;
  const nc::Program& program_;
  nc::Interpretation moves_;
  Diagnostics& diagnostics_;
  std::size_t first_ = 0, end_ = 0;
  TriangleMesh part_;
  Surroundings surroundings_;
  std::vector<PathPoint> points_;
  std::optional<LagError> lag_;
};

void Maker::write(Postured& out) const {
  const kinematics::Chain chain(job_.machine);
  const int decimals = std::max(kLeastDecimals, nc::coordinate_decimals_of(program_));
  const repath::PostRounding rounding{decimals, decimals + 1, decimals};
  repath::PostOptions options{.target = repath::PostTarget::tcp};
  std::vector<Vec3>& axes = out.axes;
  const bool framed = request_.options.indexed &&
                      (request_.written == nc::OneDirection::tilted || request_.written == nc::OneDirection::dynamic);
  if (framed) {
    const WrittenFrame frame =
        frame_text(chain, request_.written, axes.front(), decimals, *nc::five_axis_text(program_, dialect()));
    options.frame = frame.frame;
    axes.assign(axes.size(), frame.axis);
  }
  repath::PostMotions motions;
  motions.of_move.assign(moves_.moves.size(), repath::PostMotions::kKept);
  std::vector<repath::DividedMotion> divided;
  const Vec3& origin = *moves_.machine_origin_mm;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const PathPoint& p = points_[i];
    if (i == 0 || points_[i - 1].move != p.move) {
      repath::TipMotion motion;
      motion.move = p.move;
      motion.rapid = p.rapid;
      motion.arc = moves_.moves[p.move].arc != nc::Move::kNoArc;
      motions.of_move[p.move] = motions.motions.size();
      motions.first_of_run.push_back(motions.motions.empty());
      motions.motions.push_back(motion);
      divided.emplace_back();
    }
    repath::PostPoint point;
    const Vec3 tip = p.tip_mm(axes[i]);
    point.tip_mm = tip - origin;
    point.rotary_deg = rounding.deg(out.rotary_rad[i]);
    point.to = p.to;
    point.rapid = p.rapid;
    // The contact keeps its feed, and the tip goes as fast as that takes.
    point.time_s = p.time_s;
    divided.back().points.push_back(point);
  }
  if (!framed) {
    // Upright again where the tool is left: at the end of a rapid, in air.
    repath::PostPoint upright = divided.back().points.back();
    upright.rotary_deg = Vec3::Zero();
    upright.rapid = upright.extra = true;
    upright.time_s = 0;
    divided.back().points.push_back(upright);
  }
  repath::Posted posted;
  repath::PostWriter(program_, moves_, job_.machine, options, rounding).write(motions, divided, posted);
  out.text = std::move(posted.text);
  out.block_of_line = std::move(posted.block_of_line);
}

}  // namespace

std::vector<Postured> make_postures(const PostureRequest& request, Diagnostics& diagnostics) {
  Maker maker(request, diagnostics);
  if (!maker.ready()) return {};
  return maker.run();
}

double least_overhang_mm(const machine::Tool& tool) {
  return std::max(tool.flute_length_mm.value_or(0), tool.diameter_mm);
}

}  // namespace camber::posture
