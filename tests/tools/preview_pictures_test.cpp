// Reference pictures of every view and option, in tests/golden/pictures: a picture that looks different fails. Look at both, and if the new one is meant,
// ARETE_UPDATE_PICTURES=1 writes it in place of the old one.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <ostream>
#include <stdexcept>
#include <string>
#include <utility>

#include "gis/image.h"
#include "tests/shaders/mesa.h"
#include "tests/tools/picture_difference.h"
#include "tests/tools/verb_fixture.h"

namespace arete {
namespace {

namespace fs = std::filesystem;

/// A picture: its name, what it shows, and how.
struct Reference {
  const char* name;
  const char* input;
  const char* options;
};
std::ostream& operator<<(std::ostream& out, const Reference& reference) { return out << reference.name; }

// To add a picture, add its line and run with ARETE_UPDATE_PICTURES=1. What is kept and compared is the lower left part, of 320 x 200 pixels.
constexpr Reference references[] = {
    {"top", "dem.tif", "--width 240"},
    {"top-azimuth", "dem.tif", "--width 240 --no-legend --azimuth 250"},
    {"top-exaggeration", "dem.tif", "--width 240 --no-legend --exaggeration 4"},
    {"top-hypsometric", "dem.tif", "--width 240 --ramp hypsometric"},
    {"top-viridis", "dem.tif", "--width 240 --no-legend --ramp viridis"},
    {"top-grey", "dem.tif", "--width 240 --no-legend --ramp grey"},
    {"top-mesh", "mesh.ply", "--width 240 --no-legend"},
    {"top-mesh-no-wireframe", "mesh.ply", "--width 240 --no-legend --no-wireframe"},
    {"top-slope-contours", "dem.tif", "--width 240 --colour slope --contours=auto"},
    {"top-aspect", "dem.tif", "--width 240 --colour aspect"},
    {"profile", "dem.tif", "--view profile --width 500"},
    {"profile-line", "dem.tif", "--view profile --width 500 --line 500200,4599900,503000,4598300 --exaggeration 0.5 --ramp hypsometric"},
    {"perspective", "dem.tif", "--view perspective --size 320x102"},
    {"perspective-look-from", "dem.tif", "--view perspective --size 240x150 --no-legend --look-from 60 --pitch 60 --fov 50"},
    {"perspective-distance", "dem.tif", "--view perspective --size 240x150 --no-legend --distance 3500 --ramp hypsometric"},
    {"perspective-look-at", "dem.tif", "--view perspective --size 240x150 --no-legend --look-at 502400,4599100 --distance 2500 --pitch 25"},
    {"perspective-eye", "dem.tif", "--view perspective --size 240x150 --no-legend --eye 500400,4598400,+150 --look-at 502400,4599200 --fov 60"},
    {"perspective-turntable-001", "dem.tif", "--view perspective --size 240x150 --no-legend --turntable 3"},
    {"perspective-azimuth", "dem.tif", "--view perspective --size 240x150 --no-legend --azimuth 60"},
    {"perspective-exaggeration", "dem.tif", "--view perspective --size 240x150 --no-legend --exaggeration 2 --ramp viridis"},
    {"perspective-wireframe", "dem.tif", "--view perspective --size 240x150 --no-legend --style wireframe --pixel-error 8"},
    {"perspective-levels", "dem.tif", "--view perspective --size 240x150 --style levels"},
    {"perspective-slope-contours", "dem.tif", "--view perspective --size 320x102 --colour slope --contours=100"},
    {"perspective-aspect", "dem.tif", "--view perspective --size 320x102 --colour aspect"},
    {"perspective-drape", "dem.tif", "--view perspective --size 240x150 --no-legend --drape FOLDER/squares.tif"},
    {"perspective-mesh", "mesh.ply", "--view perspective --size 240x150 --no-legend"},
    {"perspective-mesh-wireframe", "mesh.ply", "--view perspective --size 240x150 --no-legend --style wireframe --colour slope"},
};

/// What is kept of a picture.
Picture lower_left(const Picture& picture) {
  Picture part(std::min<std::int64_t>(320, picture.width()), std::min<std::int64_t>(200, picture.height()));
  paste(part, picture, 0, part.height() - picture.height());
  return part;
}

class PreviewPictures : public VerbFixture, public testing::WithParamInterface<Reference> {
 protected:
  void SetUp() override {
    VerbFixture::SetUp();
    hold_mesa_still();
    if (find_font().empty()) GTEST_SKIP() << "no font; install fonts-dejavu-core";
    write_island();
  }

