#include "core/codec/predict_residual.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/support/random.h"

namespace arete {
namespace {

struct Coded {
  ResidualContext context;
  std::int64_t residual;
};

std::vector<std::byte> encode(const std::vector<Coded>& list) {
  RangeEncoder coder;
  BitWriter bits{coder};
  ResidualModels models = initial_residual_models();
  for (const Coded& c : list) code_residual(bits, models, c.context, c.residual);
  return coder.finish();
}

ResidualContext context_of(std::uint64_t i) {
  ResidualContext context;
  const auto below = [&](std::uint64_t j, std::uint64_t end) { return static_cast<int>(hash_position(2, i, j) % end); };
  context.shift = below(0, 25);
  context.scale = below(1, residual_scales);
  context.lean = below(2, 16);
  context.beside = below(3, 16);
  context.relief = below(4, 256);
  context.wide = below(5, 24);
  context.turn = below(6, 9);
  context.phase = below(7, 3);
  return context;
}

TEST(PredictResidual, EveryResidualComesBack) {
  std::vector<Coded> list;
  const std::int64_t largest = (std::int64_t{1} << 32) - 1;
  for (std::int64_t r : {std::int64_t{0}, std::int64_t{1}, std::int64_t{19}, std::int64_t{20}, std::int64_t{21}, largest})
    for (std::uint64_t i = 0; i < 50; ++i) {
      list.push_back({context_of(i), r});
      list.push_back({context_of(i + 50), -r});
    }
  for (std::uint64_t i = 0; i < 5000; ++i) {
    const auto size = static_cast<int>(hash_position(1, i, 0) % 33);
    const auto r = static_cast<std::int64_t>(hash_position(1, i, 1) & ((std::uint64_t{1} << size) - 1));
    list.push_back({context_of(i), i % 2 != 0 ? r : -r});
  }
  const auto bytes = encode(list);
  RangeDecoder coder(bytes);
  BitReader bits{coder};
  ResidualModels models = initial_residual_models();
  for (const Coded& c : list) ASSERT_EQ(code_residual(bits, models, c.context, 0), c.residual);
}

// Two-sided geometric residuals: the code length is near their entropy once the models have learnt.
TEST(PredictResidual, CostsTheEntropyOfGeometricResiduals) {
  for (int shift : {0, 3}) {
    const double mean = shift == 0 ? 0.7 : 8;  // of the magnitude
    const double ratio = mean / (1 + mean);    // P(m) = (1 - ratio) ratio^m
    ResidualContext context;
    context.shift = shift;
    context.scale = 20;
    std::vector<Coded> list;
    double bits = 0;
    for (std::uint64_t i = 0; i < 100000; ++i) {
      const auto m = static_cast<std::int64_t>(std::log(1 - uniform_at(3, i, 0)) / std::log(ratio));
      bits += -std::log2((1 - ratio) * std::pow(ratio, static_cast<double>(m))) + (m != 0);
      list.push_back({context, uniform_at(3, i, 1) < 0.5 ? m : -m});
    }
    EXPECT_LT(8.0 * static_cast<double>(encode(list).size()), 1.01 * bits) << shift;
  }
}

// What the trained states must have learned: the larger the magnitude that is expected, the rarer a zero.
TEST(PredictResidual, ZerosGrowRareWithTheExpectedMagnitude) {
  const ResidualModels& models = initial_residual_models();
  for (std::size_t scale = 8; scale + 4 < residual_scales; scale += 4)
    EXPECT_GT(models.by_scale[0][scale + 4].p(), models.by_scale[0][scale].p()) << scale;
}

// A prediction that was rounded up is likely to be too high, the more so the less is expected.
TEST(PredictResidual, SignsFollowTheRounding) {
  const ResidualModels& models = initial_residual_models();
  for (std::size_t scale : {3U, 4U, 5U, 6U}) {
    EXPECT_GT(models.sign_by_lean[2 * 8 + scale].p(), 40000U) << scale;
    EXPECT_LT(models.sign_by_lean[14 * 8 + scale].p(), 25536U) << scale;
  }
}

TEST(PredictResidual, TheWholeTableIsRead) {
  for (std::int32_t weight : initial_residual_models().sign_mixer.weights) EXPECT_NE(weight, 0);
}

// The same residuals again cost less.
TEST(PredictResidual, ModelsOfTheCallerKeepWhatTheyLearn) {
  std::vector<Coded> list;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    ResidualContext context = context_of(i % 3);
    context.shift = 0;
    list.push_back({context, static_cast<std::int64_t>(i % 3) * 3 - 2});
  }
  ResidualModels models = initial_residual_models();
  const auto cost = [&] {
    RangeEncoder coder;
    BitWriter bits{coder};
    for (const Coded& c : list) code_residual(bits, models, c.context, c.residual);
    return coder.finish().size();
  };
  const std::size_t first = cost();
  EXPECT_LT(cost(), first);
}

TEST(PredictResidual, QuarterLogarithms) {
  EXPECT_EQ(quarter_log2(1), 0);
  EXPECT_EQ(quarter_log2(2), 4);
  EXPECT_EQ(quarter_log2(3), 6);
  EXPECT_EQ(quarter_log2(4), 8);
  EXPECT_EQ(quarter_log2(5), 9);
  EXPECT_EQ(quarter_log2(7), 11);
  EXPECT_EQ(quarter_log2(std::uint64_t{0xffffffff}), 127);
  for (std::uint64_t v = 1; v < 5000; ++v) {
    EXPECT_LE(quarter_log2(v), 4 * std::log2(static_cast<double>(v)) + 1e-9);
    EXPECT_GT(quarter_log2(v), 4 * std::log2(static_cast<double>(v)) - 1.4);
  }
}

TEST(PredictResidual, ExpGolombNumbersComeBack) {
  RangeEncoder coder;
  BitWriter out{coder};
  const std::vector<std::uint64_t> values = {0, 1, 2, 3, 100, 65535, 0xfffffffe};
  for (std::uint64_t v : values) code_exp_golomb(out, v);
  const auto bytes = coder.finish();
  RangeDecoder decoder(bytes);
  BitReader in{decoder};
  for (std::uint64_t v : values) EXPECT_EQ(code_exp_golomb(in, 0), v);
}

}  // namespace
}  // namespace arete
