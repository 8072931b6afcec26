// features.csv.
#include <fmt/format.h>

#include "inspect/evaluate.h"

namespace camber::inspect {
namespace {

std::string cell(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value + 0.0, decimals) : std::string();
}

/// A name with a comma or a quote stands in quotes.
std::string quoted(const std::string& name) {
  if (name.find_first_of(",\"\n") == std::string::npos) return name;
  std::string out = "\"";
  for (const char c : name) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

}  // namespace

std::string features_csv(const std::vector<FeatureResult>& results) {
  std::string out =
      "feature,kind,nominal_mm,predicted_mm,std_mm,measured_mm,difference_um,form_um,taper_um,lower_mm,upper_mm,"
      "within\n";
  for (const FeatureResult& r : results) {
    const auto within = r.within();
    out +=
        fmt::format("{},{},{:.6f},{},{},{},{},{},{},{},{},{}\n", quoted(r.feature),
                    machine::kFeatureKindWords[static_cast<std::size_t>(r.kind)], r.nominal_mm, cell(r.predicted_mm, 6),
                    cell(r.std_mm, 6), cell(r.measured_mm, 6), cell(r.difference_um(), 3), cell(r.form_um, 3),
                    cell(r.taper_um, 3), cell(r.lower_mm, 6), cell(r.upper_mm, 6), within ? (*within ? "1" : "0") : "");
  }
  return out;
}

}  // namespace camber::inspect
