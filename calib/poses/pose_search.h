// Finds the pose of a target of any shape in one recorded polar image, without a start pose.
//
// The acoustic model predicts the image (power over a noise floor, through beam and pulse), because the
// paper's sum of decibels differs too much from a real image. Both images are smoothed and compared by grey
// levels. A coarse sweep over all directions of the target's longest axis, and over its roll unless it is a
// body of revolution, gives starts. Each is moved so that its echo lies on the recorded one. The best starts
// that differ are refined by damped steps (calib/poses/damped_steps.h, slopes by central differences of
// traced images), first on a coarse image, then the best on the full one. The strength of the target's echo
// is fitted at the same time. The scene may hold a floor: a material with a strength of its own.
//
// Limit: one image does not determine everything. The result lists other poses with their likelihood, among
// them the mirror image in the plane of the beams and the reversed target, and states what is open.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/poses/equally_good.h"
#include "calib/poses/target_pose.h"
#include "calib/shapes/mesh_symmetry.h"
#include "core/types/mask.h"
#include "core/types/option.h"
#include "sim/simulator.h"

namespace sonarcal::calib {

// Thrown when the caller stops a search. No result is available.
struct PoseSearchStopped : std::exception {
  const char* what() const noexcept override { return "the pose search was stopped"; }
};

struct PoseSearchOptions {
  double smooth_bins = 2.0;  // standard deviation of the smoothing of both images
  double smooth_beams = 1.0;
  // Box that holds the middle of the target. Only the image around it is compared. Absent: around the
  // brightest spot of the size of the target.
  std::optional<Interval> range_m = {};
  std::optional<Interval> azimuth_deg = {};
  double start_spacing_deg = 20.0;  // between directions, and between rolls, of the sweep
  int refined_starts = 4;           // best starts of the sweep that differ, refined on the coarse image
  int max_candidates = 4;           // refined on the full image, besides mirror image and reversed target
  bool relatives = true;            // also the mirror image and the reversed target are candidates
  int coarse_factor = 3;            // decimation of range bins and rays in the coarse image
  int cols_per_beam = 2;
  double ray_height_deg = 0.05;
  double elevation_span_deg = 28.0;  // targets are visible outside the nominal vertical field of view
  double elevation_limit_deg = 14.0;
  std::vector<double> ridge_elevations_deg = {-6.0, -3.0, 0.0, 3.0, 6.0};  // for a comparison of the cost
  int max_iterations = 20;
  std::optional<Pose> start = {};   // sonar_from_target: refines this pose, without a sweep
  std::string floor_material = {};  // material with a strength of its own, below the target; empty: none
  Mask pixels = {};                 // 1 for pixels that hold a measurement; empty: all
  std::function<void(const std::string&)> progress = {};
  std::function<bool()> stop = {};  // called between images; true throws PoseSearchStopped

  // Throws DataError with field, value and limit.
  void Check() const;
};

enum class CandidateKind { kStart, kMirrored, kReversed };

// Result of a refinement.
struct PoseCandidate {
  CandidateKind kind = CandidateKind::kStart;
  Pose sonar_from_target;  // the target's frame is that of its mesh
  TargetPose pose;         // the same pose, of the frame of the body (MeshSymmetry::mesh_from_body)
  double gain_db = 0.0;    // gain of the target's echo relative to the given parameters
  double floor_gain_db = 0.0;
  double cost = 0.0;  // mean squared difference of the smoothed images, full scale 1
  // Log-likelihood ratio of the best candidate to this one, and how many standard deviations the sum of the
  // differences over the image is from zero. 0 for the best.
  double worse_by_nats = 0.0;
  double worse_by_sigmas = 0.0;
  std::vector<std::string> at_bounds = {};  // a sentence for each coordinate that ended at a bound

  // The image does not decide between this candidate and the best one.
  bool ExplainsAsWell() const { return worse_by_sigmas < kMaxWorseSigmas || worse_by_nats < kMaxWorseNats; }
  Pose WorldFromSonar() const { return sonar_from_target.Inverse(); }  // with the mesh's frame as world
};

struct PoseSearchResult {
  MeshSymmetry symmetry;
  std::vector<PoseCandidate> candidates;  // refined on the full image, best first; at least one
  std::vector<PoseCandidate> starts;      // refined on the coarse image, best first
  std::vector<PoseCandidate> ridge;  // refined with fixed elevation, in the order of ridge_elevations_deg
  std::vector<std::string> open;     // properties that this image does not determine, one sentence each
  long rays_cast = 0;

  const PoseCandidate& best() const { return candidates.front(); }
};

// "the reversed target", for a text.
std::string_view NameOf(CandidateKind kind);

// `measured` holds grey levels. `parameters` gives display, noise floor, beam and pulse, and a backscatter
// curve for each material. Throws DataError if no object exceeds the background.
PoseSearchResult SearchPose(const Scene& target, const SonarModel& sonar, const Water& water,
                            const PolarImage& measured, const ParameterSet& parameters,
                            const PoseSearchOptions& options = {});

}  // namespace sonarcal::calib
