// SPDX-License-Identifier: Apache-2.0
#include "separate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "scalar_operation.hpp"
#include "spread_points.hpp"

namespace meso::implicit {
namespace {

using expr::Op;
using Id = Graph::Id;

constexpr Id none = std::numeric_limits<Id>::max();
constexpr std::size_t max_rows = 12;
constexpr double max_relative_error = 1e-12;

/// Every node's values at a few points of the box.
class Probe {
 public:
  Probe(const Graph& graph, const Grid& grid) : graph_(graph), points_(spread_points<64>(grid.box)) {}

  /// Not finite if a value is not.
  [[nodiscard]] double magnitude(Id id) {
    double result = 0;
    for (const double v : values(id)) result = std::isfinite(v) ? std::max(result, std::abs(v)) : HUGE_VAL;
    return result;
  }
  [[nodiscard]] double range(Id id) {
    const auto [least, greatest] = std::minmax_element(values(id).begin(), values(id).end());
    return *greatest - *least;
  }

 private:
  using Values = std::array<double, 64>;

  const Values& values(Id id) {
    for (Id next = static_cast<Id>(values_.size()); next <= id; ++next) values_.push_back(computed(next));
    return values_[id];
  }

  Values computed(Id id) const {
    const Graph::Node& node = graph_[id];
    Values result{};
    if (node.op == Op::number) {
      result.fill(node.number);
    } else if (node.op == Op::name) {
      for (std::size_t p = 0; p < points_.size(); ++p) result[p] = leaf(node.leaf, points_[p]);
    } else {
      const auto operands = graph_.operands(id);
      std::vector<double> arguments(operands.size());
      for (std::size_t p = 0; p < points_.size(); ++p) {
        for (std::size_t o = 0; o < operands.size(); ++o) arguments[o] = values_[operands[o]][p];
        result[p] = node.op == sum_of_products ? sum(arguments) : apply_operation(node.op, arguments);
      }
    }
    return result;
  }
  double leaf(std::uint32_t leaf, Vec3 p) const {
    if (leaf < 3) return p[leaf];
    const ExternalLeaf& external = graph_.externals()[leaf - 3];
    return external.field->value(external.field_from_world * p);
  }
  static double sum(std::span<const double> v) {
    double result = v[0];
    for (std::size_t k = 1; k + 1 < v.size(); k += 2) result += v[k] * v[k + 1];
    return result;
  }

  const Graph& graph_;
  std::array<Vec3, 64> points_{};
  std::vector<Values> values_;
};

/// row * rest, row depending on x (none: 1), rest not.
struct Product {
  Id row = none;
  Id rest = 0;
};

/// A sum of products, of distinct rows in ascending order.
struct Polynomial {
  std::vector<Product> products;
  double magnitude = 0;  ///< bound of the sum of magnitudes of everything that is added up
};

class Separator {
 public:
  Separator(Graph& graph, const Grid& grid) : graph_(graph), probe_(graph, grid) {}

  Id separated(Id root) {
    polynomials_.resize(root + 1);
    for (const Id id : graph_.reachable(root)) polynomials_[id] = polynomial(id);
    return sum_node(root);
  }

 private:
  [[nodiscard]] bool has_x(Id id) const { return (graph_[id].axes & x_axis) != 0; }
  [[nodiscard]] bool is_x_alone(Id id) const { return graph_[id].axes == x_axis; }

  Polynomial polynomial(Id id) {
    if (!has_x(id) || is_x_alone(id)) return atom(id);
    if (auto regrouped = this->regrouped(id);
        regrouped && regrouped->products.size() <= max_rows + 1 &&
        regrouped->magnitude * std::numeric_limits<double>::epsilon() <= max_relative_error * probe_.range(id))
      return std::move(*regrouped);
    return atom(with_separated_operands(id));
  }

  Polynomial atom(Id id) {
    const double magnitude = probe_.magnitude(id);
    if (!has_x(id)) return {{{none, id}}, magnitude};
    double factor = 1;  // taken out, so that multiples of a row are one row
    for (bool again = true; again;) {
      again = false;
      const Op op = graph_[id].op;
      const auto operands = graph_.operands(id);
      if (op == Op::negate) {
        factor = -factor;
        id = operands[0];
        again = true;
      } else if (op == Op::multiply && (graph_.is_number(operands[0]) || graph_.is_number(operands[1]))) {
        const std::size_t number = graph_.is_number(operands[0]) ? 0 : 1;
        factor *= graph_[operands[number]].number;
        id = operands[1 - number];
        again = true;
      }
    }
    return {{{id, graph_.number(factor)}}, magnitude};
  }

  Id with_separated_operands(Id id) {
    std::vector<Id> operands(graph_.operands(id).begin(), graph_.operands(id).end());
    if (operands.empty()) return id;
    if (graph_[id].op == Op::hypot && is_moderate(operands[0]) && is_moderate(operands[1])) {
      const auto x2 = times(polynomials_[operands[0]], polynomials_[operands[0]]);
      const auto y2 = times(polynomials_[operands[1]], polynomials_[operands[1]]);
      if (x2 && y2) return graph_.apply(Op::sqrt, {sum_node(plus(*x2, *y2))});
    }
    for (Id& operand : operands) operand = sum_node(operand);
    return graph_.apply(graph_[id].op, operands);
  }
  [[nodiscard]] bool is_moderate(Id id) {
    const double magnitude = probe_.magnitude(id);
    return magnitude > 1e-100 && magnitude < 1e100;
  }

