// SPDX-License-Identifier: Apache-2.0
#include "meso/export_step/write_step.hpp"

#include <algorithm>
#include <chrono>

#include "meso/brep/instance_map.hpp"
#include "step_geometry.hpp"
#include "step_text.hpp"

namespace meso {
namespace step {
namespace {

using namespace brep;

/// One shell: vertices and edges are written when a face first uses them, and never twice.
class ShellWriter {
 public:
  ShellWriter(StepText& text, StepGeometry& geometry, const Shell& shell)
      : text_(text), geometry_(geometry), shell_(shell), template_(*shell.geometry), pose_(shell) {}

  StepId write() {
    shell_.visit([this](const FaceInstance& instance) {
      if (text_.ok()) faces_.push_back(write_face(template_.faces[instance.face], instance.cell));
    });
    return text_.entity("CLOSED_SHELL", NoName{}, faces_);
  }

 private:
  StepId write_face(const FaceTemplate& face, const Index3& cell) {
    bounds_.clear();
    for (const auto& loop : face.loops) {
      const StepId written = write_loop(loop, cell);
      bounds_.push_back(text_.entity("FACE_BOUND", NoName{}, Ref{written}, true));
    }
    pose_.set_cell(cell);
    const StepId surface = geometry_.surface(face.surface, pose_);
    return text_.entity("ADVANCED_FACE", NoName{}, bounds_, Ref{surface}, !face.reversed);
  }

  // Edges without a curve (poles, apexes) have no place in STEP; a loop of nothing else is a point.
  StepId write_loop(const std::vector<Coedge>& loop, const Index3& cell) {
    coedges_.clear();
    for (const Coedge& use : loop) {
      if (template_.edges[use.edge].degenerate) continue;
      const StepId edge = edge_id(use.edge, cell + use.offset);
      coedges_.push_back(text_.entity("ORIENTED_EDGE", NoName{}, Raw{"*"}, Raw{"*"}, Ref{edge}, !use.reversed));
    }
    if (!coedges_.empty()) return text_.entity("EDGE_LOOP", NoName{}, coedges_);
    const EdgeTemplate& pole = template_.edges[loop.front().edge];
    const StepId vertex = vertex_id(pole.vertex[0], cell + loop.front().offset + pole.vertex_offset[0]);
    return text_.entity("VERTEX_LOOP", NoName{}, Ref{vertex});
  }

  StepId edge_id(std::uint32_t index, const Index3& cell) {
    const auto [id, fresh] = edges_.find_or_add(index, cell);
    if (fresh) {
      const EdgeTemplate& edge = template_.edges[index];
      const StepId first = vertex_id(edge.vertex[0], cell + edge.vertex_offset[0]);
      const StepId last = vertex_id(edge.vertex[1], cell + edge.vertex_offset[1]);
      pose_.set_cell(cell);
      const StepId curve = geometry_.curve(edge.curve, pose_);
      id = text_.entity("EDGE_CURVE", NoName{}, Ref{first}, Ref{last}, Ref{curve}, true);
    }
    return id;
  }

  StepId vertex_id(std::uint32_t index, const Index3& cell) {
    const auto [id, fresh] = vertices_.find_or_add(index, cell);
    if (fresh) {
      pose_.set_cell(cell);
      const StepId point = geometry_.point(pose_.point(template_.vertices[index]));
      id = text_.entity("VERTEX_POINT", NoName{}, Ref{point});
    }
    return id;
  }

