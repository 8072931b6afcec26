#pragma once
// What nobody gave: values that a job or a machine only assumes. Every result begins with them.
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "machine/job_file.h"

namespace camber::machine {

/// The lists `assumed` of a job's file: keys whose values nobody gave, as camber init writes them, by table ("tool.1",
/// "material", "stock"). Nothing where the file cannot be read.
std::map<std::string, std::vector<std::string>> assumed_keys(const std::string& job_path);

/// Whether `key` of `table` is one of them.
bool is_assumed(const std::map<std::string, std::vector<std::string>>& keys, const std::string& table,
                std::string_view key);

/// One entry each for the machine (a preset, or a file that was made from one), the material (a preset that nobody
/// chose, or one that stands for a name that is not in the library), every tool and the stock; empty: everything was
/// given.
std::vector<std::string> assumptions(const Job& job);
std::vector<std::string> assumptions(const Machine& machine);

/// The warning that a result begins with, with a line end; empty where nothing is assumed.
std::string assumptions_text(const std::vector<std::string>& assumptions);

/// The JSON of a result, an object, with `assumed` as its first key; unchanged where nothing is assumed.
std::string with_assumptions(std::string json, const std::vector<std::string>& assumptions);

}  // namespace camber::machine
