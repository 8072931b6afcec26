#pragma once
// A JSON document that is put together and written. Reading, and how numbers are written, are nlohmann's
// (base/json.cpp): its header takes the compiler longer than most files that only write a few figures.
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace camber {

/// A value of JSON. Members of objects keep the order in which they were added.
///
/// In braces, pairs that begin with a text make an object, and anything else an array:
///   Json{{"time_s", 1.5}, {"blocks", 7}} is {"time_s": 1.5, "blocks": 7}, Json{1, 2} is [1, 2].
class Json {
 public:
  struct Member;

  Json();  ///< null
  Json(std::nullptr_t);
  Json(bool value);
  template <std::signed_integral T>
  Json(T value) : Json(Whole{static_cast<std::int64_t>(value)}) {}
  template <std::unsigned_integral T>
  requires(!std::same_as<T, bool>) Json(T value) : Json(Natural{static_cast<std::uint64_t>(value)}) {}
  Json(double value);  ///< what is not finite is written as null
  Json(const char* text);
  Json(std::string text);
  Json(std::string_view text);
  template <std::convertible_to<Json> T>
  Json(const std::vector<T>& values) : Json(of_range(values)) {}
  template <std::convertible_to<Json> T, std::size_t N>
  Json(const std::array<T, N>& values) : Json(of_range(values)) {}
  Json(std::initializer_list<Json> values);
  Json(const Json&);
  Json(Json&&) noexcept;
  Json& operator=(const Json&);
  Json& operator=(Json&&) noexcept;
  ~Json();

  static Json array(std::initializer_list<Json> values = {});
  static Json object(std::initializer_list<Json> members = {});

  /// The member of that name, null if it is new. What is null becomes an object. Precondition: null or an object.
  Json& operator[](std::string_view name);
  /// Adds to an array. What is null becomes one. Precondition: null or an array.
  void push_back(Json value);
  /// Takes over the members of another object; those that both have get its values. Precondition: both are objects.
  void update(const Json& other);
  /// Removes a member, if the object has it.
  void erase(std::string_view name);
  bool contains(std::string_view name) const;
  bool is_null() const;
  bool empty() const { return size() == 0; }  ///< no elements or members
  std::size_t size() const;

  /// The value as text: in one line, or indented by `indent` blanks a level. Bytes that are not UTF-8 become U+FFFD.
  std::string dump(int indent = -1) const;

 private:
  struct Whole {
    std::int64_t value;
  };
  struct Natural {
    std::uint64_t value;
  };
  using Array = std::vector<Json>;
  using Object = std::vector<Member>;
  explicit Json(Whole value);
  explicit Json(Natural value);
  template <class Range>
  static Json of_range(const Range& values) {
    Json out = array();
    for (const auto& value : values) out.push_back(Json(value));
    return out;
  }
  bool is_member() const;
  struct Written;

  std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double, std::string, Array, Object> value_;
};

struct Json::Member {
  std::string name;
  Json value;
};

}  // namespace camber
