#pragma once
// Symbol visibility: marks what the shared library exports.
#if defined(__GNUC__)
#define CAMBER_API __attribute__((visibility("default")))
#else
#define CAMBER_API
#endif
