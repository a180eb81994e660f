#include "descriptors/describe.h"

#include <mutex>

#include <opencv2/core/mat.hpp>

#include "descriptors/illumination.h"

namespace vpr {

SequenceCodes describe_sequence(const Sequence& sequence, const LdbSettings& settings,
                                Unreadable unreadable, const Monitor& monitor) {
  const PixelFormat format = settings.illumination_invariant ? PixelFormat::bgr : PixelFormat::grey;
  std::mutex mutex;  // a video's length is not known before its end
  std::vector<LdbCode> codes(sequence.files.size());
  FrameList frames = for_each_frame(
      sequence, format, unreadable, monitor, [&](size_t index, const cv::Mat& image) {
        const LdbCode code =
            describe_ldb(settings.illumination_invariant ? illumination_invariant(image) : image);
        const std::lock_guard lock(mutex);
        if (index >= codes.size()) codes.resize(index + 1);
        codes[index] = code;
      });
  return {std::move(codes), std::move(frames)};
}

}  // namespace vpr
