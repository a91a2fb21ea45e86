#include <cstdio>
#include <exception>
#include <new>

#include "tools/command.h"
#include "tools/verbs.h"

namespace {

int fail(const char* message, int code) {
  std::fprintf(stderr, "arete: %s\n", message);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Amplify, compress, mesh and draw real elevation data.", "arete");
  app.set_version_flag("--version", "arete " ARETE_VERSION);
  app.require_subcommand(1);

  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    return fail(error.what(), static_cast<int>(arete::ErrorKind::usage));
  } catch (const arete::Error& error) {
    return fail(error.what(), static_cast<int>(error.kind()));
  } catch (const std::bad_alloc&) {
    return fail("out of memory; give a smaller --memory", static_cast<int>(arete::ErrorKind::memory));
  } catch (const std::exception& error) {
    return fail(error.what(), 70);
  }
}
