#pragma once
// Function clones for wider vectors, chosen at run time. Floating-point contraction is off, so results are identical.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__SANITIZE_ADDRESS__)
#define CAMBER_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define CAMBER_VECTOR_CLONES
#endif
