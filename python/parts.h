#pragma once
// The parts of the module.
#include <pybind11/pybind11.h>

#include "camber/job.h"
#include "camber/machine.h"
#include "camber/program.h"

namespace camber_python {

void add_exceptions(pybind11::module_& module);  ///< with Diagnostic
void add_inputs(pybind11::module_& module);      ///< Program, Machine, Job
void add_results(pybind11::module_& module);
void add_functions(pybind11::module_& module);
void add_copy(pybind11::module_& module);
void add_plan(pybind11::module_& module);
void add_five_axis(pybind11::module_& module);  ///< post, posture
void add_fits(pybind11::module_& module);       ///< compress, resegment, raster, protocol, lobes, fit_modes, fit_force

/// Converts an argument of a function: an object, or the path of a file that holds it.
camber::Program program_of(const pybind11::handle& object);
camber::Machine machine_of(const pybind11::handle& object);
camber::Job job_of(const pybind11::handle& object);
/// A path of a job that may leave out its program.
camber::Job unprogrammed_job_of(const pybind11::handle& object);

}  // namespace camber_python
