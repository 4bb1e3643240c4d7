// SPDX-License-Identifier: Apache-2.0
#include "beam_graph_mitre_edges.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "beam_graph_spans.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double same_corner = 1e-6;     // of the ball, between points that are one
constexpr double same_turn = 1e-7;       // radians
constexpr double curve_accuracy = 3e-8;  // of the ball, between a curve and what it is laid through
constexpr std::size_t most_spans = 2000;
/// Radians. Through longer spans OpenCASCADE lays its curves in the surface a ten-thousandth of a millimetre beside.
constexpr double least_span = 1e-7, most_span = 0.5;

Vec3 unit(Vec3 v) { return v / norm(v); }

struct Piece {
  Mitre part;
  std::uint32_t first = 0, last = 0;  ///< vertices
  Coedge use{};
  bool has_edge = false, is_seam = false;

  /// As the stub's face runs along it, counter-clockwise.
  [[nodiscard]] std::uint32_t begin() const { return part.goes_in ? last : first; }
  [[nodiscard]] std::uint32_t end() const { return part.goes_in ? first : last; }
};

/// In the plane between two cylinders of one radius; counter-clockwise about the first axis.
Ellipse ellipse_between(const Stub& a, const Stub& b, Vec3 origin) {
  const Vec3 along = unit(a.axis + b.axis);
  const double sine = norm(a.axis - b.axis) / 2;  // of half their angle
  return {{origin, unit(a.axis - b.axis), along}, a.radius / sine, a.radius};
}

class EdgeMaker {
 public:
  EdgeMaker(const NodeMiters& node, Vec3 origin, const std::vector<double>& seams, Template& geometry,
            std::vector<MitreArc>& arcs)
      : node_(node), origin_(origin), geometry_(geometry), arcs_(arcs) {
    for (std::size_t i = 0; i < node.stubs().size(); ++i) {
      pieces_.push_back(pieces_from(node.mitres()[i], seams[i]));
      // In a corner of more than three surfaces rounding sees some of them side by side.
      std::erase_if(pieces_[i], [&](const Piece& p) {
        return p.part.to - p.part.from < 0.1 &&
               is_corner(node.point(i, p.part, p.part.from), node.point(i, p.part, p.part.to));
      });
    }
  }

  std::optional<NodeEdges> make() {
    if (!divide_at_corners()) return {};
    for (std::size_t i = 0; i < pieces_.size(); ++i) name_corners(i);
    NodeEdges out;
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      for (Piece& piece : pieces_[i])
        if (!piece.has_edge && !add(i, piece, out)) return {};
    for (const auto& pieces : pieces_) {
      auto around = chain(pieces);
      if (!around) return {};
      out.around.push_back(std::move(*around));
    }
    return out;
  }

 private:
  /// The mitre that the seam ends at is divided there.
  static std::vector<Piece> pieces_from(const std::vector<Mitre>& mitres, double seam) {
    std::vector<Piece> out;
    for (const Mitre& m : mitres) {
      const double turn = seam < m.from ? seam + 2 * pi : seam;
      const bool has_seam = !m.goes_in && turn <= m.to;
      if (has_seam && m.to - m.from == 2 * pi) {
        out.push_back({.part = {seam, seam + 2 * pi, m.other}, .is_seam = true});
      } else if (has_seam) {
        out.push_back({.part = {turn, m.to, m.other}, .is_seam = true});
        out.push_back({.part = {m.from, turn, m.other}});
      } else {
        out.push_back({.part = m});
      }
    }
    return out;
  }

  /// Where a mitre of one stub ends or is divided, that of the other one has a corner, too.
  bool divide_at_corners() {
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      for (std::size_t k = 0; k < pieces_[i].size(); ++k) {
        const Mitre own = pieces_[i][k].part;
        if (own.other == at_ball) continue;
        for (const double turn : {own.from, own.to})
          if (!divide(static_cast<std::size_t>(own.other), static_cast<int>(i), node_.point(i, own, turn)))
            return false;
      }
    return true;
  }