  std::optional<Polynomial> regrouped(Id id) {
    const std::vector<Id> operands(graph_.operands(id).begin(), graph_.operands(id).end());
    switch (graph_[id].op) {
      case Op::add:
        return plus(polynomials_[operands[0]], polynomials_[operands[1]]);
      case Op::subtract:
        return plus(polynomials_[operands[0]], negated(polynomials_[operands[1]]));
      case Op::negate:
        return negated(polynomials_[operands[0]]);
      case Op::multiply:
        return times(polynomials_[operands[0]], polynomials_[operands[1]]);
      case Op::divide:
        if (has_x(operands[1]) && !is_x_alone(operands[1])) return std::nullopt;
        return times(polynomials_[operands[0]], atom(graph_.apply(Op::divide, {graph_.number(1), operands[1]})));
      case Op::sin:
      case Op::cos:
        return split_angle(graph_[id].op, polynomials_[operands[0]]);
      default:
        return std::nullopt;
    }
  }

  Polynomial negated(Polynomial a) {
    for (Product& product : a.products) product.rest = graph_.apply(Op::multiply, {graph_.number(-1), product.rest});
    return a;
  }

  Polynomial plus(const Polynomial& a, const Polynomial& b) {
    Polynomial sum{a.products, a.magnitude + b.magnitude};
    for (const Product& product : b.products) add(sum, product);
    return sum;
  }

  void add(Polynomial& sum, const Product& product) {
    const auto place = std::lower_bound(sum.products.begin(), sum.products.end(), product,
                                        [](const Product& p, const Product& q) { return p.row < q.row; });
    if (place == sum.products.end() || place->row != product.row)
      sum.products.insert(place, product);
    else
      place->rest = graph_.apply(Op::add, {place->rest, product.rest});
  }

  /// Nothing if rows would have to be multiplied that are not tables, or if it becomes too long.
  std::optional<Polynomial> times(const Polynomial& a, const Polynomial& b) {
    Polynomial result{{}, a.magnitude * b.magnitude};
    for (const Product& p : a.products)
      for (const Product& q : b.products) {
        Product product{p.row == none ? q.row : p.row, graph_.apply(Op::multiply, {p.rest, q.rest})};
        if (p.row != none && q.row != none) {
          if (!is_x_alone(p.row) || !is_x_alone(q.row)) return std::nullopt;
          product.row = graph_.apply(Op::multiply, {p.row, q.row});
        }
        add(result, product);
        if (result.products.size() > max_rows + 1) return std::nullopt;
      }
    return result;
  }

  /// sin(u + w) and cos(u + w) where u is known along a row without y, and w without x.
  std::optional<Polynomial> split_angle(Op op, const Polynomial& angle) {
    Id u = none, w = none;
    for (const Product& product : angle.products) {
      if (product.row == none) {
        w = product.rest;
        continue;
      }
      if ((graph_[product.row].axes & y_axis) != 0 || !graph_.is_number(product.rest)) return std::nullopt;
      const Id part = graph_.apply(Op::multiply, {product.rest, product.row});
      u = u == none ? part : graph_.apply(Op::add, {u, part});
    }
    if (u == none || w == none || graph_.is_number(w)) return std::nullopt;
    const Id sin_u = graph_.apply(Op::sin, {u}), cos_u = graph_.apply(Op::cos, {u});
    const Id sin_w = graph_.apply(Op::sin, {w}), cos_w = graph_.apply(Op::cos, {w});
    const Id minus_sin_w = graph_.apply(Op::multiply, {graph_.number(-1), sin_w});
    Polynomial result{{}, 2};
    add(result, op == Op::sin ? Product{sin_u, cos_w} : Product{cos_u, cos_w});
    add(result, op == Op::sin ? Product{cos_u, sin_w} : Product{sin_u, minus_sin_w});
    return result;
  }

  Id sum_node(Id id) { return has_x(id) && !is_x_alone(id) ? sum_node(polynomials_[id]) : id; }

  Id sum_node(const Polynomial& polynomial) {
    std::vector<Id> operands = {graph_.number(0)};
    Id constant_rows = none;  // rows times numbers are one row, if they are tables
    for (const Product& product : polynomial.products) {
      if (product.row == none) {
        operands[0] = product.rest;
      } else if (is_x_alone(product.row) && graph_.is_number(product.rest)) {
        const Id part = graph_.apply(Op::multiply, {product.rest, product.row});
        constant_rows = constant_rows == none ? part : graph_.apply(Op::add, {constant_rows, part});
      } else {
        operands.insert(operands.end(), {product.row, product.rest});
      }
    }
    if (constant_rows != none) operands.insert(operands.end(), {constant_rows, graph_.number(1)});
    if (operands.size() == 1) return operands[0];
    const bool only_a_row = operands.size() == 3 && graph_.is_number(operands[0]) && graph_[operands[0]].number == 0 &&
                            graph_.is_number(operands[2]) && graph_[operands[2]].number == 1;
    return only_a_row ? operands[1] : graph_.apply(sum_of_products, operands);
  }

  Graph& graph_;
  Probe probe_;
  std::vector<Polynomial> polynomials_;
};

}  // namespace

Id separate(Graph& graph, Id root, const Grid& grid) { return Separator(graph, grid).separated(root); }

}  // namespace meso::implicit
