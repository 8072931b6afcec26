#include "machine/library_words.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"

namespace camber::machine {
namespace {

struct Word {
  std::string_view type, kind;
};
// Types of Fusion's library; a word that is part of several stands after those.
constexpr std::array kFusionWords{
    Word{"bull nose", "bull"},
    Word{"ball end", "ball"},
    Word{"flat end", "flat"},
    Word{"face mill", "flat"},
    Word{"chamfer", "chamfer"},
    Word{"counter sink", "chamfer"},
    Word{"countersink", "chamfer"},
    Word{"drill", "drill"},
    Word{"thread mill", "thread mill"},
    Word{"slot mill", "slitting saw"},
    Word{"dovetail", "dovetail"},
    Word{"radius mill", "corner rounding mill"},
    Word{"tap ", "tap"},
    Word{"reamer", "reamer"},
    Word{"turning", "turning"},
    Word{"probe", "probe"},
    Word{"laser", "laser"},
    Word{"holder", "holder"},
};

struct KindType {
  std::string_view kind;
  ToolType type;
};
constexpr std::array kTypes{
    KindType{"flat", ToolType::flat},         KindType{"ball", ToolType::ball},
    KindType{"bull", ToolType::bull},         KindType{"drill", ToolType::drill},
    KindType{"chamfer", ToolType::chamfer},   KindType{"vbit", ToolType::chamfer},
    KindType{"engraving", ToolType::chamfer}, KindType{"tapered ball", ToolType::tapered_ball},
    KindType{"tap", ToolType::drill},         KindType{"reamer", ToolType::drill},
};

}  // namespace

std::string kind_of_fusion(std::string_view type) {
  for (const Word& word : kFusionWords)
    if (type.find(word.type) != std::string_view::npos) return std::string(word.kind);
  return std::string(type);
}

void set_type_by_kind(ToolProposal& tool) {
  const auto* at = std::ranges::find(kTypes, std::string_view(tool.kind), &KindType::kind);
  if (at != kTypes.end())
    tool.type = at->type;
  else if (!tool.kind.empty())
    tool.doubt = fmt::format("a {} is none of camber's cutters; type \"general\" describes a profile", tool.kind);
  if (tool.kind == "tap" || tool.kind == "reamer")
    tool.doubt = "taps and reamers stand as drills: they make holes alone";
}

void set_fusion_cutter(ToolProposal& tool, std::string_view type, const FusionSizes& sizes) {
  const auto given = [](double value) { return value > 0 ? std::optional(value) : std::nullopt; };
  tool.kind = kind_of_fusion(type);
  if (tool.kind == "tapered mill" && sizes.diameter > 0 && sizes.corner_radius >= 0.499 * sizes.diameter)
    tool.kind = "tapered ball";
  set_type_by_kind(tool);
  tool.diameter_mm = given(sizes.diameter);
  if (tool.type == ToolType::bull) tool.corner_radius_mm = given(sizes.corner_radius);
  tool.flute_length_mm = given(sizes.flute_length);
  tool.overhang_mm = given(sizes.body_length);
  tool.overall_length_mm = given(sizes.overall_length);
  tool.shank_diameter_mm = given(sizes.shank_diameter);
  tool.shoulder_length_mm = given(sizes.shoulder_length);
  if (sizes.shoulder_diameter != sizes.diameter) tool.neck_diameter_mm = given(sizes.shoulder_diameter);
  if (sizes.flutes > 0) tool.flutes = static_cast<int>(std::lround(std::min(sizes.flutes, 1e6)));
  if (tool.kind == "drill" || type == "counter sink") tool.point_angle_deg = given(sizes.point_deg);
  if (is_conical(tool.kind)) {
    tool.tip_diameter_mm = given(sizes.tip_diameter);
    if (!tool.point_angle_deg) tool.point_angle_deg = given(2 * sizes.taper_deg);
  }
  if (tool.kind == "tapered ball") tool.taper_deg = given(sizes.taper_deg);
  check_cone(tool);
}

bool is_conical(std::string_view kind) { return kind == "chamfer" || kind == "vbit" || kind == "engraving"; }

void check_cone(ToolProposal& tool) {
  constexpr double kRounding = 0.01;
  if (tool.kind != "chamfer" || !tool.diameter_mm || !tool.flute_length_mm || !tool.point_angle_deg) return;
  const double top_mm =
      tool.tip_diameter_mm.value_or(0) + 2 * *tool.flute_length_mm * std::tan(rad_from_deg(*tool.point_angle_deg / 2));
  if (top_mm < *tool.diameter_mm * (1 - kRounding))
    tool.doubt = fmt::format("its cone of {:.4g} degrees ends at D{:.4g}, not at its diameter of {:.4g}",
                             *tool.point_angle_deg, top_mm, *tool.diameter_mm);
}

std::optional<double> modulus_of_library_GPa(std::string_view word) {
  constexpr double kCarbide_GPa = 600, kSteel_GPa = 210;
  std::string lower(word);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (lower == "carbide") return kCarbide_GPa;
  if (lower == "hss") return kSteel_GPa;
  return std::nullopt;
}

}  // namespace camber::machine
