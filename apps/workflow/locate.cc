#include "apps/workflow/locate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/workflow/assumptions.h"
#include "apps/workflow/rays/ray_options.h"
#include "apps/workflow/simulate.h"
#include "calib/noise/background_display.h"
#include "core/imaging/change_scale.h"
#include "core/math/statistics.h"
#include "core/text/nearest_word.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "metrics/segmentation/segmentation.h"
#include "sim/paper/paper_image.h"
#include "sim/physics/absorption.h"
#include "sim/physics/receiver.h"
#include "sim/scenes/scene_primitives.h"
#include "sim/simulator.h"

namespace sonarcal::workflow {
namespace {

// Half-power width of a beam in elevation over the nominal field of view: outside that field targets are
// still visible (docs/studies/bomb.md).
constexpr double kNominalWidths = 2.0;
constexpr std::array kTapers = {1.0, 0.6, 0.4};  // of the beams' aperture: without and with side lobes
constexpr double kMinSpanDeg = 28.0;  // targets are visible outside the nominal vertical field of view

double MedianGrey(const PolarImage& image) {
  return UpperMedian(std::vector<float>(image.value.values().begin(), image.value.values().end()));
}

// Pixel-wise mean. Smoothed images are compared, so the mean has all that several frames of one pose hold.
PolarImage MeanOf(const std::vector<Frame>& frames) {
  PolarImage mean = frames.front().image;
  for (std::size_t i = 0; i < mean.value.size(); ++i) {
    double sum = 0.0;
    for (const Frame& frame : frames) sum += frame.image.value.values()[i];
    mean.value.values()[i] = static_cast<float>(sum / static_cast<double>(frames.size()));
  }
  return mean;
}

Scene WithFloor(const Scene& mesh, double below_m, double reach_m) {
  double lowest_m = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3f& vertex : mesh.vertices_m) lowest_m = std::min<double>(lowest_m, vertex.z());
  Scene scene = mesh;
  scene.Append(sim::MakePatch({-reach_m, -reach_m, lowest_m - below_m}, {2.0 * reach_m, 0.0, 0.0},
                              {0.0, 2.0 * reach_m, 0.0}, sim::kUndivided, "floor"));
  return scene;
}

double ElevationSpanDeg(const SonarModel& sonar, const ParameterSet& parameters) {
  const double width_deg = parameters.beam.elevation_width_deg > 0.0 ? parameters.beam.elevation_width_deg
                                                                     : sonar.elevation_beam_width_deg;
  return std::clamp(width_deg, kMinSpanDeg, 120.0);
}

// Parameters with the strengths found.
ParameterSet AtGains(ParameterSet parameters, const calib::PoseCandidate& found,
                     const std::string& floor_material) {
  parameters.receiver.gain_db += found.gain_db;
  if (floor_material.empty()) return parameters;
  parameters.materials[floor_material] = parameters.Material(floor_material);
  GsabParameters<double>& gsab = parameters.materials[floor_material].gsab;
  const double factor = PowerFromDb(found.floor_gain_db - found.gain_db);
  for (double* amplitude : {&gsab.a, &gsab.c, &gsab.e}) *amplitude *= factor;
  return parameters;
}

class Locator {
 public:
  Locator(const RecordingSource& recording, const Scene& mesh, const LocateOptions& options,
          const Listener& listener)
      : recording_(recording), options_(options), listener_(listener), threads_(options.threads) {
    RecordingInfo info = recording.info();
    floor_material_ = options.floor_material;
    const auto& names = mesh.material_names;
    if (options.floor && !floor_material_.empty())
      throw UsageError("--floor and --floor-material are given, expected one of them");
    if (!floor_material_.empty() && std::find(names.begin(), names.end(), floor_material_) == names.end()) {
      throw DataError("the mesh has no material '{}' for its floor{}", floor_material_,
                      ExpectedWord(floor_material_, names));
    }
    location_.scene = mesh;
    if (options.floor) {
      if (std::find(names.begin(), names.end(), "floor") != names.end())
        throw UsageError(
            "--floor is given and the mesh has a material 'floor', expected --floor-material floor");
      floor_material_ = "floor";
      location_.scene = WithFloor(mesh, *options.floor, 2.0 * info.sonar.axes.range_max_m);
    }
  }

