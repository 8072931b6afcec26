#pragma once
// Function clones for wider vectors, chosen at run time. Floating-point contraction is off, so results are identical.
//
// Whatever such a function calls is inlined (flatten), so it must be defined in the same file. g++ 12 does not clear
// the upper halves of the vector registers before it calls a function of the same file that was compiled for narrow
// ones, and on Intel processors every change between the two encodings then takes some hundred cycles.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__SANITIZE_ADDRESS__)
#define CAMBER_VECTOR_CLONES __attribute__((target_clones("avx2", "default"), flatten))
#else
#define CAMBER_VECTOR_CLONES
#endif
