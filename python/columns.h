#pragma once
// Columns of a result's rows as numpy arrays that share the result's memory.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <vector>

namespace camber_python {

/// One field of all rows of `owner`'s vector: a read-only view with the row's size as its stride. It keeps `owner`
/// alive; nothing is copied.
template <class Row, class Field>
pybind11::array column(const pybind11::object& owner, const std::vector<Row>& rows, Field Row::*field) {
  const Field* first = rows.empty() ? nullptr : &(rows.front().*field);
  pybind11::array_t<Field> view({rows.size()}, {sizeof(Row)}, first, owner);
  view.attr("setflags")(pybind11::arg("write") = false);
  return view;
}

/// Three double fields that stand behind each other, as an array of (n, 3); otherwise as column().
template <class Row>
pybind11::array vectors(const pybind11::object& owner, const std::vector<Row>& rows, double Row::*first) {
  const double* at = rows.empty() ? nullptr : &(rows.front().*first);
  pybind11::array_t<double> view({rows.size(), std::size_t{3}}, {sizeof(Row), sizeof(double)}, at, owner);
  view.attr("setflags")(pybind11::arg("write") = false);
  return view;
}

/// The rows of a result as an object with an attribute for each column.
template <class Row>
struct ColumnTable {
  pybind11::object owner;  ///< the Python object of the result
  const std::vector<Row>* rows = nullptr;
};

template <class Row>
class TableClass {
 public:
  TableClass(pybind11::module_& module, const char* name) : class_(module, name) {
    class_.def("__len__", [](const ColumnTable<Row>& t) { return t.rows->size(); });
    class_.def_property_readonly_static("columns", [names = names_](const pybind11::object&) { return *names; });
  }
  /// (n, 3): three fields that stand behind each other in a row, "x_mm", "y_mm", "z_mm".
  TableClass& add_vectors(const char* name, double Row::*first) {
    class_.def_property_readonly(name, [first](const ColumnTable<Row>& t) { return vectors(t.owner, *t.rows, first); });
    return *this;
  }
  template <class Field>
  TableClass& add(const char* name, Field Row::*field) {
    names_->emplace_back(name);
    class_.def_property_readonly(name, [field](const ColumnTable<Row>& t) { return column(t.owner, *t.rows, field); });
    return *this;
  }

 private:
  pybind11::class_<ColumnTable<Row>> class_;
  std::shared_ptr<std::vector<std::string>> names_ = std::make_shared<std::vector<std::string>>();
};

}  // namespace camber_python
