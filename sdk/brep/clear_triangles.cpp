// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/clear_triangles.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <unordered_map>

#include "box_pairs.hpp"
#include "meso/brep/instance_map.hpp"
#include "meso/brep/placement.hpp"
#include "meso/mesh/self_contact.hpp"
#include "surface_point.hpp"

namespace meso::brep {
namespace {

constexpr int most_passes = 24;       ///< each halves segments that are still too long
constexpr double straight_mm = 1e-9;  ///< a chord that is off by less is not worth a point

/// A segment modulo lattice translation: both ends, the second counted from the cell of the first.
struct SegmentName {
  Vec3 a, b;
  Index3 offset{};  ///< of b

  friend bool operator==(const SegmentName& s, const SegmentName& t) {
    return s.a == t.a && s.b == t.b && s.offset == t.offset;
  }
};
struct SegmentHash {
  std::size_t operator()(const SegmentName& s) const {
    std::uint64_t h = 0;
    for (const double c : {s.a.x, s.a.y, s.a.z, s.b.x, s.b.y, s.b.z})
      h = std::rotl((h ^ std::bit_cast<std::uint64_t>(c + 0.0)) * 0x9e3779b97f4a7c15u, 29);
    return h;
  }
};

struct NamedSegment {
  SegmentName name;
  Index3 cell{};  ///< of the first end, from that of the face
};

NamedSegment named(const MeshPoint* a, const MeshPoint* b) {
  const auto key = [](const MeshPoint& p) { return std::tie(p.point.x, p.point.y, p.point.z, p.offset); };
  if (key(*b) < key(*a)) std::swap(a, b);
  Index3 offset{};
  for (std::size_t i = 0; i < 3; ++i) offset[i] = b->offset[i] - a->offset[i];
  return {{a->point, b->point, offset}, a->offset};
}

NamedSegment segment_of(const Triangulation& mesh, std::size_t triangle, std::size_t k) {
  const auto& t = mesh.triangles[triangle];
  return named(&mesh.points[t[k]], &mesh.points[t[(k + 1) % 3]]);
}

/// The surfaces that a segment runs between, and how far its middle is from them.
struct Halving {
  std::vector<std::pair<const Surface*, Vec3>> surfaces;  ///< and where the segment's frame stands in the surface's
  Vec3 point;
  double off = 0;
};
using Halvings = std::unordered_map<SegmentName, Halving, SegmentHash>;

/// Where the surfaces meet, by projecting onto one after the other.
void find_point(const SegmentName& name, const Template& geometry, Halving& halving) {
  const Vec3 b = name.b + cell_origin(geometry, name.offset);
  const Vec3 middle = 0.5 * (name.a + b);
  Vec3 p = middle;
  for (int round = 0; round < 200; ++round) {
    const Vec3 before = p;
    for (const auto& [surface, shift] : halving.surfaces) p = nearest_point(*surface, p + shift) - shift;
    if (norm(p - before) < 1e-13) break;
  }
  halving.point = p;
  halving.off = norm(p - middle);
  if (!(halving.off < 0.499 * norm(b - name.a))) halving.off = 0;  // another branch, or a diameter
}

struct Placed {
  const Shell* shell = nullptr;
  FaceInstance instance;
};

Box3 box_of(const Placed& placed) {
  const Template& geometry = *placed.shell->geometry;
  const Vec3 origin = cell_origin(geometry, placed.instance.cell);
  Box3 box;
  for (const MeshPoint& p : geometry.faces[placed.instance.face].mesh.points)
    box.extend(placed.shell->placement * (p.point + origin + cell_origin(geometry, p.offset)));
  return box;
}

template <typename Visit>
void visit_shells(Body& body, Visit visit) {
  for (Solid& solid : body.solids) {
    visit(solid.outer);
    for (Shell& hollow : solid.voids) visit(hollow);
  }
}

/// One instance of each face of each template, and all instances that come near one of those.
std::vector<Placed> looked_at(Body& body) {
  constexpr std::int32_t reach = 2;  // cells
  std::vector<Placed> first, others, out;
  std::map<const Template*, std::vector<bool>> seen;
  std::map<const Template*, std::set<Index3>> near;
  visit_shells(body, [&](const Shell& shell) {
    std::vector<bool>& faces = seen[shell.geometry.get()];
    std::set<Index3>& cells = near[shell.geometry.get()];
    faces.resize(shell.geometry->faces.size());
    shell.visit([&](const FaceInstance& instance) {
      if (faces[instance.face]) return;
      faces[instance.face] = true;
      first.push_back({&shell, instance});
      const Index3 c = instance.cell;
      if (cells.contains(c)) return;
      for (std::int32_t i = -reach; i <= reach; ++i)
        for (std::int32_t j = -reach; j <= reach; ++j)
          for (std::int32_t k = -reach; k <= reach; ++k) cells.insert(c + Index3{i, j, k});
    });
  });
  std::map<const Template*, std::vector<bool>> taken;
  visit_shells(body, [&](const Shell& shell) {
    std::vector<bool>& faces = taken[shell.geometry.get()];
    faces.resize(shell.geometry->faces.size());
    const std::set<Index3>& cells = near[shell.geometry.get()];
    shell.visit([&](const FaceInstance& instance) {
      if (!faces[instance.face])
        faces[instance.face] = true;  // the one in `first`
      else if (cells.contains(instance.cell))
        others.push_back({&shell, instance});
    });
  });
  std::vector<Box3> boxes;
  for (const Placed& placed : first) boxes.push_back(box_of(placed));
  for (const Placed& placed : others) boxes.push_back(box_of(placed));
  std::vector<bool> meets(boxes.size());
  visit_meeting_pairs(boxes, [&](std::size_t i, std::size_t k) {
    if (i < first.size()) meets[k] = true;
  });
  out = first;
  for (std::size_t i = 0; i < others.size(); ++i)
    if (meets[first.size() + i]) out.push_back(others[i]);
  return out;
}

/// Triangles of templates, each once: (face, triangle).
using Chosen = std::map<const Template*, std::set<std::pair<std::uint32_t, std::uint32_t>>>;

/// Of the body as an STL file has it.
Chosen chosen_triangles(const std::vector<Placed>& placed) {
  using Float3 = std::array<float, 3>;
  struct Hash {
    std::size_t operator()(const Float3& p) const {
      std::uint64_t h = 0;
      for (const float c : p) h = std::rotl((h ^ std::bit_cast<std::uint32_t>(c)) * 0x9e3779b97f4a7c15u, 29);
      return h;
    }
  };
  struct Origin {
    std::size_t placed;
    std::uint32_t triangle;
  };
  TriangleMesh mesh;
  std::vector<Origin> origins;
  std::unordered_map<Float3, std::uint32_t, Hash> numbers;
  std::vector<std::uint32_t> local;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const Template& geometry = *placed[i].shell->geometry;
    const FaceInstance& instance = placed[i].instance;
    const Triangulation& face = geometry.faces[instance.face].mesh;
    local.clear();
    for (const MeshPoint& p : face.points) {
      const Vec3 at = placed[i].shell->placement * (p.point + cell_origin(geometry, instance.cell + p.offset));
      const Float3 rounded{static_cast<float>(at.x) + 0.0F, static_cast<float>(at.y) + 0.0F,
                           static_cast<float>(at.z) + 0.0F};
      const auto [number, fresh] = numbers.try_emplace(rounded, static_cast<std::uint32_t>(mesh.points.size()));
      if (fresh) mesh.points.push_back({rounded[0], rounded[1], rounded[2]});
      local.push_back(number->second);
    }
    for (std::uint32_t t = 0; t < face.triangles.size(); ++t) {
      const auto& [a, b, c] = face.triangles[t];
      if (local[a] == local[b] || local[b] == local[c] || local[c] == local[a]) continue;
      mesh.triangles.push_back({local[a], local[b], local[c]});
      origins.push_back({i, t});
    }
  }
  Chosen chosen;
  for (const std::uint32_t t : triangles_in_contact(mesh)) {
    const Placed& where = placed[origins[t].placed];
    chosen[where.shell->geometry.get()].insert({where.instance.face, origins[t].triangle});
  }
  return chosen;
}

/// What halving the segments of the chosen triangles would do; only the worst of each triangle is kept.
Halvings halvings_of(const Template& geometry, const Chosen::mapped_type& chosen) {
  Halvings all;
  for (const auto& [face, triangle] : chosen)
    for (std::size_t k = 0; k < 3; ++k) all.try_emplace(segment_of(geometry.faces[face].mesh, triangle, k).name);
  for (const FaceTemplate& face : geometry.faces)
    for (std::size_t t = 0; t < face.mesh.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const NamedSegment segment = segment_of(face.mesh, t, k);
        const auto found = all.find(segment.name);
        if (found == all.end()) continue;
        const std::pair<const Surface*, Vec3> use{&face.surface, cell_origin(geometry, segment.cell)};
        auto& surfaces = found->second.surfaces;
        if (std::ranges::find(surfaces, use) == surfaces.end()) surfaces.push_back(use);
      }
  for (auto& [name, halving] : all) find_point(name, geometry, halving);
  Halvings worst;
  for (const auto& [face, triangle] : chosen) {
    std::array<Halvings::const_iterator, 3> sides;
    for (std::size_t k = 0; k < 3; ++k) sides[k] = all.find(segment_of(geometry.faces[face].mesh, triangle, k).name);
    const auto largest = *std::ranges::max_element(sides, {}, [](const auto& side) { return side->second.off; });
    if (largest->second.off > straight_mm) worst.insert(*largest);
  }
  return worst;
}

/// Halves have the origin of the whole.
void halve(Triangulation& mesh, const Halvings& halvings, std::vector<std::uint32_t>& origins) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;  // by the numbers of both ends
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3;) {
      const NamedSegment segment = segment_of(mesh, t, k);
      const auto found = halvings.find(segment.name);
      if (found == halvings.end()) {
        ++k;
        continue;
      }
      std::array<std::uint32_t, 3> half = mesh.triangles[t];
      const auto [middle, fresh] =
          middles.try_emplace(std::minmax(half[k], half[(k + 1) % 3]), static_cast<std::uint32_t>(mesh.points.size()));
      if (fresh) mesh.points.push_back({found->second.point, segment.cell});
      half[k] = middle->second;
      mesh.triangles[t][(k + 1) % 3] = middle->second;
      mesh.triangles.push_back(half);
      origins.push_back(origins[t]);
      k = 0;  // other sides may be named, too
    }
}

