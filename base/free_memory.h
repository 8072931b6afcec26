#pragma once
// Available memory.

namespace camber {

/// Bytes available without swapping; 1e18 if unknown.
double free_memory_bytes();

}  // namespace camber
