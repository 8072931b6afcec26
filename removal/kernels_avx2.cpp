// Compiled with -mavx2 (CMakeLists.txt); called only where the processor has it.
#if defined(__x86_64__)
#include "removal/block_kernels_impl.h"
#include "removal/kernels_impl.h"
#include "removal/mark_kernels_impl.h"

namespace camber::removal {

const Kernels kAvx2Kernels = Vectors<xsimd::avx2>::table();
const BlockKernels kAvx2BlockKernels = BlockVectors<xsimd::avx2>::table();
const MarkKernels kAvx2MarkKernels = MarkVectors<xsimd::avx2>::table();

}  // namespace camber::removal
#endif
