#include "tools/command.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cctype>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <string_view>

#include <unistd.h>

namespace arete::tools {
namespace {

std::atomic<bool> interrupted{false};
// Whether a bar stands on the terminal's last line, which any other line must first wipe.
std::atomic<bool> bar_drawn{false};

void on_signal(int signal) {
  interrupted = true;
  std::signal(signal, SIG_DFL);
}

void wipe_bar() {
  if (bar_drawn.exchange(false)) std::fprintf(stderr, "\r\033[K");
}

std::string readable_seconds(double seconds) {
  const long whole = std::lround(std::ceil(seconds));
  if (whole < 60) return std::to_string(whole) + " s";
  char text[32];
  if (whole < 3600)
    std::snprintf(text, sizeof text, "%ld min %02ld s", whole / 60, whole % 60);
  else
    std::snprintf(text, sizeof text, "%ld h %02ld min", whole / 3600, whole / 60 % 60);
  return text;
}

class TerminalProgress final : public Progress {
 public:
  explicit TerminalProgress(bool visible) : visible_(visible) {
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
  }
  ~TerminalProgress() override { wipe_bar(); }

  void begin(const std::string& label, std::int64_t total) override {
    stop_if_asked();
    label_ = label;
    total_ = total;
    done_ = 0;
    start_ = last_ = Clock::now();
    draw();
  }
  void advance(std::int64_t done) override {
    stop_if_asked();
    done_ += done;
    const auto now = Clock::now();
    if (now - last_ < std::chrono::milliseconds(100)) return;
    last_ = now;
    draw();
  }
  void end() override { wipe_bar(); }

 private:
  using Clock = std::chrono::steady_clock;

  static void stop_if_asked() {
    if (interrupted) throw Error(ErrorKind::interrupted, "interrupted; the output was not written");
  }
  void draw() const {
    if (!visible_ || total_ <= 0) return;
    const double share = std::clamp(static_cast<double>(done_) / static_cast<double>(total_), 0.0, 1.0);
    const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
    std::string bar(static_cast<std::size_t>(share * 30), '=');
    bar.resize(30, ' ');
    std::fprintf(stderr, "\r\033[K%-24s [%s] %3.0f %%", label_.c_str(), bar.c_str(), std::floor(share * 100));
    if (share > 0.01 && elapsed > 0.5)
      std::fprintf(stderr, "  %s left", readable_seconds(elapsed * (1 - share) / share).c_str());
    std::fflush(stderr);
    bar_drawn = true;
  }

  bool visible_;
  std::string label_;
  std::int64_t total_ = 0, done_ = 0;
  Clock::time_point start_, last_;
};

std::int64_t physical_memory() {
  return static_cast<std::int64_t>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGE_SIZE);
}

constexpr std::int64_t least_memory = std::int64_t{64} << 20;

void add_common_options(CLI::App& verb, CommonOptions& common) {
  verb.add_option("--threads", common.threads, "Threads to use; default: one per core")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  verb.add_option("--memory", common.memory_bytes, "Memory to use, as 512M or 4G; default: a quarter of the machine's")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("SIZE");
  verb.add_option("--seed", common.seed, "Seed of every random choice; the same seed gives the same bytes; default: 1")
      ->type_name("N");
  verb.add_flag("--overwrite", common.overwrite, "Replace an output that exists");
  verb.add_flag("--quiet", common.quiet, "No progress bar and no warnings");
  verb.add_flag("--json", common.json, "Print the result as JSON");
  for (const char* name : {"--threads", "--memory", "--seed", "--overwrite", "--quiet", "--json"})
    verb.get_option(name)->group("Options of every verb");
}

std::string indent_lines(const std::string& text) {
  std::string indented = "  ";
  for (const char c : text) {
    indented += c;
    if (c == '\n') indented += "  ";
  }
  return indented;
}

}  // namespace

CLI::App* add_verb(CLI::App& app, const std::string& name, const std::string& description, const std::string& example,
                   std::shared_ptr<CommonOptions> common, std::function<void()> run) {
  CLI::App* verb = app.add_subcommand(name, description)->group("Verbs");
  verb->footer("Example:\n" + indent_lines(example));
  add_common_options(*verb, *common);
  verb->callback([common, run] {
    if (common->memory_bytes == 0) common->memory_bytes = std::max(physical_memory() / 4, least_memory);
    if (common->memory_bytes < least_memory)
      throw Error(ErrorKind::usage, "--memory: at least 64M is needed, found " + readable_bytes(common->memory_bytes));
    run();
  });
  return verb;
}

CLI::Validator above_zero() {
  const auto check = [](std::string& text) {
    double value = 0;
    const bool is_number = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
    return is_number && value > 0 ? std::string() : "a number above 0 is expected, found '" + text + "'";
  };
  return {check, "POSITIVE"};
}

std::unique_ptr<Progress> make_progress(const CommonOptions& common) {
  return std::make_unique<TerminalProgress>(!common.quiet && isatty(STDERR_FILENO) != 0);
}

void warn(const CommonOptions& common, const std::string& message) {
  if (common.quiet) return;
  wipe_bar();
  std::fprintf(stderr, "arete: warning: %s\n", message.c_str());
}

void print_result(const CommonOptions& common, const std::string& text, const nlohmann::json& data) {
  wipe_bar();
  if (common.json)
    // Names in a file may be in any encoding; JSON is UTF-8.
    std::cout << data.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
  else
    std::cout << text;
}

std::string readable_bytes(std::int64_t bytes) {
  constexpr const char* units[] = {"bytes", "KB", "MB", "GB", "TB"};
  auto value = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; value >= 1024 && unit + 1 < std::size(units); ++unit) value /= 1024;
  char text[32];
  std::snprintf(text, sizeof text, unit == 0 || value >= 100 ? "%.0f %s" : "%.1f %s", value, units[unit]);
  return text;
}

std::string quote_command_line(int argc, const char* const* argv) {
  std::string line;
  for (int i = 0; i < argc; ++i) {
    const std::string argument = i == 0 ? "arete" : argv[i];
    const bool plain = !argument.empty() && std::all_of(argument.begin(), argument.end(), [](unsigned char c) {
      return std::isalnum(c) != 0 || std::string_view("_-+=.,:/@%").find(static_cast<char>(c)) != std::string_view::npos;
    });
    if (i > 0) line += ' ';
    if (plain) {
      line += argument;
      continue;
    }
    line += '\'';
    for (const char c : argument) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

}  // namespace arete::tools
