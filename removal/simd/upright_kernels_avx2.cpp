// Compiled with -mavx2 (CMakeLists.txt); called only where the processor has it.
#if defined(__x86_64__)
#include "removal/simd/upright_block_kernels_impl.h"
#include "removal/simd/upright_kernels_impl.h"
#include "removal/simd/upright_mark_kernels_impl.h"

namespace camber::removal::upright {

const Kernels kAvx2Kernels = Vectors<xsimd::avx2>::table();
const BlockKernels kAvx2BlockKernels = BlockVectors<xsimd::avx2>::table();
const MarkKernels kAvx2MarkKernels = MarkVectors<xsimd::avx2>::table();

}  // namespace camber::removal::upright
#endif
