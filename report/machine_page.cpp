#include "report/machine_page.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "base/json.h"
#include "base/numbers.h"
#include "base/output_file.h"
#include "base/units.h"
#include "kinematics/chain.h"
#include "report/machine_view.h"
#include "report/packed_arrays.h"
#include "report/page_parts.h"
#include "report/page_tables.h"

namespace camber::report {
namespace {

using kinematics::PoseSample;

constexpr double kBeyond = 1e-6;  ///< mm, degrees: what rounding leaves

constexpr const char* kMachineCard =
    "<div class=\"card\" id=\"machine\"><h2>The machine</h2>\n"
    "<noscript><p class=\"note\">The pictures need JavaScript; the tables below do without.</p></noscript>\n"
    "<div class=\"bar\" id=\"machine-controls\"></div>\n"
    "<div class=\"scenes\"><figure><figcaption>In the machine's frame</figcaption>"
    "<div class=\"scene\" id=\"scene\"></div></figure>\n"
    "<figure><figcaption>In the part's frame</figcaption><div class=\"scene\" id=\"part-scene\"></div></figure></div>\n"
    "<div class=\"timebar\" id=\"time\"></div>\n<div class=\"selected\" id=\"selected\"></div>\n"
    "<p class=\"note screen\">Drag to rotate, drag with the right button to pan, use the wheel to zoom, double-click "
    "to "
    "reset. Table, spindle and tool are drawn as plain bodies on the axes of the chain. Red: an axis is beyond its "
    "travel.</p></div>\n";

constexpr const char* kJointsCard =
    "<div class=\"card\" id=\"along\"><h2>Axes over time</h2>\n<div id=\"plots\"></div>\n"
    "<p class=\"note screen\">Click a plot to move the machine there; drag to zoom, double-click to reset. Dashed: "
    "limits of travel.</p></div>\n";

struct Axis {
  char letter = 'x';
  bool rotary = false;
  std::array<double, 2> travel{};  ///< mm or degrees
  Eigen::Index index() const { return letter - (rotary ? 'a' : 'x'); }
  char name() const { return static_cast<char>(std::toupper(static_cast<unsigned char>(letter))); }
  double at(const PoseSample& s) const {
    return rotary ? deg_from_rad(s.joints.rotary_rad[index()]) : s.joints.linear_mm[index()];
  }
  bool beyond(double value) const { return value < travel[0] - kBeyond || value > travel[1] + kBeyond; }
};

/// Linear axes first, then the rotary ones.
std::vector<Axis> axes_of(const machine::Machine& machine) {
  std::vector<Axis> out;
  for (const char letter : std::string_view("xyzabc")) {
    if (machine.kinematics.chain.find(letter) == std::string::npos) continue;
    Axis axis{.letter = letter, .rotary = letter < 'x'};
    const auto i = static_cast<std::size_t>(axis.index());
    axis.travel = axis.rotary ? machine.rotary[i].travel_rad : machine.axis[i].travel_mm;
    if (axis.rotary)
      for (double& end : axis.travel) end = deg_from_rad(end);
    out.push_back(axis);
  }
  return out;
}

/// Every n-th sample, the extremes of every joint, and both ends.
std::vector<PoseSample> thinned(std::span<const PoseSample> samples, const std::vector<Axis>& axes, std::size_t most) {
  if (samples.size() <= most) return {samples.begin(), samples.end()};
  const std::size_t step = samples.size() / most + 1;
  std::vector<bool> kept(samples.size());
  for (std::size_t i = 0; i < samples.size(); i += step) kept[i] = true;
  kept.back() = true;
  for (const Axis& axis : axes) {
    const auto less = [&](const PoseSample& a, const PoseSample& b) { return axis.at(a) < axis.at(b); };
    const auto [low, high] = std::minmax_element(samples.begin(), samples.end(), less);
    kept[static_cast<std::size_t>(low - samples.begin())] = kept[static_cast<std::size_t>(high - samples.begin())] =
        true;
  }
  std::vector<PoseSample> out;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (kept[i]) out.push_back(samples[i]);
  return out;
}

Json vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json limit_json(double value) { return std::isinf(value) ? Json(nullptr) : Json(value); }

template <class Value>
std::vector<double> column(const std::vector<PoseSample>& samples, Value value) {
  std::vector<double> out(samples.size());
  std::transform(samples.begin(), samples.end(), out.begin(), value);
  return out;
}

Json part_json(PackedArrays& arrays, const TriangleMesh& part) {
  Json out = {{"place", Json::array()}, {"corner", Json::array()}};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const auto& p : part.points) values.push_back(p[axis]);
    out["place"].push_back(arrays.add_quantised(values));
  }
  for (std::size_t corner = 0; corner < 3; ++corner) {
    std::vector<std::uint32_t> values;
    for (const auto& t : part.triangles) values.push_back(t[corner]);
    out["corner"].push_back(arrays.add_whole(values));
  }
  return out;
}

