// SPDX-License-Identifier: Apache-2.0
#include "meso/base/memory_mesh_sink.hpp"

namespace meso {
namespace {

constexpr std::size_t block_size = 4096;

template <class T>
std::string_view bytes_of(std::span<const T> block) {
  return {reinterpret_cast<const char*>(block.data()), block.size_bytes()};
}

template <class T>
void append_bytes(std::vector<T>& to, std::string_view bytes) {
  if (bytes.empty()) return;
  const std::size_t old = to.size();
  to.resize(old + bytes.size() / sizeof(T));
  std::memcpy(to.data() + old, bytes.data(), bytes.size());
}

template <class T, class Encode, class Write>
bool stream(std::span<const T> all, Encode encode, Write write) {
  ByteBuffer bytes;
  for (; !all.empty(); all = all.subspan(std::min(block_size, all.size()))) {
    bytes.clear();
    encode(all.first(std::min(block_size, all.size())), bytes);
    if (!write(bytes.view())) return false;
  }
  return true;
}

}  // namespace

bool MemoryMeshSink::begin() {
  mesh_ = {};
  return true;
}

void MemoryMeshSink::encode_points(std::span<const Vec3> block, ByteBuffer& out) const { out.append(bytes_of(block)); }

bool MemoryMeshSink::write_points(std::string_view bytes) {
  append_bytes(mesh_.points, bytes);
  return true;
}

bool MemoryMeshSink::begin_triangles(std::uint64_t) { return true; }

void MemoryMeshSink::encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const {
  out.append(bytes_of(block));
}

bool MemoryMeshSink::write_triangles(std::string_view bytes) {
  append_bytes(mesh_.triangles, bytes);
  return true;
}

bool MemoryMeshSink::finish(std::uint64_t) { return true; }

bool write_mesh(const TriangleMesh& mesh, MeshSink& sink) {
  return sink.begin() &&
         stream(
             std::span(mesh.points), [&](auto block, ByteBuffer& out) { sink.encode_points(block, out); },
             [&](std::string_view bytes) { return sink.write_points(bytes); }) &&
         sink.begin_triangles(mesh.points.size()) &&
         stream(
             std::span(mesh.triangles), [&](auto block, ByteBuffer& out) { sink.encode_triangles(block, out); },
             [&](std::string_view bytes) { return sink.write_triangles(bytes); }) &&
         sink.finish(mesh.triangles.size());
}

}  // namespace meso
