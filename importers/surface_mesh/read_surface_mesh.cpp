// SPDX-License-Identifier: Apache-2.0
#include "meso/import_surface_mesh/read_surface_mesh.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "meso/import_surface_mesh/read_stl.hpp"
#include "readers.hpp"
#include "text_scanner.hpp"

namespace meso {
namespace {

using Reader = std::optional<TriangleMesh> (*)(std::string_view, const std::string&, DiagnosticSink&);

Reader reader_of_extension(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; });
  if (extension == ".stl") return read_stl;
  if (extension == ".ply") return read_ply;
  if (extension == ".obj") return read_obj;
  if (extension == ".off") return read_off;
  return nullptr;
}

/// "ply" and "OFF" begin nothing else; "solid" begins STL, if not an OBJ of that name.
Reader reader_of(std::string_view bytes, const std::string& file) {
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r")) return read_ply;
  const std::string_view first = TextScanner(bytes.substr(0, 4096), "", '#').word();
  constexpr std::size_t longest = 8;  // STCN4nOFF without one
  if (first.ends_with("OFF") && first.size() <= longest) return read_off;
  if (const Reader named = reader_of_extension(file)) return named;
  if (first == "solid") return read_stl;
  if (first == "v" || first == "o" || first == "mtllib") return read_obj;
  constexpr std::size_t header_bytes = 84, facet_bytes = 50;
  std::uint32_t facets = 0;
  if (bytes.size() >= header_bytes) std::memcpy(&facets, bytes.data() + 80, sizeof facets);
  if (facets > 0 && bytes.size() == header_bytes + std::uint64_t{facets} * facet_bytes) return read_stl;
  return nullptr;
}

/// Read, not sized: a pipe or a device has no size, and may never end.
std::optional<std::string> contents(const std::filesystem::path& file, const RunOptions& run, DiagnosticSink& sink) {
  const std::uint64_t most = run.max_memory_bytes / 4;
  const auto fail = [&]() -> std::nullopt_t {
    sink.report({.code = Code::file_not_found, .args = {file.string(), std::strerror(errno)}});
    return std::nullopt;
  };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), std::fclose);
  if (!stream) return fail();
  std::string bytes;
  std::size_t size = 0;
  do {
    constexpr std::size_t block = 1 << 20;
    if (size == bytes.size()) bytes.resize(std::max(2 * size, block));
    errno = 0;
    const std::size_t wanted = std::min(bytes.size() - size, 64 * block);
    const std::size_t read = std::fread(bytes.data() + size, 1, wanted, stream.get());
    size += read;
    if (size > most) {
      sink.report(
          {.code = Code::file_too_large, .args = {file.string(), std::to_string(size) + "+", std::to_string(most)}});
      return std::nullopt;
    }
    if (run.should_stop()) {
      sink.report({.code = run.out_of_time() ? Code::limit_time : Code::cancelled});
      return std::nullopt;
    }
    if (read < wanted) break;
  } while (true);
  if (std::ferror(stream.get()) != 0) return fail();
  bytes.resize(size);
  return bytes;
}

}  // namespace

std::optional<TriangleMesh> read_surface_mesh(std::string_view bytes, const std::string& file, DiagnosticSink& sink) {
  std::optional<TriangleMesh> mesh;  // returned everywhere: a move of it makes GCC 12 warn at -O2
  const Reader reader = reader_of(bytes, file);
  if (reader == nullptr) {
    sink.report({.code = Code::mesh_file_format, .where = {.file = file}, .args = {file}});
    return mesh;
  }
  mesh = reader(bytes, file, sink);
  if (mesh && mesh->triangles.empty()) {
    sink.report({.code = Code::mesh_file_empty, .where = {.file = file}});
    mesh.reset();
  }
  return mesh;
}

std::optional<TriangleMesh> read_surface_mesh_file(const Resource& file, DiagnosticSink& sink, const RunOptions& run) {
  if (file.memory() != nullptr) return read_surface_mesh(*file.memory(), file.name().string(), sink);
  const std::optional<std::string> bytes = contents(file.name(), run, sink);
  if (!bytes) return {};
  return read_surface_mesh(*bytes, file.name().string(), sink);
}

}  // namespace meso
