// SPDX-License-Identifier: Apache-2.0
#include "import_solid.hpp"

#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPControl_Reader.hxx>
#include <algorithm>
#include <cctype>
#include <istream>

#include "boolean.hpp"
#include "import_crossing.hpp"
#include "import_kernel.hpp"
#include "import_stl.hpp"
#include "meso/base/number.hpp"
#include "meso/brep/read_step.hpp"
#include "meso/brep/step_text.hpp"
#include "meso/resource/resource.hpp"
#include "solid_primitive.hpp"
#include "view_buffer.hpp"

namespace meso::brep {
namespace {

using std::filesystem::path;

enum class FileKind { step, iges, brep, stl, other };

FileKind kind_of(const path& file) {
  std::string text = file.extension().string();
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text == ".step" || text == ".stp"   ? FileKind::step
         : text == ".iges" || text == ".igs" ? FileKind::iges
         : text == ".brep"                   ? FileKind::brep
         : text == ".stl"                    ? FileKind::stl
                                             : FileKind::other;
}

bool hash_holds(const eval::ImportShape& import, ElementId where, const SolidContext& context) {
  if (!import.sha256) return true;
  const auto actual = sha256_of(import.file);
  if (actual == import.sha256) return true;
  context.report(Code::import_changed, where,
                 {import.file.name().string(), actual.value_or("(unreadable)"), *import.sha256});
  return false;
}

/// Null if no root could be transferred.
TopoDS_Shape read_step_shape(const std::string& name, std::string_view text) {
  const std::scoped_lock lock(reader_mutex());
  Message::DefaultMessenger()->ChangePrinters().Clear();
  STEPControl_Reader reader;
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  ViewBuffer buffer(text);
  std::istream stream(&buffer);
  if (reader.ReadStream(name.c_str(), stream) != IFSelect_RetDone || reader.TransferRoots() == 0) return {};
  return reader.OneShape();
}

std::optional<Solids> read_step(const Resource& file, ElementId where, const SolidContext& context) {
  const std::string name = file.name().string();
  std::string error;
  const auto bytes = ResourceBytes::open(file, error);
  if (!bytes) {
    context.report(Code::import_unreadable, where, {name, "it cannot be opened"});
    return {};
  }
  if (const auto fault = step_text_fault(bytes->view())) {
    context.report(Code::import_unreadable, where, {name, *fault});
    return {};
  }
  const TopoDS_Shape shape = read_step_shape(name, bytes->view());
  if (shape.IsNull()) {
    context.report(Code::import_unreadable, where, {name, "it is not a complete STEP file"});
    return {};
  }
  return solids_of(shape);
}

std::optional<Solids> read_solids(const Resource& file, ElementId where, const SolidContext& context) {
  switch (kind_of(file.name())) {
    case FileKind::step:
      return read_step(file, where, context);
    case FileKind::iges:
      return read_iges_solids(file, where, context);
    case FileKind::brep:
      return read_brep_solids(file, where, context);
    case FileKind::stl:
      return read_stl_solids(file, where, context);
    case FileKind::other:
      break;
  }
  context.report(Code::import_no_reader, where, {file.name().string()});
  return {};
}

/// What is wrong with imported solids, or nothing.
std::optional<std::string> fault_of(const Solids& solids) {
  if (solids.empty()) return "no solid in it";
  for (const TopoDS_Shape& solid : solids) {
    const EdgeUses uses = edge_uses(solid);
    if (uses.free > 0) return std::to_string(uses.free) + " edges belong to one face only";
    if (uses.multiple > 0) return std::to_string(uses.multiple) + " edges belong to more than two faces";
    if (!(volume_of(solid) > 0)) return "a solid has no volume";
  }
  return {};
}

bool crosses(const Solids& solids, const eval::ImportShape& import, ElementId where, const SolidContext& context) {
  for (const TopoDS_Shape& solid : solids) {
    const auto place = self_crossing(solid);
    if (!place) continue;
    context.report(
        Code::import_overlaps, where,
        {import.file.name().string(), "the surface of a solid passes through itself near " + format_number(place->x) +
                                          " " + format_number(place->y) + " " + format_number(place->z) + " mm"});
    return true;
  }
  return false;
}

}  // namespace

bool is_exact_file(const path& file) {
  const FileKind kind = kind_of(file);
  return kind == FileKind::step || kind == FileKind::iges || kind == FileKind::brep;
}

std::optional<Solids> import_solids(const eval::ImportShape& import, const Affine& map, ElementId where,
                                    const SolidContext& context, Crossing crossing) {
  if (!hash_holds(import, where, context)) return {};
  std::optional<Solids> read = read_solids(import.file, where, context);
  if (!read) return {};
  if (const auto fault = fault_of(*read)) {
    context.report(Code::import_not_closed, where, {import.file.name().string(), *fault});
    return {};
  }
  if (crossing == Crossing::refused && kind_of(import.file.name()) != FileKind::stl &&
      crosses(*read, import, where, context))
    return {};
  // Solids of one body may overlap; what follows counts on solids that do not.
  read = fuse(*read, where, context);
  if (!read) return {};
  const double s = import.scale;
  const Affine scaled{Mat3::from_columns({s, 0, 0}, {0, s, 0}, {0, 0, s}), {}};
  for (TopoDS_Shape& solid : *read) solid = mapped(solid, map * import.transform * scaled);
  return read;
}

}  // namespace meso::brep
