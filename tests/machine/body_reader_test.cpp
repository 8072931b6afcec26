#include <gtest/gtest.h>

#include "machine/machine_model.h"
#include "tests/support/temp_folder.h"

namespace camber::machine {
namespace {

using tests::TempFolder;

constexpr const char* kChain = R"([kinematics]
chain = ["part", "c", "a", "y", "bed", "x", "z", "spindle"]
[axis.a]
direction = [1, 0, 0]
point_mm = [0, 0, -70]
positive = "table"
[axis.c]
direction = [0, 0, 1]
point_mm = [0, 0, 0]
positive = "table"
)";

/// Everything the reader says about this text behind the chain, with the file named m.toml.
std::string messages(const std::string& text, const std::string& before = kChain) {
  const TempFolder folder;
  const std::string path = folder.write("m.toml", before + text);
  Diagnostics diagnostics;
  try {
    read_machine(path, diagnostics);
  } catch (const InputError& problem) {
    return tests::replaced(problem.what(), folder.path() + "/", "");
  }
  return "";
}

TEST(BodyReader, CountsTheAxesBetweenPartAndBody) {
  const TempFolder folder;
  folder.write("table.stl", "solid\nendsolid\n");
  std::string text = kChain;
  for (const char* on : {"part", "c", "a", "y", "bed", "x", "z", "spindle"})
    text += std::string("[[body]]\non = \"") + on + "\"\nbox_mm = [[0, 0, -1.5], [1, 2, 3]]\n";
  text += "[[body]]\nname = \"trunnion\"\non = \"a\"\nmesh = \"table.stl\"\n";
  Diagnostics diagnostics;
  const Machine m = read_machine(folder.write("m.toml", text), diagnostics);
  std::vector<std::size_t> axes;
  for (const Body& body : m.bodies) axes.push_back(body.axes);
  EXPECT_EQ(axes, (std::vector<std::size_t>{0, 0, 1, 2, 3, 4, 5, 5, 1}));
  EXPECT_EQ(m.bodies[1].name, "body 2");
  EXPECT_EQ((*m.bodies[0].box_mm)[0], Vec3(0, 0, -1.5));
  EXPECT_EQ(m.bodies[8].name, "trunnion");
  EXPECT_EQ(m.bodies[8].mesh, folder.path() + "/table.stl");
  const std::string written = to_toml(m);
  Diagnostics again;
  EXPECT_EQ(to_toml(read_machine(folder.write("n.toml", written), again)), written);
  EXPECT_NE(written.find("[[body]]\nname = \"body 4\"\non = \"y\"\nbox_mm = [[0, 0, -1.5], [1, 2, 3]]\n"),
            std::string::npos)
      << written;
}

TEST(BodyReader, RefusesWhatIsNoBody) {
  EXPECT_EQ(
      messages("[[body]]\n"),
      "m.toml:11:1: error: on is missing in [[body]]; what carries the body, part, c, a, y, x, z, bed or spindle, "
      "was expected [key-missing]\n    [[body]]\n    ^\n"
      "m.toml:11:1: error: box_mm is missing in [[body]]; box_mm = [[x, y, z], [x, y, z]] or mesh was expected "
      "[key-missing]\n    [[body]]\n    ^");
  EXPECT_EQ(
      messages("[[body]]\non = \"b\"\nbox_mm = [[0, 0, 0], [1, 0, 1]]\n"),
      "m.toml:12:6: error: on is \"b\"; part, c, a, y, x, z, bed or spindle was expected [value-choice]\n"
      "    on = \"b\"\n         ^\n"
      "m.toml:13:10: error: box_mm goes from y = 0 to y = 0; the second must be greater than the first [body-box]\n"
      "    box_mm = [[0, 0, 0], [1, 0, 1]]\n             ^");
  EXPECT_EQ(messages("[[body]]\non = \"c\"\nmesh = \"none.stl\"\nbox_mm = [[0, 0, 0], [1, 1, 1]]\n"),
            "m.toml:13:8: error: mesh: no such file: none.stl (paths are relative to the machine's folder) "
            "[file-missing]\n    mesh = \"none.stl\"\n           ^\n"
            "m.toml:13:1: error: the body has box_mm and mesh; one of them was expected [body-shape]\n"
            "    mesh = \"none.stl\"\n    ^");
  EXPECT_EQ(messages("[body]\non = \"c\"\n"),
            "m.toml:11:1: error: body is a table; a list of tables [[body]] was expected [value-type]\n"
            "    [body]\n    ^");
}

TEST(BodyReader, WithoutAChainBodiesAreOnThePartOrTheSpindle) {
  EXPECT_EQ(messages("[[body]]\non = \"bed\"\nbox_mm = [[0, 0, 0], [1, 1, 1]]\n", ""),
            "m.toml:2:6: error: on is \"bed\"; part or spindle was expected [value-choice]\n"
            "    on = \"bed\"\n         ^");
  const TempFolder folder;
  Diagnostics diagnostics;
  const Machine m = read_machine(folder.write("m.toml",
                                              "[[body]]\non = \"spindle\"\nbox_mm = [[-9, -9, 0], [9, 9, 50]]\n"
                                              "[[body]]\non = \"part\"\nbox_mm = [[0, 0, 0], [1, 1, 1]]\n"),
                                 diagnostics);
  ASSERT_EQ(m.bodies.size(), 2);
  EXPECT_EQ(m.bodies[0].axes, 3);
  EXPECT_EQ(m.bodies[1].axes, 0);
}

}  // namespace
}  // namespace camber::machine
