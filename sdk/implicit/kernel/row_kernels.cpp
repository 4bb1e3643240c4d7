// SPDX-License-Identifier: Apache-2.0
// Compiled three times, with MESO_ROW_ISA = sse2, avx2, avx512 and the flags of each.
#include "row_kernels.hpp"

#include "lanes.hpp"

namespace meso::implicit {
namespace {

using expr::Op;

struct Reader {
  explicit Reader(const Input& in) : values(in.values), first(splat(*in.values)), uniform(in.uniform) {}
  Lanes operator()(std::size_t i) const { return uniform ? first : load(values + i); }
  const double* values;
  Lanes first;
  bool uniform;
};

template <class F>
void one(const Input* in, std::size_t, double* out, std::size_t n) {
  const Reader a(in[0]);
  for (std::size_t i = 0; i < n; i += width) store(out + i, F{}(a(i)));
}

template <class F>
void two(const Input* in, std::size_t, double* out, std::size_t n) {
  const Reader a(in[0]), b(in[1]);
  if (a.uniform)
    for (std::size_t i = 0; i < n; i += width) store(out + i, F{}(a.first, b(i)));
  else if (b.uniform)
    for (std::size_t i = 0; i < n; i += width) store(out + i, F{}(load(a.values + i), b.first));
  else
    for (std::size_t i = 0; i < n; i += width) store(out + i, F{}(load(a.values + i), load(b.values + i)));
}

template <class F>
void three(const Input* in, std::size_t, double* out, std::size_t n) {
  const Reader a(in[0]), b(in[1]), c(in[2]);
  for (std::size_t i = 0; i < n; i += width) store(out + i, F{}(a(i), b(i), c(i)));
}

// One row_unit of a sum of products, as independent chains.
constexpr std::size_t chains = row_unit / width;
struct Unit {
  Lanes lanes[chains];
};

/// The usual case: rows times numbers, and how many is known when this is compiled.
template <int products>
inline Unit sum_of_rows(const Input* in, std::size_t i) {
  Unit sum;
  for (std::size_t c = 0; c < chains; ++c) sum.lanes[c] = splat(*in[0].values);
  for (int k = 0; k < products; ++k)
    for (std::size_t c = 0; c < chains; ++c)
      sum.lanes[c] = sum.lanes[c] + load(in[2 * k + 1].values + i + c * width) * splat(*in[2 * k + 2].values);
  return sum;
}

inline Unit sum_of_any(const Input* in, std::size_t count, std::size_t i) {
  const auto at = [i](const Input& input, std::size_t c) {
    return input.uniform ? splat(*input.values) : load(input.values + i + c * width);
  };
  Unit sum;
  for (std::size_t c = 0; c < chains; ++c) sum.lanes[c] = at(in[0], c);
  for (std::size_t k = 1; k + 1 < count; k += 2)
    for (std::size_t c = 0; c < chains; ++c) sum.lanes[c] = sum.lanes[c] + at(in[k], c) * at(in[k + 1], c);
  return sum;
}

struct ToDoubles {
  double* out;
  void operator()(std::size_t i, const Unit& unit) const {
    for (std::size_t c = 0; c < chains; ++c) store(out + i + c * width, unit.lanes[c]);
  }
};

struct ToSamples {
  float* values;
  std::uint16_t* inside;
  void operator()(std::size_t i, const Unit& unit) const {
    unsigned bits = 0;
    for (std::size_t c = 0; c < chains; ++c) {
      bits |= negative(unit.lanes[c]) << (c * width);
      *reinterpret_cast<Floats*>(values + i + c * width) = __builtin_convertvector(unit.lanes[c], Floats);
    }
    inside[i / row_unit] = static_cast<std::uint16_t>(bits);
  }
};

template <int products, class Sink>
void add_rows(const Input* in, std::size_t n, Sink sink) {
  for (std::size_t i = 0; i < n; i += row_unit) sink(i, sum_of_rows<products>(in, i));
}

template <class Sink>
void add_up(const Input* in, std::size_t count, std::size_t n, Sink sink) {
  bool rows_times_numbers = in[0].uniform;
  for (std::size_t k = 1; k + 1 < count; k += 2)
    rows_times_numbers = rows_times_numbers && !in[k].uniform && in[k + 1].uniform;
  switch (rows_times_numbers ? count / 2 : 99) {
#define MESO_CASE(products) \
  case products:            \
    return add_rows<products>(in, n, sink)
    MESO_CASE(1);
    MESO_CASE(2);
    MESO_CASE(3);
    MESO_CASE(4);
    MESO_CASE(5);
    MESO_CASE(6);
    MESO_CASE(7);
    MESO_CASE(8);
    MESO_CASE(9);
    MESO_CASE(10);
    MESO_CASE(11);
    MESO_CASE(12);
#undef MESO_CASE
    default:
      for (std::size_t i = 0; i < n; i += row_unit) sink(i, sum_of_any(in, count, i));
  }
}

void sum_of_products_row(const Input* in, std::size_t count, double* out, std::size_t n) {
  add_up(in, count, n, ToDoubles{out});
}
void store_sum_of_products(const Input* in, std::size_t count, float* values, std::uint16_t* inside, std::size_t n) {
  add_up(in, count, n, ToSamples{values, inside});
}
void store_row(const Input* in, std::size_t, float* values, std::uint16_t* inside, std::size_t n) {
  const ToSamples sink{values, inside};
  for (std::size_t i = 0; i < n; i += row_unit) sink(i, sum_of_any(in, 1, i));
}

}  // namespace

namespace MESO_ROW_ISA {

void fill(RowKernels& kernels) {
  kernels.store = store_row;
  kernels.store_sum_of_products = store_sum_of_products;
  Kernel* const of_op = kernels.of_op;
  of_op[static_cast<std::size_t>(sum_of_products)] = sum_of_products_row;
#define MESO_ONE(op, formula)                             \
  {                                                       \
    struct F {                                            \
      Lanes operator()(Lanes x) const { return formula; } \
    };                                                    \
    of_op[static_cast<std::size_t>(Op::op)] = one<F>;     \
  }
#define MESO_TWO(op, formula)                                      \
  {                                                                \
    struct F {                                                     \
      Lanes operator()(Lanes x, Lanes y) const { return formula; } \
    };                                                             \
    of_op[static_cast<std::size_t>(Op::op)] = two<F>;              \
  }
#define MESO_THREE(op, formula)                                             \
  {                                                                         \
    struct F {                                                              \
      Lanes operator()(Lanes x, Lanes y, Lanes z) const { return formula; } \
    };                                                                      \
    of_op[static_cast<std::size_t>(Op::op)] = three<F>;                     \
  }
  MESO_ONE(negate, -x)
  MESO_ONE(logical_not, truth(x == 0))
  MESO_ONE(floor, floored(x))
  MESO_ONE(ceil, -floored(-x))
  MESO_ONE(round, rounded(x))
  MESO_ONE(abs, absolute(x))
  MESO_ONE(sign, truth(x > 0) - truth(x < 0))
  MESO_ONE(sqrt, square_root(x))
  MESO_ONE(exp, exponential(x))
  MESO_ONE(log, logarithm(x))
  MESO_ONE(sin, sine(x))
  MESO_ONE(cos, cosine(x))
  MESO_ONE(tan, tangent(x))
  MESO_ONE(asin, arc_sine(x))
  MESO_ONE(acos, arc_cosine(x))
  MESO_ONE(atan, arc_tangent(x))
  MESO_TWO(add, x + y)
  MESO_TWO(subtract, x - y)
  MESO_TWO(multiply, x * y)
  MESO_TWO(divide, x / y)
  MESO_TWO(less, truth(x < y))
  MESO_TWO(less_equal, truth(x <= y))
  MESO_TWO(greater, truth(x > y))
  MESO_TWO(greater_equal, truth(x >= y))
  MESO_TWO(equal, truth(x == y))
  MESO_TWO(not_equal, truth(x != y))
  MESO_TWO(mod, x - y * floored(x / y))
  MESO_TWO(power, power(x, y))
  MESO_TWO(atan2, arc_tangent2(x, y))
  MESO_TWO(hypot, hypotenuse(x, y))
  MESO_TWO(min, y < x ? y : x)
  MESO_TWO(max, y > x ? y : x)
  MESO_TWO(logical_and, truth((x != 0) & (y != 0)))
  MESO_TWO(logical_or, truth((x != 0) | (y != 0)))
  MESO_THREE(select, x != 0 ? y : z)
#undef MESO_ONE
#undef MESO_TWO
#undef MESO_THREE
}

}  // namespace MESO_ROW_ISA
}  // namespace meso::implicit
