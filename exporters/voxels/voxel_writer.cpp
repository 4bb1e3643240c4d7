// SPDX-License-Identifier: Apache-2.0
#include "meso/export_voxels/voxel_writer.hpp"

#include <bit>
#include <cassert>
#include <string>

#include "meso/base/number.hpp"

namespace meso {
namespace {

static_assert(std::endian::native == std::endian::little);

std::string vector_text(const Vec3& v, const char* between) {
  return format_number(v.x) + between + format_number(v.y) + between + format_number(v.z);
}

class FileVoxels : public VoxelSink {
 public:
  explicit FileVoxels(ByteSink& file) : file_(file) {}
  [[nodiscard]] bool write_plane(std::string_view bytes) override { return file_.write(bytes); }

 protected:
  ByteSink& file_;
};

/// Samples are in the middles of cells, so the origin is the middle of the first one.
class NrrdWriter final : public FileVoxels {
 public:
  using FileVoxels::FileVoxels;
  [[nodiscard]] bool begin(const VoxelArray& a) override {
    const Vec3 h = a.spacing;
    const auto sizes = std::to_string(a.cells[0]) + " " + std::to_string(a.cells[1]) + " " + std::to_string(a.cells[2]);
    return file_.write(
        "NRRD0005\ntype: " + std::string(a.type == VoxelType::uint8 ? "uint8" : "float") +
        "\ndimension: 3\nsizes: " + sizes + "\nspace dimension: 3\nspace units: \"mm\" \"mm\" \"mm\"" +
        "\nspace directions: (" + vector_text({h.x, 0, 0}, ",") + ") (" + vector_text({0, h.y, 0}, ",") + ") (" +
        vector_text({0, 0, h.z}, ",") + ")\nspace origin: (" + vector_text(a.origin + 0.5 * h, ",") +
        ")\ncenterings: cell cell cell\nendian: little\nencoding: raw\ncontent: " + std::string(a.name) + "\n\n");
  }
  [[nodiscard]] bool finish() override { return true; }
};

class VtiWriter final : public FileVoxels {
 public:
  using FileVoxels::FileVoxels;
  [[nodiscard]] bool begin(const VoxelArray& a) override {
    std::string extent;
    for (const std::uint32_t n : a.cells) extent += (extent.empty() ? "0 " : " 0 ") + std::to_string(n);
    const std::string name(a.name), type = a.type == VoxelType::uint8 ? "UInt8" : "Float32";
    const std::uint64_t bytes = a.bytes();
    return file_.write(
               "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" "
               "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<ImageData WholeExtent=\"" +
               extent + "\" Origin=\"" + vector_text(a.origin, " ") + "\" Spacing=\"" + vector_text(a.spacing, " ") +
               "\">\n<Piece Extent=\"" + extent + "\">\n<CellData Scalars=\"" + name + "\">\n<DataArray type=\"" +
               type + "\" Name=\"" + name +
               "\" format=\"appended\" offset=\"0\"/>\n</CellData>\n</Piece>\n</ImageData>\n"
               "<AppendedData encoding=\"raw\">\n_") &&
           file_.write({reinterpret_cast<const char*>(&bytes), sizeof bytes});
  }
  [[nodiscard]] bool finish() override { return file_.write("\n</AppendedData>\n</VTKFile>\n"); }
};

}  // namespace

std::optional<VoxelFormat> voxel_format_of(std::string_view path) {
  std::string ending(path.substr(std::min(path.size(), path.rfind('.'))));
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (ending == ".nrrd") return VoxelFormat::nrrd;
  if (ending == ".vti") return VoxelFormat::vti;
  return std::nullopt;
}

std::unique_ptr<VoxelSink> make_voxel_writer(VoxelFormat format, ByteSink& file) {
  if (format == VoxelFormat::nrrd) return std::make_unique<NrrdWriter>(file);
  return std::make_unique<VtiWriter>(file);
}

}  // namespace meso
