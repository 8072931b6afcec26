#include "base/json.h"

#include <algorithm>
#include <cassert>

#include <nlohmann/json.hpp>

namespace camber {

Json::Json() : value_(nullptr) {}
Json::Json(std::nullptr_t) : value_(nullptr) {}
Json::Json(bool value) : value_(value) {}
Json::Json(Whole value) : value_(value.value) {}
Json::Json(Natural value) : value_(value.value) {}
Json::Json(double value) : value_(value) {}
Json::Json(const char* text) : value_(std::string(text)) {}
Json::Json(std::string text) : value_(std::move(text)) {}
Json::Json(std::string_view text) : value_(std::string(text)) {}
Json::Json(const Json&) = default;
Json::Json(Json&&) noexcept = default;
Json& Json::operator=(const Json&) = default;
Json& Json::operator=(Json&&) noexcept = default;
Json::~Json() = default;

Json::Json(std::initializer_list<Json> values)
    : Json(std::ranges::all_of(values, &Json::is_member) ? object(values) : array(values)) {}

bool Json::is_member() const {
  const Array* pair = std::get_if<Array>(&value_);
  return pair && pair->size() == 2 && std::holds_alternative<std::string>(pair->front().value_);
}

Json Json::array(std::initializer_list<Json> values) {
  Json out;
  out.value_ = Array(values);
  return out;
}

Json Json::object(std::initializer_list<Json> members) {
  Json out;
  out.value_ = Object();
  for (const Json& member : members) {
    assert(member.is_member());
    const Array& pair = std::get<Array>(member.value_);
    out[std::get<std::string>(pair[0].value_)] = pair[1];
  }
  return out;
}

Json& Json::operator[](std::string_view name) {
  if (is_null()) value_ = Object();
  assert(std::holds_alternative<Object>(value_));
  Object& members = std::get<Object>(value_);
  const auto found = std::ranges::find(members, name, &Member::name);
  if (found != members.end()) return found->value;
  return members.emplace_back(Member{std::string(name), Json()}).value;
}

void Json::push_back(Json value) {
  if (is_null()) value_ = Array();
  assert(std::holds_alternative<Array>(value_));
  std::get<Array>(value_).push_back(std::move(value));
}

void Json::update(const Json& other) {
  for (const Member& member : std::get<Object>(other.value_)) (*this)[member.name] = member.value;
}

void Json::erase(std::string_view name) {
  std::erase_if(std::get<Object>(value_), [&](const Member& member) { return member.name == name; });
}

bool Json::contains(std::string_view name) const {
  const Object* members = std::get_if<Object>(&value_);
  return members && std::ranges::find(*members, name, &Member::name) != members->end();
}

bool Json::is_null() const { return std::holds_alternative<std::nullptr_t>(value_); }

std::size_t Json::size() const {
  if (const Array* values = std::get_if<Array>(&value_)) return values->size();
  const Object* members = std::get_if<Object>(&value_);
  return members ? members->size() : 0;
}

/// The same document as nlohmann's writer takes it.
struct Json::Written {
  using Out = nlohmann::ordered_json;

  Out operator()(const Array& values) const {
    Out out = Out::array();
    for (const Json& value : values) out.push_back(std::visit(*this, value.value_));
    return out;
  }
  Out operator()(const Object& members) const {
    Out out = Out::object();
    // Names are unique: not looked for again.
    for (const Member& member : members)
      out.get_ref<Out::object_t&>().emplace_back(member.name, std::visit(*this, member.value.value_));
    return out;
  }
  template <class Scalar>
  Out operator()(const Scalar& value) const {
    return Out(value);
  }
};

std::string Json::dump(int indent) const {
  return std::visit(Written{}, value_).dump(indent, ' ', false, Written::Out::error_handler_t::replace);
}

}  // namespace camber
