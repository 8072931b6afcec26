#pragma once
// How sure the model is of a job's features.
#include "machine/job_file.h"

namespace camber::inspect {

/// The job's [model_error] where it has one; else relative standard errors by where its numbers come from:
///
///   deflection  forces: the preset's scatter, or 25 % for coefficients from elsewhere, and 150 % for the thin chips of
///               small tools, where size effect, edge wear and rubbing make up to three times the force of a law that
///               was fitted on thick chips; stiffness: 40 % where the root or the flutes are typical values, else 15 %
///   contour     15 %: gains of position loops as they are set
///   size        5 um: what a tool's diameter is off
///
/// Source of the size effect: Altintas, Manufacturing Automation, 2nd ed., ch. 2; of the 150 %: docs/measured-parts.md.
machine::ModelError model_error_of(const machine::Job& job);

}  // namespace camber::inspect
