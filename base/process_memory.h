#pragma once
// Memory: what is available, what this process takes, and what it gives back.

namespace camber {

/// Bytes available without swapping, within the limits of the process's control groups; 1e18 if unknown.
double free_memory_bytes();

/// Bytes of this process in memory; 0 if unknown.
double used_memory_bytes();

/// Returns freed memory to the system (glibc keeps it, fragmented over its heaps). To be called after freeing hundreds
/// of megabytes in small pieces. With another C library it does nothing.
void return_freed_memory();

}  // namespace camber
