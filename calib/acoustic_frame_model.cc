#include "calib/acoustic_frame_model.h"

#include <ceres/jet.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "data_io/types/error.h"
#include "data_io/types/units.h"
#include "sim/physics/beam_pattern.h"
#include "sim/physics/gsab.h"

namespace sonarcal {
namespace {

constexpr double kNeperPerDb = std::numbers::ln10 / 10.0;
using Dual = ceres::Jet<double, 1>;

// Sums over each cell's entries of `count` values a node.
std::vector<double> CellValues(const EchoPower& echoes, std::span<const double> nodes, int count) {
  std::vector<double> values(echoes.cells.size() * count, 0.0);
  for (std::size_t i = 0; i < echoes.cells.size(); ++i) {
    double* cell = &values[i * count];
    for (std::uint32_t e = echoes.cells[i].first_entry; e < echoes.cells[i].last_entry; ++e) {
      const double weight = echoes.entries[e].power;
      const double* at = &nodes[static_cast<std::size_t>(echoes.entries[e].node) * count];
      for (int k = 0; k < count; ++k) cell[k] += weight * at[k];
    }
  }
  return values;
}

}  // namespace

std::vector<RecordedPower> RecordedPowers(const PolarImage& image, const DisplayParameters<double>& display) {
  if (image.scale.quantity != Quantity::kGrey) {
    throw DataError("fit: the recorded image holds {}, expected grey levels", ToString(image.scale.quantity));
  }
  const double full_scale = image.scale.full_scale;
  const auto power_of = [&](double grey) {
    return PowerFromDb(display.db_min + grey / full_scale * (display.db_max - display.db_min));
  };
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

AcousticFrameModel::AcousticFrameModel(const std::vector<AcousticFrame>& frames, const SonarModel& sonar,
                                       double absorption_db_per_m, std::vector<std::string> material_names,
                                       const ParameterSet& initial, bool response_is_fixed)
    : frames_(frames),
      sonar_(sonar),
      absorption_db_per_m_(absorption_db_per_m),
      material_names_(std::move(material_names)),
      initial_(initial),
      catalog_(BuildAcousticCatalog(material_names_, sonar)),
      shown_(material_names_.size(), false) {
  if (!initial_.receiver.noise_db) throw DataError("fit: the acoustic model needs receiver.noise_db");
  if (!(initial_.beam.azimuth_width_deg > 0.0))
    initial_.beam.azimuth_width_deg = sonar.azimuth_beam_width_deg;
  if (!(initial_.beam.azimuth_width_deg > 0.0)) {
    throw DataError("{}: azimuth beam width unknown; give it in the sonar or as beam.azimuth_width_deg",
                    sonar.name);
  }
  if (!(initial_.pulse.length_m > 0.0)) initial_.pulse.length_m = sonar.axes.range_bin_m();
  for (const std::string& name : material_names_) initial_.materials[name] = initial.Material(name);
  for (const AcousticFrame& frame : frames) {
    if ((!frame.use.empty() && frame.use.size() != pixel_count()) || frame.recorded.size() != pixel_count() ||
        frame.echoes.materials != static_cast<int>(material_names_.size())) {
      throw DataError("fit: frame {} has {} pixels and {} materials, expected {} and {}", frame.index,
                      frame.recorded.size(), frame.echoes.materials, pixel_count(), material_names_.size());
    }
    for (const EchoPower::Entry& entry : frame.echoes.entries) shown_[entry.node / kIncidenceNodes] = true;
  }
  if (!response_is_fixed) return;
  for (const AcousticFrame& frame : frames) {
    pixel_echoes_.push_back(GatherPixelEchoes(frame.echoes, Response(initial_, frame.echoes, Slope::kNone)));
  }
}

ParameterValues AcousticFrameModel::Values(const ParameterSet& parameters) const {
  ParameterSet complete = parameters;
  for (const std::string& name : material_names_) complete.materials[name] = parameters.Material(name);
  if (!complete.receiver.noise_db) complete.receiver.noise_db = initial_.receiver.noise_db;
  if (!(complete.beam.azimuth_width_deg > 0.0)) complete.beam = initial_.beam;
  if (!(complete.pulse.length_m > 0.0)) complete.pulse = initial_.pulse;
  ParameterValues values;
  for (const CatalogEntry& entry : catalog_) values.push_back(AcousticSlot(complete, material_names_, entry));
  return values;
}

ParameterSet AcousticFrameModel::Parameters(const ParameterValues& values) const {
  ParameterSet parameters = initial_;
  for (std::size_t i = 0; i < catalog_.size(); ++i)
    AcousticSlot(parameters, material_names_, catalog_[i]) = values[i];
  return parameters;
}

namespace {

constexpr double kReachInWidths = 3.0;      // of the pulse: 2^-36 of the peak
constexpr double kSideLobeReachDb = -60.0;  // of the beam

// Beams in the fit's scalar: width and taper are what it may be differentiated by.
AzimuthShape<Dual> ShapeOf(const SonarModel& sonar, const BeamParameters& beam) {
  return {.pattern = beam.azimuth_pattern,
          .width_rad = Dual(RadFromDeg(beam.azimuth_width_deg), 0),
          .taper = Dual(beam.azimuth_taper),
          .table_db = &beam.azimuth_table_db,
          .beam_spacing_rad = 0.0,
          .beam_azimuth_rad = &sonar.axes.beam_azimuth_rad};
}

}  // namespace

PowerResponse AcousticFrameModel::Response(const ParameterSet& parameters, const EchoPower& echoes,
                                           Slope of) const {
  const PolarAxes& axes = sonar_.axes;
  const AzimuthShape<Dual> shape = ShapeOf(sonar_, parameters.beam);
  const AzimuthResponse<Dual> beam_response(shape);
  const AzimuthResponse<double> values({.pattern = shape.pattern,
                                        .width_rad = shape.width_rad.a,
                                        .taper = shape.taper.a,
                                        .table_db = shape.table_db,
                                        .beam_spacing_rad = shape.beam_spacing_rad,
                                        .beam_azimuth_rad = shape.beam_azimuth_rad});
  std::vector<PowerResponse::Window> azimuth(axes.beam_count());
  const std::vector<double>& columns = echoes.column_azimuth_rad;
  for (int beam = 0; beam < axes.beam_count(); ++beam) {
    const double centre = axes.beam_azimuth_rad[beam];
    const auto [low, high] = AzimuthReachRad(values, centre, kSideLobeReachDb);
    auto column = std::lower_bound(columns.begin(), columns.end(), low);
    azimuth[beam].first = static_cast<int>(column - columns.begin());
    for (; column != columns.end() && *column <= high; ++column) {
      const Dual power = beam_response.Power(*column, centre);
      azimuth[beam].weight.push_back(of == Slope::kAzimuthWidth ? power.v[0] * RadFromDeg(1.0) : power.a);
    }
  }
  const Dual length_m(parameters.pulse.length_m, 0);
  const double step_m = axes.range_bin_m() / echoes.range_steps;
  const int reach = static_cast<int>(std::ceil(kReachInWidths * length_m.a / step_m)) + echoes.range_steps;
  PowerResponse::Window pulse{.first = -reach, .weight = {}};
  for (int row = -reach; row <= reach + echoes.range_steps; ++row) {
    const Dual power = GaussianResponse(Dual((row + 0.5) * step_m - 0.5 * axes.range_bin_m()), length_m);
    pulse.weight.push_back(of == Slope::kPulseLength ? power.v[0] : power.a);
  }
  return {axes.range_bins, echoes.range_steps, std::move(azimuth), std::move(pulse)};
}

// Mean power, and its derivatives with respect to the active values: pixels x active.
struct AcousticFrameModel::Means {
  std::vector<double> power;
  std::vector<double> jacobian;
};

// Echoes through beam and pulse: image 0 their power with SL + G = 0 dB, image 1 + k its derivative by the
// k-th of `curves`, entries of the catalog that belong to GSAB.
ImageStack AcousticFrameModel::EchoImages(int frame, const ParameterSet& parameters,
                                          std::span<const int> curves) const {
  using CurveDual = ceres::Jet<double, 6>;
  const int count = 1 + static_cast<int>(curves.size());
  const auto values_at = [&](std::span<const double> nodes_deg) {
    std::vector<double> values(material_names_.size() * nodes_deg.size() * count, 0.0);
    for (std::size_t material = 0; material < material_names_.size(); ++material) {
      const GsabParameters<double>& g = parameters.materials.at(material_names_[material]).gsab;
      const GsabParameters<CurveDual> gsab = {CurveDual(g.a, 0), CurveDual(g.b_deg, 1),
                                              CurveDual(g.c, 2), CurveDual(g.d, 3),
                                              CurveDual(g.e, 4), CurveDual(g.f_deg, 5)};
      for (std::size_t node = 0; node < nodes_deg.size(); ++node) {
        const CurveDual power = GsabPower(gsab, nodes_deg[node]);
        double* at = &values[(material * nodes_deg.size() + node) * count];
        at[0] = power.a;
        for (int k = 1; k < count; ++k) {
          const CatalogEntry& entry = catalog_[curves[k - 1]];
          if (entry.material == static_cast<int>(material)) at[k] = power.v[entry.index];
        }
      }
    }
    return values;
  };
  if (!pixel_echoes_.empty()) {
    return SumPixelEchoes(pixel_echoes_[frame], values_at(CoarseIncidenceDeg()), count);
  }
  const EchoPower& echoes = frames_[frame].echoes;
  static const std::vector<double> kFineNodesDeg = [] {
    std::vector<double> nodes;
    for (int node = 0; node < kIncidenceNodes; ++node) nodes.push_back(node * kIncidenceStepDeg);
    return nodes;
  }();
  return Response(parameters, echoes, Slope::kNone)
      .Apply(echoes, CellValues(echoes, values_at(kFineNodesDeg), count), count);
}

// The derivative of image 0 by the width of the beam or the length of the pulse.
std::vector<double> AcousticFrameModel::ResponseSlope(int frame, const ParameterSet& parameters,
                                                      Slope of) const {
  const EchoPower& echoes = frames_[frame].echoes;
  std::vector<double> curve;
  for (const std::string& name : material_names_) {
    for (int node = 0; node < kIncidenceNodes; ++node)
      curve.push_back(GsabPower(parameters.materials.at(name).gsab, node * kIncidenceStepDeg));
  }
  return Response(parameters, echoes, of).Apply(echoes, CellValues(echoes, curve, 1), 1).values;
}

AcousticFrameModel::Means AcousticFrameModel::MeansAt(int frame, const ParameterSet& parameters,
                                                      std::span<const int> active) const {
  const int beams = sonar_.axes.beam_count();
  std::vector<int> curves;
  std::vector<double> by_width;
  std::vector<double> by_length;
  for (const int entry : active) {
    const ParameterGroup group = catalog_[entry].group;
    if (group == ParameterGroup::kGsab) curves.push_back(entry);
    if (group == ParameterGroup::kBeam) by_width = ResponseSlope(frame, parameters, Slope::kAzimuthWidth);
    if (group == ParameterGroup::kPulse) by_length = ResponseSlope(frame, parameters, Slope::kPulseLength);
  }
  const ImageStack stack = EchoImages(frame, parameters, curves);
  const int count = stack.count;

  Means means;
  means.power.resize(pixel_count());
  means.jacobian.assign(pixel_count() * active.size(), 0.0);
  const ReceiverParameters& receiver = parameters.receiver;
  const double gain = PowerFromDb(parameters.source_level_db + receiver.gain_db);
  for (std::size_t pixel = 0; pixel < pixel_count(); ++pixel) {
    const int bin = static_cast<int>(pixel) / beams;
    const double range_m = sonar_.axes.range_centre_m(bin);
    const double echo = gain * stack.values[pixel * count];
    const double taper_db = receiver.noise_taper_db.empty() ? 0.0 : receiver.noise_taper_db[pixel % beams];
    const double noise = PowerFromDb(*receiver.noise_db + receiver.noise_slope_db_per_m * range_m + taper_db);
    means.power[pixel] = echo + noise;
    double* row = means.jacobian.data() + pixel * active.size();
    int curve_index = 0;
    for (std::size_t k = 0; k < active.size(); ++k) {
      const CatalogEntry& entry = catalog_[active[k]];
      switch (entry.group) {
        case ParameterGroup::kGsab:
          row[k] = gain * stack.values[pixel * count + ++curve_index];
          break;
        case ParameterGroup::kReceiver:
          row[k] = kNeperPerDb * (entry.index == 0 ? echo : noise * (entry.index == 1 ? 1.0 : range_m));
          break;
        case ParameterGroup::kBeam:
          row[k] = gain * by_width[pixel];
          break;
        case ParameterGroup::kPulse:
          row[k] = gain * by_length[pixel];
          break;
        default:
          row[k] = kNeperPerDb * echo;
      }
    }
  }
  return means;
}

std::vector<double> AcousticFrameModel::MeanPower(int frame, const ParameterValues& values) const {
  return MeansAt(frame, Parameters(values), {}).power;
}

bool AcousticFrameModel::Evaluate(int frame, const ParameterValues& values, std::span<const int> active,
                                  bool derivatives, PixelTerms& terms) const {
  const AcousticFrame& of = frames_[frame];
  const ParameterSet parameters = Parameters(values);
  const std::span<const int> differentiated = derivatives ? active : std::span<const int>{};
  Means means = MeansAt(frame, parameters, differentiated);
  const double looks = parameters.receiver.looks;
  const DisplayParameters<double>& display = parameters.display;
  const double lowest = PowerFromDb(display.db_min);
  const double highest = PowerFromDb(display.db_max);
  terms.residual.assign(pixel_count(), 0.0);
  if (derivatives) {
    terms.slope.assign(pixel_count(), 0.0);
    terms.information.assign(pixel_count(), 0.0);
  }
  for (std::size_t pixel = 0; pixel < pixel_count(); ++pixel) {
    double* row = means.jacobian.data() + pixel * differentiated.size();
    if (!Counts(frame, pixel)) {
      std::fill(row, row + differentiated.size(), 0.0);
      continue;
    }
    const double mean = means.power[pixel];
    if (!(mean > 0.0) || !std::isfinite(mean)) return false;
    const LikelihoodTerm term = PowerLikelihood(of.recorded[pixel], mean, looks);
    terms.residual[pixel] = term.residual;
    if (!derivatives) continue;
    terms.slope[pixel] = term.slope;
    terms.information[pixel] = ExpectedInformation(lowest, highest, mean, looks);
    for (std::size_t k = 0; k < differentiated.size(); ++k) row[k] /= mean;
  }
  terms.eta_jacobian = std::move(means.jacobian);
  return true;
}

}  // namespace sonarcal
