#pragma once
// A large file whose writer seeks to and fro.
#include <cstddef>
#include <ostream>
#include <streambuf>
#include <string>

namespace camber {

/// Between a writer that asks where it is after every few bytes, or goes back to fill in a number, and a stream that
/// would write out its buffer each time: of the file some megabytes are in memory, or all of it where the stream cannot
/// seek (a pipe). Errors are those of the stream.
class WindowBuffer : public std::streambuf {
 public:
  /// `out`: at its beginning. It must outlive this.
  explicit WindowBuffer(std::ostream& out) : out_(out), seekable_(out.tellp() != pos_type(off_type(-1))) {}
  /// Writes what is still kept.
  void finish() { write_out(); }

 protected:
  std::streamsize xsputn(const char* text, std::streamsize count) override;
  int_type overflow(int_type c) override;
  pos_type seekoff(off_type by, std::ios_base::seekdir from, std::ios_base::openmode which) override;
  pos_type seekpos(pos_type to, std::ios_base::openmode which) override;

 private:
  void write_out();

  std::ostream& out_;
  bool seekable_;
  std::string kept_;  ///< bytes of the file from `begin_` on
  std::streamoff begin_ = 0;
  std::size_t at_ = 0;      ///< in `kept_`: where the next byte goes
  std::streamoff end_ = 0;  ///< end of all that was written
};

}  // namespace camber
