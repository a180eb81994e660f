// Arrays of .npz files.
#pragma once

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/npy.h"
#include "base/zip_file.h"

namespace vpr::test {

/// The bytes of NAME.npy in an archive; empty if there is none.
inline std::string npz_bytes(const std::filesystem::path& path, const std::string& name) {
  ZipFile archive(path);
  const auto found = std::ranges::find(archive.names(), name + ".npy");
  if (found == archive.names().end()) return "";
  ZipFile::Entry entry(archive, static_cast<size_t>(found - archive.names().begin()));
  std::string bytes;
  std::string piece(65536, '\0');
  while (const size_t count = entry.read(std::as_writable_bytes(std::span(piece))))
    bytes.append(piece, 0, count);
  return bytes;
}

/// The values of an array in an archive, in the order of the file.
template <class T>
std::vector<T> npz_array(const std::filesystem::path& path, const std::string& name) {
  const std::string bytes = npz_bytes(path, name);
  const auto header = parse_npy_header(bytes);
  if (!header || header->type != npy_type<T>()) throw std::runtime_error("no such array: " + name);
  std::vector<T> values((bytes.size() - header->offset) / sizeof(T));
  std::memcpy(values.data(), bytes.data() + header->offset, sizeof(T) * values.size());
  return values;
}

}  // namespace vpr::test
