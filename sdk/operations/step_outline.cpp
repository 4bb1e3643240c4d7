// SPDX-License-Identifier: Apache-2.0
#include "step_outline.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <span>
#include <unordered_map>
#include <vector>

#include "meso/brep/step_text.hpp"

namespace meso::operations {
namespace {

enum class Kind : std::uint8_t { other, edge, use, loop, vertex_loop, bound, face, shell, turned_shell, solid };

struct KindName {
  std::string_view name;
  Kind kind;
};
constexpr std::array<KindName, 12> kinds{{{"EDGE_CURVE", Kind::edge},
                                          {"ORIENTED_EDGE", Kind::use},
                                          {"EDGE_LOOP", Kind::loop},
                                          {"VERTEX_LOOP", Kind::vertex_loop},
                                          {"FACE_BOUND", Kind::bound},
                                          {"FACE_OUTER_BOUND", Kind::bound},
                                          {"ADVANCED_FACE", Kind::face},
                                          {"CLOSED_SHELL", Kind::shell},
                                          {"OPEN_SHELL", Kind::shell},
                                          {"ORIENTED_CLOSED_SHELL", Kind::turned_shell},
                                          {"MANIFOLD_SOLID_BREP", Kind::solid},
                                          {"BREP_WITH_VOIDS", Kind::solid}}};

Kind kind_of(std::string_view name) {
  for (const KindName& known : kinds)
    if (known.name == name) return known.kind;
  return Kind::other;
}

/// `#12 = EDGE_LOOP('', (#3, #4));`: its kind, the last of its logical values, and the entities it names.
struct Entity {
  Kind kind = Kind::other;
  bool is_true = true;
  std::uint32_t first = 0, count = 0;  ///< of the references
};

struct Uses {
  std::uint32_t forward = 0, backward = 0;
};

class Outliner {
 public:
  Outliner(std::string_view text, const RunOptions& run, std::string& fault) : text_(text), run_(run), fault_(fault) {}

  std::optional<StepOutline> make() {
    if (!read()) return {};
    for (const std::uint32_t solid : solids_) {
      ++outline_.solids;
      for (const std::uint64_t shell : references(entities_[solid]))
        if (!add_shell(shell)) return {};
    }
    if (outline_.solids == 0) return fault_ = "no solid in it", std::nullopt;
    if (outline_.edges == 0) return fault_ = "its faces have no edges", std::nullopt;
    return outline_;
  }

 private:
  bool read() {
    for (std::size_t at = 0; at < text_.size();) {
      if (text_[at] != '#')
        at = std::max(at + 1, brep::behind_string_or_comment(text_, at));
      else if (((entities_.size() & 0xffff) == 0 && run_.should_stop()) || !read_entity(at))
        return false;
    }
    return true;
  }

  /// From its `#` to behind its semicolon.
  bool read_entity(std::size_t& at) {
    std::uint64_t id = 0;
    if (!read_id(at, id)) return true;
    skip_blanks(at);
    if (at < text_.size() && text_[at] == '=') skip_blanks(++at);
    const auto is_of_name = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_'; };
    const std::size_t name = at;
    while (at < text_.size() && is_of_name(text_[at])) ++at;
    Entity entity{.kind = kind_of(text_.substr(name, at - name)),
                  .first = static_cast<std::uint32_t>(references_.size())};
    if (!read_arguments(at, entity)) return false;
    if (entity.kind == Kind::other) return true;
    if (!place_of_.emplace(id, static_cast<std::uint32_t>(entities_.size())).second)
      return fault_ = "it has two entities #" + std::to_string(id), false;
    if (entity.kind == Kind::solid) solids_.push_back(static_cast<std::uint32_t>(entities_.size()));
    entities_.push_back(entity);
    return true;
  }

  void skip_blanks(std::size_t& at) const {
    while (at < text_.size()) {
      const std::size_t behind = text_[at] == '/' ? brep::behind_string_or_comment(text_, at) : at;
      if (behind == at && std::string_view(" \t\r\n").find(text_[at]) == std::string_view::npos) return;
      at = std::max(at + 1, behind);
    }
  }

