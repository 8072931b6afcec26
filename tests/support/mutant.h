#pragma once

#include <concepts>
#include <cstdlib>
#include <type_traits>

/// Faults that scripts/mutants puts into a copy of the source: each of these calls stands in place of one expression
/// and is that expression, unless the environment variable CAMBER_MUTANT has its number.
namespace camber_mutant {

inline const int active = std::getenv("CAMBER_MUTANT") ? std::atoi(std::getenv("CAMBER_MUTANT")) : 0;

template <typename T>
concept Number = std::is_arithmetic_v<T> && !std::same_as<T, bool>;

template <typename T>
concept Counted = !std::floating_point<T>;

/// Of a summand: turned.
inline int sign(int n) { return active == n ? -1 : 1; }

/// Of a summand: dropped.
inline int term(int n) { return active == n ? 0 : 1; }

/// Of a product or quotient: dropped.
template <Number T>
T factor(int n, T value) {
  return active == n ? T{1} : value;
}

template <std::floating_point T>
T scaled(int n, T value) {
  return active == n ? static_cast<T>(1.02) * value : value;
}

template <std::integral T>
T off_by_one(int n, T value) {
  return active == n ? static_cast<T>(value + 1) : value;
}

/// a < b, or a <= b; and so on. Not of floating point numbers, which are hardly ever equal.
template <Counted A, Counted B>
bool less(int n, const A& a, const B& b) {
  return active == n ? a <= b : a < b;
}
template <Counted A, Counted B>
bool less_equal(int n, const A& a, const B& b) {
  return active == n ? a < b : a <= b;
}
template <Counted A, Counted B>
bool greater(int n, const A& a, const B& b) {
  return active == n ? a >= b : a > b;
}
template <Counted A, Counted B>
bool greater_equal(int n, const A& a, const B& b) {
  return active == n ? a > b : a >= b;
}

/// The index of an axis: of y in place of x, of x in place of y or z.
inline int axis(int n, int index) { return active == n ? (index == 0 ? 1 : 0) : index; }

template <typename T>
bool inverted(int n, const T& condition) {
  return static_cast<bool>(condition) != (active == n);
}

}  // namespace camber_mutant
