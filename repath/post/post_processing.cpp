#include "repath/post/post_processing.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/numbers.h"
#include "base/stage.h"
#include "base/units.h"
#include "kinematics/control_options.h"
#include "repath/post/post_divide.h"
#include "repath/post/post_motions.h"
#include "repath/post/post_plan.h"
#include "repath/post/post_writer.h"

namespace camber::repath {
namespace {

constexpr int kLeastDecimals = 4, kMostDecimals = 8;

PostRounding rounding_of(const nc::Program& program, const machine::Control& control, const PostOptions& options) {
  const int own = std::clamp(nc::coordinate_decimals_of(program), kLeastDecimals, kMostDecimals);
  PostRounding out{own, own + 1, own};
  if (control.least_increment_mm) {
    const nc::EmitOptions of_control = kinematics::decimals_for(control, program);
    out = {of_control.decimals_mm, of_control.decimals_inch, of_control.decimals_mm};
  }
  if (options.decimals) out = {*options.decimals, *options.decimals, *options.decimals};
  return out;
}

class Post {
 public:
  Post(const nc::Program& program, const nc::Interpretation& moves, const machine::Machine& machine,
       const PostOptions& options, Diagnostics& diagnostics)
      : program_(program),
        moves_(moves),
        machine_(machine),
        options_(options),
        diagnostics_(diagnostics),
        rounding_(rounding_of(program, machine.control, options)) {}

  Posted run() {
    Posted out;
    if (!origin_is_known()) return out;
    const auto text = nc::five_axis_text(program_, kinematics::dialect_of(machine_.control.kind));
    if (!language_says(*text)) return out;
    const PostMotions motions = post_motions(program_, moves_, machine_, options_.target, diagnostics_);
    if (diagnostics_.has_errors()) return out;
    if (motions.motions.empty()) {
      fail(nullptr, "nothing-to-post",
           options_.target == PostTarget::joints
               ? fmt::format("no move is under tool-centre-point control; {} was expected", text->control_words())
               : "no move runs with turned rotary axes outside tool-centre-point control and tilted frames; A, B or C "
                 "was expected");
      return out;
    }
    const MotionFrame frame(machine_, moves_);
    std::vector<PlannedStretch> plan;
    if (options_.target == PostTarget::joints)
      plan = plan_choices(motions.motions, motions.before, frame, machine_);
    else
      for (std::size_t i = 0; i < motions.motions.size(); ++i)
        plan.push_back({.motion = i, .choice = {}, .before = {}});
    const auto divided = divide(motions, frame, plan, out);
    if (diagnostics_.has_errors()) return out;
    PostWriter(program_, moves_, machine_, options_, rounding_).write(motions, divided, out);
    return out;
  }

 private:
  void fail(const nc::Move* move, const char* check, std::string message) {
    const std::size_t offset = move ? program_.blocks[move->block].offset : 0;
    diagnostics_.add(program_.source.diagnostic(Severity::error, offset, std::move(message), check));
  }

  /// Whether the language of the program has words for what is asked for.
  bool language_says(const nc::FiveAxisText& text) {
    if (options_.inverse_time)
      if (const std::string why = text.feed_refused(nc::FeedMode::inverse_time); !why.empty()) {
        fail(nullptr, "inverse-time", why);
        return false;
      }
    if (options_.target == PostTarget::tcp) return true;
    for (const nc::Move& m : moves_.moves) {
      if (moves_.state_of(m).tip_control == nc::TipControl::off) continue;
      const std::string why = text.joints_refused(moves_, m);
      if (why.empty()) continue;
      fail(&m, "tilted-frame", why);
      return false;
    }
    return true;
  }

  bool origin_is_known() {
    if (moves_.machine_origin_mm) return true;
    fail(moves_.moves.empty() ? nullptr : &moves_.moves.front(), "work-offset",
         "the work offset is not known, so that joints are not; --work-offset or G10 L2 was expected");
    return false;
  }

  std::vector<DividedMotion> divide(const PostMotions& motions, const MotionFrame& frame,
                                    const std::vector<PlannedStretch>& plan, Posted& out) {
    const Divider divider(frame, machine_, options_, rounding_);
    Stage stage("dividing blocks", motions.motions.size());
    std::vector<DividedMotion> divided;
    std::size_t next = 0;
    for (std::size_t i = 0; i < motions.motions.size(); ++i) {
      const std::size_t first = next;
      while (next < plan.size() && plan[next].motion == i) ++next;
      const TipMotion& motion = motions.motions[i];
      const nc::Move& move = moves_.moves[motion.move];
      const double rounding_mm = rounding_.tip_mm(moves_.state_of(move).inch, moves_.frame_of(move));
      if (!tolerance_holds(motion, move, rounding_mm)) return divided;
      divided.push_back(divider.divide(motion, {plan.data() + first, next - first}, rounding_mm, out.turns_back));
      count(motion, divided.back(), out);
      stage.advance();
    }
    for (const DividedMotion& d : divided) out.axis_bound_rad = std::max(out.axis_bound_rad, d.axis_bound_rad);
    out.axis_bound_rad += static_cast<double>(frame.chain().rotary_axes().size()) *
                          rad_from_deg(0.5 * std::pow(10.0, -rounding_.decimals_deg));
    return divided;
  }

  bool tolerance_holds(const TipMotion& motion, const nc::Move& move, double rounding_mm) {
    const double tolerance = motion.rapid ? options_.rapid_tolerance_mm : options_.tolerance_mm;
    if (options_.one_degree || rounding_mm < 0.8 * tolerance) return true;
    fail(&move, "tolerance",
         fmt::format("rounding of the words to {} decimals moves the tip by up to {} mm, of a tolerance of {} mm; more "
                     "decimals or a larger tolerance were expected",
                     moves_.state_of(move).inch ? rounding_.decimals_inch : rounding_.decimals_mm,
                     format_trimmed(rounding_mm, 6), format_trimmed(tolerance, 6)));
    return false;
  }

  static void count(const TipMotion& motion, const DividedMotion& divided, Posted& out) {
    ++out.moves;
    double& worst = motion.rapid ? out.rapid_bound_mm : out.tip_bound_mm;
    worst = std::max(worst, divided.bound_mm);
    if (motion.rapid) return;
    ++out.feed_moves;
    out.feed_blocks += static_cast<std::size_t>(
        std::count_if(divided.points.begin(), divided.points.end(), [](const PostPoint& p) { return !p.extra; }));
    out.one_degree_blocks += divided.one_degree_blocks;
    out.one_degree_bound_mm = std::max(out.one_degree_bound_mm, divided.one_degree_bound_mm);
  }

  const nc::Program& program_;
  const nc::Interpretation& moves_;
  const machine::Machine& machine_;
  const PostOptions& options_;
  Diagnostics& diagnostics_;
  PostRounding rounding_;
};

}  // namespace

Posted post(const nc::Program& program, const nc::Interpretation& moves, const machine::Machine& machine,
            const PostOptions& options, Diagnostics& diagnostics) {
  return Post(program, moves, machine, options, diagnostics).run();
}

}  // namespace camber::repath
