#include "removal/simd/upright_kernels.h"

#include "removal/simd/upright_block_kernels_impl.h"
#include "removal/simd/upright_kernels_impl.h"
#include "removal/simd/upright_mark_kernels_impl.h"

namespace camber::removal::upright {

#if defined(__x86_64__)
const Kernels kBaseKernels = Vectors<xsimd::sse2>::table();
const BlockKernels kBaseBlockKernels = BlockVectors<xsimd::sse2>::table();
const MarkKernels kBaseMarkKernels = MarkVectors<xsimd::sse2>::table();
#else
const Kernels kBaseKernels = Vectors<xsimd::default_arch>::table();
const BlockKernels kBaseBlockKernels = BlockVectors<xsimd::default_arch>::table();
const MarkKernels kBaseMarkKernels = MarkVectors<xsimd::default_arch>::table();
#endif

const Kernels& kernels() {
#if defined(__x86_64__)
  static const Kernels& widest = __builtin_cpu_supports("avx2") ? kAvx2Kernels : kBaseKernels;
  return widest;
#else
  return kBaseKernels;
#endif
}

const BlockKernels& block_kernels() {
#if defined(__x86_64__)
  static const BlockKernels& widest = __builtin_cpu_supports("avx2") ? kAvx2BlockKernels : kBaseBlockKernels;
  return widest;
#else
  return kBaseBlockKernels;
#endif
}

const MarkKernels& mark_kernels() {
#if defined(__x86_64__)
  static const MarkKernels& widest = __builtin_cpu_supports("avx2") ? kAvx2MarkKernels : kBaseMarkKernels;
  return widest;
#else
  return kBaseMarkKernels;
#endif
}

}  // namespace camber::removal::upright