/// Triangles of the templates as they were given: template, face, triangle.
using Originals = std::set<std::tuple<const Template*, std::uint32_t, std::uint32_t>>;

/// Divides the triangles of one body.
class Division {
 public:
  Division(Body& body, const Originals& left_alone) : body_(body), left_alone_(left_alone) {}

  /// What still meets others when nothing can be done, or not in time, besides what is left alone.
  Originals divide(const RunOptions& run) {
    std::size_t first_count = 0;
    for (int pass = 0;; ++pass) {
      Chosen chosen = chosen_triangles(looked_at(body_));
      std::size_t count = 0;
      Originals originals;
      for (auto& [geometry, triangles] : chosen) {
        std::erase_if(triangles,
                      [&, from = geometry](const auto& t) { return left_alone_.contains(original_of(from, t)); });
        count += triangles.size();
        for (const auto& t : triangles) originals.insert(original_of(geometry, t));
      }
      if (pass == 0) first_count = count;
      const bool hopeless = pass == most_passes || count > 4 * first_count + 1000 || run.should_stop();
      if (count == 0 || hopeless || !halve_all(chosen)) return originals;
    }
  }

 private:
  struct Copy {
    std::shared_ptr<Template> geometry;
    const Template* given = nullptr;
    std::vector<std::vector<std::uint32_t>> origins;  ///< by face and triangle
  };

