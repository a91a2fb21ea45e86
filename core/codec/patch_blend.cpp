#include "core/codec/patch_blend.h"

#include <algorithm>
#include <limits>

#include "core/codec/patch_weights.h"
#include "core/support/parallel.h"

namespace arete {

// The cells of a block of R x R cells, along one axis, that a window of a level asks for.
struct DiscBlend::Span {
  std::int64_t first;  // within the block
  std::int64_t count, step;
  std::int64_t out;  // where the first goes in the window
};

struct DiscBlend::Sums {
  std::vector<std::int64_t> means, details;
};

namespace {

std::int64_t ceil_shift(std::int64_t value, int shift) { return (value + (std::int64_t{1} << shift) - 1) >> shift; }

}  // namespace

DiscBlend::DiscBlend(const PatchParameters& parameters)
    : atoms_(parameters.atoms),
      radius_(parameters.radius),
      base_(static_cast<double>(parameters.base)),
      mean_quantum_(static_cast<double>(parameters.mean_quantum)),
      coefficient_quantum_(static_cast<double>(parameters.coefficient_quantum)),
      weights_(integer_disc_weights(2 * radius_)),
      totals_(static_cast<std::size_t>(radius_ * radius_)) {
  const int m = 2 * radius_;
  for (int y = 0; y < m; ++y)
    for (int x = 0; x < m; ++x)
      totals_[static_cast<std::size_t>(y % radius_ * radius_ + x % radius_)] += weights_[static_cast<std::size_t>(y * m + x)];
}

PatchRange DiscBlend::discs_reaching(std::int64_t begin, std::int64_t end, int level) const {
  return patches_touching(PatchGrid{2 * radius_, radius_, {}}, begin << level, ((end - 1) << level) + 1);
}

float DiscBlend::value(std::int64_t mean_sum, std::int64_t detail_sum, std::int64_t weight) const {
  const double means = static_cast<double>(mean_sum) * mean_quantum_;
  const double details = static_cast<double>(detail_sum) * (2 * coefficient_quantum_);
  const double relief = (means + details) / static_cast<double>(weight);
  constexpr double most = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(base_ + relief, -most, most));
}

// `corner`: index of the block's first cell in the disc's square.
void DiscBlend::add_disc(const DiscView& disc, const Span& columns, const Span& rows, std::int64_t corner, Sums& sums) const {
  const int m = 2 * radius_;
  const auto add = [&](const auto* cells, std::int64_t factor, std::vector<std::int64_t>& to) {
    std::int64_t* at = to.data();
    for (std::int64_t y = 0; y < rows.count; ++y) {
      const auto* from = cells + corner + (rows.first + y * rows.step) * m + columns.first;
      for (std::int64_t x = 0; x < columns.count; ++x) *at++ += factor * from[x * columns.step];
    }
  };
  if (disc.mean != 0) add(weights_.data(), disc.mean, sums.means);
  for (const DiscTerm& term : disc.terms) add(atoms_.atom(term.atom), term.coefficient, sums.details);
}

void DiscBlend::evaluate(int level, const Window& window, const std::function<DiscView(std::int64_t, std::int64_t)>& disc_at, RasterView<float> out,
                         int threads) const {
  const auto span_of = [&](std::int64_t block, std::int64_t begin, std::int64_t count) {
    const std::int64_t first = std::max(ceil_shift(block * radius_, level), begin);
    const std::int64_t last = std::min(ceil_shift((block + 1) * radius_, level), begin + count);
    return Span{(first << level) - block * radius_, std::max<std::int64_t>(0, last - first), std::int64_t{1} << level, first - begin};
  };
  const PatchRange rows = discs_reaching(window.y, window.y + window.height, level), columns = discs_reaching(window.x, window.x + window.width, level);
  // Over block b lie the discs b and b + 1.
  parallel_for(rows.count() - 1, threads, [&](std::int64_t r) {
    const std::int64_t by = rows.begin + r;
    const Span down = span_of(by, window.y, window.height);
    if (down.count == 0) return;
    Sums sums;
    for (std::int64_t bx = columns.begin; bx < columns.end - 1; ++bx) {
      const Span across = span_of(bx, window.x, window.width);
      const auto cells = static_cast<std::size_t>(across.count * down.count);
      if (cells == 0) continue;
      sums.means.assign(cells, 0);
      sums.details.assign(cells, 0);
      for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i)
          add_disc(disc_at(bx + i, by + j), across, down, (1 - j) * std::int64_t{radius_} * 2 * radius_ + (1 - i) * radius_, sums);
      for (std::int64_t y = 0; y < down.count; ++y)
        for (std::int64_t x = 0; x < across.count; ++x) {
          const auto at = static_cast<std::size_t>(y * across.count + x);
          const std::int64_t total = (down.first + y * down.step) * radius_ + across.first + x * across.step;
          out(across.out + x, down.out + y) = value(sums.means[at], sums.details[at], totals_[static_cast<std::size_t>(total)]);
        }
    }
  });
}

}  // namespace arete
