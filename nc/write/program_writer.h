#pragma once
// Writes a program from nothing in the words of a control: what copy milling, rasters and protocols emit. Given
// programs are changed by nc/emit.h instead.
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/geometry.h"
#include "nc/arcs.h"
#include "nc/dialect.h"

namespace camber::nc {

/// A whole program in the pieces that a plan puts together anew. Lines have no block numbers yet; see text_of().
struct WrittenProgram {
  std::string head;
  std::vector<std::string> operations;  ///< each from its tool change to its spindle stop
  std::string end;
};

struct WriterFormat {
  std::string title;  ///< "COPY MILLING"; in the head where the language has a place for it
  int decimals = 3;   ///< of coordinates and arc centres, mm
  bool coolant = false;
  std::optional<double> corner_tolerance_mm{};  ///< G64 P, where it is the control's word for it
};

struct WrittenTool {
  int number = 0;
  std::string comment;  ///< "BALL D6"
  double spindle_rpm = 0;
  double safe_z_mm = 0;  ///< where the tool goes first, in rapid
};

/// Places are absolute, mm, in the work frame of the program; words that stay as they are are left out. The plane is
/// that of X and Y but for arcs.
class ProgramWriter {
 public:
  virtual ~ProgramWriter() = default;

  /// Units, plane, modes. Before all else.
  void begin();
  /// Ends the operation before it.
  void change_tool(const WrittenTool& tool);
  void rapid(const Vec3& to);
  void line(const Vec3& to, double feed_mm_per_min);
  /// In a level of the plane, in which `centre` lies; all round where the end is the start.
  void arc(const Vec3& to, const Vec2& centre, bool counter_clockwise, double feed_mm_per_min, Plane plane = Plane::xy);
  /// A rotary axis alone; without a feed in rapid.
  void turn(char axis, double to_deg, std::optional<double> feed_deg_per_min);
  virtual void dwell(double seconds) = 0;
  /// Every block ends in a stop from here on, in controls that have a word for it.
  virtual void stop_exactly() = 0;
  /// The program is complete.
  WrittenProgram finish();

  /// Lines of the program so far, which is the number of the last one.
  std::size_t lines() const { return lines_; }

 protected:
  ProgramWriter(const Dialect& dialect, WriterFormat format) : dialect_(dialect), format_(std::move(format)) {}

  virtual void write_head() = 0;
  virtual void write_tool(const WrittenTool& tool) = 0;
  virtual void write_spindle_stop() = 0;
  virtual void write_end() = 0;
  /// `words`: "X12.5 Y3"; F is still to come.
  virtual void write_rapid(const std::string& words) = 0;
  virtual void write_line(const std::string& words, double feed) = 0;
  struct Arc {
    Vec3 from, to;
    Vec2 centre;
    bool counter_clockwise = false;
    Plane plane = Plane::xy;
    std::string words;  ///< of the end: what changes
  };
  virtual void write_arc(const Arc& arc, double feed) = 0;
  /// 12. rather than 12, which some controls take for increments.
  virtual bool whole_numbers_have_points() const { return false; }

  void put(const std::string& text) { *into_ += text + "\n", ++lines_; }
  /// Zeros at the end are left out.
  std::string number(double value, int decimals) const;
  virtual std::string coordinate(char letter, double value) const { return letter + number(value, format_.decimals); }
  /// " F1500." where it is another than before.
  std::string feed_word(double feed);
  /// "Copy milling" -> "COPY_MILLING": names of programs have letters, digits and underlines.
  static std::string program_name(std::string_view title);
  const Dialect& dialect() const { return dialect_; }
  const WriterFormat& format() const { return format_; }

 private:
  std::string changed_places(const Vec3& to);

  const Dialect& dialect_;
  WriterFormat format_;
  WrittenProgram out_;
  std::string* into_ = &out_.head;
  std::optional<Vec3> at_;
  std::string feed_;
  std::size_t lines_ = 0;
};

/// In the language of the dialect.
std::unique_ptr<ProgramWriter> program_writer(const Dialect& dialect, WriterFormat format);

/// The program as its control reads it: with block numbers where the language has them.
std::string text_of(const Dialect& dialect, const WrittenProgram& program);

/// The one operation of a program of which text_of() made the text and in which points and feeds were changed then.
std::string operation_of(const Dialect& dialect, const WrittenProgram& program, const std::string& changed_text);

std::unique_ptr<ProgramWriter> iso_writer(const Dialect& dialect, WriterFormat format);

}  // namespace camber::nc
