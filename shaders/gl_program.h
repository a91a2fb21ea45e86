#pragma once

#include <string>
#include <vector>

namespace arete {

/// The GLSL text of a file of this folder ("terrain.vert"), built into the library; nullptr where there is none.
const char* stage_text(const std::string& name);

/// Compiles and links stages by file name; the extension says which stage. A line #include "light.glsl" stands for that file. `captured`: outputs that
/// transform feedback records, interleaved. `defined`: a word that #ifdef sees in all stages. The context must be current; the caller deletes the program.
/// Throws Error{format} with the driver's words.
unsigned link_program(const std::vector<std::string>& stages, const std::vector<const char*>& captured = {}, const std::string& defined = {});

}  // namespace arete
