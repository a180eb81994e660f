#include <cmath>
#include <memory>
#include <vector>

#include <cairo-pdf.h>
#include <librsvg/rsvg.h>
#include <opencv2/imgcodecs.hpp>

#include "base/error.h"
#include "present/chart.h"

namespace vpr {
namespace {

template <auto free>
struct Free {
  template <class T>
  void operator()(T* object) const {
    free(object);
  }
};
using Handle = std::unique_ptr<RsvgHandle, Free<g_object_unref>>;
using Stream = std::unique_ptr<GInputStream, Free<g_object_unref>>;
using Surface = std::unique_ptr<cairo_surface_t, Free<cairo_surface_destroy>>;
using Painter = std::unique_ptr<cairo_t, Free<cairo_destroy>>;

// Frees the error. Null: the image is too large.
[[noreturn]] void fail(GError* error) {
  const std::string message = error == nullptr ? "it is too large" : error->message;
  g_clear_error(&error);
  throw Error(ErrorKind::internal, "cannot draw an image: {}", message);
}

Handle read_svg(const std::string& svg) {
  const Stream stream(
      g_memory_input_stream_new_from_data(svg.data(), static_cast<gssize>(svg.size()), nullptr));
  GError* error = nullptr;
  // A matrix is one attribute longer than the default limit.
  Handle handle(rsvg_handle_new_from_stream_sync(stream.get(), nullptr, RSVG_HANDLE_FLAG_UNLIMITED,
                                                 nullptr, &error));
  if (!handle) fail(error);
  return handle;
}

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

struct Size {
  double width = 0;
  double height = 0;
};

Size size_of(const Handle& handle) {
  Size size;
  if (!rsvg_handle_get_intrinsic_size_in_pixels(handle.get(), &size.width, &size.height))
    fail(nullptr);
  return size;
}

void draw(const Handle& handle, const Painter& painter, const Size& size) {
  const RsvgRectangle whole{0, 0, size.width, size.height};
  GError* error = nullptr;
  if (!rsvg_handle_render_document(handle.get(), painter.get(), &whole, &error)) fail(error);
}

}  // namespace

std::string png_of(const cv::Mat& image) {
  std::vector<uint8_t> png;
  // Level 9 takes sixteen times as long, for files that are a seventh smaller.
  cv::imencode(".png", image, png, {cv::IMWRITE_PNG_COMPRESSION, 6});
  return {png.begin(), png.end()};
}

std::string png_of_svg(const std::string& svg, double zoom) {
  const Handle handle = read_svg(svg);
  const Size svg_size = size_of(handle);
  const Size size{std::ceil(svg_size.width * zoom), std::ceil(svg_size.height * zoom)};
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(size.width),
                                                   static_cast<int>(size.height)));
  const Painter painter(cairo_create(surface.get()));
  cairo_set_source_rgb(painter.get(), 1, 1, 1);
  cairo_paint(painter.get());
  draw(handle, painter, size);
  std::string png;
  if (cairo_surface_write_to_png_stream(surface.get(), append, &png) != CAIRO_STATUS_SUCCESS)
    fail(nullptr);
  return png;
}

std::string pdf_of_svg(const std::string& svg) {
  constexpr double kPointsPerUnit = 72.0 / 96;
  const Handle handle = read_svg(svg);
  const Size svg_size = size_of(handle);
  const Size size{svg_size.width * kPointsPerUnit, svg_size.height * kPointsPerUnit};
  std::string pdf;
  const Surface surface(cairo_pdf_surface_create_for_stream(append, &pdf, size.width, size.height));
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
  const Painter painter(cairo_create(surface.get()));
  draw(handle, painter, size);
  cairo_surface_finish(surface.get());
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) fail(nullptr);
  return pdf;
}

}  // namespace vpr
