#include "core/amplify/amplify.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/amplify/amplified_terrain.h"
#include "core/amplify/consistent_stage.h"
#include "core/amplify/paper_stage.h"
#include "core/support/error.h"
#include "tests/core/amplify/sample_dictionary.h"

namespace arete {
namespace {

/// Keeps every band, and checks that each cell comes once.
class BandSink final : public RasterSink {
 public:
  BandSink(Size size, int bands) {
    for (int b = 0; b < bands; ++b) {
      cells.emplace_back(size.width, size.height);
      times.emplace_back(size.width, size.height, std::uint8_t{0});
    }
  }
  void write(int band, const Window& window, RasterView<const float> from) override {
    auto& to = cells.at(static_cast<std::size_t>(band));
    for (std::int64_t y = 0; y < window.height; ++y)
      for (std::int64_t x = 0; x < window.width; ++x) {
        to(window.x + x, window.y + y) = from(x, y);
        ++times[static_cast<std::size_t>(band)](window.x + x, window.y + y);
      }
    ++windows;
  }
  bool complete() const {
    for (const auto& t : times)
      for (std::int64_t i = 0; i < t.size().cells(); ++i)
        if (t.data()[i] != 1) return false;
    return true;
  }
  std::vector<Raster<float>> cells;
  std::vector<Raster<std::uint8_t>> times;
  int windows = 0;
};

const Dictionary& dictionary_for(int factor) {
  static std::map<int, Dictionary> learned;
  if (!learned.contains(factor)) learned[factor] = fractal_dictionary(factor);
  return learned[factor];
}

/// Hills by the sea, with voids.
Raster<float> input() {
  Raster<float> cells = fractal_terrain(83, 71, 7, 2, -100, 500);
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) cells.data()[i] = std::max(cells.data()[i], 0.0f);
  make_void(cells, {30, 20, 7, 9});
  make_void(cells, {0, 60, 5, 11});
  return cells;
}

BandSink run(const Raster<float>& terrain, int dictionary_factor, const AmplifyOptions& options) {
  BandSink sink({terrain.width() * options.factor, terrain.height() * options.factor}, 1 + options.uncertainty + 2 * options.sources);
  NoProgress silent;
  amplify(ViewSource(terrain.view()), dictionary_for(dictionary_factor), options, sink, silent);
  EXPECT_TRUE(sink.complete());
  return sink;
}

TEST(Amplify, NeitherMemoryNorThreadsChangeAByte) {
  struct Case {
    int dictionary_factor, factor;
    AmplifyMethod method;
    bool bands;
  };
  for (const Case& c : {Case{2, 2, AmplifyMethod::consistent, false}, Case{3, 3, AmplifyMethod::consistent, false},
                        Case{4, 4, AmplifyMethod::consistent, true}, Case{5, 5, AmplifyMethod::consistent, false},
                        Case{2, 4, AmplifyMethod::consistent, true}, Case{4, 16, AmplifyMethod::consistent, false},
                        Case{4, 4, AmplifyMethod::paper, false}, Case{2, 4, AmplifyMethod::paper, false}}) {
    const Raster<float> terrain = c.factor == 16 ? cut_window(input().view(), {10, 8, 34, 30}) : input();
    AmplifyOptions options;
    options.method = c.method;
    options.factor = c.factor;
    options.sparsity = c.factor == 3 ? 2 : 1;
    options.uncertainty = options.sources = c.bands;
    options.threads = 1;
    const BandSink expected = run(terrain, c.dictionary_factor, options);
    EXPECT_EQ(expected.windows, static_cast<int>(expected.cells.size()));
    const struct {
      std::int64_t megabytes;
      int threads;
    } settings[] = {{28, 2}, {28, 7}, {64, 3}, {1024, 7}};
    for (const auto& s : settings) {
      options.memory_bytes = s.megabytes << 20;
      options.threads = s.threads;
      const BandSink found = run(terrain, c.dictionary_factor, options);
      for (std::size_t b = 0; b < found.cells.size(); ++b)
        EXPECT_TRUE(same_bits(found.cells[b].view(), expected.cells[b].view()))
            << "factor " << c.factor << " by " << c.dictionary_factor << " band " << b << " memory " << s.megabytes << " threads " << s.threads;
    }
  }
}

TEST(Amplify, ALittleMemoryMeansManyWindows) {
  AmplifyOptions options;
  options.factor = 16;
  options.detail = 0;
  options.memory_bytes = std::int64_t{24} << 20;
  const Raster<float> terrain = input();
  EXPECT_GT(run(terrain, 4, options).windows, 4);
}

TEST(Amplify, StagesAreTheStageAppliedAgain) {
  for (const AmplifyMethod method : {AmplifyMethod::consistent, AmplifyMethod::paper}) {
    const Raster<float> terrain = cut_window(input().view(), {14, 10, 40, 33});
    AmplifyOptions options;
    options.method = method;
    options.factor = 8;
    options.detail = 0.7;
    const BandSink found = run(terrain, 2, options);
    const auto stage = method == AmplifyMethod::paper ? make_paper_stage(dictionary_for(2), {}) : make_consistent_stage(dictionary_for(2), {0.7, 1, 0, 0});
    Raster<float> cells = terrain.clone();
    for (int turn = 0; turn < 3; ++turn) {
      const ViewSource source(cells.view());
      cells = read_all(AmplifiedTerrain(source, *stage, 2));
    }
    EXPECT_TRUE(same_bits(found.cells[0].view(), cells.view()));
  }
}

TEST(Amplify, EveryStageIsConsistent) {
  AmplifyOptions options;
  options.factor = 16;
  const Raster<float> terrain = cut_window(input().view(), {10, 8, 34, 30});
  const BandSink found = run(terrain, 4, options);
  EXPECT_LT(largest_difference(area_average(found.cells[0].view(), 16).view(), terrain.view()), 1e-4);
}

void expect_error(const AmplifyOptions& options, Dictionary dictionary, ErrorKind kind, const std::string& advice) {
  const Raster<float> terrain = fractal_terrain(20, 20, 1);
  BandSink sink({1, 1}, 0);
  NoProgress silent;
  try {
    amplify(ViewSource(terrain.view()), std::move(dictionary), options, sink, silent);
    FAIL() << "no error; expected " << advice;
  } catch (const Error& e) {
    const std::string message = e.what();
    EXPECT_EQ(e.kind(), kind) << message;
    EXPECT_NE(message.find(advice), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_EQ(sink.windows, 0);
  }
}

TEST(Amplify, SaysWhatIsWrongAndWhatToDo) {
  AmplifyOptions options;
  for (const int factor : {3, 8, 32}) {
    options.factor = factor;
    expect_error(options, dictionary_for(4), ErrorKind::usage, "learn with --factor " + std::to_string(factor));
  }
  for (const int factor : {1, 0, -4}) {
    options.factor = factor;
    expect_error(options, dictionary_for(4), ErrorKind::usage, "expected at least 2");
  }
  options = {};
  for (const double detail : {-0.01, 1.01, std::nan("")}) {
    options.detail = detail;
    expect_error(options, dictionary_for(4), ErrorKind::usage, "0 (least error) to 1 (natural)");
  }
  options = {};
  options.sparsity = 0;
  expect_error(options, dictionary_for(4), ErrorKind::usage, "at least 1");
  options = {};
  options.pitch = 3;
  expect_error(options, dictionary_for(4), ErrorKind::usage, "divisor of the patch");
  options = {};
  options.uncertainty = true;
  options.method = AmplifyMethod::paper;
  expect_error(options, dictionary_for(4), ErrorKind::usage, "--method consistent");
  options = {};
  Dictionary one_resolution = dictionary_for(4);
  one_resolution.factor = 1;
  expect_error(options, one_resolution, ErrorKind::usage, "learn with --factor 4");
}

TEST(Amplify, BandsThatNeedAtomsAreRefusedWithoutThem) {
  Dictionary linear = dictionary_for(4);
  linear.detail.resize(0, 0);
  AmplifyOptions options;
  options.detail = 0;
  for (const bool sources : {false, true}) {
    options.sources = sources;
    options.uncertainty = !sources;
    expect_error(options, linear, ErrorKind::input, "--factor");
  }
}

// The budget that the message asks for is enough, a little less is not.
TEST(Amplify, TooLittleMemoryIsRefusedWithTheLeastThatWorks) {
  AmplifyOptions options;
  options.memory_bytes = std::int64_t{1} << 20;
  const Raster<float> terrain = fractal_terrain(20, 20, 1);
  BandSink sink({80, 80}, 1);
  NoProgress silent;
  std::string message;
  try {
    amplify(ViewSource(terrain.view()), dictionary_for(4), options, sink, silent);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::memory);
    message = e.what();
  }
  const std::size_t at = message.find("--memory ");
  ASSERT_NE(at, std::string::npos) << message;
  const std::int64_t least = std::stoll(message.substr(at + 9));
  options.memory_bytes = least << 20;
  EXPECT_NO_THROW(amplify(ViewSource(terrain.view()), dictionary_for(4), options, sink, silent)) << message;
  options.memory_bytes = (least - 2) << 20;
  EXPECT_THROW(amplify(ViewSource(terrain.view()), dictionary_for(4), options, sink, silent), Error);
}

TEST(Amplify, CountsStages) {
  EXPECT_EQ(count_stages(4, 4), 1);
  EXPECT_EQ(count_stages(256, 4), 4);
  EXPECT_EQ(count_stages(27, 3), 3);
  EXPECT_THROW(count_stages(256, 3), Error);
  EXPECT_THROW(count_stages(2147483647, 2), Error);
}

/// What amplify() finds out about an input, without much work.
AmplifyReport judge(const Raster<float>& terrain, double beta_of_exemplar, BandSink& sink, AmplifyOptions options = {}) {
  NoProgress silent;
  options.factor = 2;
  return amplify(ViewSource(terrain.view()), fractal_dictionary(2, 1, beta_of_exemplar), options, sink, silent);
}

TEST(Amplify, NoticesAnExemplarUnlikeTheInput) {
  BandSink sink({192, 192}, 1);
  const AmplifyReport rough_exemplar = judge(fractal_terrain(96, 96, 41, 3), 1.3, sink);
  EXPECT_TRUE(rough_exemplar.unlike);
  EXPECT_LT(rough_exemplar.likeness, 1 / most_unlike);
  EXPECT_NEAR(rough_exemplar.detail_scale, std::sqrt(rough_exemplar.likeness), 1e-12);
  BandSink again({192, 192}, 1);
  const AmplifyReport smooth_exemplar = judge(fractal_terrain(96, 96, 42, 1.3), 3, again);
  EXPECT_TRUE(smooth_exemplar.unlike);
  EXPECT_GT(smooth_exemplar.detail_scale, 1);
}

TEST(Amplify, DoesNotMindOneOfTheSameKind) {
  for (const std::uint64_t seed : {51u, 52u, 53u})
    for (const double beta : {1.7, 2.0, 2.3}) {
      BandSink sink({192, 192}, 1);
      const AmplifyReport report = judge(fractal_terrain(96, 96, seed, beta), beta, sink);
      EXPECT_FALSE(report.unlike) << report.likeness;
      EXPECT_NEAR(std::log2(report.likeness), 0, 0.6);
      EXPECT_EQ(report.detail_scale, 1);
    }
}

TEST(Amplify, DoesNotJudgeWhatIsTooSmall) {
  BandSink sink({40, 40}, 1);
  const AmplifyReport report = judge(fractal_terrain(20, 20, 61, 3), 1.3, sink);
  EXPECT_FALSE(report.unlike);
  EXPECT_EQ(report.likeness, 0);
  EXPECT_EQ(report.detail_scale, 1);
}

// The uncertainty knows what the judge found: calibrated on an input that is smoother than the exemplar, with and without detail.
TEST(Amplify, TheUncertaintyFollowsTheInputNotTheExemplar) {
  const Raster<float> truth = fractal_terrain(192, 192, 43, 3), coarse = area_average(truth.view(), 2);
  for (const double detail : {0.0, 1.0}) {
    AmplifyOptions options;
    options.detail = detail;
    options.uncertainty = true;
    BandSink sink({192, 192}, 2);
    EXPECT_TRUE(judge(coarse, 1.3, sink, options).unlike);
    double sum = 0;
    std::int64_t cells = 0;
    for (std::int64_t y = 12; y < 180; ++y)
      for (std::int64_t x = 12; x < 180; ++x, ++cells)
        sum += std::pow(static_cast<double>(sink.cells[0](x, y) - truth(x, y)) / static_cast<double>(sink.cells[1](x, y)), 2);
    EXPECT_GT(sum / static_cast<double>(cells), 1.0 / 3) << detail;
    EXPECT_LT(sum / static_cast<double>(cells), 3) << detail;
  }
}

}  // namespace
}  // namespace arete
