#pragma once
// The parts of the module.
#include <pybind11/pybind11.h>

namespace camber_python {

void add_exceptions(pybind11::module_& module);  ///< with Diagnostic
void add_inputs(pybind11::module_& module);      ///< Program, Machine, Job
void add_results(pybind11::module_& module);
void add_functions(pybind11::module_& module);
void add_copy(pybind11::module_& module);
void add_plan(pybind11::module_& module);

}  // namespace camber_python