Json index_json(PackedArrays& arrays, const machine::Machine& machine, const std::vector<PoseSample>& samples,
                const MachinePage& page) {
  const kinematics::Chain chain(machine);
  Json out = {{"chain", chain_json(machine)},
              {"work", vector_json(page.work_origin_mm)},
              {"diameter", page.tool_diameter_mm},
              {"time_label", page.time_label},
              {"axes", Json::array()},
              {"tip", Json::array()},
              {"axis", Json::array()}};
  out["time"] = arrays.add_floats(column(samples, [](const PoseSample& s) { return s.time_s; }));
  out["length"] = arrays.add_quantised(
      column(samples, [&](const PoseSample& s) { return (chain.pose(s.joints, 0).tip_mm - s.pose.tip_mm).norm(); }));
  std::vector<std::uint32_t> lines;
  for (const PoseSample& s : samples) lines.push_back(static_cast<std::uint32_t>(std::max(s.line, 0)));
  out["line"] = arrays.add_whole(lines);
  for (const Axis& axis : axes_of(machine)) {
    const std::vector<double> values = column(samples, [&](const PoseSample& s) { return axis.at(s); });
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    out["axes"].push_back({{"axis", std::string(1, axis.name())},
                           {"rotary", axis.rotary},
                           {"travel", {limit_json(axis.travel[0]), limit_json(axis.travel[1])}},
                           {"range", {*low, *high}},
                           {"values", arrays.add_floats(values)}});
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    out["tip"].push_back(arrays.add_floats(column(samples, [&](const PoseSample& s) { return s.pose.tip_mm[i]; })));
    out["axis"].push_back(arrays.add_floats(column(samples, [&](const PoseSample& s) { return s.pose.axis[i]; })));
  }
  if (page.part && page.part->triangles.size() <= page.max_triangles) out["part"] = part_json(arrays, *page.part);
  return out;
}

std::string limit_text(double value) { return std::isinf(value) ? "unlimited" : number_text(value, 3); }

std::vector<std::string> notes_of(const MachinePage& page, std::size_t given, std::size_t shown) {
  std::vector<std::string> notes = page.notes;
  if (shown < given)
    notes.push_back(fmt::format(
        "Pictures and plots show {} of {} positions; the extremes of every axis are among them.", shown, given));
  if (page.part && page.part->triangles.size() > page.max_triangles)
    notes.push_back(fmt::format("The part has {} triangles and is not drawn; at most {} are.",
                                page.part->triangles.size(), page.max_triangles));
  return notes;
}

}  // namespace

TextTable axis_table(const machine::Machine& machine, std::span<const PoseSample> samples) {
  TextTable table{"Axes", {"axis", "unit", "lowest", "highest", "travel from", "to", "first line beyond"}, {}, {}};
  if (samples.empty()) return table;
  for (const Axis& axis : axes_of(machine)) {
    double low = axis.at(samples.front()), high = low;
    int line = 0;
    for (const PoseSample& s : samples) {
      const double value = axis.at(s);
      low = std::min(low, value);
      high = std::max(high, value);
      if (line == 0 && axis.beyond(value)) line = s.line;
    }
    table.rows.push_back({std::string(1, axis.name()), axis.rotary ? "degrees" : "mm", number_text(low, 3),
                          number_text(high, 3), limit_text(axis.travel[0]), limit_text(axis.travel[1]),
                          line > 0 ? fmt::format("{}", line) : "none"});
  }
  return table;
}

MachineCards machine_cards(const machine::Machine& machine, std::span<const PoseSample> samples,
                           const MachinePage& page) {
  const std::vector<PoseSample> shown = thinned(samples, axes_of(machine), page.max_samples);
  MachineCards out;
  out.notes = notes_of(page, samples.size(), shown.size());
  if (shown.empty()) {
    out.pictures =
        "<div class=\"card\"><p class=\"missing\">The positions of the axes are not known: the work offset, or the "
        "length of the tool, is missing.</p></div>\n";
    return out;
  }
  out.pictures = std::string(kMachineCard) + kJointsCard;
  out.axes = table_html(axis_table(machine, samples));
  PackedArrays arrays;
  const Json index = index_json(arrays, machine, shown, page);
  out.scripts = fmt::format(
      "<script type=\"application/json\" id=\"index\">{}</script>\n"
      "<script type=\"text/plain\" id=\"arrays\">{}</script>\n<script>{}</script>\n",
      script_safe(index.dump()), arrays.text(), machine_script());
  return out;
}

std::string machine_page(const machine::Machine& machine, std::span<const PoseSample> samples,
                         const MachinePage& page) {
  const MachineCards cards = machine_cards(machine, samples, page);
  ReportData figures;
  figures.figures = page.figures;
  std::string out = page_head(page.title, page.subtitle) + tiles_html(figures);
  out += list_html("Warnings", "warnings", page.warnings) + cards.pictures;
  out += "<div class=\"columns\">\n" + figures_html(figures) + cards.axes;
  for (const TextTable& table : page.tables) out += table_html(table);
  out += list_html("Notes", "notes", cards.notes) + "</div>\n</main>\n";
  return out + cards.scripts + "</body>\n</html>\n";
}

void write_machine_page(const std::string& path, const machine::Machine& machine, std::span<const PoseSample> samples,
                        const MachinePage& page) {
  write_file(path, machine_page(machine, samples, page));
}

}  // namespace camber::report
