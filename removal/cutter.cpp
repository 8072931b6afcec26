#include "removal/cutter.h"

#include <algorithm>
#include <cmath>

#include "removal/field/rounded_cutter.h"

namespace camber::removal {
namespace {

RoundedCutter<double> rounded(const CutterShape& shape) { return {shape.bottom_length_mm(), shape.corner_radius_mm}; }

}  // namespace

double CutterShape::distance_mm(const Vec3& p) const {
  if (general) return profile.distance_mm({std::sqrt(p.x() * p.x() + p.y() * p.y()), p.z()});
  return rounded(*this).distance(std::sqrt(p.x() * p.x() + p.y() * p.y()), p.z());
}

Vec3 CutterShape::gradient(const Vec3& p) const {
  const double rho = std::sqrt(p.x() * p.x() + p.y() * p.y());
  if (general) {
    const Vec2 n = profile.nearest({rho, p.z()}).normal;
    return {rho > 0 ? p.x() / rho * n.x() : 0, rho > 0 ? p.y() / rho * n.x() : 0, n.y()};
  }
  const auto cutter = rounded(*this);
  const auto n = cutter.normal(cutter.place(rho, p.z()));
  const double per_rho = rho > 0 ? n.radial / rho : 0;
  return {p.x() * per_rho, p.y() * per_rho, -n.down};
}

CutterShape shape_of(const machine::Tool& tool) {
  const machine::CutterParameters parameters = machine::parameters_of(tool);
  Profile profile(parameters);
  const bool general = tool.type != machine::ToolType::ball && tool.type != machine::ToolType::flat &&
                       tool.type != machine::ToolType::bull;
  const double radius = general ? profile.largest_radius_mm() : tool.diameter_mm / 2;
  return {radius, parameters.corner_radius_mm, general, std::move(profile)};
}

namespace {

constexpr double kMaxTurn_rad = 0.06;  ///< of the profile's normal over one ring of a small corner
/// A level bottom cuts where the tool descends, all of it alike: rings this wide, but for a few at its rim.
constexpr double kBottom_mm = 0.5, kBottomOfRadius = 1.0 / 12;
constexpr int kRimRings = 3;

/// Cuts [from, to] in equal rings no wider than `step`.
void add_rings(EnvelopeGrid& grid, double from, double to, double step) {
  if (to - from <= 1e-9) return;
  const int n = std::max(1, static_cast<int>(std::ceil((to - from) / step - 1e-9)));
  const double width = (to - from) / n;
  for (int i = 0; i < n; ++i) {
    const ProfilePoint p = grid.shape.profile.at(from + (i + 0.5) * width);
    grid.rings.push_back({p, width, p.height_mm * grid.lag_per_mm, static_cast<float>(std::sin(p.normal_angle_rad)),
                          static_cast<float>(std::cos(p.normal_angle_rad))});
  }
}

bool is_level(const Profile::Piece& piece) { return !piece.arc && std::abs(piece.normal.x()) < 1e-12; }

}  // namespace

EnvelopeGrid make_envelope(const machine::Tool& tool, double top_mm, double step_mm, double rotation_step_rad,
                           double above_mm) {
  EnvelopeGrid grid;
  grid.shape = shape_of(tool);
  grid.flutes = tool.flutes;
  grid.lag_per_mm = std::tan(tool.helix_rad) / (tool.diameter_mm / 2);
  grid.steps_per_pitch = std::max(4, static_cast<int>(std::ceil(2 * kPi / (rotation_step_rad * tool.flutes) - 1e-9)));
  grid.steps = grid.steps_per_pitch * tool.flutes;

  const Profile& profile = grid.shape.profile;
  const double top = profile.length_to_height_mm(std::max(0.0, top_mm));
  const double end = profile.length_to_height_mm(std::max(0.0, top_mm + above_mm));
  for (const auto& piece : profile.pieces()) {
    const double to = piece.from_s_mm + piece.length_mm;
    const double step = piece.arc ? std::min(step_mm, kMaxTurn_rad * piece.radius_mm) : step_mm;
    double from = piece.from_s_mm;
    if (const double wide = std::min(kBottom_mm, kBottomOfRadius * grid.shape.radius_mm), rim = to - kRimRings * step;
        is_level(piece) && wide > step && rim > from && to <= top) {
      add_rings(grid, from, rim, wide);
      from = rim;
    }
    add_rings(grid, from, std::min(to, top), step);
    add_rings(grid, std::max(piece.from_s_mm, top), std::min(to, end), step);
  }

  for (const auto& ring : grid.rings) {
    for (int i = 0; i < grid.steps; ++i) {
      const double phi = 2 * kPi * i / grid.steps + ring.lag_rad;
      const double sk = std::sin(ring.profile.normal_angle_rad), ck = std::cos(ring.profile.normal_angle_rad);
      grid.x.push_back(static_cast<float>(ring.profile.radius_mm * std::cos(phi)));
      grid.y.push_back(static_cast<float>(ring.profile.radius_mm * std::sin(phi)));
      grid.z.push_back(static_cast<float>(ring.profile.height_mm));
      grid.nx.push_back(static_cast<float>(sk * std::cos(phi)));
      grid.ny.push_back(static_cast<float>(sk * std::sin(phi)));
      grid.nz.push_back(static_cast<float>(-ck));
      grid.cos_phi.push_back(static_cast<float>(std::cos(phi)));
      grid.sin_phi.push_back(static_cast<float>(std::sin(phi)));
    }
  }
  return grid;
}

void make_patches(EnvelopeGrid& grid, double size_mm) {
  grid.patches.clear();
  const int rings = static_cast<int>(grid.rings.size());
  for (int r0 = 0; r0 < rings;) {
    int r1 = r0;
    double height = 0, widest = 0;
    while (r1 < rings && (r1 == r0 || height + grid.rings[r1].width_mm <= size_mm)) {
      height += grid.rings[r1].width_mm;
      widest = std::max(widest, grid.rings[r1].profile.radius_mm);
      ++r1;
    }
    const double turn = std::min(2 * kPi / 3, size_mm / std::max(widest, 1e-9));
    const int span = std::clamp(static_cast<int>(turn * grid.steps / (2 * kPi)), 1, grid.steps);
    for (int i0 = 0; i0 < grid.steps; i0 += span) {
      EnvelopeGrid::Patch patch{
          .ring_from = r0, .ring_to = r1, .step_from = i0, .step_to = std::min(i0 + span, grid.steps)};
      const auto for_points = [&](auto f) {
        for (int r = r0; r < r1; ++r)
          for (int i = patch.step_from; i < patch.step_to; ++i) {
            const auto p = static_cast<std::size_t>(r) * grid.steps + i;
            f(Vec3(grid.x[p], grid.y[p], grid.z[p]), Vec3(grid.nx[p], grid.ny[p], grid.nz[p]));
          }
      };
      double count = 0;
      for_points([&](const Vec3& place, const Vec3& normal) {
        patch.centre_from_tip += place;
        patch.normal += normal;
        ++count;
      });
      patch.centre_from_tip /= count;
      patch.normal /= count;
      for_points([&](const Vec3& place, const Vec3& normal) {
        patch.radius_mm = std::max(patch.radius_mm, (place - patch.centre_from_tip).norm());
        patch.normal_spread = std::max(patch.normal_spread, (normal - patch.normal).norm());
      });
      grid.patches.push_back(patch);
    }
    r0 = r1;
  }
}

}  // namespace camber::removal