  Location Run(const std::vector<int>& frames, const std::vector<data_io::TimedPose>& start) {
    std::vector<Frame> read;
    for (const int index : frames) read.push_back(ReadFrame(index));
    Prepare(read.front().image);
    std::vector<Frame> posed;
    try {
      if (options_.one_pose) {
        const PolarImage mean = MeanOf(read);
        ChooseSideLobes(mean, StartOf(start, 0));
        const calib::PoseSearchResult found = Search(mean, StartOf(start, 0));
        for (std::size_t i = 0; i < read.size(); ++i) Add(frames[i], read[i], found, posed);
      } else {
        ChooseSideLobes(read.front().image, StartOf(start, 0));
        for (std::size_t i = 0; i < read.size(); ++i) {
          listener_.Progress("Searching", static_cast<int>(i), static_cast<int>(read.size()));
          if (read.size() > 1) listener_.Message(fmt::format("frame {}", frames[i]));
          Add(frames[i], read[i], Search(read[i].image, StartOf(start, i)), posed);
        }
      }
    } catch (const calib::PoseSearchStopped&) {
      location_.interrupted = true;
    }
    if (posed.empty()) return std::move(location_);
    location_.parameters = AtGains(parameters_, location_.frames.front().search.best(), floor_material_);
    RecordingInfo info = recording_.info();
    info.notes.emplace_back("Poses were found by a search on the frames themselves; none is recorded.");
    location_.recording = std::make_unique<MemoryRecording>(std::move(info), std::move(posed));
    return std::move(location_);
  }

 private:
  // Throws DataError for a frame with other axes than the recording, whose axes the search uses.
  Frame ReadFrame(int index) const {
    Frame frame = recording_.ReadFrame(index);
    std::string why;
    if (!frame.image.axes.Matches(recording_.info().sonar.axes, &why)) {
      throw DataError("{}: frame {} and the recording have {}, expected one geometry for all frames",
                      recording_.info().source, index, why);
    }
    return frame;
  }

  void Prepare(const PolarImage& image) {
    RecordingInfo info = recording_.info();
    std::vector<std::string> notes;
    if (const auto sentence = AssumeFrequency(info.sonar)) notes.push_back(*sentence);
    if (options_.params) {
      parameters_ = *options_.params.value;
      if (parameters_.model != EchoModel::kAcoustic)
        throw UsageError("--params is for the {} model, expected the acoustic model",
                         ToString(parameters_.model));
      for (const std::string& name : location_.scene.material_names) parameters_.Material(name);
    }
    const WaterChoice water = ChooseWater(parameters_, info.water);
    water_ = water.water;
    listener_.Message(water.note);
    if (!options_.params) parameters_ = ParametersForSearch(info, water_, image, location_.scene, notes);
    for (const std::string& note : notes) listener_.Message(note);
    sonar_ = info.sonar;
    span_deg_ = ElevationSpanDeg(sonar_, parameters_);
  }

  static std::optional<Pose> StartOf(const std::vector<data_io::TimedPose>& start, std::size_t i) {
    if (start.empty()) return std::nullopt;
    return start[start.size() == 1 ? 0 : i].world_from_sonar.Inverse();
  }

  // Without given parameters, takes the shading of the beams that describes the image best at the pose found
  // with each of a few: sonars state no side lobes, and a wrong guess shifts the outline of a bright target.
  void ChooseSideLobes(const PolarImage& image, const std::optional<Pose>& start) {
    if (options_.params) return;
    listener_.Message("choosing the side lobes of the beams at a first pose");
    calib::PoseSearchOptions quick = SearchOptions(start);
    quick.ridge_elevations_deg = {};
    quick.max_candidates = 1;
    quick.relatives = false;
    quick.progress = {};
    double lowest = std::numeric_limits<double>::infinity();
    double best_taper = 0.0;
    for (const double taper : kTapers) {
      parameters_.beam.azimuth_taper = taper;
      const calib::PoseSearchResult found =
          calib::SearchPose(location_.scene, sonar_, water_, image, parameters_, quick);
      quick.start = found.best().sonar_from_target;
      if (!(found.best().cost < lowest)) continue;
      lowest = found.best().cost;
      best_taper = taper;
    }
    parameters_.beam.azimuth_taper = best_taper;
    listener_.Message(fmt::format("beam.azimuth_taper {:g} describes the first image best", best_taper));
  }

