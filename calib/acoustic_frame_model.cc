#include "calib/acoustic_frame_model.h"

#include <ceres/jet.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "data_io/types/error.h"
#include "data_io/types/units.h"
#include "sim/physics/gsab.h"
#include "sim/physics/receiver.h"

namespace sonarcal {
namespace {

constexpr double kNeperPerDb = std::numbers::ln10 / 10.0;

// Half the distance over which echoes are differenced: wide enough that the rays at an object's edge come and
// go evenly, narrow beside bins and beams.
double DifferenceStep(const CatalogEntry& entry, const ParameterValues& values, const SonarModel& sonar,
                      int index) {
  constexpr double kOfWidth = 0.03;
  if (entry.group != ParameterGroup::kPose) return kOfWidth * values[index];
  const double beam_deg =
      DegFromRad((sonar.axes.beam_azimuth_rad.back() - sonar.axes.beam_azimuth_rad.front()) /
                 std::max(1, sonar.axes.beam_count() - 1));
  return entry.index < 3 ? 0.5 * sonar.axes.range_bin_m() : std::max(0.1, beam_deg);
}

}  // namespace

std::vector<RecordedPower> RecordedPowers(const PolarImage& image, const DisplayParameters<double>& display) {
  if (image.scale.quantity != Quantity::kGrey) {
    throw DataError("fit: the recorded image holds {}, expected grey levels", ToString(image.scale.quantity));
  }
  const double full_scale = image.scale.full_scale;
  const auto power_of = [&](double grey) { return PowerFromDisplay(display, grey / full_scale); };
  std::vector<RecordedPower> recorded;
  recorded.reserve(image.value.size());
  for (const float value : image.value.values()) {
    const double grey = value;
    if (!std::isfinite(grey)) throw DataError("fit: a recorded pixel is not finite");
    // A grey level holds what rounds to it.
    if (grey < 0.5) {
      recorded.push_back({power_of(0.5), Censoring::kAtMost});
    } else if (grey > full_scale - 0.5) {
      recorded.push_back({power_of(full_scale - 0.5), Censoring::kAtLeast});
    } else {
      recorded.push_back({power_of(grey), Censoring::kNone});
    }
  }
  return recorded;
}

AcousticFrameModel::AcousticFrameModel(const Simulator& simulator, const std::vector<AcousticFrame>& frames,
                                       const ParameterSet& initial)
    : simulator_(simulator),
      frames_(frames),
      material_names_(simulator.caster().material_names()),
      initial_(initial),
      shown_(material_names_.size(), false) {
  if (!initial_.receiver.noise_db) throw DataError("fit: the acoustic model needs receiver.noise_db");
  CompleteResponse(simulator.sonar(), initial_);
  CheckTapers(initial_.receiver, beams());
  for (const std::string& name : material_names_) initial_.materials[name] = initial.Material(name);
  std::vector<int> indices;
  for (const AcousticFrame& frame : frames) {
    indices.push_back(frame.index);
    if ((!frame.use.empty() && frame.use.size() != pixel_count()) || frame.recorded.size() != pixel_count()) {
      throw DataError("fit: frame {} has {} pixels, expected {}", frame.index, frame.recorded.size(),
                      pixel_count());
    }
  }
  catalog_ = BuildAcousticCatalog(material_names_, simulator.sonar(), indices);
  for (const CatalogEntry& entry : catalog_) {
    if (entry.group != ParameterGroup::kPose) {
      initial_values_.push_back(AcousticSlot(initial_, material_names_, entry));
      continue;
    }
    const Pose& pose = frames[entry.frame].world_from_sonar;
    const Eigen::Vector3d yaw_pitch_roll = YawPitchRollFromRotation(pose.rotation);
    initial_values_.push_back(entry.index < 3 ? pose.position_m(entry.index)
                                              : DegFromRad(yaw_pitch_roll(5 - entry.index)));
  }
  Linearise(initial_values_, {});
  for (const FrameEchoes& of : echoes_) {
    for (const PixelEchoes::Entry& entry : of.at_point.entries)
      shown_[entry.node / CoarseIncidenceDeg().size()] = true;
  }
}

ParameterSet AcousticFrameModel::Parameters(const ParameterValues& values) const {
  ParameterSet parameters = initial_;
  for (std::size_t i = 0; i < catalog_.size(); ++i) {
    if (catalog_[i].group == ParameterGroup::kPose) continue;
    AcousticSlot(parameters, material_names_, catalog_[i]) = values[i];
  }
  return parameters;
}

Pose AcousticFrameModel::PoseOf(int frame, const ParameterValues& values) const {
  std::array<double, 6> of{};
  for (std::size_t i = 0; i < catalog_.size(); ++i) {
    if (catalog_[i].group == ParameterGroup::kPose && catalog_[i].frame == frame)
      of[catalog_[i].index] = values[i];
  }
  return {RotationFromYawPitchRoll(RadFromDeg(of[5]), RadFromDeg(of[4]), RadFromDeg(of[3])),
          {of[0], of[1], of[2]}};
}

AcousticFrameModel::FrameEchoes AcousticFrameModel::EchoesAbout(int frame, const ParameterValues& values,
                                                                const std::vector<int>& geometric) const {
  const auto gather = [&](const ParameterValues& at) {
    return GatherPixelEchoes(simulator_, PoseOf(frame, at), Parameters(at));
  };
  FrameEchoes echoes{.at_point = gather(values), .entries = {}, .slopes = {}};
  for (const int entry : geometric) {
    if (catalog_[entry].group == ParameterGroup::kPose && catalog_[entry].frame != frame) continue;
    const double step = DifferenceStep(catalog_[entry], values, simulator_.sonar(), entry);
    ParameterValues above = values;
    ParameterValues below = values;
    above[entry] += step;
    below[entry] -= step;
    echoes.entries.push_back(entry);
    echoes.slopes.push_back(Difference(gather(above), gather(below), 1.0 / (2.0 * step)));
  }
  return echoes;
}

void AcousticFrameModel::Linearise(const ParameterValues& values, const std::vector<int>& geometric) {
  point_ = values;
  std::vector<FrameEchoes> echoes;
  for (int frame = 0; frame < frame_count(); ++frame) echoes.push_back(EchoesAbout(frame, values, geometric));
  echoes_ = std::move(echoes);
}

// Node by node: the curves' power, and its derivative by each of `curves`, entries of the catalog that belong
// to GSAB.
std::vector<double> AcousticFrameModel::Curves(const ParameterSet& parameters,
                                               std::span<const int> curves) const {
  using Dual = ceres::Jet<double, 6>;
  const std::size_t count = 1 + curves.size();
  const std::vector<double>& nodes_deg = CoarseIncidenceDeg();
  std::vector<double> values(material_names_.size() * nodes_deg.size() * count, 0.0);
  for (std::size_t material = 0; material < material_names_.size(); ++material) {
    const GsabParameters<double>& g = parameters.materials.at(material_names_[material]).gsab;
    const GsabParameters<Dual> gsab = {Dual(g.a, 0), Dual(g.b_deg, 1), Dual(g.c, 2),
                                       Dual(g.d, 3), Dual(g.e, 4),     Dual(g.f_deg, 5)};
    for (std::size_t node = 0; node < nodes_deg.size(); ++node) {
      const Dual power = GsabPower(gsab, nodes_deg[node]);
      double* at = &values[(material * nodes_deg.size() + node) * count];
      at[0] = power.a;
      for (std::size_t k = 1; k < count; ++k) {
        const CatalogEntry& entry = catalog_[curves[k - 1]];
        if (entry.material == static_cast<int>(material)) at[k] = power.v[entry.index];
      }
    }
  }
  return values;
}

// Mean power, and its derivatives with respect to the active values, pixels x active.
void AcousticFrameModel::MeansAt(int frame, const ParameterValues& values, std::span<const int> active,
                                 std::vector<double>& mean, std::vector<double>& jacobian) const {
  const ParameterSet parameters = Parameters(values);
  const FrameEchoes& echoes = echoes_[frame];
  std::vector<int> curves;
  for (const int entry : active) {
    if (catalog_[entry].group == ParameterGroup::kGsab) curves.push_back(entry);
  }
  const std::vector<double> nodes = Curves(parameters, curves);
  const int count = 1 + static_cast<int>(curves.size());
  ImageStack echo = SumPixelEchoes(echoes.at_point, nodes, count);
  std::vector<ImageStack> slopes;
  for (std::size_t g = 0; g < echoes.entries.size(); ++g) {
    slopes.push_back(SumPixelEchoes(echoes.slopes[g], nodes, count));
    const double moved = values[echoes.entries[g]] - point_[echoes.entries[g]];
    if (moved == 0.0) continue;
    for (std::size_t i = 0; i < echo.values.size(); ++i) echo.values[i] += moved * slopes[g].values[i];
  }

  mean.resize(pixel_count());
  jacobian.assign(pixel_count() * active.size(), 0.0);
  const ReceiverParameters& receiver = parameters.receiver;
  ReceiverParameters before_gain = receiver;
  before_gain.noise_after_gain_db.reset();
  const double level_db = parameters.source_level_db + receiver.gain_db;
  for (int bin = 0; bin < range_bins(); ++bin) {
    const double range_m = simulator_.sonar().axes.range_centre_m(bin);
    const double gain = PowerFromDb(
        level_db + TimeVariedGainDb(receiver.time_varied_gain, range_m, simulator_.absorption_db_per_m()));
    for (int beam = 0; beam < beams(); ++beam) {
      const std::size_t pixel = static_cast<std::size_t>(bin) * beams() + beam;
      // Far from the point the linear echo may fall below nothing.
      const bool heard = echo.values[pixel * count] > 0.0;
      const double power = heard ? gain * echo.values[pixel * count] : 0.0;
      const double noise = NoisePower(receiver, range_m, beam, simulator_.absorption_db_per_m());
      // Of which the floor before the gain: noise_db and its slope are of that one.
      const double trending = NoisePower(before_gain, range_m, beam, simulator_.absorption_db_per_m());
      mean[pixel] = power + noise;
      double* row = jacobian.data() + pixel * active.size();
      int curve = 0;
      for (std::size_t k = 0; k < active.size(); ++k) {
        const CatalogEntry& entry = catalog_[active[k]];
        if (entry.group == ParameterGroup::kGsab) {
          ++curve;
          if (heard) row[k] = gain * echo.values[pixel * count + curve];
        } else if (entry.group == ParameterGroup::kReceiver && entry.index > 0) {
          row[k] = kNeperPerDb * trending * (entry.index == 1 ? 1.0 : range_m);
        } else if (!IsGeometric(entry)) {
          row[k] = kNeperPerDb * power;
        } else if (heard) {
          for (std::size_t g = 0; g < slopes.size(); ++g) {
            if (echoes.entries[g] == active[k]) row[k] = gain * slopes[g].values[pixel * count];
          }
        }
      }
    }
  }
}

std::vector<double> AcousticFrameModel::MeanPower(int frame, const ParameterValues& values) const {
  std::vector<double> mean;
  std::vector<double> jacobian;
  MeansAt(frame, values, {}, mean, jacobian);
  return mean;
}

bool AcousticFrameModel::Evaluate(int frame, const ParameterValues& values, std::span<const int> active,
                                  Terms wanted, PixelTerms& terms) const {
  const bool derivatives = wanted != Terms::kResiduals;
  const AcousticFrame& of = frames_[frame];
  const std::span<const int> differentiated = derivatives ? active : std::span<const int>{};
  std::vector<double> means;
  MeansAt(frame, values, differentiated, means, terms.eta_jacobian);
  const double looks = initial_.receiver.looks;
  const DisplayParameters<double>& display = initial_.display;
  const double lowest = PowerFromDisplay(display, 0.0);
  const double highest = PowerFromDisplay(display, 1.0);
  terms.residual.assign(pixel_count(), 0.0);
  if (derivatives) {
    terms.slope.assign(pixel_count(), 0.0);
    terms.information.assign(wanted == Terms::kInformation ? pixel_count() : 0, 0.0);
  }
  for (std::size_t pixel = 0; pixel < pixel_count(); ++pixel) {
    double* row = terms.eta_jacobian.data() + pixel * differentiated.size();
    if (!Counts(frame, pixel)) {
      std::fill(row, row + differentiated.size(), 0.0);
      continue;
    }
    const double mean = means[pixel];
    if (!(mean > 0.0) || !std::isfinite(mean)) return false;
    const LikelihoodTerm term = PowerLikelihood(of.recorded[pixel], mean, looks);
    terms.residual[pixel] = term.residual;
    if (!derivatives) continue;
    terms.slope[pixel] = term.slope;
    if (wanted == Terms::kInformation) {
      terms.information[pixel] = ExpectedInformation(lowest, highest, mean, looks);
    }
    for (std::size_t k = 0; k < differentiated.size(); ++k) row[k] /= mean;
  }
  return true;
}

}  // namespace sonarcal
