// Postfix form to a number.
#include "nc/expression.h"

#include <cmath>

#include <fmt/format.h>

#include "base/units.h"

namespace camber::nc {
namespace {

constexpr double kDegree = 0.017453292519943295;  // pi / 180

/// Functions that some arguments have no value for.
double checked(double value, const ExpressionOp& op, const std::string& why) {
  if (std::isfinite(value)) return value;
  throw MacroError(op.offset, "expression", why);
}

std::int64_t bits(double value) { return std::abs(value) < 9e15 ? static_cast<std::int64_t>(std::round(value)) : 0; }

double modulo(double a, double b, const Dialect& dialect) {
  if (dialect.mod_is_whole) return std::fmod(std::round(a), std::round(b));
  const double rest = std::fmod(a, b);
  return rest < 0 ? rest + std::abs(b) : rest;
}

double arc_tangent(double y, double x, const Dialect& dialect) {
  const double angle = std::atan2(y, x) / kDegree;
  return angle < 0 && dialect.atan_is_positive ? angle + 360 : angle;
}

double from_bcd(double value, const ExpressionOp& op) {
  if (!(value >= 0 && value < 1e15)) throw MacroError(op.offset, "expression", "BIN takes a number of zero or more");
  double result = 0, place = 1;
  for (auto rest = static_cast<std::uint64_t>(value); rest > 0; rest >>= 4, place *= 10)
    result += static_cast<double>(rest & 15) * place;
  return result;
}

double to_bcd(double value, const ExpressionOp& op) {
  if (!(value >= 0 && value < 1e12)) throw MacroError(op.offset, "expression", "BCD takes a number of zero or more");
  double result = 0, place = 1;
  for (auto rest = static_cast<std::uint64_t>(value); rest > 0; rest /= 10, place *= 16)
    result += static_cast<double>(rest % 10) * place;
  return result;
}

double rounded_to(double value, double step) { return step == 1 ? std::round(value) : std::round(value / step) * step; }

/// Applies a function of one number.
double unary(const ExpressionOp& op, double a, const Dialect& dialect, double round_step) {
  switch (op.op) {
    case Op::negate:
      return -a;
    case Op::sine:
      return std::sin(a * kDegree);
    case Op::cosine:
      return std::cos(a * kDegree);
    case Op::tangent:
      return std::tan(a * kDegree);
    case Op::arc_sine:
      return checked(std::asin(a) / kDegree, op, fmt::format("ASIN of {}; -1 to 1 was expected", a));
    case Op::arc_cosine:
      return checked(std::acos(a) / kDegree, op, fmt::format("ACOS of {}; -1 to 1 was expected", a));
    case Op::arc_tangent:
      return std::atan(a) / kDegree;
    case Op::square_root:
      return checked(std::sqrt(a), op, fmt::format("the square root of {}; zero or more was expected", a));
    case Op::absolute:
      return std::abs(a);
    case Op::round:
      return rounded_to(a, round_step);
    case Op::fix:
      return dialect.fix_to_zero ? std::trunc(a) : std::floor(a);
    case Op::fup:
      return dialect.fix_to_zero ? std::copysign(std::ceil(std::abs(a)), a) : std::ceil(a);
    case Op::logarithm:
      return checked(std::log(a), op, fmt::format("the logarithm of {}; a number greater than zero was expected", a));
    case Op::exponential:
      return checked(std::exp(a), op, fmt::format("EXP of {} is too large", a));
    case Op::from_bcd:
      return from_bcd(a, op);
    case Op::to_bcd:
      return to_bcd(a, op);
    case Op::logic_not:
      return a == 0 ? 1 : 0;
    default:
      return a;
  }
}

/// Vacant variables equal each other and no number; else they count as zero (Fanuc, custom macro B, table of #0).
bool equal(const Value& a, const Value& b, const Dialect& dialect) {
  if (!a || !b) return a.has_value() == b.has_value();
  const double difference = std::abs(*a - *b);
  return difference == 0 || difference < dialect.equal_within;
}

double logic(Op op, double a, double b, const Dialect& dialect) {
  if (!dialect.logic_is_bitwise) {
    const bool p = a != 0, q = b != 0;
    return op == Op::logic_and ? p && q : op == Op::logic_or ? p || q : p != q;
  }
  const std::int64_t p = bits(a), q = bits(b);
  return static_cast<double>(op == Op::logic_and ? p & q : op == Op::logic_or ? p | q : p ^ q);
}

double binary(const ExpressionOp& op, const Value& left, const Value& right, const Dialect& dialect) {
  const double a = left.value_or(0), b = right.value_or(0);
  switch (op.op) {
    case Op::add:
      return a + b;
    case Op::subtract:
      return a - b;
    case Op::multiply:
      return a * b;
    case Op::divide:
      if (b == 0) throw MacroError(op.offset, "expression", "a division by zero");
      return a / b;
    case Op::modulo:
      return checked(modulo(a, b, dialect), op, fmt::format("{} MOD {}; a divisor other than zero was expected", a, b));
    case Op::power:
      return checked(std::pow(a, b), op, fmt::format("{} to the power of {} is no number", a, b));
    case Op::equal:
      return equal(left, right, dialect);
    case Op::not_equal:
      return !equal(left, right, dialect);
    case Op::greater:
      return a > b;
    case Op::greater_equal:
      return a >= b;
    case Op::less:
      return a < b;
    case Op::less_equal:
      return a <= b;
    case Op::arc_tangent_2:
      return arc_tangent(a, b, dialect);
    default:
      return logic(op.op, a, b, dialect);
  }
}

bool takes_two(Op op) { return (op >= Op::add && op <= Op::logic_xor) || op == Op::arc_tangent_2; }

}  // namespace

Value evaluate(const Expressions& expressions, std::uint32_t index, VariableSource& variables, const Dialect& dialect,
               double round_step) {
  const Expression& e = expressions.list[index];
  const std::uint32_t first = dialect.and_binds_as_product ? e.product_first : e.first;
  const std::uint32_t count = dialect.and_binds_as_product ? e.product_count : e.count;
  std::vector<Value> stack;
  const auto pop = [&] {
    const Value v = stack.back();
    stack.pop_back();
    return v;
  };
  for (std::uint32_t i = first; i < first + count; ++i) {
    const ExpressionOp& op = expressions.ops[i];
    const std::string* name = nullptr;
    if (op.op == Op::named || op.op == Op::name_known) name = &expressions.names[static_cast<std::size_t>(op.operand)];
    if (op.op == Op::number) {
      stack.push_back(op.operand);
    } else if (op.op == Op::variable) {
      stack.push_back(variables.get(pop().value_or(0), op.offset));
    } else if (op.op == Op::named) {
      stack.push_back(variables.get(*name, op.offset));
    } else if (op.op == Op::variable_known) {
      stack.push_back(variables.known(pop().value_or(0)) ? 1.0 : 0.0);
    } else if (op.op == Op::name_known) {
      stack.push_back(variables.known(*name) ? 1.0 : 0.0);
    } else if (takes_two(op.op)) {
      const Value b = pop(), a = pop();
      stack.push_back(checked(binary(op, a, b, dialect), op, "the result is too large"));
    } else {
      const Value a = pop();
      if (op.op == Op::plus) {
        stack.push_back(a);
      } else {
        stack.push_back(unary(op, a.value_or(0), dialect, round_step));
      }
    }
  }
  return stack.back();
}

}  // namespace camber::nc
