#pragma once
// mpirun -n N camber predict J.toml -o DIR: a rank computes a section, parts go from rank to rank. camber compensate
// shares each of its predictions in the same way.
//
// The same executable with and without mpirun; the only file that sees MPI is mpi_run.cpp.
#include <string>

#include "cli/job_commands.h"

namespace camber::cli {

/// Started by mpirun, by what it sets in the environment; one process alone counts where has_mpi().
bool started_by_mpi();
/// Whether this executable is built with MPI.
bool has_mpi();

/// camber predict on every rank; rank 0 merges and writes. The exit status is that of rank 0. Requires has_mpi().
int run_predict_on_ranks(const PredictArguments& arguments, const GlobalOptions& options);
/// camber compensate on every rank; rank 0 writes. As above.
int run_compensate_on_ranks(const CompensateArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
