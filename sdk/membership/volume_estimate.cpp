// SPDX-License-Identifier: Apache-2.0
#include "meso/membership/volume_estimate.hpp"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <mutex>
#include <thread>

#include "meso/base/threads.hpp"

namespace meso::membership {
namespace {

/// A number in [0, 1) from any key (SplitMix64; Steele, Lea and Flood, 2014).
double random_fraction(std::uint64_t key) {
  std::uint64_t z = key * 0x9e3779b97f4a7c15u + 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  z ^= z >> 31;
  return static_cast<double>(z >> 11) * 0x1p-53;
}

constexpr std::size_t block_size = 4096;  ///< even: neighbours that are compared stand in one block

/// Calls work(first, last) for blocks of [0, count), from several threads. False if the run was stopped.
template <typename Work>
bool in_blocks(std::size_t count, const RunOptions& run, const Work& work) {
  std::atomic<std::size_t> next_block = 0;
  std::atomic<bool> stopped = false;
  const auto take_blocks = [&](std::size_t worker) {
    for (std::size_t first; !stopped && (first = block_size * next_block++) < count;) {
      const std::size_t last = std::min(first + block_size, count);
      work(first, last);
      if (worker != 0) continue;
      run.report("points", static_cast<double>(last) / static_cast<double>(count));
      if (run.should_stop()) stopped = true;
    }
  };
  on_threads(run.jobs > 0 ? run.jobs : std::max(1u, std::thread::hardware_concurrency()), take_blocks);
  return !stopped;
}

struct Counts {
  std::size_t inside = 0, unknown = 0, differing_low = 0, differing_high = 0;

  /// Point number i, and the one before it.
  void add(std::size_t i, Answer answer, Answer before) {
    inside += answer == Answer::inside;
    unknown += answer == Answer::unknown;
    if (i % 2 == 0) return;
    differing_low += (answer == Answer::inside) != (before == Answer::inside);
    differing_high += (answer == Answer::outside) != (before == Answer::outside);
  }
  [[nodiscard]] VolumeEstimate estimate(double each) const {
    const double differing = static_cast<double>(std::max(differing_low, differing_high));
    return {static_cast<double>(inside) * each, static_cast<double>(inside + unknown) * each,
            std::max(1.0, std::sqrt(differing)) * each};
  }
};

}  // namespace

JitteredPoints::JitteredPoints(const Box3& box, std::size_t count, std::uint64_t seed) : corner_(box.min), seed_(seed) {
  const Vec3 size = box.max - box.min;
  assert(size.x > 0 && size.y > 0 && size.z > 0);
  const double edge = std::cbrt(size.x * size.y * size.z / static_cast<double>(count));
  for (std::size_t i = 0; i < 3; ++i) {
    counts_[i] = static_cast<std::size_t>(std::max(1.0, std::round(size[i] / edge)));
    step_[i] = size[i] / static_cast<double>(counts_[i]);
  }
}

Vec3 JitteredPoints::operator[](std::size_t i) const {
  const std::array<std::size_t, 3> at{i / (counts_[1] * counts_[2]), i / counts_[2] % counts_[1], i % counts_[2]};
  Vec3 p = corner_;
  for (std::size_t a = 0; a < 3; ++a)
    p[a] += (static_cast<double>(at[a]) + random_fraction(seed_ * 0x100000001b3u + 3 * i + a)) * step_[a];
  return p;
}

std::optional<std::vector<Answer>> answers_at(const Membership& part, const JitteredPoints& points,
                                              const RunOptions& run) {
  std::vector<Answer> answers(points.size());
  const bool done = in_blocks(points.size(), run, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) answers[i] = part.at(points[i]);
  });
  return done ? std::optional(std::move(answers)) : std::nullopt;
}

VolumeEstimate estimate_volume(const JitteredPoints& points, const std::vector<Answer>& answers) {
  Counts counts;
  for (std::size_t i = 0; i < answers.size(); ++i) counts.add(i, answers[i], answers[i > 0 ? i - 1 : 0]);
  return counts.estimate(points.volume_each());
}

std::optional<VolumeEstimate> estimate_volume(const Membership& part, const JitteredPoints& points,
                                              const RunOptions& run) {
  Counts all;
  std::mutex mutex;
  const bool done = in_blocks(points.size(), run, [&](std::size_t first, std::size_t last) {
    Counts counts;
    Answer before = Answer::outside;
    for (std::size_t i = first; i < last; ++i) {
      const Answer answer = part.at(points[i]);
      counts.add(i, answer, before);
      before = answer;
    }
    const std::scoped_lock lock(mutex);
    all.inside += counts.inside;
    all.unknown += counts.unknown;
    all.differing_low += counts.differing_low;
    all.differing_high += counts.differing_high;
  });
  return done ? std::optional(all.estimate(points.volume_each())) : std::nullopt;
}

}  // namespace meso::membership
