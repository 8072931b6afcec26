#pragma once
// The cases of tests/data/dynamics/cases.json and their tables of lobes.
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "base/units.h"
#include "dynamics/vibrating_cut.h"
#include "tests/support/csv_columns.h"
#include "tests/support/test_data.h"

namespace camber::testing {

struct LobeCase {
  std::string name;
  std::vector<dynamics::Mode> modes;
  dynamics::Cut cut;
  std::map<std::string, std::vector<double>> table;  ///< of numbers; border reads as NaN
};

inline std::string text_of(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

inline LobeCase lobe_case(const std::string& start) {
  LobeCase c;
  for (const auto& json : nlohmann::json::parse(text_of(tests::data_path("dynamics/cases.json")))) {
    if (!json["name"].get<std::string>().starts_with(start)) continue;
    c.name = json["name"];
    for (const std::string axis : {"x", "y"})
      for (const auto& m : json["modes_" + axis])
        c.modes.push_back(
            {axis == "x" ? Vec2::UnitX() : Vec2::UnitY(), m["f_Hz"], m["zeta"], m["k_N_per_m"].get<double>() / 1000});
    const double kt = json["Kt_N_per_m2"].get<double>() * 1e-6;
    c.cut.slices = {dynamics::shoulder(json["radial_immersion"],
                                       json["direction"] == "up" ? dynamics::Milling::up : dynamics::Milling::down, kt,
                                       kt * json["Kr"].get<double>())};
    c.cut.pitch_rad = dynamics::equal_pitches(json["teeth"]);
    if (const double helix = json["helix_deg"]; helix > 0)
      c.cut.lag_rad_per_mm = std::tan(rad_from_deg(helix)) / (json["diameter_mm"].get<double>() / 2);
  }
  // The kind of the border is a word.
  std::string text = text_of(tests::data_path("dynamics/" + c.name + ".csv"));
  for (const std::string word : {",hopf", ",flip", ",fold"})
    for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at))
      text.replace(at, word.size(), ",");
  c.table = tests::columns_of(text);
  return c;
}

}  // namespace camber::testing
