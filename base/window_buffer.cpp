#include "base/window_buffer.h"

#include <algorithm>

namespace camber {
namespace {

constexpr std::size_t kWindow = std::size_t{4} << 20;

}  // namespace

std::streamsize WindowBuffer::xsputn(const char* text, std::streamsize count) {
  const auto size = static_cast<std::size_t>(count);
  if (at_ + size > kept_.size()) kept_.resize(at_ + size);
  std::copy_n(text, size, kept_.data() + at_);
  at_ += size;
  end_ = std::max(end_, begin_ + static_cast<std::streamoff>(kept_.size()));
  if (seekable_ && kept_.size() >= kWindow) write_out();
  return count;
}

WindowBuffer::int_type WindowBuffer::overflow(int_type c) {
  if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
  const char byte = traits_type::to_char_type(c);
  xsputn(&byte, 1);
  return c;
}

WindowBuffer::pos_type WindowBuffer::seekoff(off_type by, std::ios_base::seekdir from, std::ios_base::openmode which) {
  const std::streamoff base = from == std::ios_base::beg   ? 0
                              : from == std::ios_base::end ? end_
                                                           : begin_ + static_cast<std::streamoff>(at_);
  return seekpos(base + by, which);
}

WindowBuffer::pos_type WindowBuffer::seekpos(pos_type to, std::ios_base::openmode) {
  const std::streamoff place = to;
  if (place < 0 || place > end_) return pos_type(off_type(-1));
  if (place < begin_ || place > begin_ + static_cast<std::streamoff>(kept_.size())) {
    write_out();
    begin_ = place;
  }
  at_ = static_cast<std::size_t>(place - begin_);
  return to;
}

void WindowBuffer::write_out() {
  if (kept_.empty()) return;
  if (seekable_ && out_.tellp() != pos_type(begin_)) out_.seekp(begin_);
  out_.write(kept_.data(), static_cast<std::streamsize>(kept_.size()));
  begin_ += static_cast<std::streamoff>(at_);
  kept_.clear();
  at_ = 0;
}

}  // namespace camber
