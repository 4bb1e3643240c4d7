// SPDX-License-Identifier: Apache-2.0
#pragma once
// Files that a document refers to: where their bytes come from, and that an href leads nowhere else.
//
//   const auto folder = resources_in_folder("examples/ibeam");
//   const auto body = folder->find("ibeam.step");          // nothing if the href leads out
//   std::string error;
//   const auto bytes = body ? ResourceBytes::open(*body, error) : nullptr;
//   bytes->view();                                          // mapped, not copied
//
// A document lies in a folder or in a package; readers ask for a Resource and do not know which. Thread rule: all
// values are immutable.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace meso {

/// Bytes under a name: a file, or bytes in memory that are called like one. Equal names mean equal bytes.
class Resource {
 public:
  Resource() = default;
  /// A file, which need not exist; from whatever a path is made of.
  template <class Path>
  requires(std::is_convertible_v<Path, std::filesystem::path> && !std::is_same_v<std::remove_cvref_t<Path>, Resource>)
      // A path is a resource. NOLINTNEXTLINE(google-explicit-constructor,bugprone-forwarding-reference-overload)
      Resource(Path&& file)
      : name_(std::forward<Path>(file)) {}
  Resource(std::filesystem::path name, std::shared_ptr<const std::string> bytes)
      : name_(std::move(name)), bytes_(std::move(bytes)) {}

  /// Of a file its path; of bytes in memory what messages call them. Its extension says what the bytes are.
  [[nodiscard]] const std::filesystem::path& name() const { return name_; }
  /// Null: a file.
  [[nodiscard]] const std::shared_ptr<const std::string>& memory() const { return bytes_; }
  /// In memory, or a regular file.
  [[nodiscard]] bool exists() const;

 private:
  std::filesystem::path name_;
  std::shared_ptr<const std::string> bytes_;
};

/// A resource's bytes without a copy; of a file, pages are read when they are touched and can be given back. A file
/// must not change while it is in use.
class ResourceBytes {
 public:
  /// Null, and why, if the file cannot be read or is no regular file.
  [[nodiscard]] static std::shared_ptr<const ResourceBytes> open(const Resource& resource, std::string& error);
  ~ResourceBytes();
  ResourceBytes(const ResourceBytes&) = delete;
  ResourceBytes& operator=(const ResourceBytes&) = delete;

  [[nodiscard]] std::string_view view() const { return {data_, size_}; }

 private:
  ResourceBytes() = default;
  const char* data_ = nullptr;
  std::size_t size_ = 0;
  std::shared_ptr<const std::string> memory_;  // null: mapped
};

/// Where a document's hrefs lead.
class Resources {
 public:
  virtual ~Resources() = default;
  /// What an href names, there or not. Nothing if it leads out of the folder or the package.
  [[nodiscard]] virtual std::optional<Resource> find(std::string_view href) const = 0;
};

/// Files of a folder; hrefs may pass through symbolic links that stay inside.
[[nodiscard]] std::shared_ptr<const Resources> resources_in_folder(std::filesystem::path folder);

/// An href as the one name of what it means inside its folder: "./a//b/../c.step" is "a/c.step". Nothing if it is
/// empty or absolute, has a scheme, a backslash or NUL, or leads out. Looks at no file.
[[nodiscard]] std::optional<std::string> normalized_href(std::string_view href);

/// Lower-case hexadecimal SHA-256.
[[nodiscard]] std::string sha256_of_bytes(std::string_view bytes);
/// The same of a resource; empty if it cannot be read.
[[nodiscard]] std::optional<std::string> sha256_of(const Resource& resource);

}  // namespace meso
