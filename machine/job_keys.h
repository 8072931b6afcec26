#pragma once
// The keys of job.toml, for its reader and its writer.
#include <array>

#include "machine/job_file.h"
#include "machine/number_key.h"

namespace camber::machine {

inline constexpr std::array<std::string_view, 7> kToolTypeWords{"ball",         "flat",    "bull",   "drill",
                                                                "tapered_ball", "chamfer", "general"};
inline constexpr std::array<std::string_view, 2> kCouplingWords{"rigid", "static"};
inline constexpr std::array<std::string_view, 2> kReferenceWords{"commanded", "machine"};
inline constexpr std::array<std::string_view, 2> kGoalWords{"best", "tolerance"};
inline constexpr std::array<std::string_view, 4> kLeverWords{"shift", "feed", "passes", "allowance"};
inline constexpr std::array<std::string_view, 2> kAdaptLeverWords{"feed", "speed"};
inline constexpr std::array<std::string_view, 3> kCollisionsWords{"error", "warning", "off"};
inline constexpr std::array<std::string_view, 2> kUnitWords{"mm", "inch"};
inline constexpr std::array<std::string_view, 2> kDirectionWords{"x", "y"};

inline constexpr NumberRange kFlutes{.min = 1, .max = 100, .whole = true};
inline constexpr NumberRange kToolNumber{.min = 0, .max = 99999999, .whole = true};
inline constexpr NumberRange kLineNumber{.min = 1, .max = 2e9, .whole = true};
inline constexpr NumberRange kRounds{.min = 1, .max = 1000, .whole = true};
inline constexpr NumberRange kHelixDeg{.min = 0, .max = 80};
inline constexpr NumberRange kRatio{.min = 0, .max = 1, .above_min = true};
inline constexpr NumberRange kTimeBudget{.min = 0, .max = 1000};
inline constexpr NumberRange kMinFeedPercent{.min = 1, .max = 100};
inline constexpr NumberRange kAngleGrowthDeg{.min = 0, .max = 90, .above_min = true};
inline constexpr NumberRange kRotationStepDeg{.min = 0, .max = 10, .above_min = true};

inline constexpr NumberRange kStepPercent{.min = 0.1, .max = 50};
inline constexpr NumberRange kTaperDeg{.min = 0, .max = 80};
inline constexpr NumberRange kPointAngleDeg{.min = 10, .max = 170};
inline constexpr NumberRange kRunoutAngleDeg{.min = -360, .max = 360};
inline constexpr NumberRange kPitchDeg{.min = 1, .max = 359};
inline constexpr NumberRange kDampingPercent{.min = 0, .max = 100, .above_min = true};

/// Numbers that a tool has anyway. Diameter and overhang must be given.
inline constexpr std::array kToolKeys{
    NumberKey<Tool>{"diameter_mm", &Tool::diameter_mm, kPositive},
    NumberKey<Tool>{"helix_deg", &Tool::helix_rad, kHelixDeg, kDegrees},
    NumberKey<Tool>{"overhang_mm", &Tool::overhang_mm, kPositive},
    NumberKey<Tool>{"effective_diameter_ratio", &Tool::effective_diameter_ratio, kRatio},
    NumberKey<Tool>{"youngs_modulus_GPa", &Tool::youngs_modulus_MPa, kPositive, kGigapascals},
    NumberKey<Tool>{"root_stiffness_N_per_um", &Tool::root_stiffness_N_per_mm, kPositiveOrInf, kNewtonsPerMicrometre},
    NumberKey<Tool>{"root_axial_stiffness_N_per_um", &Tool::root_axial_stiffness_N_per_mm, kPositiveOrInf,
                    kNewtonsPerMicrometre},
    NumberKey<Tool>{"root_rotational_stiffness_Nm_per_rad", &Tool::root_rotational_stiffness_Nmm_per_rad,
                    kPositiveOrInf, kNewtonMetres},
    NumberKey<Tool>{"runout_um", &Tool::runout_mm, kNotNegative, kMicrometres},
    NumberKey<Tool>{"runout_angle_deg", &Tool::runout_angle_rad, kRunoutAngleDeg, kDegrees},
};

/// Numbers of the profile and the types that have them; asked of those types unless a type has a default.
struct ProfileKey {
  NumberKey<Tool> number;
  std::string_view types;  ///< their words, in message order
  std::string_view asked_of;

