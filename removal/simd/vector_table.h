#pragma once
// Values of tables by index, in vectors: what xsimd 8 gathers well only by the processor's own instruction. Included
// by the files that are compiled for one instruction set, as removal/simd/upright_kernels_impl.h.
#include <cstdint>

#include <xsimd/xsimd.hpp>

namespace camber::removal {
namespace {

template <class A>
struct Table {
  using F = xsimd::batch<float, A>;
  using I = xsimd::batch<std::int32_t, A>;
  static constexpr int n = static_cast<int>(F::size);

  static F gather(const float* from, const I& index) { return F::gather(from, index); }
  static I gather(const std::int32_t* from, const I& index) {
    alignas(64) std::int32_t at[n], value[n];
    index.store_aligned(at);
    for (int l = 0; l < n; ++l) value[l] = from[at[l]];
    return I::load_aligned(value);
  }
  /// from[index] and from[index + 1].
  static void gather_pair(const float* from, const I& index, F& first, F& second) {
    first = gather(from, index);
    second = gather(from, index + I(1));
  }
  static void gather_pair(const std::int32_t* from, const I& index, I& first, I& second) {
    first = gather(from, index);
    second = gather(from, index + I(1));
  }
  /// A bit a lane.
  static std::uint32_t bits(const xsimd::batch_bool<float, A>& mask) {
    alignas(64) float lanes[n];
    xsimd::select(mask, F(1.0f), F(0.0f)).store_aligned(lanes);
    std::uint32_t out = 0;
    for (int l = 0; l < n; ++l) out |= static_cast<std::uint32_t>(lanes[l] > 0) << l;
    return out;
  }
};

#if defined(__AVX2__)
template <>
struct Table<xsimd::avx2> {
  using F = xsimd::batch<float, xsimd::avx2>;
  using I = xsimd::batch<std::int32_t, xsimd::avx2>;

  static F gather(const float* from, const I& index) { return _mm256_i32gather_ps(from, index, sizeof(float)); }
  static I gather(const std::int32_t* from, const I& index) {
    return _mm256_i32gather_epi32(from, index, sizeof(std::int32_t));
  }
  static void gather_pair(const std::int32_t* from, const I& index, I& first, I& second) {
    F a, b;
    gather_pair(reinterpret_cast<const float*>(from), index, a, b);  // 64 bits of any kind
    first = _mm256_castps_si256(a);
    second = _mm256_castps_si256(b);
  }
  static void gather_pair(const float* from, const I& index, F& first, F& second) {
    alignas(32) std::int32_t at[8];
    index.store_aligned(at);
    // Quicker than the gather instructions of some processors.
    const auto two = [&](int a, int b) {
      const __m128 low = _mm_loadl_pi(_mm_setzero_ps(), reinterpret_cast<const __m64*>(from + at[a]));
      return _mm_loadh_pi(low, reinterpret_cast<const __m64*>(from + at[b]));
    };
    const __m256 low = _mm256_insertf128_ps(_mm256_castps128_ps256(two(0, 1)), two(4, 5), 1);
    const __m256 high = _mm256_insertf128_ps(_mm256_castps128_ps256(two(2, 3)), two(6, 7), 1);
    first = _mm256_shuffle_ps(low, high, 0x88);
    second = _mm256_shuffle_ps(low, high, 0xdd);
  }
  static std::uint32_t bits(const xsimd::batch_bool<float, xsimd::avx2>& mask) {
    return static_cast<std::uint32_t>(_mm256_movemask_ps(mask));
  }
};
#endif

}  // namespace
}  // namespace camber::removal
