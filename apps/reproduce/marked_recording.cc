#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "apps/reproduce/marked_surface.h"
#include "apps/reproduce/prepared_recording.h"
#include "apps/workflow/comparison_options.h"
#include "apps/workflow/fit.h"
#include "calib/acoustic_fit.h"
#include "calib/noise/noise_fit.h"
#include "calib/selection/held_out_likelihood.h"
#include "core/types/error.h"
#include "data_io/open_recording.h"
#include "sim/physics/recorded_beam.h"

namespace sonarcal::reproduce {
namespace {

struct MarkedPing {
  Frame frame;
  FirstReturn marks;
};

std::vector<MarkedPing> ReadMarked(const RecordingSource& pings, const std::filesystem::path& marks,
                                   const std::string& suffix) {
  std::vector<MarkedPing> marked;
  for (int i = 0; i < pings.frame_count(); ++i) {
    const std::filesystem::path stem = std::filesystem::path(pings.frame_info(i).name).stem();
    const std::filesystem::path file = marks / (stem.string() + suffix);
    if (!std::filesystem::exists(file)) continue;
    MarkedPing ping{pings.ReadFrame(i), {}};
    ping.marks = ReadFirstReturn(file, ping.frame.image.axes);
    const auto is_marked = [](const std::optional<int>& mark) { return mark.has_value(); };
    if (std::count_if(ping.marks.begin(), ping.marks.end(), is_marked) >= 2)
      marked.push_back(std::move(ping));
  }
  return marked;
}

class SurfaceMaker {
 public:
  SurfaceMaker(const CasePlan& plan, std::filesystem::path folder, const PrepareOptions& options)
      : plan_(plan),
        surface_(std::get<MarkedSurfaceCase>(plan.study)),
        folder_(std::move(folder)),
        options_(options),
        pings_(data_io::OpenRecording(folder_ / surface_.pings)) {
    info_ = pings_->info();
    const std::filesystem::path marks = folder_ / surface_.marks;
    marked_ = ReadMarked(*pings_, marks, surface_.marks_suffix);
    const int wanted = surface_.frames_used + surface_.frames_held_out;
    if (static_cast<int>(marked_.size()) < wanted) {
      throw DataError("{}: {} marked pings, expected {}: {} to fit and {} to evaluate", marks.string(),
                      marked_.size(), wanted, surface_.frames_used, surface_.frames_held_out);
    }
    marked_.resize(wanted);
    Mask valid(info_.sonar.axes.range_bins, info_.sonar.axes.beam_count(), 1);
    for (int bin = 0; bin < std::min(surface_.blind_bins, valid.rows()); ++bin) {
      for (int beam = 0; beam < valid.cols(); ++beam) valid(bin, beam) = 0;
    }
    info_.valid = std::move(valid);
    for (std::size_t i = 0; i < marked_.size(); ++i) {
      Pose pose;
      pose.position_m.x() = surface_.apart_m * static_cast<double>(i);
      marked_[i].frame.info.world_from_sonar = pose;
    }
  }

  PreparedRecording Make() {
    ParameterSet parameters = Initial();
    double best = -std::numeric_limits<double>::infinity();
    double lean_deg = 0.0;
    double largest_deg = 0.0;
    std::string table;
    for (std::size_t i = 0; i < surface_.leans_deg.size(); i += options_.quick ? 3 : 1) {
      const double lean = surface_.leans_deg[i];
      largest_deg = lean;
      const auto [fitted, nats] = FitAt(lean, Initial());
      Say(fmt::format("leaning {:g} degrees: {:.4f} nats a pixel of the pings used", lean, nats));
      table += fmt::format("{}{:g}: {:.4f}", table.empty() ? "" : ", ", lean, nats);
      if (nats <= best) continue;
      best = nats;
      lean_deg = lean;
      parameters = fitted;
    }
    std::vector<Frame> frames;
    for (const MarkedPing& ping : marked_) frames.push_back(ping.frame);
    RecordingInfo info = info_;
    info.notes.emplace_back(fmt::format(
        "The marked pings of a folder, {:g} m apart so that each has a strip from marks of its own: "
        "positions are made up.",
        surface_.apart_m));
    std::vector<std::string> warnings;
    if (const auto at_end = LeanAtEnd(lean_deg, largest_deg)) warnings.push_back(*at_end);
    metrics::CompareOptions comparison;
    comparison.segmentation.method = surface_.segmentation;
    comparison.segmentation.background_law = std::make_shared<const metrics::BackgroundLaw>(
        workflow::BackgroundLawOf(parameters, info.sonar.axes, folder_.string()));
    std::vector<int> held_out(surface_.frames_held_out);
    std::iota(held_out.begin(), held_out.end(), surface_.frames_used);
    return {.title = plan_.title,
            .recording = std::make_unique<MemoryRecording>(info, std::move(frames)),
            .scene = Strips(lean_deg),
            .parameters = std::move(parameters),
            .comparison = std::move(comparison),
            .held_out = std::move(held_out),
            .apart = false,
            .hold_noise = true,
            .warnings = std::move(warnings),
            .caveats = {LeanCaveat(lean_deg, table)},
            .inputs = {folder_, plan_.folder}};
  }