  static constexpr bool lists(std::string_view words, std::string_view word) {
    for (std::size_t at = 0; at < words.size();) {
      const std::size_t space = words.find(' ', at), end = space < words.size() ? space : words.size();
      if (words.substr(at, end - at) == word) return true;
      at = end + 1;
    }
    return false;
  }
  constexpr bool belongs_to(std::string_view type) const { return lists(types, type); }
  constexpr bool must_have(std::string_view type) const { return lists(asked_of, type); }
};
inline constexpr std::array kProfileKeys{
    ProfileKey{{"corner_radius_mm", &Tool::corner_radius_mm, kPositive}, "bull general", "bull"},
    ProfileKey{{"tip_diameter_mm", &Tool::tip_diameter_mm, kNotNegative}, "chamfer", ""},
    ProfileKey{{"point_angle_deg", &Tool::point_angle_rad, kPointAngleDeg, kDegrees}, "chamfer drill", "chamfer"},
    ProfileKey{{"taper_deg", &Tool::taper_rad, kTaperDeg, kDegrees}, "tapered_ball general", "tapered_ball"},
    ProfileKey{{"bottom_angle_deg", &Tool::bottom_angle_rad, kTaperDeg, kDegrees}, "general", ""},
    ProfileKey{{"corner_centre_r_mm", &Tool::corner_centre_r_mm, kAnyNumber}, "general", ""},
    ProfileKey{{"corner_centre_z_mm", &Tool::corner_centre_z_mm, kAnyNumber}, "general", ""},
};

/// Keys of [[tool.N.mode]] and [[workpiece.mode]]; all must be given.
inline constexpr std::array kModeKeys{
    NumberKey<Mode>{"frequency_Hz", &Mode::frequency_hz, kPositive},
    NumberKey<Mode>{"damping_percent", &Mode::damping_ratio, kDampingPercent, kAsPercent},
    NumberKey<Mode>{"stiffness_N_per_um", &Mode::stiffness_N_per_mm, kPositive, kNewtonsPerMicrometre},
};

inline constexpr std::array kSimulationKeys{
    NumberKey<Simulation>{"voxel_mm", &Simulation::voxel_mm, kPositive},
    NumberKey<Simulation>{"rotation_step_deg", &Simulation::rotation_step_rad, kRotationStepDeg, kDegrees},
    NumberKey<Simulation>{"envelope_step_mm", &Simulation::envelope_step_mm, kNotNegative},
};

inline constexpr std::array kCompensationKeys{
    NumberKey<CompensationSettings>{"tolerance_um", &CompensationSettings::tolerance_um, kPositive},
    NumberKey<CompensationSettings>{"max_shift_mm", &CompensationSettings::max_shift_mm, kPositive},
    NumberKey<CompensationSettings>{"max_overcut_um", &CompensationSettings::max_overcut_um, kNotNegative},
    NumberKey<CompensationSettings>{"max_angle_growth_deg", &CompensationSettings::max_angle_growth_rad,
                                    kAngleGrowthDeg, kDegrees},
    NumberKey<CompensationSettings>{"min_feed_percent", &CompensationSettings::min_feed_percent, kMinFeedPercent},
    NumberKey<CompensationSettings>{"pass_allowance_mm", &CompensationSettings::pass_allowance_mm, kNotNegative},
};

inline constexpr NumberRange kPoissonRatio{.min = 0, .max = 0.49};
inline constexpr std::array kWorkpieceKeys{
    NumberKey<Workpiece>{"poisson_ratio", &Workpiece::poisson_ratio, kPoissonRatio},
    NumberKey<Workpiece>{"fixture_stiffness_N_per_um", &Workpiece::fixture_stiffness_N_per_mm, kPositiveOrInf,
                         kNewtonsPerMicrometre},
    NumberKey<Workpiece>{"cell_mm", &Workpiece::cell_mm, kNotNegative},
};

/// Key of a limit in [adapt] limits.
struct LimitKey {
  std::string_view key;
  std::optional<double> AdaptLimits::*field;
  FileUnit unit = kAsIs;
  NumberRange range = kPositive;
};
inline constexpr NumberRange kMarginRange{.min = 0, .max = 1, .above_min = true};
inline constexpr std::array kLimitKeys{
    LimitKey{"force_N", &AdaptLimits::force_N},
    LimitKey{"torque_Nm", &AdaptLimits::torque_Nmm, kNewtonMetres},
    LimitKey{"deflection_um", &AdaptLimits::deflection_mm, kMicrometres},
    LimitKey{"form_error_um", &AdaptLimits::form_error_mm, kMicrometres},
    LimitKey{"chip_mm", &AdaptLimits::chip_mm},
    LimitKey{"power_W", &AdaptLimits::power_W},
    LimitKey{"chip_min_mm", &AdaptLimits::chip_min_mm},
    LimitKey{"chatter_margin", &AdaptLimits::chatter_margin, kAsIs, kMarginRange},
};
inline constexpr std::array kAdaptKeys{
    NumberKey<AdaptSettings>{"step_percent", &AdaptSettings::step_fraction, kStepPercent, kAsPercent},
};

}  // namespace camber::machine
