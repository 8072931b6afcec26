#pragma once
// Comparisons with independent calculations as figures: expected here, recorded for bench/accuracy/report.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

namespace camber::tests {

/// Appends a figure of the running test to the file that CAMBER_FIGURES names, one line of JSON: `off_percent`, how far
/// Camber is off the independent calculation, and `allowed_percent`, how far it may be.
inline void record_figure(const std::string& what, double off_percent, double allowed_percent) {
  const char* path = std::getenv("CAMBER_FIGURES");
  if (path == nullptr) return;
  const ::testing::TestInfo* test = ::testing::UnitTest::GetInstance()->current_test_info();
  std::FILE* file = std::fopen(path, "a");
  ASSERT_NE(file, nullptr) << path;
  char line[512];
  const int length = std::snprintf(line, sizeof line,
                                   "{\"test\": \"%s.%s\", \"figure\": \"%s\", \"off_percent\": %.4f, "
                                   "\"allowed_percent\": %.4f}\n",
                                   test->test_suite_name(), test->name(), what.c_str(), off_percent, allowed_percent);
  std::fwrite(line, 1, static_cast<std::size_t>(length), file);  // tests run side by side: one write a line
  std::fclose(file);
}

/// Expects `got` within `allowed` (a share of `scale`, by itself of `want`) of the independent calculation's `want`.
inline void expect_figure(const std::string& what, double got, double want, double allowed, double scale = 0) {
  if (scale == 0) scale = std::abs(want);
  EXPECT_NEAR(got, want, allowed * scale) << what;
  record_figure(what, 100 * (got - want) / scale, 100 * allowed);
}

/// The same of vectors: the length of the difference.
template <class Vector>
void expect_vector_figure(const std::string& what, const Vector& got, const Vector& want, double allowed,
                          double scale = 0) {
  if (scale == 0) scale = want.norm();
  EXPECT_LT((got - want).norm(), allowed * scale)
      << what << ": " << got.transpose() << " instead of " << want.transpose();
  record_figure(what, 100 * (got - want).norm() / scale, 100 * allowed);
}

/// The largest of many deviations of one kind, recorded once.
class LargestFigure {
 public:
  LargestFigure(std::string what, double allowed) : what_(std::move(what)), allowed_(allowed) {}
  LargestFigure(const LargestFigure&) = delete;
  LargestFigure& operator=(const LargestFigure&) = delete;
  ~LargestFigure() { record_figure(what_, largest_, 100 * allowed_); }

  void expect(double got, double want, const std::string& where, double scale = 0) {
    if (scale == 0) scale = std::abs(want);
    EXPECT_NEAR(got, want, allowed_ * scale) << what_ << ", " << where;
    add(100 * (got - want) / scale);
  }
  template <class Vector>
  void expect_vector(const Vector& got, const Vector& want, const std::string& where, double scale = 0) {
    if (scale == 0) scale = want.norm();
    EXPECT_LT((got - want).norm(), allowed_ * scale)
        << what_ << ", " << where << ": " << got.transpose() << " instead of " << want.transpose();
    add(100 * (got - want).norm() / scale);
  }

 private:
  void add(double off) {
    if (std::abs(off) > std::abs(largest_)) largest_ = off;
  }

  std::string what_;
  double allowed_, largest_ = 0;
};

}  // namespace camber::tests
