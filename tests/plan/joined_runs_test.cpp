// Operations that are cut in one run, and what must come before what.
#include "plan/joined_runs.h"

#include <gtest/gtest.h>

#include "plan/programs.h"
#include "tests/support/random_part.h"
#include "tests/support/temp_folder.h"

namespace camber::plan {
namespace {

using tests::BlockPart;
using tests::box;
using tests::TempFolder;

std::string axis(const char* name) {
  return std::string("[axis.") + name + "]\nmax_velocity_mm_per_min = 20000\nacceleration_mm_per_s2 = 3000\n";
}

constexpr const char* kCases =
    "[[case]]\nmaterial = \"A5052\"\ntool = \"end mill\"\ntool_material = \"carbide\"\ndiameter_mm = 8\n"
    "speed_m_per_min = 300\nfeed_mm_per_min = 3600\naxial_depth_mm = 3.2\nradial_depth_mm = 3\n"
    "[[case]]\nmaterial = \"A5052\"\ntool = \"drill\"\ntool_material = \"carbide\"\ndiameter_mm = 8\n"
    "speed_m_per_min = 100\nfeed_mm_per_min = 600\n";

std::string mill(int number, double diameter) {
  return "[tool." + std::to_string(number) + "]\ntype = \"flat\"\ndiameter_mm = " + std::to_string(diameter) +
         "\nflutes = 3\noverhang_mm = 60\n";
}

struct Planned {
  PlanInput input;
  PlanResult result;
  SetupPlan& setup() { return result.setups.at(0); }
  const PlannedDivision& best() const { return result.setups[0].plans.at(result.setups[0].best); }
};

Planned planned(const TempFolder& folder, const BlockPart& part, const machine::Box& blank) {
  tests::write_stl(part.mesh(), folder / "part.stl");
  folder.write("machine.toml", "[control]\ndialect = \"fanuc\"\nperiod_ms = 4.0\n" + axis("x") + axis("y") + axis("z") +
                                   "[spindle]\nmax_rpm = 12000\n");
  folder.write("cases.toml", kCases);
  const auto corner = [](const Vec3& p) {
    return "[" + std::to_string(p.x()) + ", " + std::to_string(p.y()) + ", " + std::to_string(p.z()) + "]";
  };
  Diagnostics diagnostics;
  PlanInput input = read_plan_input(
      folder.write("plan.toml",
                   "part = \"part.stl\"\nmachine = \"machine.toml\"\ncase_base = \"cases.toml\"\n[blank]\nbox_mm = [" +
                       corner(blank.min_mm) + ", " + corner(blank.max_mm) +
                       "]\n[material]\npreset = \"Al6082-T6\"\n[work]\nmaterial = \"A5052\"\nfinish = \"fine\"\n"
                       "allowance_mm = 0.2\n[simulation]\nvoxel_mm = 0.5\n" +
                       mill(1, 3) + mill(2, 6) + mill(3, 12) +
                       "[tool.4]\ntype = \"drill\"\ndiameter_mm = 8\nflutes = 2\noverhang_mm = 90\n"
                       "[tool.5]\ntype = \"drill\"\ndiameter_mm = 10\nflutes = 2\noverhang_mm = 90\n"),
      diagnostics);
  PlanResult result = make_plan(input, diagnostics);
  return {std::move(input), std::move(result)};
}

/// A face of 2 mm over the whole, and a step of 2 mm along one side below it: at 4.8 mm a level they are one region.
Planned face_and_step(const TempFolder& folder) {
  return planned(folder, {.block = box(0, 0, 0, 60, 40, 18), .pockets = {box(-1, -1, 16, 61, 25, 19)}, .holes = {}},
                 box(0, 0, 0, 60, 40, 20));
}

TEST(JoinedRuns, TakeWhatLiesOnEachOther) {
  const TempFolder folder;
  const Planned p = face_and_step(folder);
  const auto& operations = p.best().operations;
  ASSERT_EQ(operations.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(operations[i].kind, i < 2 ? OperationKind::rough : OperationKind::finish) << i;
    EXPECT_EQ(operations[i].joined, i % 2 == 1) << i;
    EXPECT_EQ(operations[i].primitive, 1 + i % 2) << i;
    EXPECT_EQ(first_of_run(p.best(), i), i / 2 * 2);
    EXPECT_EQ(operations[i].pattern, operations[i / 2 * 2].pattern);
  }
  // The depth of both.
  EXPECT_NEAR(operations[0].conditions.axial_mm, 4, 1e-9);
  EXPECT_EQ(operations[1].conditions.axial_mm, operations[0].conditions.axial_mm);
  const auto copied = copy_operations(p.input, p.best());
  ASSERT_EQ(copied.size(), 2U);
  ASSERT_EQ(copied[0].region.boxes_mm.size(), 2U);
  EXPECT_NEAR(copied[0].region.boxes_mm[0][0].z(), 18, 1e-9);
  EXPECT_NEAR(copied[0].region.boxes_mm[1][0].z(), 16, 1e-9);
  EXPECT_NEAR((*copied[0].region.z_mm)[0], 16, 1e-9);
  EXPECT_NEAR((*copied[0].region.z_mm)[1], 20, 1e-9);
  EXPECT_EQ(copied[1].place.location.line, 3U);  // the row with which the run begins
}

TEST(JoinedRuns, LeaveApartWhatWallsDivide) {
  const TempFolder folder;
  const Planned p = planned(folder,
                            {.block = box(0, 0, 0, 120, 60, 20),
                             .pockets = {box(5, 5, 16, 50, 50, 21), box(70, 5, 16, 115, 50, 21)},
                             .holes = {}},
                            box(0, 0, 0, 120, 60, 20));
  ASSERT_GE(p.best().operations.size(), 4U);
  for (const PlanOperation& o : p.best().operations) EXPECT_FALSE(o.joined);
}

/// Under a face of one level lies a small shallow step: together two even levels would be cut, the first one over the
/// whole face, and then the face's own bottom.
TEST(JoinedRuns, LeaveApartWhatTakesLongerTogether) {
  const TempFolder folder;
  const Planned p =
      planned(folder, {.block = box(0, 0, 0, 120, 100, 25.4), .pockets = {box(90, -1, 24.4, 121, 30, 27)}, .holes = {}},
              box(0, 0, 0, 120, 100, 30));
  for (const PlanOperation& o : p.best().operations)
    EXPECT_FALSE(o.kind == OperationKind::rough && o.joined) << o.primitive;
}

/// Of random parts: what is joined fits together, what a primitive needs comes before it, nothing is lost.
TEST(JoinedRuns, KeepWhatMustComeFirst) {
  std::size_t joined = 0;
  for (unsigned seed = 3; seed < 33; ++seed) {
    const tests::RandomPart made = tests::random_part(seed);
    const TempFolder folder;
    Planned p = planned(folder, made.part, made.blank);
    for (const PlannedDivision& plan : p.setup().plans) {
      const auto& ops = plan.operations;
      const auto primitive = [&](const PlanOperation& o) -> const VolumePrimitive& {
        return plan.primitives[plan.order.steps[o.primitive - 1].primitive];
      };
      for (std::size_t i = 0; i < ops.size(); ++i) {
        if (ops[i].joined) {
          ++joined;
          ASSERT_GT(i, 0U);
          EXPECT_EQ(not_joined_because(ops[i - 1], ops[i]), "") << seed;
          EXPECT_EQ(ops[i].conditions.axial_mm, ops[i - 1].conditions.axial_mm) << seed;
        }
        for (std::size_t k = 0; k < i; ++k) {
          const VolumePrimitive &before = primitive(ops[k]), &after = primitive(ops[i]);
          if (before.is_hole || after.is_hole) {
            EXPECT_TRUE(after.is_hole || !before.is_hole) << seed << ": a hole before a box";
            continue;
          }
          if (ops[k].primitive == ops[i].primitive) {
            EXPECT_LE(static_cast<int>(ops[k].kind), static_cast<int>(ops[i].kind)) << seed;
            continue;
          }
          // What lies above is roughed before, or in the same run.
          bool over = after.min_mm.z() > before.max_mm.z() - 1e-6 && first_of_run(plan, i) != first_of_run(plan, k) &&
                      ops[i].kind == OperationKind::rough && ops[k].kind == OperationKind::rough;
          for (int a = 0; a < 2; ++a)
            over = over &&
                   std::min(before.max_mm[a], after.max_mm[a]) > std::max(before.min_mm[a], after.min_mm[a]) + 1e-6;
          EXPECT_FALSE(over) << seed << ": " << ops[k].primitive << " before " << ops[i].primitive << " above it";
        }
      }
    }
  }
  EXPECT_GT(joined, 20U);
}

std::string table_error(Planned& p, const TempFolder& folder, const std::string& rows) {
  Diagnostics diagnostics;
  const std::string path = folder.write("operations.toml", "division = \"largest\"\n" + rows);
  try {
    read_operations(path, p.input, p.setup(), diagnostics);
  } catch (const InputError& error) {
    const std::string text = to_string(error.diagnostics().at(0));
    return text.substr(path.size(), text.find('\n') - path.size());
  }
  return "nothing";
}

TEST(JoinedRuns, AreReadBackFromTheTable) {
  const TempFolder folder;
  Planned p = face_and_step(folder);
  const std::string text = operations_toml(p.input, p.setup(), p.setup().best);
  EXPECT_NE(text.find("\njoined = true  # cut in one run with 1\n"), std::string::npos) << text;
  Diagnostics diagnostics;
  read_operations(folder.write("operations.toml", text), p.input, p.setup(), diagnostics);
  EXPECT_EQ(operations_toml(p.input, p.setup(), 0), text);
  // Without the word each is cut by itself.
  std::string apart = text;
  for (std::size_t at = 0; (at = apart.find("joined = true", at)) != std::string::npos;)
    apart.replace(at, 13, "joined = false");
  read_operations(folder.write("operations.toml", apart), p.input, p.setup(), diagnostics);
  EXPECT_EQ(copy_operations(p.input, p.best()).size(), 4U);
}

TEST(JoinedRuns, AreRefusedWhereTheyDoNotFit) {
  const TempFolder folder;
  const std::string first = "[[operation]]\nprimitive = 1\nkind = \"rough\"\n",
                    second = "[[operation]]\nprimitive = 2\n";
  const auto said = [&](const std::string& rows) {
    Planned p = face_and_step(folder);
    return table_error(p, folder, rows);
  };
  EXPECT_EQ(said(first + second + "kind = \"rough\"\njoined = true\n"), "nothing");
  EXPECT_EQ(said("[[operation]]\nprimitive = 1\nkind = \"rough\"\njoined = true\n"),
            ":5:10: error: joined = true in the first row; an operation that is cut in one run with the row before was "
            "expected [plan-joined]");
  EXPECT_EQ(said(first + second + "kind = \"rough\"\ntool = 2\njoined = true\n"),
            ":9:10: error: joined = true, but its tool is 2, that of the row before 3; an operation that is cut in one "
            "run with the row before was expected [plan-joined]");
  EXPECT_EQ(said(first + second + "kind = \"finish\"\njoined = true\n"),
            ":8:10: error: joined = true, but it is of another kind than the row before; an operation that is cut in "
            "one run with the row before was expected [plan-joined]");
  EXPECT_EQ(said(first + second + "kind = \"rough\"\nfeed_mm_per_min = 1000\nallowance_mm = 0.2\njoined = true\n"),
            ":10:10: error: joined = true, but spindle speed, feed or depths are not those of the row before; the same "
            "were expected in one run [plan-joined]");
}

}  // namespace
}  // namespace camber::plan
