#pragma once
// Memory that is no longer used.

namespace camber {

/// Hands freed memory back to the system: glibc keeps it, scattered over its heaps, where large arrays that are made
/// next find no room. Worth a call where hundreds of megabytes in small pieces have just been freed. With another C
/// library it does nothing.
void return_freed_memory();

}  // namespace camber
