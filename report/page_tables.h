#pragma once
// The parts of the report page that are plain HTML: they are read without a script, and on paper.
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "compensate/compensate_path.h"
#include "machine/job_file.h"
#include "report/html_report.h"

namespace camber::report {

/// Text with &, <, > and quotes made harmless.
std::string html_text(std::string_view text);

/// JSON as a script element may hold it. A "<" stands in strings alone, where its escape means the same: without it
/// neither an end tag nor "<!--<script", which hides the end tag, can come up.
std::string script_safe(const std::string& json);

/// A number of the page: `decimals` behind the point, a true minus sign; a dash where it is not finite.
std::string number_text(double value, int decimals);

/// A page from its first byte to the heading and the line below it.
std::string page_head(std::string_view title, std::string_view subtitle);
std::string tiles_html(const ReportData& data);
std::string figures_html(const ReportData& data);
std::string table_html(const TextTable& table);
/// A card with a list; empty without items.
std::string list_html(const std::string& title, const std::string& css_class, const std::vector<std::string>& items);

// What compensation could and could not do, as tables of text.

/// Error decomposition; the depth into the part; the second prediction and the band, where they were asked for.
std::vector<TextTable> compensation_tables(const compensate::CompensationResult& result);

// What a result rests on, as tables: the files, the program's version, the model and how well it is known.

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

// The lines of a program whose surface is worst.

/// The ten lines with the greatest root mean square of the form error over the surface that they left, weighted by
/// area, the worst first; lines that left less than a thousandth of the whole surface are passed over. `after`: of the
/// emitted program's error. No rows where no line is known.
TextTable worst_lines_table(const SurfaceSamples& surface, std::string_view program_text, bool after);

}  // namespace camber::report
