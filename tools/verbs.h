#pragma once

#include <memory>

#include <CLI/CLI.hpp>

#include "tools/command.h"

namespace arete::tools {

// One file per verb: each adds its options and its action to the command line.
void add_learn(CLI::App& app, std::shared_ptr<CommonOptions> common);
void add_amplify(CLI::App& app, std::shared_ptr<CommonOptions> common);
void add_compare(CLI::App& app, std::shared_ptr<CommonOptions> common);
void add_preview(CLI::App& app, std::shared_ptr<CommonOptions> common);
void add_view(CLI::App& app, std::shared_ptr<CommonOptions> common);
void add_demo(CLI::App& app, std::shared_ptr<CommonOptions> common);
void add_compress(CLI::App& app, std::shared_ptr<CommonOptions> common);
void add_decompress(CLI::App& app, std::shared_ptr<CommonOptions> common);
void add_tin(CLI::App& app, std::shared_ptr<CommonOptions> common);
void add_sample(CLI::App& app, std::shared_ptr<CommonOptions> common);
void add_verify(CLI::App& app, std::shared_ptr<CommonOptions> common);
void add_bench(CLI::App& app, std::shared_ptr<CommonOptions> common);
void add_info(CLI::App& app, std::shared_ptr<CommonOptions> common);

}  // namespace arete::tools