  bool read_arguments(std::size_t& at, Entity& entity) {
    while (at < text_.size()) {
      const char c = text_[at];
      if (c == ';') {
        entity.count = static_cast<std::uint32_t>(references_.size()) - entity.first;
        return ++at, true;
      }
      if (entity.kind != Kind::other && c == '.' && (text_.substr(at, 3) == ".T." || text_.substr(at, 3) == ".F.")) {
        entity.is_true = text_[at + 1] == 'T';
        at += 3;
      } else if (entity.kind != Kind::other && c == '#') {
        std::uint64_t id = 0;
        if (read_id(at, id)) references_.push_back(id);
      } else {
        at = std::max(at + 1, brep::behind_string_or_comment(text_, at));
      }
    }
    return fault_ = "it ends within an entity", false;
  }

  /// Behind the number; false: there is none.
  bool read_id(std::size_t& at, std::uint64_t& id) const {
    const auto [end, error] = std::from_chars(text_.data() + at + 1, text_.data() + text_.size(), id);
    at = static_cast<std::size_t>(end - text_.data());
    return error == std::errc();
  }

  [[nodiscard]] std::span<const std::uint64_t> references(const Entity& e) const {
    return std::span(references_).subspan(e.first, e.count);
  }
  const Entity* find(std::uint64_t id, Kind kind) {
    const auto found = place_of_.find(id);
    if (found != place_of_.end() && entities_[found->second].kind == kind) return &entities_[found->second];
    fault_ = "#" + std::to_string(id) + " is not what refers to it expects";
    return nullptr;
  }

  bool add_shell(std::uint64_t id) {
    if (run_.should_stop()) return false;
    const auto place = place_of_.find(id);
    if (place != place_of_.end() && entities_[place->second].kind == Kind::turned_shell &&
        entities_[place->second].count > 0)
      id = references(entities_[place->second])[0];
    const Entity* shell = find(id, Kind::shell);
    if (shell == nullptr) return false;
    if (shell->count == 0) return fault_ = "shell #" + std::to_string(id) + " has no faces", false;
    std::unordered_map<std::uint64_t, Uses> uses;
    ++outline_.shells;
    for (const std::uint64_t f : references(*shell)) {
      const Entity* face = find(f, Kind::face);
      if (face == nullptr) return false;
      ++outline_.faces;
      const auto parts = references(*face);  // bounds, and the surface
      for (std::size_t b = 0; b + 1 < parts.size(); ++b)
        if (!add_bound(parts[b], uses)) return false;
    }
    for (const auto& [edge, use] : uses) {
      outline_.free_edges += use.forward + use.backward == 1;
      outline_.multiple_edges += use.forward + use.backward > 2;
      outline_.conflicts += use.forward + use.backward == 2 && use.forward != 1;
    }
    outline_.edges += uses.size();
    return true;
  }

  bool add_bound(std::uint64_t id, std::unordered_map<std::uint64_t, Uses>& uses) {
    const Entity* bound = find(id, Kind::bound);
    if (bound == nullptr || bound->count != 1) return false;
    const auto place = place_of_.find(references(*bound)[0]);
    if (place != place_of_.end() && entities_[place->second].kind == Kind::vertex_loop) return true;
    const Entity* loop = find(references(*bound)[0], Kind::loop);
    if (loop == nullptr) return false;
    std::uint64_t first = 0, last = 0;
    bool is_chain = loop->count > 0;
    for (const std::uint64_t u : references(*loop)) {
      const Entity* use = find(u, Kind::use);
      if (use == nullptr || use->count != 1) return false;
      const std::uint64_t e = references(*use)[0];
      const Entity* edge = find(e, Kind::edge);
      if (edge == nullptr || edge->count < 2) return false;
      (use->is_true == bound->is_true ? uses[e].forward : uses[e].backward) += 1;
      const std::uint64_t from = references(*edge)[use->is_true ? 0 : 1], to = references(*edge)[use->is_true ? 1 : 0];
      if (first == 0)
        first = from;
      else
        is_chain = is_chain && from == last;
      last = to;
    }
    outline_.open_loops += !is_chain || first != last;
    return true;
  }

  std::string_view text_;
  const RunOptions& run_;
  std::string& fault_;
  std::vector<Entity> entities_;
  std::vector<std::uint64_t> references_;
  std::unordered_map<std::uint64_t, std::uint32_t> place_of_;
  std::vector<std::uint32_t> solids_;
  StepOutline outline_;
};

}  // namespace

std::optional<StepOutline> outline_step(std::string_view text, const RunOptions& run, std::string& fault) {
  return Outliner(text, run, fault).make();
}

std::uint64_t count_step_faces(std::string_view text) {
  constexpr std::string_view word = "ADVANCED_FACE";
  std::uint64_t count = 0;
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string_view::npos; at += word.size()) ++count;
  return count;
}

}  // namespace meso::operations