  StepText& text_;
  StepGeometry& geometry_;
  const Shell& shell_;
  const Template& template_;
  Pose pose_;
  InstanceMap<StepId> vertices_, edges_;
  std::vector<StepId> faces_, bounds_, coedges_;
};

StepId write_solid(StepText& text, StepGeometry& geometry, const Solid& solid) {
  const StepId outer = ShellWriter(text, geometry, solid.outer).write();
  if (solid.voids.empty()) return text.entity("MANIFOLD_SOLID_BREP", NoName{}, Ref{outer});
  std::vector<StepId> voids;
  for (const Shell& hollow : solid.voids) {
    const StepId shell = ShellWriter(text, geometry, hollow).write();
    // Normals of a Body's voids already point into the hollow, as those of the solid must.
    voids.push_back(text.entity("ORIENTED_CLOSED_SHELL", NoName{}, Raw{"*"}, Ref{shell}, true));
  }
  return text.entity("BREP_WITH_VOIDS", NoName{}, Ref{outer}, voids);
}

std::string iso_time(std::int64_t timestamp) {
  using namespace std::chrono;
  const sys_seconds time{seconds{timestamp}};
  const auto day = floor<days>(time);
  const year_month_day date{day};
  const hh_mm_ss clock{time - day};
  char text[32];
  std::snprintf(text, sizeof text, "%04d-%02u-%02uT%02d:%02d:%02d", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()));
  return text;
}

struct SchemaNames {
  std::string_view file_schema, standard, application;
  int year;
};
SchemaNames names_of(StepSchema schema) {
  if (schema == StepSchema::ap242)
    return {"AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }",
            "ap242_managed_model_based_3d_engineering", "managed model based 3d engineering", 2011};
  return {"AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }", "automotive_design",
          "core data for automotive mechanical design processes", 2000};
}

void write_header(StepText& text, const StepOptions& options) {
  const Raw nobody{"('')"};
  text.raw("ISO-10303-21;\nHEADER;\n");
  text.part("FILE_DESCRIPTION", Raw{"('')"}, Quoted{"2;1"});
  text.raw(";\n");
  text.part("FILE_NAME", Quoted{options.name}, Quoted{iso_time(options.timestamp)}, nobody, nobody, Quoted{"meso"},
            Quoted{"meso"}, NoName{});
  text.raw(";\n");
  text.part("FILE_SCHEMA", Raw{"('" + std::string(names_of(options.schema).file_schema) + "')"});
  text.raw(";\nENDSEC;\nDATA;\n");
}

StepId write_context(StepText& text) {
  text.begin_complex();
  text.part("LENGTH_UNIT");
  text.part("NAMED_UNIT", Raw{"*"});
  text.part("SI_UNIT", Raw{".MILLI."}, Raw{".METRE."});
  const StepId length = text.end_complex();
  text.begin_complex();
  text.part("NAMED_UNIT", Raw{"*"});
  text.part("PLANE_ANGLE_UNIT");
  text.part("SI_UNIT", Raw{"$"}, Raw{".RADIAN."});
  const StepId angle = text.end_complex();
  text.begin_complex();
  text.part("NAMED_UNIT", Raw{"*"});
  text.part("SI_UNIT", Raw{"$"}, Raw{".STERADIAN."});
  text.part("SOLID_ANGLE_UNIT");
  const StepId solid_angle = text.end_complex();
  const StepId uncertainty = text.entity("UNCERTAINTY_MEASURE_WITH_UNIT", Raw{"LENGTH_MEASURE(1.E-06)"}, Ref{length},
                                         Quoted{"distance_accuracy_value"}, Quoted{"confusion accuracy"});
  text.begin_complex();
  text.part("GEOMETRIC_REPRESENTATION_CONTEXT", 3);
  text.part("GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT", std::vector{uncertainty});
  text.part("GLOBAL_UNIT_ASSIGNED_CONTEXT", std::vector{length, angle, solid_angle});
  text.part("REPRESENTATION_CONTEXT", NoName{}, Quoted{"3D"});
  return text.end_complex();
}

StepId write_product(StepText& text, const StepOptions& options) {
  const SchemaNames names = names_of(options.schema);
  const Quoted name{options.name};
  const StepId application = text.entity("APPLICATION_CONTEXT", Quoted{names.application});
  text.entity("APPLICATION_PROTOCOL_DEFINITION", Quoted{"international standard"}, Quoted{names.standard}, names.year,
              Ref{application});
  const StepId product_context = text.entity("PRODUCT_CONTEXT", NoName{}, Ref{application}, Quoted{"mechanical"});
  const StepId product = text.entity("PRODUCT", name, name, NoName{}, std::vector{product_context});
  text.entity("PRODUCT_RELATED_PRODUCT_CATEGORY", Quoted{"part"}, Raw{"$"}, std::vector{product});
  const StepId formation = text.entity("PRODUCT_DEFINITION_FORMATION", NoName{}, NoName{}, Ref{product});
  const StepId definition_context =
      text.entity("PRODUCT_DEFINITION_CONTEXT", Quoted{"part definition"}, Ref{application}, Quoted{"design"});
  const StepId definition =
      text.entity("PRODUCT_DEFINITION", Quoted{"design"}, NoName{}, Ref{formation}, Ref{definition_context});
  return text.entity("PRODUCT_DEFINITION_SHAPE", NoName{}, NoName{}, Ref{definition});
}

}  // namespace
}  // namespace step

StepCounts write_step(const brep::Body& body, const StepOptions& options, ByteSink& sink) {
  using namespace step;
  StepText text(sink);
  StepGeometry geometry(text);
  write_header(text, options);
  const StepId shape = write_product(text, options);
  const StepId context = write_context(text);
  const StepId origin = text.entity("CARTESIAN_POINT", NoName{}, Vec3{});
  const StepId z = text.entity("DIRECTION", NoName{}, Vec3{0, 0, 1}),
               x = text.entity("DIRECTION", NoName{}, Vec3{1, 0, 0});
  std::vector<StepId> items{text.entity("AXIS2_PLACEMENT_3D", NoName{}, Ref{origin}, Ref{z}, Ref{x})};
  for (const brep::Solid& solid : body.solids) items.push_back(write_solid(text, geometry, solid));
  const StepId representation =
      text.entity("ADVANCED_BREP_SHAPE_REPRESENTATION", Quoted{options.name}, items, Ref{context});
  text.entity("SHAPE_DEFINITION_REPRESENTATION", Ref{shape}, Ref{representation});
  text.raw("ENDSEC;\nEND-ISO-10303-21;\n");
  text.flush();
  return {text.bytes(), text.entities(), text.ok()};
}

}  // namespace meso
