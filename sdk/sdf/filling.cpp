// SPDX-License-Identifier: Apache-2.0
#include "filling.hpp"

#include <algorithm>

#include "meso/implicit/density_table.hpp"

namespace meso::sdf {

using implicit::Term;

namespace {

Term product(const Term& a, const Term& b) {
  if (a.is_constant() && a.node().number == 1) return b;
  return b.is_constant() && b.node().number == 1 ? a : a * b;
}

bool same_number(const Term& a, const Term& b) {
  return a.is_constant() && b.is_constant() && a.node().number == b.node().number;
}

}  // namespace

Filling::Filling(const Term& function, Vec3 period, Term share)
    : functions_{(1 / implicit::root_mean_square(function, {{}, period})) * function},
      parts_{Term::constant(1)},
      share_(std::move(share)),
      period_(period) {}

Filling Filling::moved(const Affine& source_from_target, Vec3 period) const {
  Filling there = *this;
  for (Term& f : there.functions_) f = f.at(source_from_target);
  for (Term& part : there.parts_) part = part.at(source_from_target);
  there.share_ = share_.at(source_from_target);
  there.period_ = period;
  return there;
}

std::optional<Filling> Filling::blended(const Filling& one, const Filling& other, const Term& weight) {
  if (!(one.period_ == other.period_)) return std::nullopt;
  Filling both;
  const Term rest = Term::constant(1) - weight;
  for (const auto& [from, part] : {std::pair(&one, &rest), std::pair(&other, &weight)})
    for (std::size_t i = 0; i < from->functions_.size(); ++i) {
      both.functions_.push_back(from->functions_[i]);
      both.parts_.push_back(product(*part, from->parts_[i]));
    }
  both.share_ = same_number(one.share_, other.share_) ? one.share_ : one.share_ + weight * (other.share_ - one.share_);
  both.period_ = one.period_;
  return both;
}

std::size_t Filling::varying() const {
  return static_cast<std::size_t>(
      std::count_if(parts_.begin() + 1, parts_.end(), [](const Term& part) { return !part.is_constant(); }));
}

Term Filling::mixed(const std::vector<Term>& parts) const {
  Term f = functions_[0];
  for (std::size_t i = 1; i < parts.size(); ++i) f = f + parts[i] * (functions_[i] - functions_[0]);
  return f;
}

Term Filling::body() const {
  std::vector<Term> at;
  for (std::size_t i = 1; i < parts_.size(); ++i)
    if (!parts_[i].is_constant()) at.push_back(parts_[i]);
  const auto function = [&](std::span<const double> chosen) {
    std::vector<Term> parts = parts_;
    std::size_t next = 0;
    for (std::size_t i = 1; i < parts.size(); ++i)
      if (!parts[i].is_constant()) parts[i] = Term::constant(chosen[next++]);
    return mixed(parts);
  };
  const auto table = std::make_shared<const implicit::DensityTable>(function, implicit::DensityTable::Room{{}, period_},
                                                                    std::vector<implicit::Interval>(at.size(), {0, 1}));
  if (at.empty() && share_.is_constant()) return mixed(parts_) - table->level(share_.node().number, {});
  return mixed(parts_) - density_level(table, share_, std::move(at));
}

}  // namespace meso::sdf
