#pragma once
// A CSV that a command wrote, column by column.
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace camber::tests {

/// The columns of a CSV by the names in its first line; NaN for empty cells.
inline std::map<std::string, std::vector<double>> columns_of(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line, cell;
  std::getline(lines, line);
  std::vector<std::string> names;
  for (std::istringstream head(line); std::getline(head, cell, ',');) names.push_back(cell);
  std::map<std::string, std::vector<double>> out;
  while (std::getline(lines, line)) {
    std::istringstream row(line);
    for (const auto& name : names) {
      std::getline(row, cell, ',');
      char* end = nullptr;
      const double value = std::strtod(cell.c_str(), &end);
      out[name].push_back(end == cell.c_str() ? std::nan("") : value);  // words too
    }
  }
  return out;
}

}  // namespace camber::tests
