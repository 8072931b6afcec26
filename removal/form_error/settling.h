#pragma once
// How place and deflection of a deflected envelope's point are brought to agree
// (removal/form_error/deflected_envelope.h).

namespace camber::removal {
namespace {  // compiled for several instruction sets

struct Settling {
  static constexpr int kSteps = 32;
  static constexpr float kClose_mm = 1e-5f;
  static constexpr int kFieldSteps = 16;  ///< largest number of steps to read the field of a deflected cutter
  static constexpr float kFieldClose_mm = 5e-5f;
  static constexpr float kFlattest = 0.3f;  ///< slope of an envelope against a point's normal, at least

  /// Number of plain steps. Where the deflection jumps against the motion of the edge, the envelope is torn, and plain
  /// steps alternate between both sides of the gap; the smaller steps that follow find the place between them.
  static constexpr int kPlainSteps = 5;
  static constexpr float share_of(int step) { return step < kPlainSteps ? 1.0f : step < 16 ? 0.3f : 0.1f; }
  /// Each plain step changes the place by a fraction of the step before it; this is the least such fraction that
  /// is believed.
  static constexpr float kTrustedFall = 0.05f;
};

}  // namespace
}  // namespace camber::removal
