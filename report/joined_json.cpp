#include "report/joined_json.h"

#include <nlohmann/json.hpp>

namespace camber::report {

using nlohmann::ordered_json;

std::string with_sections(const std::string& json, const SectionFigures& figures) {
  auto out = ordered_json::parse(json);
  out["sections"] = {{"pieces", figures.pieces},
                     {"rounds", figures.rounds},
                     {"solved_again", figures.solved_again},
                     {"largest_change_um", figures.largest_change_um}};
  return out.dump(2) + "\n";
}

std::string join_results(const std::vector<std::string>& assumed, const std::vector<std::string>& programs,
                         const std::vector<std::string>& json, const std::vector<std::string>& places) {
  ordered_json out = ordered_json::object(), list = ordered_json::array();
  if (!assumed.empty()) out["assumed"] = assumed;
  double machine_time_s = 0;
  for (std::size_t i = 0; i < json.size(); ++i) {
    ordered_json one = {{"program", programs[i]}, {"output", places[i]}};
    if (!json[i].empty()) {
      ordered_json result = ordered_json::parse(json[i]);
      result.erase("assumed");
      if (const auto time = result.find("machine_time_s"); time != result.end())
        machine_time_s += time->is_object() ? time->value("after", 0.0) : time->get<double>();
      one.update(result);
    }
    list.push_back(std::move(one));
  }
  out["machine_time_s"] = machine_time_s;
  out["programs"] = std::move(list);
  return out.dump(2) + "\n";
}

}  // namespace camber::report
