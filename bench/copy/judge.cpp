// Judges a three-axis NC program against the part's STL with a height map (tests/support/height_map_judge.h), which
// shares no code with Camber. Prints the figures of one program as a table.
//
//   copy_judge OUT.nc PART.stl X0,Y0,Z0,X1,Y1,Z1 CELL ALLOWANCE TOOL:DIAMETER[,CORNER[,FLUTES[,POINT_deg]]]...
//   [TOOL@RADIUS,ABOVE_TIP]... [in=X0,Y0,Z0,X1,Y1,Z1] [reach=TOOL]
//
// TOOL@RADIUS,ABOVE_TIP: a shank or holder part, a cylinder of that radius from that height over the tip on. in: the
// part's surface is looked at in this box alone. reach: the cutter that is to have reached all of it, else the smallest
// mill.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/height_map_judge.h"

namespace {

std::vector<double> numbers(const std::string& text) {
  std::vector<double> out;
  std::istringstream cells(text);
  for (std::string cell; std::getline(cells, cell, ',');) out.push_back(std::stod(cell));
  return out;
}

void show(const char* what, const judge::Worst& w) {
  std::printf("%-28s %9.4f mm", what, w.depth);
  if (w.depth > 0) std::printf("  at %.3f %.3f %.3f, line %d", w.place.x, w.place.y, w.place.z, w.line);
  std::printf("\n");
}

int run(int argc, char** argv) {
  if (argc < 7) {
    std::fprintf(stderr, "copy_judge OUT.nc PART.stl X0,Y0,Z0,X1,Y1,Z1 CELL ALLOWANCE TOOL:DIAMETER[,CORNER...]...\n");
    return 2;
  }
  std::ifstream file(argv[1]);
  if (!file) throw std::runtime_error(std::string(argv[1]) + " cannot be read");
  std::ostringstream text;
  text << file.rdbuf();
  const std::vector<double> box = numbers(argv[3]);
  if (box.size() != 6) throw std::runtime_error("six numbers were expected: " + std::string(argv[3]));
  judge::Question q{{box[0], box[1], box[2]}, {box[3], box[4], box[5]}};
  q.cell = std::atof(argv[4]), q.allowance = std::atof(argv[5]);
  for (int i = 6; i < argc; ++i) {
    const std::string tool = argv[i];
    if (tool.starts_with("in=")) {
      const std::vector<double> v = numbers(tool.substr(3));
      q.from = {v.at(0), v.at(1), v.at(2)}, q.to = {v.at(3), v.at(4), v.at(5)};
      continue;
    }
    if (tool.starts_with("reach=")) {
      q.reaching = std::atoi(tool.c_str() + 6);
      continue;
    }
    const std::size_t at = tool.find_first_of(":@");
    if (at == std::string::npos) throw std::runtime_error("TOOL:DIAMETER was expected: " + tool);
    const std::vector<double> v = numbers(tool.substr(at + 1));
    judge::Cutter& cutter = q.cutters[std::atoi(tool.c_str())];
    if (tool[at] == '@') {
      cutter.bodies.push_back({v.at(0), v.at(1)});
      continue;
    }
    cutter.diameter = v.at(0);
    if (v.size() > 1) cutter.corner_radius = v[1];
    if (v.size() > 2) cutter.flutes = v[2];
    if (v.size() > 3) cutter.point_angle = v[3] * 3.14159265358979323846 / 180;
  }
  const judge::Verdict v =
      judge::judge(judge::ProgramReader().read(text.str()), judge::PartMesh(judge::read_stl(argv[2])), q);
  show("deepest into the part", v.gouge);
  show("most left over the part", v.left);
  show("of it within reach", v.left_reachable);
  std::printf("%-28s %9.2f mm2\n", "left over the allowance", v.left_area);
  show("rapid through material", v.rapid);
  show("shank through material", v.shank);
  show("shank or holder in material", v.body);
  std::printf("%-28s %9.1f mm3\n", "removed", v.removed);
  return v.gouge.depth > 0.01 || v.rapid.depth > 0 || v.shank.depth > 0 || v.body.depth > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "copy_judge: %s\n", e.what());
    return 2;
  }
}
