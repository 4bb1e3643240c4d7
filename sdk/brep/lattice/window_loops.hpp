// SPDX-License-Identifier: Apache-2.0
#pragma once
// How what is left of a face's edges in a window bounds the part of the face there. Private.

#include "lattice/window_border.hpp"

namespace meso::brep {

/// The boundary of a face's part: what is left of its edges, linked by their vertices and by the window's border.
class FaceWindows::Loops {
 public:
  Loops(const FaceWindows& all, const Request& request) : all_(all), request_(request) {
    face_ = TopoDS::Face(request.face->face.EmptyCopied().Oriented(TopAbs_FORWARD));
  }

  /// Empty where that is not clear.
  std::vector<TopoDS_Face> run() {
    take_parts();
    if (!link()) return {};
    if (entries_.empty() && !border_alone()) return {};
    for (std::size_t p = 0; p < parts_.size(); ++p)
      if (!parts_[p].used && !walk(p)) return {};
    return pieces();
  }

 private:
  struct Part {
    TopoDS_Edge edge;
    int next = -1;      ///< -1: leaves the window
    double leaves = 0;  ///< where, on its border
    bool used = false;
  };
  struct Entry {
    double border = 0;
    std::size_t part = 0;
    TopoDS_Vertex vertex;
  };

  void take_parts();
  bool link();
  bool border_alone();
  [[nodiscard]] std::vector<TopoDS_Face> pieces();
  bool walk(std::size_t from);
  bool add_border(TopoDS_Wire& wire, double from, TopoDS_Vertex start, double to, const TopoDS_Vertex& end);
  void add_side(TopoDS_Wire& wire, double from, const TopoDS_Vertex& start, double to, const TopoDS_Vertex& end);
  [[nodiscard]] std::optional<double> border_of(const TopoDS_Vertex& vertex) const;
  TopoDS_Vertex corner(std::size_t number);
  [[nodiscard]] gp_Pnt point(const FaceParameters& p) const;

  const FaceWindows& all_;
  const Request& request_;
  TopoDS_Face face_;
  std::vector<Part> parts_;
  std::vector<Entry> entries_;
  std::vector<double> exits_;
  std::array<TopoDS_Vertex, 4> corners_;
  std::vector<TopoDS_Wire> outer_;  ///< those along the border: each bounds a piece of its own
  std::vector<std::pair<TopoDS_Wire, FaceParameters>> holes_;  ///< and a point of each
  const BRep_Builder builder_{};
};

}  // namespace meso::brep
