#include "sim/simulator.h"

#include <utility>

namespace sonarcal {
namespace {

SimulationOptions Checked(SimulationOptions options) {
  options.Check();
  return options;
}

}  // namespace

void SimulationOptions::Check() const {
  fan.Check();
  trace.Check();
  if (bits != 8 && bits != 12 && bits != 16) throw DataError("image of {} bits, expected 8, 12 or 16", bits);
}

Simulator::Simulator(const Scene& scene, SonarModel sonar, SimulationOptions options)
    : sonar_(std::move(sonar)),
      options_(Checked(std::move(options))),
      caster_(scene),
      fan_(sonar_, options_.fan),
      absorption_db_per_m_(AbsorptionDbPerM(options_.absorption, sonar_.frequency_hz, options_.water)) {
  if (!(sonar_.frequency_hz > 0.0)) {
    throw DataError("{}: frequency {} Hz, expected a positive one", sonar_.name, sonar_.frequency_hz);
  }
}

EchoList Simulator::TraceEchoes(const Pose& world_from_sonar) const {
  return Trace(caster_, fan_, world_from_sonar, sonar_.axes, options_.trace);
}

PolarImage Simulator::Render(const Pose& world_from_sonar, const ParameterSet& parameters,
                             int frame_idx) const {
  return RenderEchoes(TraceEchoes(world_from_sonar), parameters, frame_idx);
}

PolarImage Simulator::RenderEchoes(const EchoList& echoes, const ParameterSet& parameters,
                                   int frame_idx) const {
  const std::uint64_t seed = options_.seed + static_cast<std::uint64_t>(frame_idx);
  PolarImage image;
  if (parameters.model == EchoModel::kPaper) {
    PaperImageOptions options{.full_scale = options_.full_scale(), .noise_seed = {}};
    if (options_.noise) options.noise_seed = seed;
    image = RenderPaperImage(echoes, sonar_, PaperParametersFor(parameters, echoes.material_names),
                             absorption_db_per_m_, options);
  } else if (options_.noise) {
    const AcousticGeometry geometry{sonar_, absorption_db_per_m_};
    image = SampleAcousticImage(MakeScatterMap(echoes, fan_, geometry, parameters), geometry, parameters,
                                options_.full_scale(), seed);
  } else {
    image = RenderExpected(echoes, parameters);
  }
  QuantiseImage(image);
  return image;
}

PolarImage Simulator::RenderExpected(const EchoList& echoes, const ParameterSet& parameters) const {
  if (parameters.model == EchoModel::kAcoustic) {
    const AcousticGeometry geometry{sonar_, absorption_db_per_m_};
    const PolarImage power =
        ExpectedPower(MakeScatterMap(echoes, fan_, geometry, parameters), geometry, parameters);
    return ExpectedDisplay(power, parameters, options_.full_scale());
  }
  const std::vector<double> values =
      ExpectedPaperImage(GatherEchoes(echoes, sonar_.axes), ImageGeometry(sonar_, absorption_db_per_m_),
                         PaperParametersFor(parameters, echoes.material_names));
  PolarImage image{sonar_.axes,
                   {.quantity = Quantity::kGrey,
                    .full_scale = options_.full_scale(),
                    .db_min = parameters.display.db_min,
                    .db_max = parameters.display.db_max,
                    .db_span = {}},
                   Grid<float>(sonar_.axes.range_bins, sonar_.axes.beam_count())};
  for (std::size_t i = 0; i < values.size(); ++i) {
    image.value.values()[i] = static_cast<float>(values[i] * options_.full_scale());
  }
  return image;
}

}  // namespace sonarcal
