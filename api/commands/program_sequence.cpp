#include "api/commands/program_sequence.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "api/commands/predict.h"
#include "machine/assumptions.h"
#include "simulate/predict.h"

namespace camber::api {

using nlohmann::ordered_json;

std::string name_of_program(const std::vector<std::string>& programs, std::size_t index) {
  return fmt::format("{}-{}", index + 1, std::filesystem::path(programs[index]).stem().string());
}

machine::Job job_of_program(const machine::JobOfPrograms& all, std::size_t index, const std::string& stock) {
  machine::Job out = all.job;
  out.program = all.programs[index];
  if (stock.empty()) return out;
  out.stock = {};
  out.stock.vdb = stock;
  return out;
}

void save_stock_after(const machine::Job& job, const std::string& path) {
  Diagnostics ignored, of_cut;
  const PredictRequest request;
  PreparedJob prepared = prepare(job, request, ignored);
  predict_prepared(job, prepared, request, of_cut).machined->save(path);
}

void save_swept_stock(const machine::Job& job, const std::string& path) {
  Diagnostics ignored;
  PreparedJob prepared = prepare(job, {}, ignored);
  simulate::sweep_path(prepared.setup.target.blank, job, prepared.setup.program.path, 0);
  prepared.setup.target.blank.save(path);
}

std::string join_results(const machine::JobOfPrograms& all, const std::vector<std::string>& json,
                         const std::vector<std::string>& places) {
  ordered_json out = ordered_json::object(), list = ordered_json::array();
  if (const auto assumed = machine::assumptions(all.job); !assumed.empty()) out["assumed"] = assumed;
  double machine_time_s = 0;
  for (std::size_t i = 0; i < json.size(); ++i) {
    ordered_json one = {{"program", all.programs[i]}, {"output", places[i]}};
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

}  // namespace camber::api