  /// Mountains of 30 m cells with a sea in the south-west and a void of 18 x 12 cells.
  void write_island() const {
    const Size size{120, 60};
    Raster<float> cells = synthesize_mountains(size, {.relief_m = 900, .lowest_m = -150, .seed = 5});
    for (std::int64_t y = 0; y < size.height; ++y)
      for (std::int64_t x = 0; x < size.width; ++x) {
        cells(x, y) += static_cast<float>(2 * x - 4 * y);
        if (cells(x, y) < 0) cells(x, y) = 0;
        if (x >= 82 && x < 100 && y >= 20 && y < 32) cells(x, y) = void_value;
      }
    GeoReference geo;
    geo.transform = {500000, 30, 0, 4600000, 0, -30};
    geo.crs_wkt = crs_wkt("EPSG:32633");
    DemWriter writer(path("dem.tif"), size, geo);
    writer.write(0, {0, 0, size.width, size.height}, cells.view());
    writer.commit();
    // Squares of 300 m on the eastern two thirds, for --drape.
    Raster<float> squares(80, 60);
    for (std::int64_t y = 0; y < 60; ++y)
      for (std::int64_t x = 0; x < 80; ++x) squares(x, y) = static_cast<float>((x / 10 + y / 10) % 3);
    geo.transform = {500000 + 40 * 30, 30, 0, 4600000, 0, -30};
    DemWriter over(path("squares.tif"), {80, 60}, geo);
    over.write(0, {0, 0, 80, 60}, squares.view());
    over.commit();
  }

