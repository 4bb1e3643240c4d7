// SPDX-License-Identifier: Apache-2.0
#include "import_kernel.hpp"

#include <unistd.h>

#include <BRepBuilderAPI_Sewing.hxx>
#include <IGESControl_Reader.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <istream>

#include "boolean.hpp"
#include "elementary_faces.hpp"
#include "view_buffer.hpp"

namespace meso::brep {
namespace {

namespace fs = std::filesystem;

std::shared_ptr<const ResourceBytes> opened(const Resource& file, ElementId where, const SolidContext& context) {
  std::string error;
  auto bytes = ResourceBytes::open(file, error);
  if (!bytes) context.report(Code::import_unreadable, where, {file.name().string(), "it cannot be opened"});
  return bytes;
}

/// What keeps the text from being a complete BREP file, or nothing. OpenCASCADE reads "nan" as a number.
std::optional<std::string> brep_text_fault(std::string_view text) {
  const auto word = text.find_first_not_of(" \t\r\n");
  if (word == std::string_view::npos) return "it is empty";
  const std::string_view head = text.substr(word, 200);
  if (head.find("DBRep_DrawableShape") != 0 && head.find("CASCADE Topology V") != 0)
    return "it is not a BREP file (text, as OpenCASCADE writes it)";
  const auto shapes = text.rfind("TShapes ");
  if (shapes == std::string_view::npos) return "it ends before its shapes";
  // The last line is the place of the whole: an orientation, the number of the shape and one of a location.
  const auto end = text.find_last_not_of(" \t\r\n\0");
  const auto line = text.rfind('\n', end);
  if (line == std::string_view::npos || line < shapes || !std::strchr("+-ie", text[line + 1]))
    return "it ends in the middle of its shapes";
  for (std::size_t i = word; i < end; ++i) {
    const std::string_view three = text.substr(i, 3);
    if ((three == "nan" || three == "NaN" || three == "NAN" || three == "inf" || three == "INF") &&
        std::isspace(static_cast<unsigned char>(text[i - 1])) != 0)
      return "it has a number that is none";
  }
  return {};
}

/// IGES is lines of 80 columns, each with the letter of its section in column 73; the last section is T.
std::optional<std::string> iges_text_fault(std::string_view text) {
  const auto end = text.find_last_not_of(" \t\r\n\0");
  if (end == std::string_view::npos) return "it is empty";
  if (text.size() < 73 || text[72] != 'S') return "it is not an IGES file of 80 columns";
  const auto line = text.rfind('\n', end);
  if (line == std::string_view::npos || end - line < 73 || text[line + 73] != 'T')
    return "it has no last line (section T)";
  return {};
}

/// The file itself, or bytes in memory in a file of the process's own: the IGES reader wants a name.
class NamedFile {
 public:
  NamedFile(const Resource& resource, std::string_view bytes) : name_(resource.name()) {
    if (!resource.memory()) return;
    std::string pattern = (fs::temp_directory_path() / "meso-XXXXXX").string();
    const int descriptor = ::mkstemp(pattern.data());
    if (descriptor < 0) return;
    ::close(descriptor);
    own_ = name_ = pattern;
    std::ofstream(own_, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  NamedFile(const NamedFile&) = delete;
  NamedFile& operator=(const NamedFile&) = delete;
  ~NamedFile() {
    std::error_code ignored;
    if (!own_.empty()) fs::remove(own_, ignored);
  }
  [[nodiscard]] std::string name() const { return name_.string(); }

 private:
  fs::path name_, own_;
};

/// Null if no entity could be transferred. May throw Standard_Failure, as may what is done with its result.
TopoDS_Shape read_iges_shape(const std::string& name) {
  const std::scoped_lock lock(reader_mutex());
  Message::DefaultMessenger()->ChangePrinters().Clear();
  IGESControl_Reader reader;
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  if (reader.ReadFile(name.c_str()) != IFSelect_RetDone || reader.TransferRoots() == 0) return {};
  return reader.OneShape();
}

/// Closed surfaces among the faces, sewn together; what stays open is put out as it is, for the check that follows.
Solids sewn(const TopoDS_Shape& shape) {
  const Box3 box = box_of(shape);
  BRepBuilderAPI_Sewing sewing(1e-5 * norm(box.max - box.min));
  sewing.Add(shape);
  sewing.Perform();
  Solids solids;
  const auto add = [&](const TopoDS_Shell& shell) {
    TopoDS_Solid solid = BRepBuilderAPI_MakeSolid(shell).Solid();
    if (edge_uses(solid).free == 0) BRepLib::OrientClosedSolid(solid);
    solids.push_back(solid);
  };
  const TopoDS_Shape result = sewing.SewedShape();
  for (TopExp_Explorer shell(result, TopAbs_SHELL); shell.More(); shell.Next()) add(TopoDS::Shell(shell.Current()));
  for (TopExp_Explorer face(result, TopAbs_FACE, TopAbs_SHELL); face.More(); face.Next()) {  // a ball is one face
    const BRep_Builder builder;
    TopoDS_Shell shell;
    builder.MakeShell(shell);
    builder.Add(shell, face.Current());
    add(shell);
  }
  return solids;
}

bool is_within(const TopoDS_Shape& inner, const TopoDS_Shape& outer) {
  const Box3 a = box_of(inner), b = box_of(outer);
  if (a.min.x < b.min.x || a.min.y < b.min.y || a.min.z < b.min.z || a.max.x > b.max.x || a.max.y > b.max.y ||
      a.max.z > b.max.z)
    return false;
  const TopExp_Explorer vertex(inner, TopAbs_VERTEX);
  if (!vertex.More()) return false;
  BRepClass3d_SolidClassifier classifier(outer, BRep_Tool::Pnt(TopoDS::Vertex(vertex.Current())), 1e-7);
  return classifier.State() == TopAbs_IN;
}

/// Sewing does not tell walls of cavities from bodies: a surface within an odd number of others is one.
Solids with_cavities(const Solids& bodies) {
  std::vector<std::vector<std::size_t>> around(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = 0; j < bodies.size(); ++j)
      if (i != j && is_within(bodies[i], bodies[j])) around[i].push_back(j);
  const BRep_Builder builder;
  Solids solids = bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (around[i].size() % 2 == 0) continue;
    // Its owner is within all others that it is within.
    const auto owner = std::ranges::max_element(around[i], {}, [&](std::size_t j) { return around[j].size(); });
    const TopExp_Explorer shell(bodies[i], TopAbs_SHELL);
    builder.Add(solids[*owner], shell.Current().Reversed());
  }
  Solids outer;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (around[i].size() % 2 == 0) outer.push_back(solids[i]);
  return outer;
}

}  // namespace

std::mutex& reader_mutex() {
  static std::mutex mutex;
  return mutex;
}

std::optional<Solids> read_brep_solids(const Resource& file, ElementId where, const SolidContext& context) {
  const auto bytes = opened(file, where, context);
  if (!bytes) return {};
  const std::string name = file.name().string();
  auto fault = brep_text_fault(bytes->view());
  TopoDS_Shape shape;
  try {
    if (!fault) {
      ViewBuffer buffer(bytes->view());
      std::istream stream(&buffer);
      BRepTools::Read(shape, stream, BRep_Builder());
      if (shape.IsNull()) fault = "it is not a complete BREP file";
    }
    if (!fault && !BRepCheck_Analyzer(shape).IsValid()) fault = "OpenCASCADE finds its shape invalid";
  } catch (const Standard_Failure&) {
    fault = "OpenCASCADE fails while it reads it";
  }
  if (fault) {
    context.report(Code::import_unreadable, where, {name, *fault});
    return {};
  }
  return solids_of(shape);
}

std::optional<Solids> read_iges_solids(const Resource& file, ElementId where, const SolidContext& context) {
  const auto bytes = opened(file, where, context);
  if (!bytes) return {};
  const std::string name = file.name().string();
  if (const auto fault = iges_text_fault(bytes->view())) {
    context.report(Code::import_unreadable, where, {name, *fault});
    return {};
  }
  std::string fault = "no entity of it could be read";
  try {
    TopoDS_Shape shape = read_iges_shape(NamedFile(file, bytes->view()).name());
    if (!shape.IsNull()) {
      shape = with_elementary_faces(shape);
      Solids solids = solids_of(shape);
      return solids.empty() ? with_cavities(sewn(shape)) : solids;
    }
  } catch (const Standard_Failure&) {
    fault = "OpenCASCADE fails while it reads it";
  }
  context.report(Code::import_unreadable, where, {name, fault});
  return {};
}

}  // namespace meso::brep
