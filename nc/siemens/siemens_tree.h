#pragma once
// Syntax tree of a Sinumerik program, beside its plain words: names, expressions, calls, flow control.
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "nc/program_text.h"
#include "nc/siemens/siemens_words.h"

namespace camber::nc::siemens {

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

enum class NodeKind : std::uint8_t {
  number,
  text,
  variable,   ///< name: declared by DEF or PROC; arguments: indexes
  parameter,  ///< R; first argument: its number
  system,     ///< $P_..., $A..., $M...; arguments: indexes
  call,       ///< a function: SIN(30)
  negate,
  plus,
  logical_not,
  bit_not,
  multiply,
  divide,
  whole_divide,
  modulo,
  add,
  subtract,
  bit_and,
  bit_xor,
  bit_or,
  logical_and,
  logical_xor,
  logical_or,
  join,  ///< <<
  equal,
  not_equal,
  less,
  greater,
  less_equal,
  greater_equal,
  chain  ///< : of frames
};

/// A node of an expression. Children are arguments: Tree::arguments[first, first + count), indexes into Tree::nodes.
struct Node {
  NodeKind kind = NodeKind::number;
  std::uint32_t offset = 0, length = 0;  ///< position in the text
  double number = 0;
  std::uint32_t name = kNone;  ///< index into Tree::names; for a text into Tree::texts
  std::uint32_t first = 0, count = 0;
};

/// Meaning of the value of an axis or centre: X=IC(5), I=AC(30), C=DC(90).
enum class Dimension : std::uint8_t { as_modal, absolute, incremental, nearest, positive, negative };

enum class ItemKind : std::uint8_t {
  word,     ///< an address with a value: X10, X=R1, CR=8, M3=3, SPOS[1]=90
  command,  ///< a word alone: TRANS, SUPA, G codes are words
  call,     ///< NAME(...), NAME, L140: a cycle or a subprogram
  assign,   ///< assignment to a variable or a parameter
  label     ///< NAME:
};

/// A part of a block.
struct Item {
  ItemKind kind = ItemKind::word;
  Dimension dimension = Dimension::as_modal;
  bool constant = false;         ///< the value is the number `number`
  bool brackets = false;         ///< a call is written with brackets
  std::uint32_t name = kNone;    ///< index into Tree::names: "X", "CR", "CYCLE81", "SLOT"
  const WordRow* row = nullptr;  ///< what the name is, where it is a word of the language
  std::uint32_t offset = 0, length = 0;
  double number = 0;
  std::uint32_t value = kNone;  ///< a node
  std::uint32_t index = kNone;  ///< a node: the extension of the address (M3=3: 3), or the one in square brackets
  std::uint32_t first = 0, count = 0;  ///< arguments; of an assignment the indexes. kNone for one that is left out
};

enum class FlowKind : std::uint8_t {
  none,
  if_block,
  else_branch,
  end_if,
  jump,    ///< GOTO, GOTOF, GOTOB, GOTOC, GOTOS, with or without IF
  select,  ///< CASE
  for_loop,
  end_for,
  while_loop,
  end_while,
  repeat_loop,
  until,
  endless_loop,
  end_loop,
  repeat_part,  ///< REPEAT label, REPEATB label
  procedure,    ///< PROC
  declaration,  ///< DEF
  external,     ///< EXTERN
  leave         ///< RET, M17, M2, M30 are words
};

/// Target of a jump: a label or block number; the search goes forward, backward, or first forward.
struct Jump {
  enum class Search : std::uint8_t { forward, backward, both, start } search = Search::both;
  bool silent = false;  ///< GOTOC: no error where there is no target
  std::uint32_t offset = 0;
  std::uint32_t target = kNone;  ///< index into Tree::names: a label, "N100" or ":100"
  std::uint32_t value = kNone;   ///< a node: the target as a text
};

enum class ValueType : std::uint8_t { real, integer, boolean, text, axis, frame };

struct Declared {
  std::uint32_t name = kNone;
  ValueType type = ValueType::real;
  bool by_reference = false;                           ///< VAR
  std::uint32_t dimension[3] = {kNone, kNone, kNone};  ///< nodes
  std::uint32_t dimensions = 0;
  std::uint32_t value = kNone;        ///< a node: the initial or default value
  std::vector<std::uint32_t> values;  ///< SET(...)
  std::uint32_t offset = 0;
};

/// A block that is not plain words alone.
struct Statement {
  std::uint32_t block = 0;
  FlowKind flow = FlowKind::none;
  bool named_number = false;  ///< REPEATB
  std::uint32_t flow_offset = 0;
  std::uint32_t condition = kNone;       ///< a node: of IF, WHILE, UNTIL, CASE; of FOR the first value
  std::uint32_t last = kNone;            ///< a node: of FOR the last value; of REPEAT the count (P)
  std::uint32_t variable = kNone;        ///< an item: the assigned variable of FOR
  std::vector<Jump> jumps;               ///< one for a jump; for CASE as many as constants, DEFAULT last
  std::vector<std::uint32_t> constants;  ///< nodes, of CASE
  std::vector<std::uint32_t> labels;     ///< names, of REPEAT
  std::vector<Declared> declared;        ///< DEF; PROC: parameters
  std::uint32_t name = kNone;            ///< PROC
  bool saves = false;                    ///< PROC ... SAVE
  std::uint32_t partner = kNone;         ///< block: of IF its ELSE or ENDIF, of ELSE its ENDIF, of loops the other end
  std::vector<Item> items;
};

/// A program of the file: the whole file, or a part behind %_N_NAME_SPF.
struct Part {
  std::string name;  ///< upper case, without _N_ and the type: "SLOT"; of the first part empty where nothing names it
  std::uint32_t first = 0, end = 0;  ///< blocks
};

struct Tree : LanguageTree {
  std::vector<std::string> names, texts;  ///< names in upper case
  std::vector<Node> nodes;
  std::vector<std::uint32_t> arguments;
  std::vector<Statement> statements;                               ///< ascending by block
  std::vector<Part> parts;                                         ///< at least one
  std::map<std::string, std::vector<std::uint32_t>> labels;        ///< blocks; names, and ":100" of main blocks
  std::vector<std::pair<std::uint64_t, std::uint32_t>> numbers{};  ///< N words and their blocks, ascending

  const Statement* statement(std::uint32_t block) const;
  /// Blocks with a label or block number ("N100"), ascending.
  std::vector<std::uint32_t> blocks_of(const std::string& label) const;
  std::uint32_t argument(const Node& node, std::uint32_t which) const { return arguments[node.first + which]; }
};

inline const Tree& tree_of(const Program& program) { return static_cast<const Tree&>(*program.tree); }

}  // namespace camber::nc::siemens
