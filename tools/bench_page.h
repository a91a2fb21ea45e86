#pragma once

#include <string>
#include <vector>

#include "gis/line_plot.h"
#include "tools/bench_data.h"
#include "tools/report.h"

namespace arete::tools {

/// PSNR over bits per sample, a curve per codec. The axis begins a little below the anchor's curve: what is worse leaves the picture.
LinePlot psnr_plot(const BenchedDem& dem);

/// Largest error over bits per sample: whole lines where a codec was asked for a rate, dashed where for that error.
LinePlot max_error_plot(const BenchedDem& dem);

/// Bits per sample over the strict error asked for, a curve per codec that can promise one.
LinePlot bound_plot(const BenchedDem& dem);

/// Tables, plots and differences, with what they mean.
Report bench_page(const std::vector<BenchedDem>& dems, const std::string& command_line);

}  // namespace arete::tools
