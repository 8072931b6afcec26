#pragma once
// A job with several programs: they run one after the other on one blank, each on what the one before has left.
#include <cstddef>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "machine/job_file.h"

namespace camber::api {

/// Name of a program's results: its place and its file's name, "2-finish".
std::string name_of_program(const std::vector<std::string>& programs, std::size_t index);

/// The job of one of its programs; `stock`: the stock.vdb that the program before has left; empty: the job's own blank.
machine::Job job_of_program(const machine::JobOfPrograms& all, std::size_t index, const std::string& stock);

/// Predicts a job of one program and saves the machined stock to `path`. What is to be said of it was said before.
/// Throws InputError.
void save_stock_after(const machine::Job& job, const std::string& path);

/// The rigid sweep of a job's program, saved to `path`: what a check of the next program starts from. Throws
/// InputError.
void save_swept_stock(const machine::Job& job, const std::string& path);

/// JSON of all programs from that of each: `programs`, a list with `program` and `folder` or `output` first, and the
/// sums of their times and volumes. An empty text stands for a program without a result.
std::string join_results(const machine::JobOfPrograms& all, const std::vector<std::string>& json,
                         const std::vector<std::string>& places);

}  // namespace camber::api
