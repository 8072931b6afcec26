#pragma once
// Cutting conditions by cases: similar jobs, modified for the difference, and their mean.
#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"

namespace camber::plan {

inline constexpr std::array<std::string_view, 2> kFinishWords{"rough", "fine"};
inline constexpr std::array<std::string_view, 2> kMachiningWords{"usual", "fast"};

/// Attributes of a case, or of the question that is compared with cases.
struct CaseContent {
  std::string material{};       ///< "FC250"
  std::string tool{};           ///< "end mill"
  std::string tool_material{};  ///< "carbide"
  bool coated = false;
  bool fine = false;  ///< finishing
  bool fast = false;  ///< on a machine for high speeds; never compared with the usual ones
  double diameter_mm = 0;
};

struct Case {
  CaseContent content;
  double speed_m_per_min = 0;
  std::optional<double> feed_mm_per_min{}, axial_depth_mm{}, radial_depth_mm{};
  std::size_t line = 0;  ///< in the file

  double spindle_rpm() const;
  std::optional<double> feed_per_turn_mm() const;
};

struct MaterialGroup {
  std::string name;
  std::vector<std::string> materials;
  double usual_m_per_min = 0, fast_m_per_min = 0;
};

struct CaseBase {
  std::string path;
  std::vector<Case> cases;
  std::vector<MaterialGroup> groups;
  double material_weight = 0.4, tool_weight = 0.3, tool_material_weight = 0.1, coating_weight = 0.1,
         finish_weight = 0.1;
  double least_similarity = 0.7;
  std::size_t most_cases = 5;
  std::map<std::string, double, std::less<>> feed_exponent;
  std::map<std::string, std::array<double, 2>, std::less<>> depth_share;  ///< axial, radial / diameter

  const MaterialGroup* group_of(std::string_view material) const;  ///< null: none
};

/// Throws InputError with file:line:column.
CaseBase read_case_base(const std::string& path, Diagnostics& diagnostics);

/// A case as [[case]] of the file.
std::string to_toml(const Case& of);

/// Share of attributes that are equal, by the base's weights: 1 for the same content. The tool's type and the kind of
/// machining must be equal (else 0); another material of the same group counts half.
double similarity(const CaseBase& base, const CaseContent& a, const CaseContent& b);

struct Neighbour {
  const Case* of = nullptr;
  double similarity = 0;
  double speed_m_per_min = 0;                ///< modified
  std::optional<double> feed_per_turn_mm{};  ///< modified
};

struct CaseAnswer {
  double speed_m_per_min = 0, feed_per_turn_mm = 0;
  double axial_depth_mm = 0, radial_depth_mm = 0;
  std::vector<Neighbour> neighbours;  ///< the most similar first; equal ones by the ratio of diameters
  bool similar = true;                ///< false: none is similar enough; the nearest ones are used all the same
};

/// Modification: the cutting speed in the ratio of the groups' limits; the feed per turn times (D / D_case)^exponent;
/// depths as shares of the diameter. The answer is the mean of the modified cases, each quantity over those that tell
/// it; a feed or depths that none tells come from the most similar cases that do, depths at last from depth_share.
/// `without`: a case that is left out. Nothing where no case has the tool's type.
std::optional<CaseAnswer> conditions_by_cases(const CaseBase& base, const CaseContent& query,
                                              const Case* without = nullptr);

/// Every case asked of the others.
struct LeftOut {
  const Case* of = nullptr;
  double speed_ratio = 0;              ///< predicted / true
  std::optional<double> feed_ratio{};  ///< predicted / true, of the feed per turn
  bool similar = true;
};
std::vector<LeftOut> leave_one_out(const CaseBase& base);

}  // namespace camber::plan
