#pragma once
// Memory that is no longer used.

namespace camber {

/// Returns freed memory to the system (glibc keeps it, fragmented over its heaps). To be called after freeing hundreds
/// of megabytes in small pieces. With another C library it does nothing.
void return_freed_memory();

}  // namespace camber
