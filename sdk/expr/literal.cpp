// SPDX-License-Identifier: Apache-2.0
#include "literal.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "meso/base/number.hpp"

namespace meso::expr {
namespace {

/// Natural numbers of any size, little-endian, without leading zero limbs: just what an exact conversion needs.
class Natural {
 public:
  explicit Natural(std::uint64_t value = 0) {
    for (; value != 0; value >>= 32) limbs_.push_back(static_cast<std::uint32_t>(value));
  }

  void multiply_add(std::uint32_t factor, std::uint32_t summand) {
    std::uint64_t carry = summand;
    for (std::uint32_t& limb : limbs_) {
      carry += static_cast<std::uint64_t>(limb) * factor;
      limb = static_cast<std::uint32_t>(carry);
      carry >>= 32;
    }
    if (carry != 0) limbs_.push_back(static_cast<std::uint32_t>(carry));
  }

  void append_digits(std::string_view digits) {
    std::uint32_t chunk = 0;
    std::uint32_t scale = 1;
    for (const char digit : digits) {
      if (digit == '.') continue;
      chunk = chunk * 10 + static_cast<std::uint32_t>(digit - '0');
      scale *= 10;
      if (scale == 1'000'000'000) {
        multiply_add(scale, chunk);
        chunk = 0;
        scale = 1;
      }
    }
    multiply_add(scale, chunk);
  }

  void multiply_by_power_of_ten(std::size_t exponent) {
    for (; exponent >= 9; exponent -= 9) multiply_add(1'000'000'000, 0);
    for (; exponent > 0; --exponent) multiply_add(10, 0);
  }

  void multiply(const Natural& other) {
    std::vector<std::uint32_t> product(limbs_.size() + other.limbs_.size());
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
      std::uint64_t carry = 0;
      for (std::size_t j = 0; j < other.limbs_.size(); ++j) {
        carry += static_cast<std::uint64_t>(limbs_[i]) * other.limbs_[j] + product[i + j];
        product[i + j] = static_cast<std::uint32_t>(carry);
        carry >>= 32;
      }
      product[i + other.limbs_.size()] = static_cast<std::uint32_t>(carry);
    }
    limbs_ = std::move(product);
    trim();
  }

  void shift_left(std::size_t bits) {
    const auto part = static_cast<unsigned>(bits % 32);
    if (part != 0) multiply_add(std::uint32_t{1} << part, 0);
    limbs_.insert(limbs_.begin(), bits / 32, 0);
  }

  /// REQUIRES: other <= *this.
  void subtract(const Natural& other) {
    std::int64_t borrow = 0;
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
      borrow += static_cast<std::int64_t>(limbs_[i]) - (i < other.limbs_.size() ? other.limbs_[i] : 0);
      limbs_[i] = static_cast<std::uint32_t>(borrow);
      borrow >>= 32;
    }
    trim();
  }

  [[nodiscard]] bool is_zero() const { return limbs_.empty(); }
  [[nodiscard]] std::int64_t bit_length() const {
    return limbs_.empty() ? 0 : static_cast<std::int64_t>(limbs_.size() * 32) - std::countl_zero(limbs_.back());
  }
  friend std::strong_ordering operator<=>(const Natural& a, const Natural& b) {
    if (a.limbs_.size() != b.limbs_.size()) return a.limbs_.size() <=> b.limbs_.size();
    return std::lexicographical_compare_three_way(a.limbs_.rbegin(), a.limbs_.rend(), b.limbs_.rbegin(),
                                                  b.limbs_.rend());
  }
  friend bool operator==(const Natural& a, const Natural& b) = default;

