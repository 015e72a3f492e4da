#include "sim/simulator.h"

#include <utility>

#include "sim/paper_frame.h"

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

Simulator::Simulator(Scene scene, SonarModel sonar, SimulationOptions options)
    : sonar_(std::move(sonar)),
      options_(Checked(std::move(options))),
      caster_(std::move(scene)),
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
  if (parameters.model == EchoModel::kPaper && options_.trace.normals == NormalSource::kGeometric) {
    RefuseMargin();
    PolarImage image = RenderPaperFrame(caster_, fan_, world_from_sonar, sonar_,
                                        PaperParametersFor(parameters, caster_.material_names()),
                                        absorption_db_per_m_, PaperOptions(frame_idx));
    QuantiseImage(image);
    return image;
  }
  if (parameters.model != EchoModel::kCoherent) {
    return RenderEchoes(TraceEchoes(world_from_sonar), parameters, frame_idx);
  }
  const PolarImage power = CoherentPower({caster_, fan_, sonar_, absorption_db_per_m_}, world_from_sonar,
                                         parameters, SeedsOf(frame_idx));
  PolarImage image = DisplayPower(power, parameters, options_.full_scale());
  QuantiseImage(image);
  return image;
}

DrawSeeds Simulator::SeedsOf(int frame_idx) const {
  const std::uint64_t of_frame = options_.seed + static_cast<std::uint64_t>(frame_idx);
  return {.scatterers = options_.frozen_speckle ? options_.seed : of_frame, .receiver = of_frame};
}

PaperImageOptions Simulator::PaperOptions(int frame_idx) const {
  PaperImageOptions options{.full_scale = options_.full_scale(), .noise_seed = {}};
  if (options_.noise) options.noise_seed = options_.seed + static_cast<std::uint64_t>(frame_idx);
  return options;
}

// A ray of the margin would count as one of the outer beam.
void Simulator::RefuseMargin() const {
  if (options_.fan.azimuth_margin_deg > 0.0) {
    throw DataError("rays: the paper model takes no azimuth margin, but it is {} degrees",
                    options_.fan.azimuth_margin_deg);
  }
}

PolarImage Simulator::RenderEchoes(const EchoList& echoes, const ParameterSet& parameters,
                                   int frame_idx) const {
  SONARCAL_CHECK(parameters.model != EchoModel::kCoherent, "a coherent image is made from a pose");
  PolarImage image;
  if (parameters.model == EchoModel::kPaper) {
    RefuseMargin();
    image = RenderPaperImage(echoes, sonar_, PaperParametersFor(parameters, echoes.material_names),
                             absorption_db_per_m_, PaperOptions(frame_idx));
  } else if (options_.noise) {
    const AcousticGeometry geometry{sonar_, absorption_db_per_m_};
    image = SampleAcousticImage(MakeScatterMap(echoes, fan_, geometry, parameters), geometry, parameters,
                                options_.full_scale(), SeedsOf(frame_idx));
  } else {
    image = RenderExpected(echoes, parameters);
  }
  QuantiseImage(image);
  return image;
}

PolarImage Simulator::RenderExpected(const EchoList& echoes, const ParameterSet& parameters) const {
  if (parameters.model != EchoModel::kPaper) {
    const AcousticGeometry geometry{sonar_, absorption_db_per_m_};
    const PolarImage power =
        ExpectedPower(MakeScatterMap(echoes, fan_, geometry, parameters), geometry, parameters);
    return ExpectedDisplay(power, parameters, options_.full_scale());
  }
  RefuseMargin();
  const std::vector<double> values =
      ExpectedPaperImage(GatherEchoes(echoes, sonar_.axes), ImageGeometry(sonar_, absorption_db_per_m_),
                         PaperParametersFor(parameters, echoes.material_names));
  PolarImage image{sonar_.axes, PaperScale(parameters.display, options_.full_scale()),
                   Grid<float>(sonar_.axes.range_bins, sonar_.axes.beam_count())};
  for (std::size_t i = 0; i < values.size(); ++i) {
    image.value.values()[i] = static_cast<float>(values[i] * options_.full_scale());
  }
  return image;
}

}  // namespace sonarcal
