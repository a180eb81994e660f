// Illumination invariance for colour frames (McManus et al., as ABLE-M uses it).
#pragma once

namespace cv {
class Mat;
}

namespace vpr {

/// `bgr`: 8 bits, three channels. Returns grey of the same size:
/// I = 0.5 + ln G - a ln B - (1 - a) ln R on channels in [0, 1], a = 0.47, ln 0 taken as 0; I below
/// 0 becomes 1; times 255, rounded half to even, saturated to 8 bits.
cv::Mat illumination_invariant(const cv::Mat& bgr);

}  // namespace vpr