  calib::PoseSearchResult Search(const PolarImage& image, const std::optional<Pose>& start) const {
    return calib::SearchPose(location_.scene, sonar_, water_, image, parameters_, SearchOptions(start));
  }

  calib::PoseSearchOptions SearchOptions(const std::optional<Pose>& start) const {
    calib::PoseSearchOptions search;
    search.range_m = options_.region_range;
    search.azimuth_deg = options_.region_azimuth;
    search.start_spacing_deg = options_.spacing;
    search.refined_starts = options_.starts;
    search.elevation_limit_deg = options_.elevation_limit;
    search.elevation_span_deg = span_deg_;
    search.max_iterations = options_.max_iterations;
    search.ray_height_deg = options_.ray_height;
    search.start = start;
    search.floor_material = floor_material_;
    if (recording_.info().valid) search.pixels = *recording_.info().valid;
    search.progress = [this](const std::string& line) { listener_.Message(line); };
    search.stop = listener_.stop;
    return search;
  }

  void Add(int index, Frame frame, const calib::PoseSearchResult& found, std::vector<Frame>& posed) {
    LocatedFrame located{.frame = index, .search = found, .images = {}};
    for (const calib::PoseCandidate& candidate : found.candidates) {
      if (static_cast<int>(located.images.size()) == kShownCandidates) break;
      located.images.push_back(ImagesOf(frame.image, candidate));
    }
    location_.frames.push_back(std::move(located));
    frame.info.world_from_sonar = found.best().WorldFromSonar();
    posed.push_back(std::move(frame));
  }

  CandidateImages ImagesOf(const PolarImage& recorded, const calib::PoseCandidate& candidate) const {
    sim::SimulationOptions simulation;
    simulation.water = water_;
    simulation.noise = true;
    simulation.fan = {.sampling = sim::Sampling::kBeams,
                      .cols = 4 * sonar_.axes.beam_count(),
                      .rows = static_cast<int>(std::ceil(span_deg_ / options_.ray_height)),
                      .elevation_span_deg = span_deg_,
                      .stagger = true,
                      .stagger_rows = true};
    const sim::Simulator simulator(location_.scene, sonar_, simulation);
    const ParameterSet parameters = AtGains(parameters_, candidate, floor_material_);
    const sim::EchoList echoes = simulator.TraceEchoes(candidate.WorldFromSonar());
    CandidateImages images{.expected = simulator.RenderExpected(echoes, parameters),
                           .sample = simulator.RenderEchoes(echoes, parameters),
                           .of_expected = {},
                           .of_sample = {}};
    metrics::CompareOptions compare;
    compare.keep_masks = true;
    compare.valid = recording_.info().valid;
    for (PolarImage* image : {&images.expected, &images.sample}) {
      ChangeScale(recorded.scale, *image);
      sim::QuantiseImage(*image);
    }
    images.of_expected = metrics::CompareFrames(recorded, images.expected, compare);
    images.of_sample = metrics::CompareFrames(recorded, images.sample, compare);
    return images;
  }

  const RecordingSource& recording_;
  const LocateOptions& options_;
  const Listener& listener_;
  ThreadLimit threads_;
  std::string floor_material_;
  Location location_;
  ParameterSet parameters_;
  Water water_;
  SonarModel sonar_;
  double span_deg_ = kMinSpanDeg;
};

}  // namespace

std::vector<data_io::TimedPose> Location::Poses() const {
  std::vector<data_io::TimedPose> poses;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const calib::PoseSearchResult& search = frames[i].search;
    data_io::TimedPose& pose =
        poses.emplace_back(data_io::TimedPose{.time_s = recording->frame_info(static_cast<int>(i)).time_s,
                                              .world_from_sonar = search.best().WorldFromSonar(),
                                              .frame = frames[i].frame});
    for (const calib::PoseCandidate& candidate : search.candidates) {
      pose.candidates.push_back(
          {.what = &candidate == &search.best() ? "best" : std::string(calib::NameOf(candidate.kind)),
           .world_from_sonar = candidate.WorldFromSonar(),
           .rms_difference = std::sqrt(candidate.cost),
           .gain_db = candidate.gain_db,
           .worse_by_nats = candidate.worse_by_nats,
           .worse_by_sigmas = candidate.worse_by_sigmas,
           .explains_as_well = candidate.ExplainsAsWell()});
    }
    pose.open = search.best().at_bounds;
    pose.open.insert(pose.open.end(), search.open.begin(), search.open.end());
  }
  return poses;
}