  [[nodiscard]] Originals::value_type original_of(const Template* geometry,
                                                  const std::pair<std::uint32_t, std::uint32_t>& t) const {
    const auto copy = copies_.find(geometry);
    if (copy == copies_.end()) return {geometry, t.first, t.second};
    return {copy->second.given, t.first, copy->second.origins[t.first][t.second]};
  }

  /// False: no segment is worth it.
  bool halve_all(const Chosen& chosen) {
    bool any = false;
    for (const auto& [geometry, triangles] : chosen) {
      const Halvings halvings = halvings_of(*geometry, triangles);
      if (halvings.empty()) continue;
      any = true;
      Copy& copy = copy_of(geometry);
      for (std::size_t f = 0; f < copy.geometry->faces.size(); ++f)
        halve(copy.geometry->faces[f].mesh, halvings, copy.origins[f]);
    }
    return any;
  }

  Copy& copy_of(const Template* geometry) {
    if (const auto known = copies_.find(geometry); known != copies_.end()) return known->second;
    Copy copy{std::make_shared<Template>(*geometry), geometry, {}};
    for (const FaceTemplate& face : copy.geometry->faces) {
      auto& origins = copy.origins.emplace_back(face.mesh.triangles.size());
      std::iota(origins.begin(), origins.end(), 0U);
    }
    visit_shells(body_, [&](Shell& shell) {
      if (shell.geometry.get() == geometry) shell.geometry = copy.geometry;
    });
    const Template* key = copy.geometry.get();
    return copies_.emplace(key, std::move(copy)).first->second;
  }

  Body& body_;
  const Originals& left_alone_;
  std::map<const Template*, Copy> copies_;  ///< by what the body has
};

constexpr std::size_t most_looked_at = 50'000;

/// Triangles of the templates, each once.
std::size_t mesh_size(Body& body) {
  std::set<const Template*> templates;
  visit_shells(body, [&](const Shell& shell) { templates.insert(shell.geometry.get()); });
  std::size_t triangles = 0;
  for (const Template* geometry : templates)
    for (const FaceTemplate& face : geometry->faces) triangles += face.mesh.triangles.size();
  return triangles;
}

}  // namespace

std::size_t clear_triangles(Body& body, const RunOptions& run) {
  constexpr int most_rounds = 3;
  if (mesh_size(body) > most_looked_at) return 0;
  const Body given = body;
  Originals left_alone;
  for (int round = 0; round < most_rounds && !run.should_stop(); ++round) {
    const Originals remaining = Division(body, left_alone).divide(run);
    if (remaining.empty()) return left_alone.size();
    left_alone.insert(remaining.begin(), remaining.end());
    body = given;  // they touch, and finer triangles would, too: again without them
  }
  std::size_t count = 0;
  for (const auto& [geometry, triangles] : chosen_triangles(looked_at(body))) count += triangles.size();
  return count;
}

}  // namespace meso::brep
