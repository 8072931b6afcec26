#pragma once
// Parts of a prediction in sections, as files or messages.
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "machine/job_file.h"

namespace camber::distribute {

enum class PartStage : std::uint8_t { sweep, solve };

/// Part of a distributed prediction: what one section has computed in one stage.
struct PartName {
  PartStage stage = PartStage::sweep;
  int round = 1;            ///< number of the solving round, from 1
  std::size_t section = 0;  ///< from 0
  std::size_t sections = 1;
  bool own = false;  ///< what only later stages of the same section read
};
/// "sweep-003-of-016.part", "solve-1-003-of-016.part", "own-sweep-003-of-016.part"; sections count from 1.
std::string file_name(const PartName& name);

/// Identifies one prediction. Parts whose key differs are refused, and the message names what differs.
struct PartKey {
  std::string job_path;  ///< absolute
  std::string hash;      ///< checksum over job, program and every file that the job reads
  std::size_t sections = 1;
  std::size_t forces_at = 0;
};

/// Where parts are kept for others.
class PartStore {
 public:
  virtual ~PartStore() = default;
  virtual bool has(const PartName& name) = 0;
  /// `write` gives the content piece by piece.
  using Write = std::function<void(const std::function<void(std::string_view)>& put)>;
  virtual void give(const PartName& name, const Write& write) = 0;
  /// Throws InputError where it is missing [part-missing], torn [part-torn] or of another prediction [part-version],
  /// [part-job].
  virtual std::string take(const PartName& name) = 0;
  /// The pieces of a part of this process, one after the other; each was given with its size before it, in 8 bytes.
  /// Throws as take(), at once.
  virtual std::function<std::string()> take_pieces(const PartName& name) = 0;
  /// Throws as take().
  virtual void check(const PartName& name) { take(name); }
};

/// Parts as files in FOLDER/parts, each written beside and renamed.
class PartFiles : public PartStore {
 public:
  PartFiles(std::string folder, PartKey key) : folder_(std::move(folder)), key_(std::move(key)) {}
  /// A whole part of this prediction.
  bool has(const PartName& name) override;
  void give(const PartName& name, const Write& write) override;
  std::string take(const PartName& name) override;
  std::function<std::string()> take_pieces(const PartName& name) override;
  void check(const PartName& name) override;
  std::string path(const PartName& name) const;

 private:
  /// The command that writes a part.
  std::string again(const PartName& name) const;
  void expect_there(const PartName& name) const;
  [[noreturn]] void refuse_torn(const PartName& name) const;
  void expect_own(const PartName& name, const std::string& version, const std::string& of_name,
                  const PartKey& key) const;

  std::string folder_;
  PartKey key_;
};

/// The key of the parts in a folder, with their hash. Throws InputError where there is no part [part-missing], or
/// where parts have different numbers of sections [part-sections].
PartKey find_parts(const std::string& folder);
/// The last round of solving that has a part which is of this prediction, or torn; 0: none.
int last_round(const std::string& folder, const PartKey& key);

PartKey part_key(const machine::Job& job, std::size_t sections, std::size_t forces_at);

}  // namespace camber::distribute
