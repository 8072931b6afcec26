#pragma once
// Memory that is still to be had.

namespace camber {

/// Bytes that the system can give without swapping; 1e18 where it does not say.
double free_memory_bytes();

}  // namespace camber
