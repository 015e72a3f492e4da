#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "apps/reproduce/hull_strip.h"
#include "apps/reproduce/known_recording.h"
#include "apps/workflow/comparison_options.h"
#include "apps/workflow/fit.h"
#include "calib/acoustic_fit.h"
#include "calib/noise/noise_fit.h"
#include "calib/selection/held_out_likelihood.h"
#include "core/types/error.h"
#include "data_io/sonars/didson_io.h"
#include "sim/physics/recorded_beam.h"

namespace sonarcal::reproduce {
namespace {

constexpr double kLeansDeg[] = {0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 40.0};
constexpr const char* kMaterial = "hull strip from marks";
// Strips stand so far apart that no ping reaches another's.
constexpr double kApartM = 100.0;
constexpr double kPulseBins = 2.0;  // where its fit starts
constexpr std::size_t kHeldOut = 2;

struct MarkedPing {
  Frame frame;
  FirstReturn marks;
};

std::vector<MarkedPing> ReadMarked(const RecordingSource& pings, const std::filesystem::path& marks) {
  std::vector<MarkedPing> marked;
  for (int i = 0; i < pings.frame_count(); ++i) {
    const std::filesystem::path stem = std::filesystem::path(pings.frame_info(i).name).stem();
    const std::filesystem::path file = marks / (stem.string() + "_annotated.png");
    if (!std::filesystem::exists(file)) continue;
    MarkedPing ping{pings.ReadFrame(i), {}};
    ping.marks = ReadFirstReturn(file, ping.frame.image.axes);
    const auto is_marked = [](const std::optional<int>& mark) { return mark.has_value(); };
    if (std::count_if(ping.marks.begin(), ping.marks.end(), is_marked) >= 2)
      marked.push_back(std::move(ping));
  }
  return marked;
}

class HullMaker {
 public:
  HullMaker(std::filesystem::path folder, const PrepareOptions& options)
      : folder_(std::move(folder)), options_(options), pings_(data_io::OpenDidson(folder_ / "test")) {
    info_ = pings_->info();
    marked_ = ReadMarked(*pings_, folder_ / "first_return");
    if (marked_.size() <= kHeldOut) {
      throw DataError("{}: {} marked pings, expected {}: two to fit and one to judge",
                      (folder_ / "first_return").string(), marked_.size(), kHeldOut + 1);
    }
    marked_.resize(kHeldOut + 1);
    Mask valid(info_.sonar.axes.range_bins, info_.sonar.axes.beam_count(), 1);
    for (int beam = 0; beam < valid.cols(); ++beam) valid(0, beam) = 0;  // of the transmitter
    info_.valid = std::move(valid);
    for (std::size_t i = 0; i < marked_.size(); ++i) {
      Pose pose;
      pose.position_m.x() = kApartM * static_cast<double>(i);
      marked_[i].frame.info.world_from_sonar = pose;
    }
  }

  PreparedRecording Make() {
    ParameterSet parameters = Initial();
    double best = -std::numeric_limits<double>::infinity();
    double lean_deg = 0.0;
    double largest_deg = 0.0;
    std::string table;
    for (std::size_t i = 0; i < std::size(kLeansDeg); i += options_.quick ? 3 : 1) {
      const double lean = kLeansDeg[i];
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
        "The marked pings of a folder, {:g} m apart so that each has a hull strip from marks of its own: "
        "positions are made up.",
        kApartM));
    std::vector<std::string> warnings;
    if (const auto at_end = LeanAtEnd(lean_deg, largest_deg)) warnings.push_back(*at_end);
    metrics::CompareOptions comparison;
    // Where most of the picture is clipped to black, spreads of grey find nothing.
    comparison.segmentation.method = metrics::SegmentationMethod::kLikelihoodRatio;
    comparison.segmentation.background_law = std::make_shared<const metrics::BackgroundLaw>(
        workflow::BackgroundLawOf(parameters, info.sonar.axes, folder_.string()));
    return {.title = "hull strip from marks, DIDSON (recorded)",
            .recording = std::make_unique<MemoryRecording>(info, std::move(frames)),
            .scene = Strips(lean_deg),
            .parameters = std::move(parameters),
            .comparison = std::move(comparison),
            .held_out = {static_cast<int>(kHeldOut)},
            .apart = false,
            .hold_noise = true,
            .warnings = std::move(warnings),
            .caveats = Caveats(lean_deg, table),
            .inputs = {folder_}};
  }

 private:
  void Say(const std::string& line) const {
    if (options_.on_note) options_.on_note(line);
  }

  // Display and receiver of the target-free pings, the recording's own beam.
  ParameterSet Initial() {
    if (!noise_) {
      Say("fitting the noise of the target-free pings");
      const auto background = data_io::OpenDidson(folder_ / "background");
      calib::NoiseFit fit = calib::FitNoise(*background, {});
      if (!fit.usable) {
        throw DataError("{}: the noise fit {}", (folder_ / "background").string(), fit.report.termination);
      }
      noise_ = std::move(fit.law);
    }
    ParameterSet initial;
    initial.model = EchoModel::kAcoustic;
    initial.source_level_db = 0.0;
    initial.display = noise_->display;
    initial.receiver = noise_->receiver;
    initial.receiver.gain_db = 120.0;  // the level is the material's to carry
    initial.beam = sim::RecordedBeam(info_);
    initial.beam.elevation_width_deg = info_.sonar.elevation_beam_width_deg;
    initial.pulse.length_m = kPulseBins * info_.sonar.axes.range_bin_m();
    initial.materials[kMaterial].gsab = {
        .a = 1.0, .b_deg = 4.0, .c = 0.02, .d = 1.0, .e = 0.1, .f_deg = 15.0};
    return initial;
  }

  Scene Strips(double lean_deg) const {
    Scene scene;
    for (const MarkedPing& ping : marked_) {
      Scene strip = MakeHullStrip(ping.marks, ping.frame.image.axes,
                                  {.lean_deg = lean_deg,
                                   .elevation_deg = info_.sonar.elevation_beam_width_deg,
                                   .material = kMaterial});
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
    for (std::size_t i = 0; i < kHeldOut; ++i) {
      used.push_back({.index = static_cast<int>(i),
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

  static std::vector<std::string> Caveats(double lean_deg, const std::string& table) {
    return {
        "The scene is a hull strip from marks, no model of the hull: in each beam a straight line through "
        "the first return that a person marked, leaning away from the sonar by one angle for all beams and "
        "pings.",
        fmt::format("That angle, {:g} degrees, is the one of these by which the pings used are likeliest "
                    "(nats a pixel): {}. Leaning the other way looks the same.",
                    lean_deg, table),
        "The strip of the ping held out is made from its own marks. So what is judged is how strong and how "
        "deep the echo behind the first return is, side lobes and noise: not where the hull is.",
        "Beams without a mark have no surface: hull that shows there stays unexplained.",
        "Noise and display are those of the target-free pings, the beam that of the recording's own point "
        "spread function. Curve and pulse are fitted to the pings used; levels are relative, and no gain "
        "over time is assumed."};
  }

  std::filesystem::path folder_;
  const PrepareOptions& options_;
  std::unique_ptr<RecordingSource> pings_;
  RecordingInfo info_;
  std::vector<MarkedPing> marked_;
  std::optional<calib::NoiseLaw> noise_;
};

}  // namespace

PreparedRecording PrepareHullRecording(const std::filesystem::path& folder, const PrepareOptions& options) {
  return HullMaker(folder, options).Make();
}

}  // namespace sonarcal::reproduce
