# arete_tree: the tree's file, its coders and what they need, nothing else. For programs that are built with other compilers or
# flags than the rest (scripts/fuzz, scripts/compare-compilers); whoever has arete_core has all of it there. The patch coder's encoder
# learns with core/sparse, which takes as long to build as all the rest: it is left out, and so must be those functions, by the linker.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(ZLIB REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(OPENBLAS REQUIRED IMPORTED_TARGET openblas)
pkg_check_modules(HWY REQUIRED IMPORTED_TARGET libhwy)

file(GLOB ARETE_TREE_SOURCES CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/core/codec/*.cpp
  ${PROJECT_SOURCE_DIR}/core/support/*.cpp
  ${PROJECT_SOURCE_DIR}/core/tree/*.cpp)
foreach(name sparse/patch_grid terrain/fill_voids terrain/flat_water terrain/georeference terrain/value_type)
  list(APPEND ARETE_TREE_SOURCES ${PROJECT_SOURCE_DIR}/core/${name}.cpp)
endforeach()
add_library(arete_tree STATIC ${ARETE_TREE_SOURCES})
target_include_directories(arete_tree PUBLIC ${PROJECT_SOURCE_DIR})
set_source_files_properties(${PROJECT_SOURCE_DIR}/core/codec/patch_coder.cpp TARGET_DIRECTORY arete_tree PROPERTIES COMPILE_OPTIONS "-ffunction-sections;${ARETE_WITHOUT_COVERAGE}")
target_link_options(arete_tree INTERFACE -Wl,--gc-sections)
target_link_libraries(arete_tree
  PUBLIC Eigen3::Eigen
  PRIVATE TBB::tbb PkgConfig::HWY PkgConfig::OPENBLAS ZLIB::ZLIB)
