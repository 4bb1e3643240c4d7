// SPDX-License-Identifier: Apache-2.0
#include "meso/resource/resource.hpp"

#include <fcntl.h>
#include <openssl/sha.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace meso {
namespace fs = std::filesystem;
namespace {

class FolderResources final : public Resources {
 public:
  explicit FolderResources(fs::path folder) : folder_(std::move(folder)) {}

  std::optional<Resource> find(std::string_view href) const override {
    if (!normalized_href(href)) return std::nullopt;
    std::error_code error;
    const fs::path root = fs::weakly_canonical(folder_.empty() ? fs::path(".") : folder_, error);
    if (error) return std::nullopt;
    const fs::path target = fs::weakly_canonical(root / fs::path(href), error);
    if (error) return std::nullopt;
    const fs::path inside = target.lexically_relative(root);
    if (inside.empty() || *inside.begin() == "..") return std::nullopt;
    return Resource(target);
  }

 private:
  fs::path folder_;
};

}  // namespace

bool Resource::exists() const {
  std::error_code error;
  return bytes_ != nullptr || fs::is_regular_file(name_, error);
}

std::shared_ptr<const ResourceBytes> ResourceBytes::open(const Resource& resource, std::string& error) {
  const std::shared_ptr<ResourceBytes> result(new ResourceBytes);
  if (resource.memory() != nullptr) {
    result->memory_ = resource.memory();
    result->data_ = result->memory_->data();
    result->size_ = result->memory_->size();
    return result;
  }
  const int descriptor = ::open(resource.name().c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (descriptor < 0 || fstat(descriptor, &status) != 0) {
    error = std::strerror(errno);
    if (descriptor >= 0) close(descriptor);
    return nullptr;
  }
  const auto size = static_cast<std::size_t>(status.st_size);
  void* bytes = nullptr;
  if (!S_ISREG(status.st_mode))
    error = "it is no regular file";
  else if (size > 0 && (bytes = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0)) == MAP_FAILED)
    error = std::strerror(errno);
  close(descriptor);
  if (!error.empty()) return nullptr;
  result->data_ = static_cast<const char*>(bytes);
  result->size_ = size;
  return result;
}

ResourceBytes::~ResourceBytes() {
  if (memory_ == nullptr && size_ > 0) munmap(const_cast<char*>(data_), size_);
}

std::shared_ptr<const Resources> resources_in_folder(fs::path folder) {
  return std::make_shared<FolderResources>(std::move(folder));
}

std::optional<std::string> normalized_href(std::string_view href) {
  if (href.empty() || href.find_first_of(std::string_view("\\\0:", 3)) != std::string_view::npos) return std::nullopt;
  const fs::path relative(href);
  if (relative.is_absolute()) return std::nullopt;
  const fs::path inside = relative.lexically_normal();
  if (inside.empty() || *inside.begin() == "..") return std::nullopt;
  return inside.generic_string();
}

std::string sha256_of_bytes(std::string_view bytes) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), digest.data());
  static constexpr char digits[] = "0123456789abcdef";
  std::string out;
  for (const unsigned char byte : digest) {
    out += digits[byte >> 4];
    out += digits[byte & 15];
  }
  return out;
}

std::optional<std::string> sha256_of(const Resource& resource) {
  std::string error;
  const auto bytes = ResourceBytes::open(resource, error);
  return bytes ? std::optional(sha256_of_bytes(bytes->view())) : std::nullopt;
}

}  // namespace meso
