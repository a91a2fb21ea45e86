#include "gis/gdal_errors.h"

#include <gtest/gtest.h>

namespace arete {
namespace {

TEST(GdalErrors, KeepsTheFirstFailureInOneLineAndPrintsNothing) {
  testing::internal::CaptureStderr();
  {
    GdalErrors errors;
    EXPECT_EQ(errors.suffix(), "");
    CPLError(CE_Warning, CPLE_AppDefined, "look out");
    EXPECT_FALSE(errors.failed());
    EXPECT_EQ(errors.message(), "look out");
    CPLError(CE_Failure, CPLE_FileIO, "%s", "it broke\n  at byte 7.\n");
    CPLError(CE_Failure, CPLE_AppDefined, "a later one");
    EXPECT_TRUE(errors.failed());
    EXPECT_EQ(errors.number(), CPLE_FileIO);
    EXPECT_EQ(errors.suffix(), ": it broke at byte 7");
    GdalErrors inner;
    CPLError(CE_Failure, CPLE_AppDefined, "inside");
    EXPECT_EQ(inner.message(), "inside");
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace arete
