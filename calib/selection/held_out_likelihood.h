// Likelihood of whole recorded frames under the acoustic model, for comparing models. It is that of the grey
// values themselves, so that display laws can be compared too. The probability of a grey level is that of its
// quantisation interval under speckle about the mean power of the pixel, through the display
// (calib/noise/noise_likelihood.h). A clipped value has the probability of all values that are shown there. A
// fraction kOutlierFraction of the pixels are outliers, with equal probability of every level. Otherwise a
// few pixels that no variant describes would dominate the sum and its standard error.
//
// Sums are kept per block of pixels. Speckle is correlated over beam and pulse, and over frames of one pose,
// so pixels are not independent but blocks nearly are. Models are compared on the same pixels. Their
// difference is much more precise than either likelihood.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "calib/models/acoustic_frame_model.h"
#include "core/types/image.h"
#include "core/types/parameters.h"
#include "core/types/pose.h"
#include "sim/simulator.h"

namespace sonarcal::calib {

inline constexpr double kOutlierFraction = 0.01;

struct GreyFrame {
  int index = 0;  // index in the recording
  Pose world_from_sonar;
  PolarImage image;                    // grey levels
  std::vector<std::uint8_t> use = {};  // 1 for used pixels; empty: all
  std::vector<PingPose> pings = {};    // as in AcousticFrame
};

// Converts the frames to those of a fit of the acoustic model, with powers through this display.
std::vector<AcousticFrame> FramesFor(const std::vector<GreyFrame>& frames,
                                     const DisplayParameters<double>& display);

// Mean power of every pixel for the initial values of a model, per frame.
std::vector<std::vector<double>> MeanPowers(const AcousticFrameModel& model);

struct BlockedLikelihood {
  std::vector<double> nats;      // log-likelihood per block
  std::vector<double> pixels;    // per block
  double variance_factor = 1.0;  // for what blocks share with their neighbours (BlockPixels)

  double Pixels() const;
  double PerPixel() const;  // mean over all pixels
};

// Log-likelihood of grey levels about mean powers (per frame, range_bins x beams), with looks and display of
// the parameters. Blocks are `block_bins` x `block_beams`; frames of one pose share their blocks. Rounds
// values to whole levels. Throws DataError if an image is not grey or a mean is not positive.
BlockedLikelihood GreyLikelihood(const std::vector<GreyFrame>& frames,
                                 const std::vector<std::vector<double>>& mean_power,
                                 const ParameterSet& parameters, int block_bins, int block_beams);

// Mean log-likelihood of a pixel of one frame, nats. nullopt if the parameters have no noise level: then the
// model expects no power in some pixels.
std::optional<double> LogLikelihoodPerPixel(const sim::Simulator& simulator, const GreyFrame& frame,
                                            const ParameterSet& parameters);

// Law of grey levels without speckle: normal about the expected value plus a constant, with one spread
// everywhere.
struct NormalGreyLaw {
  double offset = 0.0;  // grey levels
  double sigma = 1.0;
};

// Estimates the law of frames about expected grey values (per frame, range_bins x beams) from medians, so
// that a few outliers do not matter.
NormalGreyLaw FindNormalGreyLaw(const std::vector<GreyFrame>& frames,
                                const std::vector<std::vector<double>>& expected_grey);

// As above, for a normal law. Values are clipped at the ends of the image's scale.
BlockedLikelihood GreyLikelihood(const std::vector<GreyFrame>& frames,
                                 const std::vector<std::vector<double>>& expected_grey,
                                 const NormalGreyLaw& law, int block_bins, int block_beams);

// Absolute differences between the frames and `shown` (grey values per frame, range_bins x beams), full scale
// 1, over the same blocks. The sums replace nats.
BlockedLikelihood GreyError(const std::vector<GreyFrame>& frames,
                            const std::vector<std::vector<double>>& shown, int block_bins, int block_beams);

// Difference of two models, nats per pixel.
struct LikelihoodDifference {
  double mean = 0.0;
  double sigma = 0.0;  // standard error over blocks; 0 for a single block
};

// Returns a - b over the same pixels in the same blocks. For errors, in fractions of full scale.
LikelihoodDifference Difference(const BlockedLikelihood& a, const BlockedLikelihood& b);

// Returns the number of looks, within the limits below, that fits the frames best about these means.
inline constexpr double kMinSimulatedLooks = 1.0;  // the min that can be simulated
inline constexpr double kMaxSimulatedLooks = 40.0;
double BestLooks(const std::vector<GreyFrame>& frames, const std::vector<std::vector<double>>& mean_power,
                 const ParameterSet& parameters);

}  // namespace sonarcal::calib
