#include "base/output_transaction.h"

#include <algorithm>
#include <cassert>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>

#include "base/error.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

std::optional<std::pair<uint64_t, uint64_t>> identity_of(const fs::path& path) {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return std::nullopt;
  return std::pair<uint64_t, uint64_t>(found.st_dev, found.st_ino);
}

fs::path name_of(const fs::path& path) {
  return path.has_filename() ? path.filename() : path.parent_path().filename();
}

// Whether two paths, which need not exist, are one name in one folder.
bool is_same_name(const fs::path& a, const fs::path& b) {
  const auto folder = [](const fs::path& path) {
    return identity_of(folder_of(path.has_filename() ? path : path.parent_path()));
  };
  return name_of(a) == name_of(b) && folder(a) && folder(a) == folder(b);
}

}  // namespace

struct OutputTransaction::Output {
  std::unique_ptr<OutputFile> file;
  std::unique_ptr<OutputFolder> folder;
  bool is_asked_for = false;

  PendingOutput& pending() const { return file ? file->pending() : folder->pending(); }
};

OutputTransaction::OutputTransaction(Existing existing) : existing_(existing) {}
OutputTransaction::~OutputTransaction() = default;

void OutputTransaction::protect(const fs::path& input) {
  const auto identity = identity_of(input);
  if (!identity) return;
  inputs_.insert(*identity);
  std::error_code error;
  fs::path folder = fs::canonical(input, error);
  while (!error && folder.has_relative_path()) {
    folder = folder.parent_path();
    const auto around = identity_of(folder);
    if (around && !around_inputs_.insert(*around).second) break;  // and all around that one
  }
  for (const auto& output : outputs_) check_protected(output->pending().target());
}

void OutputTransaction::release(const fs::path& input) {
  if (const auto identity = identity_of(input)) {
    inputs_.erase(*identity);
    around_inputs_.erase(*identity);
  }
}

void OutputTransaction::extend(const fs::path& input) {
  release(input);
  if (const auto identity = identity_of(input)) extended_.insert(*identity);
}

void OutputTransaction::check_protected(const fs::path& path) const {
  const auto identity = identity_of(path);
  if (!identity) return;
  if (inputs_.contains(*identity))
    throw Error(ErrorKind::usage,
                fmt::format("{}: is an input of this run, which its output would replace; give "
                            "the output another name",
                            path.string()));
  if (around_inputs_.contains(*identity))
    throw Error(ErrorKind::usage,
                fmt::format("{}: holds an input of this run, which its output would replace; give "
                            "the output another name",
                            path.string()));
}

OutputTransaction::Output* OutputTransaction::find(const fs::path& path) {
  for (const auto& output : outputs_)
    if (is_same_name(output->pending().target(), path)) return output.get();
  return nullptr;
}

OutputTransaction::Output& OutputTransaction::claim(const fs::path& path, FolderCheck is_ours) {
  if (find(path) != nullptr)
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: is written twice; give each output a name of its own", path.string()));
  check_protected(path);
  const auto identity = identity_of(path);
  const bool is_extended = identity && extended_.contains(*identity);
  const Existing existing = is_extended ? Existing::replace : existing_;
  auto output = std::make_unique<Output>();
  if (is_ours == nullptr)
    output->file = std::make_unique<OutputFile>(path, existing);
  else
    output->folder = std::make_unique<OutputFolder>(path, existing, is_ours);
  return *outputs_.emplace_back(std::move(output));
}

OutputTransaction::Output& OutputTransaction::ask(const fs::path& path, FolderCheck is_ours) {
  Output* const claimed = find(path);
  Output& output = claimed != nullptr && !claimed->is_asked_for ? *claimed : claim(path, is_ours);
  assert((output.file != nullptr) == (is_ours == nullptr));
  output.is_asked_for = true;
  return output;
}

void OutputTransaction::claim_file(const fs::path& path) {
  if (!is_left_) claim(path, nullptr);
}

void OutputTransaction::claim_folder(const fs::path& path, FolderCheck is_ours) {
  if (!is_left_) claim(path, is_ours);
}

OutputFile& OutputTransaction::file(const fs::path& path) { return *ask(path, nullptr).file; }

OutputFolder& OutputTransaction::folder(const fs::path& path, FolderCheck is_ours) {
  return *ask(path, is_ours).folder;
}

std::string OutputTransaction::with_targets(std::string sentence) const {
  for (const auto& output : outputs_) {
    const std::string made = output->pending().temporary().path().string();
    const std::string target = output->pending().target().string();
    for (size_t at = sentence.find(made); at != std::string::npos; at = sentence.find(made, at))
      sentence.replace(at, made.size(), target);
  }
  return sentence;
}

bool OutputTransaction::has_outputs() const {
  return std::any_of(outputs_.begin(), outputs_.end(),
                     [](const auto& output) { return output->is_asked_for; });
}

void OutputTransaction::commit() {
  std::vector<PendingOutput*> pending;
  for (size_t i = outputs_.size(); i-- > 0;) {
    if (!outputs_[i]->is_asked_for) continue;
    if (outputs_[i]->folder) outputs_[i]->folder->complete();
    pending.push_back(&outputs_[i]->pending());
  }
  const auto outputs = std::exchange(outputs_, {});  // what is old and new has both its names now
  commit_together(pending);
}

}  // namespace vpr