 private:
  void Say(const std::string& line) const {
    if (options_.on_note) options_.on_note(line);
  }

  // Display and receiver of the target-free pings, the recording's own beam.
  ParameterSet Initial() {
    if (!noise_) {
      Say("fitting the noise of the target-free pings");
      const auto background = data_io::OpenRecording(folder_ / surface_.background);
      calib::NoiseFit fit = calib::FitNoise(*background, {});
      if (!fit.usable) {
        throw DataError("{}: the noise fit {}", (folder_ / surface_.background).string(),
                        fit.report.termination);
      }
      noise_ = std::move(fit.law);
    }
    ParameterSet initial = surface_.start;
    const double gain_db = initial.receiver.gain_db;  // the level is the material's to carry
    initial.display = noise_->display;
    initial.receiver = noise_->receiver;
    initial.receiver.gain_db = gain_db;
    initial.beam = sim::RecordedBeam(info_);
    initial.beam.elevation_width_deg = info_.sonar.elevation_beam_width_deg;
    return initial;
  }

  Scene Strips(double lean_deg) const {
    Scene scene;
    for (const MarkedPing& ping : marked_) {
      Scene strip = MakeMarkedStrip(ping.marks, ping.frame.image.axes,
                                    {.lean_deg = lean_deg,
                                     .elevation_deg = info_.sonar.elevation_beam_width_deg,
                                     .material = surface_.material});
      const Eigen::Vector3f at = ping.frame.info.world_from_sonar->position_m.cast<float>();
      for (Eigen::Vector3f& vertex : strip.vertices_m) vertex += at;
      scene.Append(strip);
    }
    return scene;
  }

  // The model fitted to the pings that are not held out, and their likelihood.
  std::pair<ParameterSet, double> FitAt(double lean_deg, const ParameterSet& initial) const {
    workflow::RayOptions rays{sim::Sampling::kBeams};
    rays.rays = options_.quick ? RayGridSize{192, 200} : RayGridSize{384, 800};
    rays.threads = options_.threads;
    const sim::Simulator simulator(Strips(lean_deg), info_.sonar,
                                   workflow::AcousticSimulation(rays, info_.sonar, Water{}, initial));
    std::vector<calib::GreyFrame> used;
    for (int i = 0; i < surface_.frames_used; ++i) {
      used.push_back({.index = i,
                      .world_from_sonar = *marked_[i].frame.info.world_from_sonar,
                      .image = marked_[i].frame.image,
                      .use = workflow::ValidPixels(info_)});
    }
    const std::vector<calib::AcousticFrame> frames = calib::FramesFor(used, initial.display);
    calib::FitOptions fit;
    fit.starts = 1;
    fit.max_iterations = options_.quick ? 10 : 60;
    fit.threads = options_.threads;
    const calib::FitConfig config{.free = std::vector<std::string>{"materials", "pulse.length_m"}};
    const calib::AcousticFit fitted = calib::FitAcousticModel(simulator, frames, initial, config, fit);
    if (!fitted.usable) {
      throw DataError("{}: the fit of a strip that leans {:g} degrees ended without a usable solution ({})",
                      folder_.string(), lean_deg, fitted.report.termination);
    }
    const calib::AcousticFrameModel model(simulator, frames, fitted.parameters);
    const double nats = calib::GreyLikelihood(used, calib::MeanPowers(model), fitted.parameters,
                                              fit.block_bins, fit.block_beams)
                            .PerPixel();
    return {fitted.parameters, nats};
  }

  static std::string LeanCaveat(double lean_deg, const std::string& table) {
    return fmt::format(
        "The lean of the strip, {:g} degrees, is the one of these by which the pings used are likeliest "
        "(nats per pixel): {}. Leaning the other way looks the same.",
        lean_deg, table);
  }

  const CasePlan& plan_;
  const MarkedSurfaceCase& surface_;
  std::filesystem::path folder_;
  const PrepareOptions& options_;
  std::unique_ptr<RecordingSource> pings_;
  RecordingInfo info_;
  std::vector<MarkedPing> marked_;
  std::optional<calib::NoiseLaw> noise_;
};

}  // namespace

PreparedRecording PrepareMarkedSurface(const CasePlan& plan, const std::filesystem::path& images,
                                       const PrepareOptions& options) {
  return SurfaceMaker(plan, images, options).Make();
}

}  // namespace sonarcal::reproduce
