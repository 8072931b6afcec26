#pragma once
// What a force law consists of.
//
// The force on an edge element of width b that takes a chip of thickness h is, tangential, radial and axial alike,
//   F = (k(h) h + k_e) b                                            [N] = ([MPa][mm] + [N/mm])[mm]
// A law says what k(h), the specific cutting force, is. The edge terms k_e belong to every law.
//
// A law is one header beside this one and an entry in list.h. It is a struct without data:
//
//   struct Coefficients { double ...; };   every coefficient, named as its key in [material]
//   static constexpr std::string_view word;     in [material] and [force_log]: law = "word"
//   static constexpr std::string_view title;    in the report
//   static constexpr bool affine;               whether k is the same at every thickness
//   static constexpr bool fits_edge_terms;      whether fit-force fits the edge terms; they are zero otherwise
//   static constexpr std::array coefficients;   CoefficientOf<Coefficients>, in the order in which they are written
//   static Components specific_MPa(const Coefficients&, double h_mm);   k; h > 0
//   static Components slope_MPa(const Coefficients&, double h_mm);      d(k h)/dh; h > 0
//   static void start(const LinearForce&, double h_mm, Coefficients&, EdgeTerms&);
//                    the coefficients with the force and, as near as the law can, the slope of the linear law at h
//
// and, where the defaults do not suit it:
//
//   static constexpr std::array further_keys;   of [material], beside the coefficients' own; needs `read`
//   static constexpr std::array shown_by;       keys that show the law where `law` is missing; the required ones
//   static constexpr std::array header_keys;    coefficients in the header of an emitted program; all
//   static void read(TomlTable&, const MaterialPreset*, Coefficients&);
//                    reads the coefficients (no edge terms); a preset, or null, has filled them in
#include <array>
#include <cstddef>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "machine/number_range.h"

namespace camber::machine {

class TomlTable;
struct MaterialPreset;

/// Along the edge's motion, the envelope's outward normal and its meridian.
struct Components {
  double tangential = 0, radial = 0, axial = 0;
};

enum class Component { tangential, radial, axial };

enum class CoefficientRole {
  cutting,  ///< a force that grows with the chip
  edge,     ///< a force per width of edge
  shape,    ///< how the force follows the chip thickness, no force itself; a fit stays within its range
};

/// `Fields` is a law's struct of coefficients, or Material, which has those of all laws.
template <class Fields>
struct CoefficientOf {
  std::string_view key;     ///< in [material], in reports, in force_log.hold
  std::string_view symbol;  ///< in the header of an emitted program
  std::string_view unit;    ///< "1": none
  std::string_view meaning;
  double Fields::*field;
  Component component;
  CoefficientRole role;
  NumberRange range;
  bool required = false;  ///< has no default; a preset gives it as well
};

/// k_e.
struct EdgeTerms {
  double kte_N_per_mm = 0, kre_N_per_mm = 0, kae_N_per_mm = 0;
};

inline constexpr std::array kEdgeTerms{
    CoefficientOf<EdgeTerms>{"kte_N_per_mm", "kte", "N/mm", "tangential edge force per width", &EdgeTerms::kte_N_per_mm,
                             Component::tangential, CoefficientRole::edge, kNotNegative},
    CoefficientOf<EdgeTerms>{"kre_N_per_mm", "kre", "N/mm", "radial edge force per width", &EdgeTerms::kre_N_per_mm,
                             Component::radial, CoefficientRole::edge, kNotNegative},
    CoefficientOf<EdgeTerms>{"kae_N_per_mm", "kae", "N/mm", "axial edge force per width", &EdgeTerms::kae_N_per_mm,
                             Component::axial, CoefficientRole::edge, kAnyNumber},
};

/// A force per width of edge that is linear in the chip thickness, cutting h + edge: where a fit of any law starts.
struct LinearForce {
  Components cutting_MPa, edge_N_per_mm;
};

template <class... Laws>
struct LawList {
  static constexpr std::size_t size = sizeof...(Laws);
  template <std::size_t I>
  using At = std::tuple_element_t<I, std::tuple<Laws...>>;
  /// Where a law stands in the list; `size` where it does not.
  template <class Law>
  static constexpr std::size_t index = [] {
    constexpr std::array same{std::is_same_v<Law, Laws>...};
    std::size_t i = 0;
    while (i < size && !same[i]) ++i;
    return i;
  }();
  static constexpr std::array<std::string_view, sizeof...(Laws)> words{Laws::word...};
};

}  // namespace camber::machine
