#include "nc/siemens/siemens_words.h"

#include <algorithm>
#include <array>
#include <vector>

namespace camber::nc::siemens {
namespace {

constexpr auto kAddress = WordKind::address;
constexpr auto kCommand = WordKind::command;
constexpr auto kCycle = WordKind::cycle;
constexpr auto kProcedure = WordKind::procedure;

constexpr std::string_view kByMoves = "the moves themselves, G0 to G3, from the CAM system";
constexpr std::string_view kByLines = "G1 to G3 within a tolerance, from the CAM system";

/// Words of the same meaning stand in one row.
constexpr auto kRows = std::to_array<WordRow>({
    // path
    WordRow{"CR", kAddress, Does::extra, "radius of an arc"},
    WordRow{"AR", kAddress, Does::extra, "opening angle of an arc"},
    WordRow{"AP RP", kAddress, Does::extra, "polar angle and radius"},
    WordRow{"TURN", kAddress, Does::extra, "full turns of a helix before the rest"},
    WordRow{"I1", kAddress, Does::extra, "point on the arc of CIP"},
    WordRow{"J1", kAddress, Does::extra, "point on the arc of CIP"},
    WordRow{"K1", kAddress, Does::extra, "point on the arc of CIP"},
    WordRow{"CIP", kCommand, Does::cip, "arc through a point"},
    WordRow{"CT", kCommand, Does::ct, "arc that continues the path tangentially"},
    WordRow{"CHF CHR", kAddress, Does::extra, "chamfer by its length, by the distance from the corner"},
    WordRow{"RND", kAddress, Does::extra, "rounded corner"},
    WordRow{"RNDM", kAddress, Does::modal_rounding, "rounded corners, modal"},
    WordRow{"FRC FRCM", kAddress, Does::corner_feed, "feed of a chamfer or rounding, with M modal"},
    WordRow{"ANG", kAddress, Does::extra, "line at an angle"},
    WordRow{"SUPA", kCommand, Does::supa, "machine coordinates in this block"},
    WordRow{"POS POSA", kAddress, Does::position_axis, "an axis positions by itself: a rapid"},
    WordRow{"POSP", kAddress, Does::refused, "positions in parts", "POS"},
    WordRow{"BNAT BTAN BAUTO ENAT ETAN EAUTO", kCommand, Does::nothing, "ends of splines"},
    WordRow{"ASPLINE BSPLINE CSPLINE POLY", kCommand, Does::refused, "spline or polynomials", kByLines},
    WordRow{"PO PL PW SD", kAddress, Does::refused, "coefficients, lengths, weights and degree of such a curve",
            kByLines},
    WordRow{"FP", kAddress, Does::nothing, "number of the fixed point of G75"},
    WordRow{"INVCW INVCCW", kCommand, Does::refused, "involute", kByLines},
    WordRow{"DIAMON DIAM90", kCommand, Does::refused, "diameters of a lathe", "DIAMOF"},
    WordRow{"DIAMOF", kCommand, Does::nothing, "radii"},
    WordRow{"CDON CDOF CDOF2", kCommand, Does::nothing, "collision monitoring of the radius compensation, on and off"},
    WordRow{"NORM", kCommand, Does::nothing, "approach square to the contour, which is assumed"},
    WordRow{"KONT KONTC KONTT", kCommand, Does::noted, "approach around the corner: read as NORM"},
    WordRow{"OFFN", kAddress, Does::offset_normal, "allowance of G41 and G42"},
    WordRow{"CUT3DC CUT3DF CUT3DFS CUT3DFF", kCommand, Does::refused, "radius compensation in space", kByLines},
    WordRow{"CUTCONON", kCommand, Does::refused, "radius compensation suspended", "G40"},
    WordRow{"CUTCONOF CUT2D CUT2DF", kCommand, Does::nothing, "radius compensation in a plane"},
    WordRow{"DISR DISCL", kAddress, Does::refused, "smooth approach (G147 ... G348)", "G1 to G3"},
    WordRow{"FAD", kAddress, Does::refused, "feed of the smooth approach", "G1 to G3"},
    WordRow{"DISC", kAddress, Does::noted, "outside corners exceed the arc: read as DISC=0"},
    // frames
    WordRow{"TRANS ATRANS", kCommand, Does::frame, "shift, with A additive"},
    WordRow{"ROT AROT", kCommand, Does::frame, "rotation, with A additive"},
    WordRow{"ROTS", kCommand, Does::refused, "rotation by solid angles", "ROT with angles about X, Y and Z"},
    WordRow{"AROTS", kCommand, Does::refused, "rotation by solid angles, additive",
            "AROT with angles about X, Y and Z"},
    WordRow{"SCALE ASCALE", kCommand, Does::frame, "scale, with A additive"},
    WordRow{"MIRROR AMIRROR", kCommand, Does::frame, "mirror image, with A additive"},
    WordRow{"RPL", kAddress, Does::extra, "angle of ROT and AROT in the plane"},
    WordRow{"TOFRAME TOROT TOROTX TOROTY PAROT", kCommand, Does::refused, "frame of the tool or of the part carrier",
            "CYCLE800 or ROT"},
    WordRow{"TOROTOF PAROTOF", kCommand, Does::nothing, "frame of the tool or the part carrier off"},
    WordRow{"TCARR", kAddress, Does::noted, "tool carrier: T and D alone are read"},
    WordRow{"TCOABS", kCommand, Does::nothing, "tool carrier"},
    WordRow{"TCOFR", kCommand, Does::noted, "tool carrier by the frame"},
    WordRow{"CFC CFIN CFTCP", kCommand, Does::nothing, "point of the cutter whose feed is F: the centre is taken"},
    // feed and the control's modes
    WordRow{"ADIS", kAddress, Does::extra, "rounding of G641"},
    WordRow{"ADISPOS", kAddress, Does::blend_distance_rapid, "rounding of G641 in rapids"},
    WordRow{"SOFT BRISK DRIVE", kCommand, Does::mode_word, "acceleration with limited jerk, without, by speed"},
    WordRow{"SOFTA", kProcedure, Does::nothing, "jerk-limited acceleration of axes"},
    WordRow{"BRISKA DRIVEA", kProcedure, Does::nothing, "acceleration of axes"},
    WordRow{"DYNNORM DYNPOS DYNROUGH DYNSEMIFIN DYNFINISH DYNPREC", kCommand, Does::mode_word,
            "dynamics by the kind of move"},
    WordRow{"COMPON COMPCURV COMPCAD COMPSURF COMPPATH", kCommand, Does::contour_mode, "compressor"},
    WordRow{"COMPOF", kCommand, Does::contour_mode_off, "compressor off"},
    WordRow{"CTOL", kAddress, Does::contour_tolerance, "tolerance of compressor and rounding"},
    WordRow{"OTOL ATOL", kAddress, Does::nothing, "tolerance of the orientation, of axes"},
    WordRow{"FFWON FFWOF", kCommand, Does::mode_word, "feed-forward, on and off"},
    WordRow{"CPRECON CPRECOF", kCommand, Does::nothing, "contour precision, on and off"},
    WordRow{"FIFOCTRL STOPFIFO STARTFIFO", kCommand, Does::nothing, "look-ahead memory"},
    WordRow{"FGROUP", kProcedure, Does::noted, "axes of F: X, Y and Z are assumed"},
    WordRow{"FGREF", kAddress, Does::noted, "effective radius of rotary axes in F"},
    WordRow{"FNORM", kCommand, Does::nothing, "constant feed in each block"},
    WordRow{"FLIN FCUB", kCommand, Does::noted, "feed that changes along the block: read as FNORM"},
    WordRow{"FPO", kProcedure, Does::noted, "feed as a polynomial"},
    WordRow{"FB", kAddress, Does::block_feed, "feed of one block"},
    WordRow{"FZ", kAddress, Does::refused, "feed per tooth", "F in G94"},
    WordRow{"FD", kAddress, Does::noted, "feed with handwheel"},
    WordRow{"FA", kAddress, Does::nothing, "feed of a positioning axis"},
    WordRow{"FL", kAddress, Does::noted, "limit of an axis feed"},
    WordRow{"OVR OVRRAP OVRA", kAddress, Does::noted, "override: 100 % is taken"},
    WordRow{"JERKLIM JERKLIMA ACC ACCLIMA VELOLIM VELOLIMA", kAddress, Does::noted,
            "acceleration, jerk and speed in percent"},
    WordRow{"RTLION RTLIOF", kCommand, Does::nothing, "rapids as lines, on and off"},
    WordRow{"ST", kAddress, Does::nothing, "sparking-out time"},
    WordRow{"SR", kAddress, Does::nothing, "retraction path"},
    // five axes
    WordRow{"TRAORI", kCommand, Does::transform_on, "tool-centre-point control"},
    WordRow{"TRAFOOF", kCommand, Does::transform_off, "transformations off"},
    WordRow{"TRANSMIT TRACYL TRAANG", kCommand, Does::refused, "transformations of lathes and cylinder surfaces",
            kByMoves},
    WordRow{"TRACON", kCommand, Does::refused, "chained transformations", "TRAORI"},
    WordRow{"A3", kAddress, Does::extra, "tool direction"},
    WordRow{"B3", kAddress, Does::extra, "tool direction"},
    WordRow{"C3", kAddress, Does::extra, "tool direction"},
    WordRow{"A2 B2 C2", kAddress, Does::refused, "Euler or RPY angles", "A3= B3= C3="},
    WordRow{"A4 B4 C4 A5 B5 C5", kAddress, Does::refused, "surface normal", "A3= B3= C3="},
    WordRow{"A6 B6 C6", kAddress, Does::refused, "rotation axis of the orientation", "A3= B3= C3="},
    WordRow{"LEAD", kAddress, Does::refused, "lead angle", "A3= B3= C3="},
    WordRow{"TILT", kAddress, Does::refused, "tilt angle", "A3= B3= C3="},
    WordRow{"THETA", kAddress, Does::refused, "turn about the tool", "A3= B3= C3="},
    WordRow{"ORIWKS ORIMKS", kCommand, Does::nothing, "orientation in coordinates of the part, of the machine"},
    WordRow{"ORIAXES ORIVECT ORIPLANE", kCommand, Does::nothing, "orientation by straight axes, on a great circle"},
    WordRow{"ORIEULER ORIRPY ORIRPY2", kCommand, Does::nothing, "meaning of A2 B2 C2"},
    WordRow{"ORIVIRT1 ORIVIRT2", kCommand, Does::nothing, "meaning of virtual angles"},
    WordRow{"ORIC ORID", kCommand, Does::nothing, "orientation at outside corners"},
    WordRow{"ORIS", kAddress, Does::nothing, "rate of orientation"},
    WordRow{"OST OSC OSS OSSE OSD OSOF ORISON ORISOF", kCommand, Does::nothing, "smoothing of orientation"},
    WordRow{"ORIRESET", kProcedure, Does::refused, "basic orientation", "the rotary axes by name"},
    WordRow{"ORICURVE", kCommand, Does::refused, "orientation along a second curve", "A3= B3= C3="},
    WordRow{"ORICONCW ORICONCCW ORICONIO ORICONTO", kCommand, Does::refused, "orientation on a cone", "A3= B3= C3="},
    WordRow{"ORIPATH", kCommand, Does::refused, "orientation by the path", "A3= B3= C3="},
    WordRow{"PTP", kCommand, Does::noted, "point to point: read as a line"},
    WordRow{"STAT TU", kAddress, Does::noted, "position of the joints and turns of the axes"},
    WordRow{"CUTMOD", kAddress, Does::nothing, "offsets of tools that are turned"},
    WordRow{"TOWSTD TOWMCS TOWWCS TOWBCS TOWTCS TOWKCS", kCommand, Does::nothing, "frame of tool wear"},
    WordRow{"UPATH SPATH CP", kCommand, Does::nothing, "parameter of paths, path in cartesian coordinates"},
    // spindle and tool
    WordRow{"SPOS SPOSA", kAddress, Does::spindle_position, "spindle at an angle"},
    WordRow{"SETMS", kProcedure, Does::main_spindle, "main spindle"},
    WordRow{"SPCON SPCOF", kCommand, Does::nothing, "position control of the spindle, on and off"},
    WordRow{"SVC", kAddress, Does::refused, "cutting speed", "S"},
    WordRow{"LIMS", kAddress, Does::noted, "limit of the spindle speed"},
    WordRow{"SETPIECE GETSELT DELDL", kProcedure, Does::nothing, "part counter, selected tool, additive offsets"},
    WordRow{"DL", kAddress, Does::nothing, "additive offset"},
    WordRow{"TOFFON", kProcedure, Does::refused, "online tool length", "the offset of the tool"},
    WordRow{"TOFFOF", kProcedure, Does::nothing, "online tool length off"},
    WordRow{"TOFFL", kAddress, Does::refused, "programmable tool length", "the offset of the tool"},
    WordRow{"TOFFR", kAddress, Does::refused, "programmable tool radius", "OFFN"},
    // program
    WordRow{"SETAL", kProcedure, Does::alarm, "alarm"},
    WordRow{"MCALL", kCommand, Does::modal_call, "modal call of a subprogram or cycle"},
    WordRow{"CALL", kCommand, Does::call_text, "subprogram whose name is a text"},
    WordRow{"EXTCALL", kCommand, Does::call_text, "program from outside, looked for as a subprogram"},
    WordRow{"ISOCALL", kCommand, Does::refused, "subprogram in ISO code", "the subprogram in this language"},
    WordRow{"RET", kCommand, Does::end_subprogram, "end of a subprogram"},
    WordRow{"SBLOF SBLON DISPLOF DISPLON ACTBLOCNO", kCommand, Does::nothing, "single block and display"},
    WordRow{"SAVE", kCommand, Does::nothing, "modal G codes come back at the end of the subprogram"},
    WordRow{"STOPRE", kCommand, Does::nothing, "look-ahead stops"},
    WordRow{"WAITP WAITS WAITM WAITE", kProcedure, Does::nothing, "waits for an axis, a spindle, a channel"},
    WordRow{"HOME", kCommand, Does::home, "place of the machine's own"},
    WordRow{"INIT START CLEARM SETM", kProcedure, Does::nothing, "channel"},
    WordRow{"GET GETD RELEASE", kProcedure, Does::nothing, "axis exchange"},
    WordRow{"GEOAX", kProcedure, Does::refused, "other geometry axes", "X, Y and Z"},
    WordRow{"NEWCONF", kCommand, Does::nothing, "machine data"},
    WordRow{"WORKPIECE", kProcedure, Does::workpiece, "stock"},
    WordRow{"GROUP_BEGIN GROUP_END GROUP_ADDEND", kProcedure, Does::nothing, "structure of the program"},
    WordRow{"WRTPR WRITE DELETE MMC MSG", kProcedure, Does::nothing, "messages, test protocol and files"},
    WordRow{"SETINT", kProcedure, Does::noted, "interrupt routine"},
    WordRow{"DISABLE ENABLE CLRINT", kProcedure, Does::nothing, "interrupt routine"},
    WordRow{"CANCEL", kProcedure, Does::nothing, "synchronized actions"},
    WordRow{"PROT CPROT", kProcedure, Does::nothing, "protection areas"},
    WordRow{"WALIMON WALIMOF WALCS0", kCommand, Does::nothing, "working area limits"},
    WordRow{"LFON LFOF", kCommand, Does::nothing, "fast retraction, on and off"},
    WordRow{"COUPON TRAILON", kProcedure, Does::noted, "coupled spindles and axes"},
    WordRow{"COUPOF TRAILOF", kProcedure, Does::nothing, "coupled spindles and axes off"},
    WordRow{"MEAS MEAW MEASA MEAC", kAddress, Does::refused, "probing", "a program without probing"},
    WordRow{"PRESETON", kProcedure, Does::refused, "new actual values of axes", "TRANS, or a work offset"},
    WordRow{"WAITMC", kProcedure, Does::nothing, "waits for a channel"},
    WordRow{"FPR", kProcedure, Does::noted, "axis of the feed per revolution"},
    WordRow{"FPRAON", kProcedure, Does::noted, "feed per revolution of an axis"},
    WordRow{"FPRAOF", kProcedure, Does::nothing, "feed per revolution of an axis off"},
    WordRow{"READ", kProcedure, Does::noted, "lines of a file"},
    WordRow{"LEADON", kProcedure, Does::refused, "coupled axes", kByMoves},
    WordRow{"FXS", kAddress, Does::refused, "travel to a fixed stop", kByMoves},
    WordRow{"POLYPATH", kProcedure, Does::refused, "polynomials", kByLines},
    WordRow{"PUTFTOC", kProcedure, Does::noted, "online tool offset"},
    WordRow{"FTOCON", kCommand, Does::noted, "online tool offset"},
    WordRow{"FTOCOF", kCommand, Does::nothing, "online tool offset off"},
    WordRow{"CROTS", kCommand, Does::refused, "rotation by solid angles", "CROT"},
    WordRow{"SON", kCommand, Does::refused, "nibbling", kByMoves},
    WordRow{"PON", kCommand, Does::refused, "punching", kByMoves},
    // cycles
    WordRow{"CYCLE81 CYCLE82", kCycle, Does::drilling, "drilling, centring, counterboring"},
    WordRow{"CYCLE83", kCycle, Does::drilling, "deep-hole drilling"},
    WordRow{"CYCLE84", kCycle, Does::drilling, "rigid tapping"},
    WordRow{"CYCLE85", kCycle, Does::drilling, "reaming"},
    WordRow{"CYCLE86 CYCLE89", kCycle, Does::drilling, "boring"},
    WordRow{"CYCLE87 CYCLE88", kCycle, Does::drilling, "drilling with stop"},
    WordRow{"CYCLE840", kCycle, Does::drilling, "tapping with a compensating chuck"},
    WordRow{"CYCLE80", kCycle, Does::nothing, "end of a modal cycle, as some posts write it"},
    WordRow{"HOLES1 HOLES2 CYCLE801 CYCLE802", kCycle, Does::pattern, "rows, circles, grids and frames of holes"},
    WordRow{"CYCLE90", kCycle, Does::thread_milling, "thread milling"},
    WordRow{"CYCLE61 CYCLE71", kCycle, Does::face, "face milling"},
    WordRow{"POCKET3 POCKET4", kCycle, Does::pocket, "rectangular and circular pocket"},
    WordRow{"CYCLE800", kCycle, Does::cycle800, "swivelled plane"},
    WordRow{"CYCLE832", kCycle, Does::cycle832, "high-speed settings"},
    WordRow{"CYCLE60", kCycle, Does::refused, "engraving", kByMoves},
    WordRow{"CYCLE62 CYCLE63 CYCLE64 CYCLE72 CYCLE73 CYCLE74 CYCLE75", kCycle, Does::refused,
            "contours and contour pockets", kByMoves},
    WordRow{"CYCLE70 CYCLE78", kCycle, Does::refused, "thread milling, with drilling", kByMoves},
    WordRow{"CYCLE76 CYCLE77 CYCLE79", kCycle, Does::refused, "spigots, polygon", kByMoves},
    WordRow{"CYCLE92 CYCLE93 CYCLE94 CYCLE95 CYCLE96 CYCLE97 CYCLE98 CYCLE99", kCycle, Does::refused, "turning",
            kByMoves},
    WordRow{"LONGHOLE SLOT1", kCycle, Does::slots, "long holes and slots on a circle"},
    WordRow{"CYCLE899 SLOT2", kCycle, Does::refused, "open and circular slots", kByMoves},
    WordRow{"CYCLE930 CYCLE940 CYCLE951 CYCLE952", kCycle, Does::refused, "turning", kByMoves},
    WordRow{"CYCLE973 CYCLE974 CYCLE976 CYCLE977 CYCLE978 CYCLE979 CYCLE994 CYCLE995 CYCLE997 CYCLE998 CYCLE971 "
            "CYCLE982 CYCLE996",
            kCycle, Does::refused, "probing", "a program without probing"},
    WordRow{"POCKET1 POCKET2", kCycle, Does::refused, "older pockets", kByMoves},
});

constexpr std::array kFunctions = {
    FunctionRow{"SIN COS TAN ASIN ACOS SQRT ABS POT TRUNC ROUND ROUNDUP LN EXP QU AC IC"},
    FunctionRow{"STRLEN NUMBER ISNUMBER TOUPPER TOLOWER ISVAR AXNAME"},
    FunctionRow{"ATAN2 MINVAL MAXVAL INDEX RINDEX MINDEX CRPL", 2, 2},
    FunctionRow{"ATAN", 1, 2},
    FunctionRow{"SUBSTR", 2, 3},
    FunctionRow{"BOUND", 3, 3},
    FunctionRow{"CTRANS CSCALE", 0, 12},
    FunctionRow{"CROT CROTS CMIRROR", 0, 6},
};

/// `name` stands among the names of a row.
bool has_name(std::string_view names, std::string_view name) {
  for (std::size_t at = names.find(name); at < names.size(); at = names.find(name, at + 1)) {
    const std::size_t end = at + name.size();
    if ((at == 0 || names[at - 1] == ' ') && (end == names.size() || names[end] == ' ')) return true;
  }
  return false;
}

}  // namespace

std::span<const WordRow> word_rows() {
  static const std::vector<WordRow> sorted = [] {
    std::vector<WordRow> rows;
    for (const WordRow& row : kRows)
      for (std::size_t at = 0; at < row.name.size();) {
        const std::size_t end = std::min(row.name.find(' ', at), row.name.size());
        rows.push_back({row.name.substr(at, end - at), row.kind, row.does, row.what, row.instead});
        at = end + 1;
      }
    std::ranges::sort(rows, {}, &WordRow::name);
    return rows;
  }();
  return sorted;
}

const WordRow* find_word(std::string_view name) {
  const auto at = std::ranges::lower_bound(word_rows(), name, {}, &WordRow::name);
  return at != word_rows().end() && at->name == name ? &*at : nullptr;
}

const FunctionRow* find_function(std::string_view name) {
  const auto at = std::ranges::find_if(kFunctions, [&](const FunctionRow& row) { return has_name(row.names, name); });
  return at == kFunctions.end() ? nullptr : &*at;
}

}  // namespace camber::nc::siemens
