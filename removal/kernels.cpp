#include "removal/kernels.h"

#include "removal/kernels_impl.h"

namespace camber::removal {

#if defined(__x86_64__)
const Kernels kBaseKernels = Vectors<xsimd::sse2>::table();
#else
const Kernels kBaseKernels = Vectors<xsimd::default_arch>::table();
#endif

const Kernels& kernels() {
#if defined(__x86_64__)
  static const Kernels& widest = __builtin_cpu_supports("avx2") ? kAvx2Kernels : kBaseKernels;
  return widest;
#else
  return kBaseKernels;
#endif
}

}  // namespace camber::removal