  /// Draws a reference with further options, and one of its own replaced, into the test's folder; false where there is no OpenGL to draw it with.
  bool draw(const Reference& reference, const std::string& further, Picture& picture, const std::pair<std::string, std::string>& instead = {}) const {
    const std::string name = reference.name, turntable = "-001";
    std::string options = reference.options;
    if (!instead.first.empty()) options.replace(options.find(instead.first), instead.first.size(), instead.second);
    const bool one_of_many = options.find("--turntable") != std::string::npos;
    const std::string stem = one_of_many ? name.substr(0, name.size() - turntable.size()) : name;
    if (const auto at = options.find("FOLDER"); at != std::string::npos) options.replace(at, 6, path(""));
    if (std::string(reference.input) == "mesh.ply") {
      const Outcome mesh = run("tin " + path("dem.tif") + " " + path("mesh.ply") + " --max-error 15");
      EXPECT_EQ(mesh.code, 0) << mesh.err;
    }
    const Outcome outcome = run("preview " + path(reference.input) + " " + path(stem + ".png") + " --overwrite " + options + " " + further);
    if (outcome.code == 3 && outcome.err.find("OpenGL") != std::string::npos) return false;
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    if (outcome.code == 0) picture = lower_left(read_picture(path(name + ".png")));
    return outcome.code == 0;
  }
  static std::string golden(const Reference& reference) { return std::string(ARETE_SOURCE_DIR) + "/tests/golden/pictures/" + reference.name + ".png"; }
  static const Reference& named(const std::string& name) {
    for (const Reference& reference : references)
      if (name == reference.name) return reference;
    throw std::invalid_argument(name);
  }
};

TEST_P(PreviewPictures, LooksAsItDid) {
  const Reference& reference = GetParam();
  Picture picture;
  const bool drawn = draw(reference, "", picture);
  if (HasFailure()) return;
  if (!drawn) GTEST_SKIP() << "no OpenGL";
  if (std::getenv("ARETE_UPDATE_PICTURES") != nullptr) return write_picture(golden(reference), picture, true);
  ASSERT_TRUE(fs::exists(golden(reference))) << "run with ARETE_UPDATE_PICTURES=1 and look at the picture";
  const double difference = picture_difference(read_picture(golden(reference)), picture);
  RecordProperty("difference", std::to_string(difference));
  if (difference < alike) return;
  const std::string kept = testing::TempDir() + "arete-" + reference.name + ".png";
  write_picture(kept, picture, true);
  FAIL() << "differs by " << difference << " from " << golden(reference) << ": see " << kept;
}

INSTANTIATE_TEST_SUITE_P(All, PreviewPictures, testing::ValuesIn(references), [](const auto& tested) {
  std::string name = tested.param.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

/// What must be seen, measured against the reference pictures.
using PreviewPicturesSee = PreviewPictures;

Picture shifted(const Picture& picture, std::int64_t dx, std::int64_t dy) {
  Picture moved(picture.width(), picture.height());
  paste(moved, picture, 0, 0);
  paste(moved, picture, dx, dy);
  return moved;
}

TEST_F(PreviewPicturesSee, EveryPictureThatIsKept) {
  std::uintmax_t bytes = 0, pictures = 0;
  for (const auto& entry : fs::directory_iterator(std::string(ARETE_SOURCE_DIR) + "/tests/golden/pictures")) {
    EXPECT_NO_THROW(named(entry.path().stem().string())) << entry.path() << " is drawn by no line of the table: remove it";
    bytes += entry.file_size(), ++pictures;
  }
  EXPECT_EQ(pictures, std::size(references));
  EXPECT_LT(bytes, 1'500'000u);  // of what everyone who clones the repository loads
}

TEST_F(PreviewPicturesSee, ASunThatMovedBy20Degrees) {
  Picture picture;
  ASSERT_TRUE(draw(named("top-azimuth"), "", picture, {"--azimuth 250", "--azimuth 270"}));
  EXPECT_GT(picture_difference(read_picture(golden(named("top-azimuth"))), picture), 2 * alike);
  if (!draw(named("perspective-azimuth"), "", picture, {"--azimuth 60", "--azimuth 40"})) GTEST_SKIP() << "no OpenGL";
  EXPECT_GT(picture_difference(read_picture(golden(named("perspective-azimuth"))), picture), 2 * alike);
}

TEST_F(PreviewPicturesSee, AMissingLegend) {
  for (const char* name : {"top", "perspective"}) {
    const Picture whole = read_picture(golden(named(name)));
    Picture view;
    if (!draw(named(name), "--no-legend", view)) continue;
    EXPECT_GT(picture_difference(whole, view), 5 * alike) << name;
    // The strip of 98 rows there, but blank.
    Picture blank = whole;
    fill(blank, {0, whole.height() - 98, whole.width(), 98}, {255, 255, 255, 255});
    EXPECT_GT(picture_difference(whole, blank), 5 * alike) << name;
  }
}

TEST_F(PreviewPicturesSee, AShiftOfTwoPixelsInEveryPicture) {
  for (const Reference& reference : references) {
    const Picture picture = read_picture(golden(reference));
    EXPECT_GT(picture_difference(picture, shifted(picture, 2, 0)), 1.5 * alike) << reference.name;
    EXPECT_GT(picture_difference(picture, shifted(picture, 0, -2)), 1.5 * alike) << reference.name;
  }
}

TEST_F(PreviewPicturesSee, NothingInHowARasteriserGoesAboutIt) {
  // Shaders compiled for other vectors.
  setenv("LP_NATIVE_VECTOR_WIDTH", "128", 1);
  Picture picture;
  const Reference& reference = named("perspective");
  if (!draw(reference, "", picture)) GTEST_SKIP() << "no OpenGL";
  EXPECT_LT(picture_difference(read_picture(golden(reference)), picture), 0.5 * alike);
}

}  // namespace
}  // namespace arete