DisplayParameters<double> DisplayOfBackground(const PolarImage& image,
                                              const metrics::SegmentationOptions& segmentation) {
  Mask background = metrics::BoxAround(metrics::Segment(image, segmentation).object, 20, 8);
  for (std::uint8_t& pixel : background.values()) pixel = pixel == 0 ? 1 : 0;
  return calib::FitBackgroundDisplay(image, background, DisplayLaw::kSoftAmplitude).display;
}

ParameterSet ParametersForSearch(const RecordingInfo& info, const Water& water, const PolarImage& image,
                                 const Scene& scene, std::vector<std::string>& notes) {
  ParameterSet parameters;
  parameters.model = EchoModel::kAcoustic;
  parameters.source_level_db = 0.0;
  const ImageScale& scale = image.scale;
  double noise_db = 0.0;
  if (scale.db_min && scale.db_max) {
    parameters.display = {.db_min = *scale.db_min, .db_max = *scale.db_max};
    noise_db = *scale.db_min + MedianGrey(image) / scale.full_scale * (*scale.db_max - *scale.db_min) -
               sim::MeanLogSpeckleDb(1.0);
  } else {
    PolarImage spanned = image;
    if (!scale.db_span) {
      spanned.scale.db_span = kAssumedSpanDb;
      notes.push_back(
          fmt::format("the recording states no dB scale: a display of {:g} dB is assumed", kAssumedSpanDb));
    }
    parameters.display = DisplayOfBackground(spanned, {});
  }
  parameters.receiver.noise_db = noise_db;
  const SonarModel& sonar = info.sonar;
  const PolarAxes& axes = sonar.axes;
  if (!(sonar.azimuth_beam_width_deg > 0.0))
    parameters.beam.azimuth_width_deg = 1.1 * DegFromRad(axes.beam_spacing_rad());
  double elevation_width_deg = sonar.elevation_beam_width_deg;
  if (!(elevation_width_deg > 0.0)) {
    elevation_width_deg = kAssumedElevationWidthDeg;
    notes.push_back(fmt::format("the recording states no elevation beam width: {:g} degrees are assumed",
                                elevation_width_deg));
  }
  parameters.beam.elevation_width_deg = kNominalWidths * elevation_width_deg;
  parameters.pulse.length_m = 2.0 * axes.range_bin_m();
  for (const std::string& name : scene.material_names)
    parameters.materials[name].gsab = {.a = 0.0, .b_deg = 4.0, .c = 1.0, .d = 1.5, .e = 0.0, .f_deg = 10.0};
  const double range_m = 0.5 * (axes.range_min_m + axes.range_max_m);
  const double cell_m2 = range_m * axes.beam_spacing_rad() * axes.range_bin_m();
  const double absorption_db_per_m =
      sim::AbsorptionDbPerM(sim::AbsorptionFormula::kAuto, sonar.frequency_hz, water);
  parameters.receiver.gain_db = noise_db + 20.0 + 40.0 * std::log10(range_m) +
                                2.0 * absorption_db_per_m * range_m - DbFromPower(cell_m2);
  return parameters;
}

Location Locate(const RecordingSource& recording, const Scene& mesh, const std::vector<int>& frames,
                const LocateOptions& options, const std::vector<data_io::TimedPose>& start,
                const Listener& listener) {
  if (frames.empty()) throw UsageError("no frame is given, expected at least one");
  if (start.size() > 1 && start.size() != frames.size()) {
    throw DataError("{} start poses for {} frames, expected one for each frame or one for all", start.size(),
                    frames.size());
  }
  return Locator(recording, mesh, options, listener).Run(frames, start);
}

}  // namespace sonarcal::workflow
