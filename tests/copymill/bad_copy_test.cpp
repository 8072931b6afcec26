// What is said of jobs and parts that copy milling cannot take.
#include <gtest/gtest.h>

#include "copymill/copy_milling.h"
#include "tests/copymill/small_copy.h"

namespace camber::copymill {
namespace {

using tests::read_copy;
using tests::ReadCopy;
using tests::SmallCopy;
using tests::TempFolder;

/// All messages, without the folders.
std::string said(const SmallCopy& c, const std::string& part_text = {}) {
  const TempFolder folder;
  try {
    ReadCopy job = read_copy(folder, c);
    if (!part_text.empty()) job.job.part.mesh = folder.write("part.stl", part_text);
    Diagnostics diagnostics;
    copy(job.job, job.operations, {}, diagnostics);
  } catch (const InputError& e) {
    std::string out;
    for (const Diagnostic& d : e.diagnostics()) out += to_string(d) + "\n";
    for (const std::string& name : {folder.path() + "/", std::string(CAMBER_SOURCE_DIR "/samples/14-copy-milling/")})
      for (std::size_t at = 0; (at = out.find(name, at)) != std::string::npos;) out.erase(at, name.size());
    return out;
  }
  return "nothing";
}

std::string operation(const std::string& keys) {
  return "[[copy]]\ntool = 1\nmode = \"contour-line\"\nspindle_rpm = 8000\nfeed_mm_per_min = 3000\n" + keys;
}

TEST(BadCopy, DepthsOfZero) {
  EXPECT_EQ(said({.operations = operation("radial_depth_mm = 0\naxial_depth_mm = 0.0\n")}),
            "job.toml:33:19: error: radial_depth_mm is 0; a number greater than zero was expected [value-range]\n"
            "    radial_depth_mm = 0\n                      ^\n"
            "job.toml:34:18: error: axial_depth_mm is 0; a number greater than zero was expected [value-range]\n"
            "    axial_depth_mm = 0.0\n                     ^\n");
}

TEST(BadCopy, MeshThatIsOpen) {
  EXPECT_EQ(
      said({.operations = operation("radial_depth_mm = 4\naxial_depth_mm = 4\n")},
           "solid part\nfacet normal 0 0 1\nouter loop\nvertex 0 0 -15\nvertex 60 0 0\nvertex 0 45 0\nendloop\n"
           "endfacet\nendsolid\n"),
      "part.stl: error: the mesh is not closed: 3 of its edges have no second triangle, and the cutter could fall "
      "through; a closed one was expected [stl-open]\n");
}

TEST(BadCopy, ToolLargerThanEveryPocket) {
  const std::string out =
      said({.part = "slot",
            .stock = "box_mm = [[0, 0, -12], [60, 30, 0]]",
            .operations = operation("radial_depth_mm = 4\naxial_depth_mm = 4\nallowance_mm = 2.5\n")});
  EXPECT_EQ(out.substr(0, 9), "job.toml:");
  EXPECT_NE(
      out.find("error: T1 with a diameter of 8 mm and an allowance of 2.5 mm has no place in the region; a tool that "
               "fits between the part's walls was expected [tool-too-large]\n"),
      std::string::npos)
      << out;
}

TEST(BadCopy, SlottingWhereThereAreNoSlots) {
  EXPECT_EQ(said({.operations = "[[copy]]\ntool = 3\nmode = \"drilling\"\nspindle_rpm = 4000\nfeed_mm_per_min = 400\n"
                                "axial_depth_mm = 3\nslotting = \"full-width\"\nholes_mm = [[10, 10]]\n"
                                "region = { z_mm = [-8, 0] }\n"}),
            "job.toml:34:1: error: slotting in drilling; it is for loops and rows level by level [copy-mode]\n"
            "    slotting = \"full-width\"\n    ^\n");
  EXPECT_EQ(said({.operations = operation("radial_depth_mm = 4\naxial_depth_mm = 4\nslotting = \"never\"\n")}),
            "job.toml:35:12: error: slotting is \"never\"; \"by-load\", \"full-width\" or \"trochoidal\" was expected "
            "[value-choice]\n    slotting = \"never\"\n               ^\n");
}

TEST(BadCopy, BoxesThatAreNoRegion) {
  const auto region = [](const std::string& keys) {
    return said({.operations = operation("radial_depth_mm = 4\naxial_depth_mm = 4\nregion = { " + keys + " }\n")});
  };
  const auto shown = [](const std::string& keys, std::size_t column) {
    return "    region = { " + keys + " }\n    " + std::string(column - 1, ' ') + "^\n";
  };
  const std::string empty = "boxes_mm = [[0, 0, -5, 9, 9, -5]]", none = "boxes_mm = []",
                    two = "boxes_mm = [[0, 0, -5, 9, 9, 0]], z_mm = [-5, 0]", five = "boxes_mm = [[0, 0, -5, 9, 9]]";
  EXPECT_EQ(region(empty),
            "job.toml:35:23: error: box 1 of boxes_mm is empty; the second corner must be greater in X, Y and Z than "
            "the first [region-empty]\n" +
                shown(empty, 23));
  EXPECT_EQ(region(none),
            "job.toml:35:23: error: boxes_mm has no box; one at least was expected [region-empty]\n" + shown(none, 23));
  EXPECT_EQ(
      region(two),
      "job.toml:35:46: error: the region has boxes_mm and z_mm; one of them was expected [region]\n" + shown(two, 46));
  EXPECT_EQ(region(five),
            "job.toml:35:23: error: boxes_mm: boxes [x, y, z, x, y, z] of two opposite corners, was "
            "expected [value-count]\n" +
                shown(five, 23));
  EXPECT_EQ(
      said({.operations = "[[copy]]\ntool = 3\nmode = \"drilling\"\nspindle_rpm = 4000\nfeed_mm_per_min = 400\n"
                          "axial_depth_mm = 3\nholes_mm = [[10, 10]]\nregion = { boxes_mm = [[0, 0, -5, 9, 9, 0]] "
                          "}\n"}),
      "job.toml:35:10: error: boxes_mm in drilling; they are for loops and rows level by level [copy-mode]\n    "
      "region = { boxes_mm = [[0, 0, -5, 9, 9, 0]] }\n             ^\n");
}

TEST(BadCopy, SlottingIsWrittenAsItIsRead) {
  const TempFolder folder;
  for (const std::string word : {"full-width", "trochoidal"}) {
    const ReadCopy read = read_copy(
        folder, {.operations = operation("radial_depth_mm = 4\naxial_depth_mm = 4\nslotting = \"" + word + "\"\n")});
    EXPECT_NE(machine::to_toml(read.operations.at(0)).find("slotting = \"" + word + "\"\n"), std::string::npos);
  }
  const ReadCopy by_load = read_copy(folder, {.operations = operation("radial_depth_mm = 4\naxial_depth_mm = 4\n")});
  EXPECT_EQ(machine::to_toml(by_load.operations.at(0)).find("slotting"), std::string::npos);
}

}  // namespace
}  // namespace camber::copymill
