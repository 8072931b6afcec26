// The material's table of the report, for every force law.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "report/page_tables.h"
#include "tests/support/law_material.h"

namespace camber::report {
namespace {

TEST(MaterialTable, HasEveryCoefficientOfTheLaw) {
  for (const auto& law : machine::force_laws()) {
    machine::Job job;
    job.material = tests::material_of(law);
    const TextTable table = material_table(job);
    ASSERT_EQ(table.rows.size(), law.coefficients.size());
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      const auto& c = law.coefficients[i];
      EXPECT_EQ(table.rows[i][0], c.key);
      EXPECT_EQ(table.rows[i][1], fmt::format("{:.6g}", job.material.*c.field));
      EXPECT_EQ(table.rows[i][3], c.unit == "1" ? "" : c.unit);
    }
    EXPECT_EQ(table.note.find(law.title), 0u) << table.note;
  }
}

}  // namespace
}  // namespace camber::report
