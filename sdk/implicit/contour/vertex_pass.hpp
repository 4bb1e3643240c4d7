// SPDX-License-Identifier: Apache-2.0
#pragma once
// The first pass over a brick of planes: samples, vertices, and the record that the second pass works from.

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "brick_crossings.hpp"
#include "brick_record.hpp"
#include "edge_end_sampler.hpp"
#include "feature_finder.hpp"
#include "joined_faces.hpp"
#include "meso/base/mesh_sink.hpp"
#include "meso/implicit/contour.hpp"
#include "meso/implicit/grid_source.hpp"
#include "root_polish.hpp"
#include "sample_rows.hpp"

namespace meso::implicit {

/// One per thread.
class VertexPass {
 public:
  /// `go_on` is asked within long work: false ends it.
  VertexPass(const Layout& layout, const GridSource& source, const MeshSink& sink, const ContourOptions& options,
             std::function<bool()> go_on);

  /// Planes [first, last) of 0 ... nodes; the last of these is the layer above the grid. Calls `after_row` now and
  /// then: false stops the work.
  [[nodiscard]] BrickRecord run(std::size_t first, std::size_t last, ByteBuffer& out,
                                const std::function<bool()>& after_row);

  /// Bytes that the sampler holds more than when this was asked last, where that depends on the surface.
  [[nodiscard]] std::uint64_t grown_by();

 private:
  /// What sharp edges need: the crossings of a brick, all at once.
  struct Sharp {
    Sharp(const Layout& layout, const Grid& grid) : crossings(layout), finder(layout, grid) {}
    BrickCrossings crossings;
    FeatureFinder finder;
    std::vector<Vec3> with_features;
  };

  void sample_plane_below(std::size_t k);
  void row(std::size_t j, std::size_t k, std::uint32_t cell_row, BrickRecord& record);
  void prefetch_next_row(std::size_t j) const;
  void find_crossings(const CellRows& rows, std::size_t j, std::size_t k, bool looks_at_faces);
  void add_vertices(const CellRows& rows, std::size_t j, std::size_t k, BrickRecord& record);
  template <class Visit>
  void visit_edges(const CellRows& rows, std::size_t j, std::size_t k, Visit visit) const;
  std::uint16_t add_centres(const CellRows& rows, std::size_t j, std::size_t k, std::span<const JoinedCell> cells);
  void flush(ByteBuffer& out);
  void keep_crossings(const CellRows& rows);
  void add_features(std::size_t first, std::size_t last, BrickRecord& record, ByteBuffer& out);

  const Layout& layout_;
  std::function<bool()> go_on_;
  std::unique_ptr<GridSampler> sampler_;
  EdgeEndSampler* edge_ends_ = nullptr;  // the sampler, if it is one
  std::uint64_t told_bytes_ = 0;
  const MeshSink& sink_;
  bool signs_only_, polish_;
  RootPolish roots_;
  SampleRows rows_;
  JoinedFaces joined_;
  std::size_t sampled_ = 0;               // planes below this one have been sampled; rows_ holds the last of them
  std::vector<std::uint16_t> x_, y_, z_;  // crossings of the current row
  std::size_t nx_ = 0, ny_ = 0, nz_ = 0;  // how many
  std::vector<Vec3> points_;
  std::size_t filled_ = 0;
  std::vector<std::uint16_t> signs_;
  std::vector<std::size_t> row_starts_;  // in signs_
  std::optional<Sharp> sharp_;
};

}  // namespace meso::implicit
