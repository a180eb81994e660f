// All outputs of one run: made under temporary names, put in their places together.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/output_file.h"

namespace vpr {

/// Outputs are claimed before the long work, which finds out whether they can be written, then
/// asked for and filled, and committed at the end. The first claimed is the main one: it is put in
/// its place last, so that its presence says that all are there. What was claimed and never asked
/// for is not written. Without a commit, nothing stays.
class OutputTransaction {
 public:
  explicit OutputTransaction(Existing existing);
  ~OutputTransaction();
  OutputTransaction(const OutputTransaction&) = delete;
  OutputTransaction& operator=(const OutputTransaction&) = delete;

  Existing existing() const { return existing_; }

  /// Of a process whose outputs another one writes: claims are not looked at from here on.
  void leave_to_another() { is_left_ = true; }

  /// A file or folder that the run reads: no output may replace it, or a folder that it is in.
  /// Throws Error(usage) if one that is claimed already would. What does not exist is let pass.
  void protect(const std::filesystem::path& input);

  /// An input that the run may replace after all, for it is read whole before.
  void release(const std::filesystem::path& input);

  /// An input that the run extends in place: what is written there replaces it, whatever
  /// existing() says.
  void extend(const std::filesystem::path& input);

  /// Throw as check_output_file and check_output_folder do, Error(usage) if the path is claimed
  /// already or protected, and Error(output) if nothing can be written beside it.
  void claim_file(const std::filesystem::path& path);
  void claim_folder(const std::filesystem::path& path, FolderCheck is_ours);

  /// What was claimed, or is now; to be asked for once. Lives as long as the transaction.
  OutputFile& file(const std::filesystem::path& path);
  OutputFolder& folder(const std::filesystem::path& path, FolderCheck is_ours);

  /// A sentence with the names of outputs in place of those under which they are being made, which
  /// say nothing to anybody.
  std::string with_targets(std::string sentence) const;

  /// Whether anything was asked for and is not in its place yet.
  bool has_outputs() const;

  /// Puts everything that was asked for in its place, all or none, as commit_together says. A
  /// transaction without outputs has nothing to do.
  void commit();

 private:
  struct Output;
  /// Device and inode: the same thing whatever it is called.
  using Identity = std::pair<uint64_t, uint64_t>;

  Output& claim(const std::filesystem::path& path, FolderCheck is_ours);
  Output& ask(const std::filesystem::path& path, FolderCheck is_ours);
  Output* find(const std::filesystem::path& path);
  void check_protected(const std::filesystem::path& path) const;

  Existing existing_;
  bool is_left_ = false;
  std::vector<std::unique_ptr<Output>> outputs_;  // in the order of claims
  std::set<Identity> inputs_;
  std::set<Identity> around_inputs_;  // folders that inputs are in
  std::set<Identity> extended_;
};

}  // namespace vpr
