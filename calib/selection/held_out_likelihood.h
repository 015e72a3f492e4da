// Likelihood of whole recorded frames under the acoustic model, for comparing models: of the grey values
// themselves, so that laws of display compare as fairly as anything else. The chance of a grey level is that
// of its quantisation interval under speckle about the pixel's mean power, carried through the display
// (calib/noise/noise_likelihood.h); a clipped value has the chance of all that is shown there. Of kAnything
// of the pixels the grey is taken to be anything, each level alike: a few pixels that no variant explains
// would else outweigh all others, and a standard error with them.
//
// Sums are kept by block of pixels. Speckle is alike over beam and pulse, and over frames of one pose, so
// that pixels are not independent but blocks are, nearly; models are compared on the same pixels, and the
// difference is far better known than either likelihood.
#pragma once

#include <cstdint>
#include <vector>

#include "calib/models/acoustic_frame_model.h"
#include "core/types/image.h"
#include "core/types/parameters.h"
#include "core/types/pose.h"

namespace sonarcal::calib {

inline constexpr double kAnything = 0.01;

struct GreyFrame {
  int index = 0;  // in the recording
  Pose world_from_sonar;
  PolarImage image;                    // of grey levels
  std::vector<std::uint8_t> use = {};  // 1 for the pixels that count; empty: all
};

// The same frames as a fit of the acoustic model takes them, their powers through this display.
std::vector<AcousticFrame> FramesFor(const std::vector<GreyFrame>& frames,
                                     const DisplayParameters<double>& display);

// Mean power of every pixel by a model's initial values, by frame.
std::vector<std::vector<double>> MeanPowers(const AcousticFrameModel& model);

struct BlockedLikelihood {
  std::vector<double> nats;    // log-likelihood, by block
  std::vector<double> pixels;  // by block

  double Pixels() const;
  double PerPixel() const;  // mean over all pixels
};

// Log-likelihood of grey levels about mean powers (by frame, range_bins x beams), looks and display those of
// the parameters. Blocks are `block_bins` x `block_beams`, those of frames of one pose are one. Values are
// rounded to whole levels. Throws DataError where an image is not grey or a mean is not positive.
BlockedLikelihood GreyLikelihood(const std::vector<GreyFrame>& frames,
                                 const std::vector<std::vector<double>>& mean_power,
                                 const ParameterSet& parameters, int block_bins, int block_beams);

// A law of grey levels that knows of no speckle: normal about what is expected and a constant, with one
// spread everywhere.
struct NormalGreyLaw {
  double offset = 0.0;  // grey levels
  double sigma = 1.0;
};

// The law of frames about expected grey values (by frame, range_bins x beams), by medians: a few pixels that
// nothing explains do not decide it.
NormalGreyLaw FindNormalGreyLaw(const std::vector<GreyFrame>& frames,
                                const std::vector<std::vector<double>>& expected_grey);

// The same as above by that law; values are clipped where the image's are.
BlockedLikelihood GreyLikelihood(const std::vector<GreyFrame>& frames,
                                 const std::vector<std::vector<double>>& expected_grey,
                                 const NormalGreyLaw& law, int block_bins, int block_beams);

// Absolute differences between the frames and `shown` (grey values by frame, range_bins x beams), of full
// scale, over the same blocks: sums stand in place of nats.
BlockedLikelihood GreyError(const std::vector<GreyFrame>& frames,
                            const std::vector<std::vector<double>>& shown, int block_bins, int block_beams);

// What one model has over another, nats a pixel.
struct LikelihoodDifference {
  double mean = 0.0;
  double sigma = 0.0;  // standard error over blocks; 0 of a single block
};

// a - b, of the same pixels in the same blocks; of errors, of full scale.
LikelihoodDifference Difference(const BlockedLikelihood& a, const BlockedLikelihood& b);

// The number of looks, kMinSimulatedLooks..kMaxSimulatedLooks, that explains the frames best about these means.
inline constexpr double kMinSimulatedLooks = 1.0;  // what can be simulated
inline constexpr double kMaxSimulatedLooks = 40.0;
double BestLooks(const std::vector<GreyFrame>& frames, const std::vector<std::vector<double>>& mean_power,
                 const ParameterSet& parameters);

}  // namespace sonarcal::calib
