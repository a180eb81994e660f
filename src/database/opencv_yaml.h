// Matrices in the YAML that OpenCV's FileStorage writes.
#pragma once

#include <filesystem>
#include <string>

#include <opencv2/core/mat.hpp>

namespace vpr {

/// The matrix `name` of a file that OpenCV wrote (plain, or compressed by gzip), of one channel of
/// `type`, CV_32F or CV_64F. The file is read by libyaml, value by value: it takes memory for the
/// values that it holds, not for those that it claims, and what is nested deeper than a matrix is
/// refused. Throws Error(input) if it can't be read, and Error(data) if it is no such YAML, has no
/// such matrix, one of another type or size, or unpacks to more than 128 MiB.
cv::Mat read_opencv_matrix(const std::filesystem::path& path, const std::string& name, int type);

}  // namespace vpr
