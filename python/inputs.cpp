// What the functions take: programs, machines and jobs; and what they raise.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "camber/camber.h"
#include "parts.h"

namespace py = pybind11;

namespace camber_python {
namespace {

py::handle input_error, beyond_model, cancelled;  // live as long as the module

/// The first error's place and check are the exception's; `diagnostics` has all.
void raise_input_error(const camber::InputError& problem) {
  py::object raised = py::reinterpret_borrow<py::object>(input_error)(problem.what());
  const auto& all = problem.diagnostics();
  raised.attr("diagnostics") = py::cast(all);
  const camber::Diagnostic* first = all.empty() ? nullptr : &all.front();
  for (const camber::Diagnostic& d : all)
    if (d.severity == camber::Severity::error) {
      first = &d;
      break;
    }
  if (first) {
    raised.attr("file") = first->location.file;
    raised.attr("line") = first->location.line;
    raised.attr("column") = first->location.column;
    raised.attr("id") = first->check;
    raised.attr("message") = first->message;
  }
  PyErr_SetObject(input_error.ptr(), raised.ptr());
}

void translate(std::exception_ptr problem) {
  try {
    if (problem) std::rethrow_exception(problem);
  } catch (const camber::InputError& e) {
    raise_input_error(e);
  } catch (const camber::BeyondModel& e) {
    PyErr_SetString(beyond_model.ptr(), e.what());
  } catch (const camber::Cancelled& e) {
    PyErr_SetString(cancelled.ptr(), e.what());
  }
}

py::handle new_exception(py::module_& module, const char* name, PyObject* base, const char* doc) {
  const std::string full = std::string("camber.") + name;
  PyObject* type = PyErr_NewExceptionWithDoc(full.c_str(), doc, base, nullptr);
  if (!type) throw py::error_already_set();
  module.add_object(name, type);
  return type;
}

std::string name_of(camber::Severity severity) { return severity == camber::Severity::error ? "error" : "warning"; }

}  // namespace

void add_exceptions(py::module_& module) {
  py::class_<camber::Diagnostic>(module, "Diagnostic")
      .def_property_readonly("severity", [](const camber::Diagnostic& d) { return name_of(d.severity); })
      .def_property_readonly("file", [](const camber::Diagnostic& d) { return d.location.file; })
      .def_property_readonly("line", [](const camber::Diagnostic& d) { return d.location.line; })
      .def_property_readonly("column", [](const camber::Diagnostic& d) { return d.location.column; })
      .def_readonly("message", &camber::Diagnostic::message)
      .def_readonly("id", &camber::Diagnostic::check)
      .def("__str__", [](const camber::Diagnostic& d) { return camber::to_string(d); })
      .def("__repr__", [](const camber::Diagnostic& d) { return "<camber.Diagnostic " + camber::to_string(d) + ">"; });
  input_error = new_exception(
      module, "InputError", PyExc_ValueError,
      "The input is wrong. file, line, column, id and message are those of the first error; diagnostics has all.");
  beyond_model =
      new_exception(module, "BeyondModel", PyExc_ArithmeticError, "The input is beyond the range of the model.");
  cancelled = new_exception(module, "Cancelled", PyExc_RuntimeError, "progress returned False.");
  py::register_exception_translator(translate);
}

void add_inputs(py::module_& module) {
  py::class_<camber::Program>(module, "Program", "An NC program in memory.")
      .def_property_readonly("path", &camber::Program::path)
      .def_property_readonly("text", &camber::Program::text);
  py::class_<camber::Machine>(module, "Machine", "A machine tool and its control.")
      .def_property_readonly("path", &camber::Machine::path)
      .def_property_readonly("diagnostics", &camber::Machine::diagnostics)
      .def("to_toml", &camber::Machine::to_toml)
      .def("set", &camber::Machine::set, py::arg("key"), py::arg("value"),
           "Sets a number by its key in machine.toml; \"axis.all.KEY\" sets the three axes.")
      .def("__copy__", [](const camber::Machine& m) { return m; });
  py::class_<camber::Job>(module, "Job", "Program, machine, tools and stock.")
      .def_property_readonly("path", &camber::Job::path)
      .def_property_readonly("program_path", &camber::Job::program_path)
      .def_property_readonly("machine", &camber::Job::machine)
      .def_property_readonly("diagnostics", &camber::Job::diagnostics)
      .def("to_toml", &camber::Job::to_toml)
      .def("set_program", &camber::Job::set_program, py::arg("path"))
      .def("set_machine", &camber::Job::set_machine, py::arg("machine"))
      .def("set_voxel_mm", &camber::Job::set_voxel_mm, py::arg("voxel_mm"))
      .def("__copy__", [](const camber::Job& j) { return j; });
}

}  // namespace camber_python
