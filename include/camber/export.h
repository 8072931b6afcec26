#pragma once
// What the shared library shows to its users; everything else in it is hidden.
#if defined(__GNUC__)
#define CAMBER_API __attribute__((visibility("default")))
#else
#define CAMBER_API
#endif
