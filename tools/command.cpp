#include "tools/command.h"

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <iostream>

#include <unistd.h>

namespace arete::tools {
namespace {

std::atomic<bool> interrupted{false};

void on_signal(int) { interrupted = true; }

class TerminalProgress final : public Progress {
 public:
  explicit TerminalProgress(bool visible) : visible_(visible) {
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
  }
  ~TerminalProgress() override { clear(); }

  void begin(const std::string& label, std::int64_t total) override {
    label_ = label;
    total_ = total;
    done_ = 0;
    start_ = last_ = Clock::now();
    draw();
  }
  void advance(std::int64_t done) override {
    done_ += done;
    if (interrupted) throw Error(ErrorKind::interrupted, "interrupted: nothing was written");
    const auto now = Clock::now();
    if (now - last_ < std::chrono::milliseconds(100)) return;
    last_ = now;
    draw();
  }
  void end() override { clear(); }

 private:
  using Clock = std::chrono::steady_clock;

  void draw() {
    if (!visible_ || total_ <= 0) return;
    const double share = std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_));
    const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
    const int filled = static_cast<int>(share * 30);
    std::string bar(static_cast<std::size_t>(filled), '=');
    bar.resize(30, ' ');
    std::fprintf(stderr, "\r\033[K%-24s [%s] %3.0f %%", label_.c_str(), bar.c_str(), share * 100);
    if (share > 0.01 && elapsed > 0.5) std::fprintf(stderr, "  %.0f s left", elapsed * (1 - share) / share);
    std::fflush(stderr);
    drawn_ = true;
  }
  void clear() {
    if (drawn_) std::fprintf(stderr, "\r\033[K");
    drawn_ = false;
  }

  bool visible_;
  bool drawn_ = false;
  std::string label_;
  std::int64_t total_ = 0, done_ = 0;
  Clock::time_point start_, last_;
};

std::int64_t physical_memory() {
  return static_cast<std::int64_t>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGE_SIZE);
}

}  // namespace

CLI::App* add_verb(CLI::App& app, const std::string& name, const std::string& description, const std::string& example,
                   std::shared_ptr<CommonOptions> common, std::function<void()> run) {
  CLI::App* verb = app.add_subcommand(name, description);
  verb->footer("Example:\n  " + example);
  verb->add_flag("--json", common->json, "Print the result as JSON");
  verb->add_flag("--quiet", common->quiet, "No progress bar and no warning");
  verb->add_flag("--overwrite", common->overwrite, "Replace an output that exists");
  verb->add_option("--threads", common->threads, "Threads to use (default: one per core)")->check(CLI::Range(1, 1024));
  verb->add_option("--memory", common->memory_bytes, "Memory budget, as 512M or 4G (default: a quarter of the machine)")
      ->transform(CLI::AsSizeValue(false));
  verb->add_option("--seed", common->seed, "Seed of every random choice (default: 1)");
  verb->callback([common, run] {
    if (common->memory_bytes == 0) common->memory_bytes = physical_memory() / 4;
    run();
  });
  return verb;
}

std::unique_ptr<Progress> make_progress(const CommonOptions& common) {
  return std::make_unique<TerminalProgress>(!common.quiet && isatty(STDERR_FILENO) != 0);
}

void print_result(const CommonOptions& common, const std::string& text, const nlohmann::json& data) {
  if (common.json)
    std::cout << data.dump(2) << '\n';
  else
    std::cout << text;
}

}  // namespace arete::tools