 private:
  void trim() {
    while (!limbs_.empty() && limbs_.back() == 0) limbs_.pop_back();
  }
  std::vector<std::uint32_t> limbs_;
};

/// The double nearest to n / d, ties to even, by long division bit for bit.
double nearest_quotient(Natural n, Natural d) {
  if (n.is_zero()) return 0;
  std::int64_t exponent = n.bit_length() - d.bit_length();
  if (exponent > 0) {
    d.shift_left(static_cast<std::size_t>(exponent));
  } else {
    n.shift_left(static_cast<std::size_t>(-exponent));
  }
  if (n < d) {
    n.shift_left(1);
    --exponent;
  }
  // Now n / d is in [1, 2) and has 53 bits to give, fewer where doubles are subnormal, none below half of the smallest.
  const std::int64_t bits = std::min<std::int64_t>(53, exponent + 1075);
  if (bits < 0) return 0;
  std::uint64_t quotient = 0;
  for (std::int64_t i = 0; i < bits; ++i) {
    quotient *= 2;
    if (n >= d) {
      n.subtract(d);
      ++quotient;
    }
    n.shift_left(1);
  }
  // What is left, n / (2 d), is the fraction that rounding decides on.
  const bool up = n > d || (n == d && quotient % 2 == 1);
  return std::ldexp(static_cast<double>(quotient + (up ? 1 : 0)), static_cast<int>(exponent - bits + 1));
}

/// Digits, position of the decimal point, exponent: decimal = 0.d1 d2 d3 ... * 10^magnitude with d1 > 0.
struct Decimal {
  std::string_view digits;  ///< from the first digit that is not 0, one point inside perhaps
  std::int64_t exponent;    ///< of the last digit
  std::int64_t magnitude;
};

std::optional<Decimal> split_decimal(std::string_view decimal) {
  const std::size_t mantissa_end = std::min(decimal.find_first_of("eE"), decimal.size());
  const std::string_view mantissa = decimal.substr(0, mantissa_end);
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  const std::size_t first = mantissa.find_first_not_of("0.");
  if (first == std::string_view::npos) return std::nullopt;

  // Saturated: an exponent of more than nine digits is out of range whatever the mantissa (which has < 2^16 digits).
  std::int64_t exponent = 0;
  bool negative = false;
  for (const char c : decimal.substr(std::min(mantissa_end + 1, decimal.size()))) {
    if (c == '-') negative = true;
    if (c >= '0' && c <= '9') exponent = std::min<std::int64_t>(exponent * 10 + (c - '0'), 1'000'000'000);
  }
  if (negative) exponent = -exponent;

  const auto place = [&](std::size_t i) {  // power of ten just above the digit at i
    return static_cast<std::int64_t>(point) - static_cast<std::int64_t>(i) + (i > point ? 1 : 0) + exponent;
  };
  const std::size_t last = mantissa.find_last_of("0123456789");
  return Decimal{mantissa.substr(first, last - first + 1), place(last) - 1, place(first)};
}

/// One length unit in micrometres: all are whole.
std::uint32_t micrometers(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::micrometer:
      return 1;
    case LengthUnit::millimeter:
      return 1'000;
    case LengthUnit::centimeter:
      return 10'000;
    case LengthUnit::meter:
      return 1'000'000;
    case LengthUnit::inch:
      return 25'400;
    case LengthUnit::foot:
      return 304'800;
  }
  return 1;
}

constexpr std::array<std::string_view, 8> names = {"um", "mm", "cm", "m", "in", "ft", "deg", "rad"};

std::optional<LengthUnit> length_unit(Suffix suffix) {
  switch (suffix) {
    case Suffix::um:
      return LengthUnit::micrometer;
    case Suffix::mm:
      return LengthUnit::millimeter;
    case Suffix::cm:
      return LengthUnit::centimeter;
    case Suffix::m:
      return LengthUnit::meter;
    case Suffix::in:
      return LengthUnit::inch;
    case Suffix::ft:
      return LengthUnit::foot;
    default:
      return std::nullopt;
  }
}

// 100 decimals of pi. A product with a rational number is never halfway between doubles; these decide the rounding of
// every literal that is not made, with some 80 digits, to lie on a halfway point.
constexpr std::string_view pi_digits =
    "3.1415926535897932384626433832795028841971693993751058209749445923078164062862089986280348253421170679";
constexpr std::size_t pi_decimals = 100;

}  // namespace

std::optional<Suffix> find_suffix(std::string_view text) {
  const auto* const found = std::find(names.begin(), names.end(), text);
  if (found == names.end()) return std::nullopt;
  return static_cast<Suffix>(found - names.begin() + 1);
}

std::span<const std::string_view> suffix_names() { return names; }

std::optional<double> literal_value(std::string_view decimal, Suffix suffix, LengthUnit document_unit) {
  const std::optional<LengthUnit> unit = length_unit(suffix);
  const bool as_written = suffix == Suffix::none || suffix == Suffix::rad || unit == document_unit;
  const std::optional<Decimal> parts = split_decimal(decimal);
  if (!parts) return 0;
  // Beyond these powers of ten no unit brings the value back; this also bounds the work below.
  if (parts->magnitude > 330 || parts->magnitude < -345) return std::nullopt;
  if (as_written) return parse_number(decimal);

  Natural numerator;
  numerator.append_digits(parts->digits);
  Natural denominator(1);
  if (parts->exponent >= 0) {
    numerator.multiply_by_power_of_ten(static_cast<std::size_t>(parts->exponent));
  } else {
    denominator.multiply_by_power_of_ten(static_cast<std::size_t>(-parts->exponent));
  }
  if (unit) {
    numerator.multiply_add(micrometers(*unit), 0);
    denominator.multiply_add(micrometers(document_unit), 0);
  } else {
    Natural pi;
    pi.append_digits(pi_digits);
    numerator.multiply(pi);
    denominator.multiply_by_power_of_ten(pi_decimals);
    denominator.multiply_add(180, 0);
  }
  const double value = nearest_quotient(std::move(numerator), std::move(denominator));
  if (value == 0 || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace meso::expr
