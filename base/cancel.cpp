#include "base/cancel.h"

#include <utility>

#include "camber/diagnostics.h"

namespace camber {
namespace {

thread_local std::stop_token current;

}  // namespace

CancelScope::CancelScope(std::stop_token token) : before_(std::exchange(current, std::move(token))) {}
CancelScope::~CancelScope() { current = std::move(before_); }

void set_stop_token(std::stop_token token) { current = std::move(token); }

void cancellation_point() {
  if (current.stop_requested()) throw Cancelled();
}

}  // namespace camber
