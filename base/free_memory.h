#pragma once
// Available memory.

namespace camber {

/// Bytes available without swapping, within the limits of the process's control groups; 1e18 if unknown.
double free_memory_bytes();

/// Bytes of this process in memory; 0 if unknown.
double used_memory_bytes();

}  // namespace camber
