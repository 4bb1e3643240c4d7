// SPDX-License-Identifier: Apache-2.0
// nothing is made of itself. The chains are those of parts, patterns and unit cells, and those of coordinate
// systems and their parents.
#include <set>

#include "families.hpp"

namespace meso {
namespace {

/// One reference: which element it names, and where it is written.
struct Edge {
  std::size_t to = 0;
  const Element* element = nullptr;
  std::string_view attribute;
};
struct Node {
  std::string name;
  std::vector<Edge> edges;
};

class Graph {
 public:
  template <class T>
  void add(const T& item) {
    number_.emplace(&item, nodes_.size());
    nodes_.push_back({std::string(to_text(KindOf<T>::kind)) + " " + item.id.text, {}});
  }
  template <class From, class To>
  void connect(const Context& c, const From& from, const Ref<To>& ref, const Element& element,
               std::string_view attribute) {
    if (const To* to = c.find(ref)) nodes_[number_.at(&from)].edges.push_back({number_.at(to), &element, attribute});
  }
  template <class From, class To>
  void connect(const Context& c, const From& from, const std::optional<Ref<To>>& ref, const Element& element,
               std::string_view attribute) {
    if (ref) connect(c, from, *ref, element, attribute);
  }

  /// One diagnostic for every circle; a circle that shares a member with a reported one is its consequence.
  void report_circles(Context& c);

 private:
  struct Step {
    std::size_t node = 0;
    std::size_t next_edge = 0;
  };
  void report(Context& c, const std::vector<Step>& stack, const Edge& closing);

  std::map<const Element*, std::size_t> number_;
  std::vector<Node> nodes_;
  std::set<std::size_t> told_;
};

void Graph::report_circles(Context& c) {
  enum class Mark { unseen, on_stack, done };
  std::vector<Mark> marks(nodes_.size(), Mark::unseen);
  // Depth-first with a stack of our own: a chain may be longer than the machine's stack is deep.
  for (std::size_t root = 0; root < nodes_.size(); ++root) {
    if (marks[root] != Mark::unseen) continue;
    std::vector<Step> stack{{root}};
    marks[root] = Mark::on_stack;
    while (!stack.empty()) {
      Step& top = stack.back();
      if (top.next_edge == nodes_[top.node].edges.size()) {
        marks[top.node] = Mark::done;
        stack.pop_back();
        continue;
      }
      const Edge& edge = nodes_[top.node].edges[top.next_edge++];
      if (marks[edge.to] == Mark::on_stack) report(c, stack, edge);
      if (marks[edge.to] != Mark::unseen) continue;
      marks[edge.to] = Mark::on_stack;
      stack.push_back({edge.to});
    }
  }
}

void Graph::report(Context& c, const std::vector<Step>& stack, const Edge& closing) {
  std::size_t first = stack.size() - 1;
  while (stack[first].node != closing.to) --first;
  std::string chain;
  bool is_told = false;
  for (std::size_t i = first; i < stack.size(); ++i) {
    is_told = !told_.insert(stack[i].node).second || is_told;
    chain += nodes_[stack[i].node].name + " -> ";
  }
  if (is_told) return;
  c.report(Code::link_cycle, *closing.element, closing.attribute, {chain + nodes_[closing.to].name});
}

void check_bodies(Context& c) {
  Graph graph;
  for (const Part& part : c.document.parts) graph.add(part);
  for (const Pattern& pattern : c.document.patterns) graph.add(pattern);
  for (const UnitCell& cell : c.document.unit_cells) graph.add(cell);
  for (const Part& part : c.document.parts) {
    for (const Apply& apply : part.steps) {
      graph.connect(c, part, apply.pattern, apply, "pattern");
      graph.connect(c, part, apply.part, apply, "part");
    }
  }
  for (const Pattern& pattern : c.document.patterns) graph.connect(c, pattern, pattern.unit_cell, pattern, "unitCell");
  for (const UnitCell& cell : c.document.unit_cells)
    if (const auto* body = std::get_if<PartBody>(&cell.body)) graph.connect(c, cell, body->part, *body, "ref");
  graph.report_circles(c);
}

void check_parents(Context& c) {
  Graph graph;
  for (const CoordinateSystem& system : c.document.coordinate_systems) graph.add(system);
  for (const CoordinateSystem& system : c.document.coordinate_systems)
    graph.connect(c, system, system.parent, system, "parent");
  graph.report_circles(c);
}

}  // namespace

void check_cycles(Context& c) {
  check_bodies(c);
  check_parents(c);
}

}  // namespace meso
