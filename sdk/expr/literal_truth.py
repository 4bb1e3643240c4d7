#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints literal_truth.hpp: literals with units and their correctly rounded values, by exact fractions.

Python divides integers with correct rounding; pi comes from Machin's formula in integers, to 400 digits.
"""
import random
import struct
from fractions import Fraction

LENGTHS = {"um": ("micrometer", 1), "mm": ("millimeter", 1000), "cm": ("centimeter", 10**4),
           "m": ("meter", 10**6), "in": ("inch", 25400), "ft": ("foot", 304800)}
SIZE_OF_UNIT = dict(LENGTHS.values())


def arctan_of_inverse(x, one):
    term = total = one // x
    n, sign = 3, -1
    while term:
        term //= x * x
        total += sign * (term // n)
        n, sign = n + 2, -sign
    return total


ONE = 10**420
PI = Fraction(4 * (4 * arctan_of_inverse(5, ONE) - arctan_of_inverse(239, ONE)), ONE)


def row(text, suffix, unit):
    exact = Fraction(text) * (PI / 180 if suffix == "deg" else Fraction(LENGTHS[suffix][1], SIZE_OF_UNIT[unit]))
    try:
        value = exact.numerator / exact.denominator
    except OverflowError:
        return None
    return f'    {{"{text}", "{suffix}", LengthUnit::{unit}, {value.hex()}}},' if value != 0 else None


def random_decimal():
    digits = "".join(random.choice("0123456789") for _ in range(random.choice([1, 2, 5, 8, 17, 18, 19, 20, 40, 90])))
    text = digits.lstrip("0") or "7"
    if random.random() < 0.5:
        point = random.randrange(len(text))
        text = text[:point] + "." + text[point:]
    if random.random() < 0.5:
        text += f"e{random.choice([random.randrange(-20, 21), random.randrange(-310, 290)])}"
    return text


def halfway_decimal(suffix, unit):
    """A decimal whose value lies exactly between two doubles, or nothing if no finite decimal does."""
    x = random.random() * 10 ** random.randrange(-3, 6)
    bits = struct.unpack("<Q", struct.pack("<d", x))[0]
    next_x = struct.unpack("<d", struct.pack("<Q", bits + 1))[0]
    decimal = (Fraction(x) + Fraction(next_x)) / 2 * Fraction(SIZE_OF_UNIT[unit], LENGTHS[suffix][1])
    odd = decimal.denominator
    while odd % 2 == 0:
        odd //= 2
    while odd % 5 == 0:
        odd //= 5
    if odd != 1:
        return None
    places = 0
    while (decimal * 10**places).denominator != 1:
        places += 1
    digits = str((decimal * 10**places).numerator).rjust(places + 1, "0")
    return digits[:-places] + "." + digits[-places:] if places else digits + ".0"


def rows():
    random.seed(20)
    yield from (row(*r) for r in [
        ("10", "mm", "inch"), ("1", "in", "millimeter"), ("0.1", "in", "millimeter"), ("1", "ft", "meter"),
        ("90", "deg", "millimeter"), ("180", "deg", "inch"), ("30", "deg", "millimeter"), ("0.3", "um", "millimeter"),
        ("2.2250738585072011e-308", "mm", "inch"), ("1.7976931348623157e305", "m", "millimeter"),
        ("5e-324", "m", "millimeter"), ("3e-324", "ft", "inch"), ("1e22", "mm", "inch"), ("1e400", "mm", "inch")])
    units = list(SIZE_OF_UNIT)
    for _ in range(80):
        yield row(random_decimal(), random.choice([*LENGTHS, "deg"]), random.choice(units))
    for _ in range(60):
        suffix, unit = random.choice([*LENGTHS]), random.choice(units)
        text = halfway_decimal(suffix, unit)
        if text:
            yield row(text, suffix, unit)
            yield row(text + "00000000000000000001", suffix, unit)


print("""// Made by literal_truth.py; do not edit.
// clang-format off
#pragma once
#include <string_view>

#include "meso/base/unit.hpp"

namespace meso::expr {

struct LiteralTruth {
  std::string_view decimal;
  std::string_view suffix;
  LengthUnit document_unit;
  double value;
};

inline constexpr LiteralTruth literal_truths[] = {""")
for line in rows():
    if line:
        print(line)
print("};\n\n}  // namespace meso::expr")
