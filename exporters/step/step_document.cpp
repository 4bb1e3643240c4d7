// SPDX-License-Identifier: Apache-2.0
#include "step_document.hpp"

#include <chrono>

namespace meso::step {
namespace {

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

}  // namespace

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

}  // namespace meso::step
