#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <memory>
#include <new>
#include <string>

#include "tools/command.h"
#include "tools/completion.h"
#include "tools/help.h"
#include "tools/manual.h"
#include "tools/verbs.h"

namespace {

constexpr int internal_error = 70;  // EX_SOFTWARE of sysexits.h

int fail(const std::string& where, std::string message, int code) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::fprintf(stderr, "%s: %s\n", where.c_str(), message.c_str());
  return code;
}

bool is_verb(const CLI::App& app, const std::string& name) {
  const auto verbs = app.get_subcommands([&](const CLI::App* verb) { return verb->get_name() == name; });
  return !verbs.empty();
}

std::string list_verbs(const CLI::App& app) {
  std::string names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App* verb) { return !verb->get_group().empty(); }))
    names += (names.empty() ? "" : ", ") + verb->get_name();
  return names;
}

/// Runs the verb that the command line names; the exit code.
int run(CLI::App& app, int argc, char** argv) {
  const std::string first = argc > 1 ? argv[1] : "";
  const std::string where = is_verb(app, first) ? "arete " + first : "arete";
  const int usage = static_cast<int>(arete::ErrorKind::usage);
  if (first.empty()) return fail(where, "a verb is needed: " + list_verbs(app) + "; see 'arete --help'", usage);
  if (first[0] != '-' && where == "arete")
    return fail(where, "unknown verb '" + first + "', expected one of: " + list_verbs(app) + "; see 'arete --help'", usage);
  if (first[0] == '-' && app.get_option_no_throw(first) == nullptr)
    return fail(where, "unknown option '" + first + "'; options come after the verb; see 'arete --help'", usage);
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    return fail(where, std::string(error.what()) + "; see '" + where + " --help'", usage);
  } catch (const arete::Error& error) {
    return fail(where, error.what(), static_cast<int>(error.kind()));
  } catch (const std::bad_alloc&) {
    return fail(where, "out of memory; give a smaller --memory", static_cast<int>(arete::ErrorKind::memory));
  } catch (const std::exception& error) {
    return fail(where, std::string("internal error: ") + error.what(), internal_error);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Make real elevation data finer, store it small, compare it and draw it.", "arete");
  app.formatter(std::make_shared<arete::tools::HelpFormatter>());
  app.set_version_flag("--version", "arete " ARETE_VERSION, "Print the version");
  app.set_help_flag("-h,--help", "Print this help");
  app.require_subcommand(1);
  app.footer("'arete VERB --help' explains a verb and gives an example.");

  const auto common = std::make_shared<arete::tools::CommonOptions>();
  common->command_line = arete::tools::quote_command_line(argc, argv);
  arete::tools::add_learn(app, common);
  arete::tools::add_amplify(app, common);
  arete::tools::add_demo(app, common);
  arete::tools::add_compare(app, common);
  arete::tools::add_preview(app, common);
  arete::tools::add_view(app, common);
  arete::tools::add_compress(app, common);
  arete::tools::add_decompress(app, common);
  arete::tools::add_tin(app, common);
  arete::tools::add_sample(app, common);
  arete::tools::add_verify(app, common);
  arete::tools::add_bench(app, common);
  arete::tools::add_info(app, common);
  arete::tools::add_completion(app);
  arete::tools::add_manual(app);

  const int code = run(app, argc, argv);
  std::cout.flush();
  if (code == 0 && (!std::cout || std::fflush(stdout) != 0))
    return fail("arete", "standard output: cannot write; is the disk full?", static_cast<int>(arete::ErrorKind::disk));
  return code;
}
