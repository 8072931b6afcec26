#pragma once
// Values of tables by index, in vectors: what xsimd 8 gathers well only by the processor's own instruction. Included
// by the files that are compiled for one instruction set, as removal/kernels_impl.h.
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
  static void gather_pair(const float* from, const I& index, F& first, F& second) {
    const auto* pairs = reinterpret_cast<const double*>(from);
    const auto read = [&](__m128i at) {  // with a mask, as g++ 12 else warns of what the instruction leaves open
      const __m256d all = _mm256_castsi256_pd(_mm256_set1_epi64x(-1));
      return _mm256_castpd_ps(_mm256_mask_i32gather_pd(_mm256_setzero_pd(), pairs, at, all, sizeof(float)));
    };
    const __m256 low = read(_mm256_castsi256_si128(index)), high = read(_mm256_extracti128_si256(index, 1));
    constexpr int kInOrder = 0xd8;  // quarters 0, 2, 1, 3
    const auto in_order = [](__m256 v) {
      return _mm256_castpd_ps(_mm256_permute4x64_pd(_mm256_castps_pd(v), kInOrder));
    };
    first = in_order(_mm256_shuffle_ps(low, high, 0x88));
    second = in_order(_mm256_shuffle_ps(low, high, 0xdd));
  }
  static std::uint32_t bits(const xsimd::batch_bool<float, xsimd::avx2>& mask) {
    return static_cast<std::uint32_t>(_mm256_movemask_ps(mask));
  }
};
#endif

}  // namespace
}  // namespace camber::removal
