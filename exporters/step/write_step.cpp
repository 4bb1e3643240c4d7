// SPDX-License-Identifier: Apache-2.0
#include "meso/export_step/write_step.hpp"

#include <deque>
#include <map>
#include <optional>
#include <utility>

#include "meso/base/ordered_blocks.hpp"
#include "step_document.hpp"
#include "step_shell.hpp"

namespace meso {
namespace step {
namespace {

using namespace brep;

constexpr std::size_t block_faces = 1024;       ///< over a megabyte of text
constexpr std::size_t group_faces = 64 * 1024;  ///< shells are numbered together up to this

/// A shell, the numbers of its entities, and what is written behind its faces.
struct NumberedShell {
  const Solid* solid = nullptr;
  const Shell* shell = nullptr;
  std::vector<FaceInstance> faces;
  ShellNumbers numbers;

  [[nodiscard]] bool is_void() const { return shell != &solid->outer; }
  [[nodiscard]] bool is_last() const { return shell == (solid->voids.empty() ? &solid->outer : &solid->voids.back()); }
};

/// A face of a group, or, behind a shell's last, the end of the shell.
struct Position {
  std::size_t shell = 0, face = 0;
};
struct Block {
  Position from;
  std::size_t steps = 0;  ///< faces and ends of shells
  StepId last = 0;        ///< number before the block's first entity
};

class BodyWriter {
 public:
  BodyWriter(const StepOptions& options, ByteSink& sink) : options_(options), sink_(sink) {}

  StepCounts write(const Body& body) {
    ByteBuffer head;
    StepText text(&head);
    write_header(text, options_);
    const StepId shape = write_product(text, options_);
    const StepId context = write_context(text);
    const StepId origin = text.entity("CARTESIAN_POINT", NoName{}, Vec3{});
    const StepId z = text.entity("DIRECTION", NoName{}, Vec3{0, 0, 1}),
                 x = text.entity("DIRECTION", NoName{}, Vec3{1, 0, 0});
    items_.push_back(text.entity("AXIS2_PLACEMENT_3D", NoName{}, Ref{origin}, Ref{z}, Ref{x}));
    last_ = text.last();
    put(head);
    for (const Solid& solid : body.solids) {
      add(solid, solid.outer);
      for (const Shell& hollow : solid.voids) add(solid, hollow);
    }
    write_group();
    ByteBuffer tail;
    StepText end(&tail, last_);
    const StepId representation =
        end.entity("ADVANCED_BREP_SHAPE_REPRESENTATION", Quoted{options_.name}, items_, Ref{context});
    end.entity("SHAPE_DEFINITION_REPRESENTATION", Ref{shape}, Ref{representation});
    end.raw("ENDSEC;\nEND-ISO-10303-21;\n");
    put(tail);
    return {.bytes = bytes_, .entities = end.last(), .touching_faces = touching_, .complete = ok_};
  }

 private:
  void put(const ByteBuffer& text) {
    ok_ = ok_ && sink_.write(text.view());
    bytes_ += text.size();
  }

  void add(const Solid& solid, const Shell& shell) {
    if (!ok_) return;
    NumberedShell& added = group_.emplace_back();
    added.solid = &solid;
    added.shell = &shell;
    added.numbers.spheres = &spheres_[shell.geometry.get()];
    shell.visit([&](const FaceInstance& instance) { added.faces.push_back(instance); });
    in_group_ += added.faces.size();
    if (in_group_ >= group_faces) write_group();
  }

  /// Numbers all entities, which is a tenth of the work, then writes them in blocks. One thread does both at once.
  void write_group() {
    const bool at_once = threads_for(options_.jobs) == 1;
    ByteBuffer buffer;
    std::vector<Block> blocks;
    std::size_t steps = in_group_ + group_.size();
    for (Position at; ok_ && steps > 0; steps -= blocks.back().steps) {
      blocks.push_back({at, std::min(steps, block_faces), last_});
      StepText text(at_once ? &buffer : nullptr, last_);
      at = write_block<ShellNumbers>(text, blocks.back(), directions_);
      last_ = text.last();
      if (at_once) put(buffer);
      buffer.clear();
    }
    if (!at_once) {
      const WrittenBlocks done =
          write_in_order(blocks.size(), options_.jobs, sink_, [&](std::size_t block, ByteBuffer& out) {
            StepText text(&out, blocks[block].last);
            write_block<const ShellNumbers>(text, blocks[block], std::as_const(directions_));
          });
      ok_ = ok_ && done.complete;
      bytes_ += done.bytes;
    }
    group_.clear();
    spheres_.clear();
    in_group_ = 0;
  }

  /// Returns where the next block begins. Only what is said with numbers that are not yet known is kept.
  template <typename Numbers>
  Position write_block(StepText& text, const Block& block, auto& directions) {
    StepGeometry geometry(text, directions);
    Position at = block.from;
    std::optional<ShellWriter> writer;
    for (std::size_t step = 0; step < block.steps; ++step) {
      NumberedShell& shell = group_[at.shell];
      Numbers& numbers = shell.numbers;
      if (!writer) writer.emplace(text, geometry, *shell.shell, numbers);
      if (at.face < shell.faces.size()) {
        writer->write_face(shell.faces[at.face++]);
        continue;
      }
      end_shell(text, shell, !std::is_const_v<Numbers>);
      writer.reset();
      at = {at.shell + 1, 0};
    }
    return at;
  }

  // Normals of a Body's voids already point into the hollow, as those of the solid must.
  void end_shell(StepText& text, const NumberedShell& shell, bool keeps) {
    const StepId closed = text.entity("CLOSED_SHELL", NoName{}, shell.numbers.faces);
    const StepId id =
        shell.is_void() ? text.entity("ORIENTED_CLOSED_SHELL", NoName{}, Raw{"*"}, Ref{closed}, true) : closed;
    if (keeps) touching_ += shell.numbers.touching;
    if (keeps && !shell.is_void()) solids_[shell.solid] = {id, {}};
    if (keeps && shell.is_void()) solids_[shell.solid].voids.push_back(id);
    if (!shell.is_last()) return;
    const SolidNumbers& solid = solids_.at(shell.solid);
    const StepId written = solid.voids.empty()
                               ? text.entity("MANIFOLD_SOLID_BREP", NoName{}, Ref{solid.outer})
                               : text.entity("BREP_WITH_VOIDS", NoName{}, Ref{solid.outer}, solid.voids);
    if (keeps) items_.push_back(written);
  }

  struct SolidNumbers {
    StepId outer = 0;
    std::vector<StepId> voids;
  };

  const StepOptions& options_;
  ByteSink& sink_;
  std::deque<NumberedShell> group_;  ///< shells that are not yet written
  std::size_t in_group_ = 0;         ///< faces
  std::map<const Template*, SphereFaces> spheres_;
  std::map<const Solid*, SolidNumbers> solids_;
  std::vector<StepId> items_;
  Directions directions_;
  StepId last_ = 0;
  std::uint64_t bytes_ = 0, touching_ = 0;
  bool ok_ = true;
};

}  // namespace
}  // namespace step

StepCounts write_step(const brep::Body& body, const StepOptions& options, ByteSink& sink) {
  return step::BodyWriter(options, sink).write(body);
}

}  // namespace meso
