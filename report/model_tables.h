#pragma once
// What a result rests on, as tables: the files, the program's version, the model and how well it is known.
#include <map>
#include <string>

#include "machine/job_file.h"
#include "report/html_report.h"

namespace camber::report {

/// The files of a job with their sizes and check sums (CRC-32, as zip has them), and Camber's version.
TextTable inputs_table(const machine::Job& job);

/// Standard errors that fit-force wrote into a file, "# ktc_MPa: 1860 +- 12 MPa", by name. Empty where there are none.
std::map<std::string, std::string> stated_errors(const std::string& path);

/// Force law with its coefficients and, where the material came from fit-force, their standard errors.
TextTable material_table(const machine::Job& job);
TextTable tools_table(const machine::Job& job);
/// Axes, corners and block time of the machine; how the simulation was cut up.
TextTable machine_table(const machine::Machine& machine);
TextTable simulation_table(const machine::Job& job);

}  // namespace camber::report