  bool divide(std::size_t stub, int other, Vec3 p) {
    auto& pieces = pieces_[stub];
    const double at = node_.stubs()[stub].turn_of(p);
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      const Mitre part = pieces[k].part;
      if (part.other != other) continue;
      for (const double turn : {at - 2 * pi, at, at + 2 * pi}) {
        if (turn < part.from - same_turn || turn > part.to + same_turn) continue;
        if (!is_corner(p, node_.point(stub, part, std::clamp(turn, part.from, part.to)))) continue;
        if (is_corner(p, node_.point(stub, part, part.from)) || is_corner(p, node_.point(stub, part, part.to)))
          return true;
        Piece rest = pieces[k];
        rest.is_seam = false;
        rest.part.from = pieces[k].part.to = turn;
        pieces.push_back(rest);
        return true;
      }
    }
    // Where more than three surfaces meet, another mitre may end there.
    return std::ranges::any_of(pieces, [&](const Piece& piece) {
      return is_corner(p, node_.point(stub, piece.part, piece.part.from)) ||
             is_corner(p, node_.point(stub, piece.part, piece.part.to));
    });
  }

  [[nodiscard]] bool is_corner(Vec3 p, Vec3 q) const { return norm(p - q) <= same_corner * node_.ball(); }

  void name_corners(std::size_t stub) {
    for (Piece& piece : pieces_[stub]) {
      piece.first = vertex_at(node_.point(stub, piece.part, piece.part.from));
      piece.last = vertex_at(node_.point(stub, piece.part, piece.part.to));
    }
    std::erase_if(pieces_[stub], [](const Piece& p) { return p.first == p.last && p.part.to - p.part.from < 0.1; });
  }

  std::uint32_t vertex_at(Vec3 p) {
    for (const std::uint32_t v : vertices_)
      if (is_corner(geometry_.vertices[v] - origin_, p)) return v;
    vertices_.push_back(static_cast<std::uint32_t>(geometry_.vertices.size()));
    geometry_.vertices.push_back(origin_ + p);
    return vertices_.back();
  }

  bool add(std::size_t i, Piece& piece, NodeEdges& out) {
    const auto edge = static_cast<std::uint32_t>(geometry_.edges.size());
    piece.use = {.edge = edge, .reversed = piece.part.goes_in};
    piece.has_edge = true;
    MitreArc arc{&node_, origin_, i, piece.part, node_.stubs()[i].radius, piece.part.to - piece.part.from};
    const Piece* along = &piece;
    auto curve = curve_of(i, piece);
    if (piece.part.other == at_ball) {
      out.on_ball.push_back({edge, i});
    } else {
      const auto other = static_cast<std::size_t>(piece.part.other);
      Piece* back = find_across(i, piece, other);
      if (back == nullptr) return false;
      back->has_edge = true;
      back->use = {.edge = edge, .reversed = !piece.use.reversed};
      if (!curve) {  // the one may turn back where the other goes on
        curve = curve_of(other, *back);
        along = back;
        arc.stub = other;
        arc.part = back->part;
        back->use.reversed = back->part.goes_in;
        piece.use.reversed = !back->use.reversed;
      }
      arc.radius = std::max(node_.stubs()[i].radius, node_.stubs()[other].radius);
      arc.sweep = std::max(arc.sweep, back->part.to - back->part.from);
    }
    if (!curve) return false;
    geometry_.edges.push_back({.curve = *curve, .vertex = {along->first, along->last}});
    arcs_.resize(edge);
    arcs_.push_back(arc);
    return true;
  }

  /// The piece of the other stub that runs back along this one.
  [[nodiscard]] Piece* find_across(std::size_t i, const Piece& piece, std::size_t other) {
    const Vec3 middle = node_.point(i, piece.part, (piece.part.from + piece.part.to) / 2);
    const double turn = node_.stubs()[other].turn_of(middle);
    for (Piece& p : pieces_[other]) {
      if (p.has_edge || p.part.other != static_cast<int>(i) || p.begin() != piece.end() || p.end() != piece.begin())
        continue;
      for (const double t : {turn - 2 * pi, turn, turn + 2 * pi})
        if (p.part.from - same_turn <= t && t <= p.part.to + same_turn &&
            is_corner(middle, node_.point(other, p.part, t)))
          return &p;
    }
    return nullptr;
  }

  /// All pieces, from the seam around.
  static std::optional<std::vector<Coedge>> chain(const std::vector<Piece>& pieces) {
    std::vector<Coedge> out;
    std::vector<bool> taken(pieces.size(), false);
    auto next = std::ranges::find(pieces, true, &Piece::is_seam);
    if (next == pieces.end()) return {};
    const std::uint32_t start = next->begin();
    while (true) {
      taken[static_cast<std::size_t>(next - pieces.begin())] = true;
      out.push_back(next->use);
      if (next->end() == start) break;
      const auto goes_on = [&](const Piece& p) {
        return p.begin() == next->end() && !taken[static_cast<std::size_t>(&p - pieces.data())];
      };
      const auto found = std::ranges::find_if(pieces, goes_on);
      if (found == pieces.end()) return {};
      next = found;
    }
    return out.size() == pieces.size() ? std::optional(out) : std::nullopt;
  }

  [[nodiscard]] std::optional<Curve> curve_of(std::size_t i, const Piece& piece) const {
    const Stub& own = node_.stubs()[i];
    const int other = piece.part.other;
    if (other == at_ball || node_.are_opposite(i, static_cast<std::size_t>(other)))
      return Circle{{origin_ + own.leaves_ball * own.axis, own.axis, own.x}, own.radius + own.growth * own.leaves_ball};
    const Stub& across = node_.stubs()[static_cast<std::size_t>(other)];
    if (own.growth == 0 && across.growth == 0 && own.radius == across.radius)
      return ellipse_between(own, across, origin_);
    std::vector<double> turns{piece.part.from};
    if (!divide_curve(i, piece.part, piece.part.from, piece.part.to, turns)) return {};
    return curve_through(i, piece, turns);
  }

  /// Adds the ends of spans that one polynomial is accurate in; false where none are.
  bool divide_curve(std::size_t i, const Mitre& part, double from, double to, std::vector<double>& turns) const {
    const double step = to - from;
    if (step < least_span || turns.size() > most_spans) return false;
    if (step <= most_span && is_accurate(i, part, from, to)) {
      turns.push_back(to);
      return true;
    }
    const double middle = (from + to) / 2;
    return divide_curve(i, part, from, middle, turns) && divide_curve(i, part, middle, to, turns);
  }

  [[nodiscard]] bool is_accurate(std::size_t i, const Mitre& part, double from, double to) const {
    const SpanPoles poles = span(i, part, from, to);
    // In the middles between the places that it is laid through, where it is off most, and beside its ends.
    return std::ranges::all_of(std::array{0.04, 0.13, 0.35, 0.5, 0.65, 0.87, 0.96}, [&](double t) {
      const Vec3 off = point_of(poles, t) - node_.point(i, part, from + t * (to - from));
      return norm(off) <= curve_accuracy * node_.ball();
    });
  }

  [[nodiscard]] SpanPoles span(std::size_t i, const Mitre& part, double from, double to) const {
    std::array<Vec3, 4> points, tangents;
    for (std::size_t k = 0; k < 4; ++k) {
      const double turn = k == 0 ? from : k == 3 ? to : from + span_places[k] * (to - from);
      points[k] = node_.point(i, part, turn);
      tangents[k] = (to - from) * node_.tangent(i, part, turn);
    }
    return span_poles(points, tangents);
  }

  /// With the points and the tangents that the surfaces have at four places of each span.
  [[nodiscard]] BSplineCurve curve_through(std::size_t i, const Piece& piece, const std::vector<double>& turns) const {
    BSplineCurve curve{.degree = span_degree};
    curve.poles.push_back(geometry_.vertices[piece.first]);
    for (std::size_t n = 0; n + 1 < turns.size(); ++n) {
      const SpanPoles poles = span(i, piece.part, turns[n], turns[n + 1]);
      for (std::size_t k = 1; k < span_degree; ++k) curve.poles.push_back(origin_ + poles[k]);
    }
    curve.poles.push_back(geometry_.vertices[piece.last]);
    curve.knots = turns;
    curve.multiplicities.assign(turns.size(), span_degree - 1);
    curve.multiplicities.front() = curve.multiplicities.back() = span_degree + 1;
    return curve;
  }

  const NodeMiters& node_;
  Vec3 origin_;
  Template& geometry_;
  std::vector<MitreArc>& arcs_;
  std::vector<std::vector<Piece>> pieces_;  ///< by stub, from its seam
  std::vector<std::uint32_t> vertices_;
};

}  // namespace

std::vector<Vec3> MitreArc::points(int parts) const {
  std::vector<Vec3> out;
  for (int i = 1; i < parts; ++i)
    out.push_back(origin + node->point(stub, part, part.from + (part.to - part.from) * i / parts));
  return out;
}

std::optional<NodeEdges> mitre_edges(const NodeMiters& node, Vec3 origin, const std::vector<double>& seams,
                                     Template& geometry, std::vector<MitreArc>& arcs) {
  return EdgeMaker(node, origin, seams, geometry, arcs).make();
}

}  // namespace meso::brep
