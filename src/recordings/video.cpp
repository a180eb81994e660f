#include "recordings/video.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/parallel.h"
#include "base/text.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

namespace vpr {
namespace {

constexpr AVRational kNanosecond = {1, 1'000'000'000};
constexpr int64_t kMaxTime = 1'000'000'000'000'000'000;  // 31 years; damaged videos state any time

struct Free {
  void operator()(AVFormatContext* file) const { avformat_close_input(&file); }
  void operator()(AVCodecContext* codec) const { avcodec_free_context(&codec); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};
template <class T>
using Owned = std::unique_ptr<T, Free>;

// A playlist makes FFmpeg open other files, of which some never end.
void refuse_text(const std::filesystem::path& path) {
  constexpr size_t kSignature = 64;
  const std::string bytes = read_file_start(path, kSignature);
  const std::string_view start = without_byte_order_mark(bytes);
  const auto is_text = [](char c) {
    return static_cast<uint8_t>(c) >= ' ' || (c >= '\t' && c <= '\r');
  };
  if (start.starts_with("YUV4MPEG2") || !std::ranges::all_of(start, is_text)) return;
  throw Error(ErrorKind::input,
              "{}: is a text file, not a video; playlists are not read. Pass the video that it "
              "names or, for a list of images, a file that ends in .txt",
              path.string());
}

Owned<AVFormatContext> open_file(const std::filesystem::path& path) {
  AVDictionary* options = nullptr;
  // Of FFmpeg's formats, those of videos that need no other file.
  av_dict_set(&options, "format_whitelist",
              "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi,mpeg,mpegts,mpegvideo,flv,live_flv,asf,"
              "ogg,yuv4mpegpipe,h264,hevc,m4v,mjpeg,mxf,ivf,gif,dv,nut,wtv,rm",
              0);
  av_dict_set(&options, "protocol_whitelist", "file", 0);
  const std::string extension = lower_case(path.extension().string());
  const bool is_mjpeg = extension == ".mjpeg" || extension == ".mjpg";  // detected as one image
  AVFormatContext* file = nullptr;
  const int status =
      avformat_open_input(&file, ("file:" + path.string()).c_str(),
                          is_mjpeg ? av_find_input_format("mjpeg") : nullptr, &options);
  av_dict_free(&options);
  return Owned<AVFormatContext>(status < 0 ? nullptr : file);
}

// The EXIF orientation that the display matrix of a video stands for; 1 for other angles.
int orientation_of(const AVStream& stream) {
#if LIBAVFORMAT_VERSION_MAJOR >= 61
  const AVPacketSideData* const side =
      av_packet_side_data_get(stream.codecpar->coded_side_data, stream.codecpar->nb_coded_side_data,
                              AV_PKT_DATA_DISPLAYMATRIX);
  const uint8_t* const data = side == nullptr ? nullptr : side->data;
#else
  const uint8_t* const data = av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, nullptr);
#endif
  if (data == nullptr) return 1;
  const auto* const m =
      reinterpret_cast<const int32_t*>(data);  // x' = m0 x + m3 y, y' = m1 x + m4 y
  if (m[1] == 0 && m[3] == 0) return m[4] < 0 ? (m[0] < 0 ? 3 : 4) : (m[0] < 0 ? 2 : 1);
  if (m[0] == 0 && m[4] == 0) return m[1] < 0 ? (m[3] < 0 ? 7 : 8) : (m[3] < 0 ? 6 : 5);
  return 1;
}

// Whether frames are gray of more than 8 bits, as of thermal cameras, or color of 16 bits: they are
// scaled by their range.
bool is_deep(AVPixelFormat format) {
  const AVPixFmtDescriptor* const pixels = av_pix_fmt_desc_get(format);
  if (pixels == nullptr || (pixels->flags & AV_PIX_FMT_FLAG_FLOAT) != 0) return false;
  const bool is_gray = pixels->nb_components < 3;
  return pixels->comp[0].depth > (is_gray ? 8 : 15);
}

// For codecs such as VP9, which state a full range in the frame; the pixel format of H.264 does.
void set_full_range(SwsContext& scaler, AVPixelFormat from) {
  if ((av_pix_fmt_desc_get(from)->flags & AV_PIX_FMT_FLAG_RGB) != 0) return;
  int* from_table = nullptr;
  int* to_table = nullptr;
  int is_from_full = 0;
  int is_to_full = 0;
  std::array<int, 3> adjustments = {};
  if (sws_getColorspaceDetails(&scaler, &from_table, &is_from_full, &to_table, &is_to_full,
                               &adjustments[0], &adjustments[1], &adjustments[2]) < 0 ||
      is_from_full != 0)
    return;
  sws_setColorspaceDetails(&scaler, from_table, 1, to_table, is_to_full, adjustments[0],
                           adjustments[1], adjustments[2]);
}

}  // namespace

// Decodes a video from its first to its last frame.
class VideoReader::Decoder {
 public:
  Decoder(const std::filesystem::path& path, size_t threads) : path_(path), file_(open_file(path)) {
    if (!open_codec(threads))
      throw Error(ErrorKind::input,
                  "{}: is neither a folder of images, a list (.txt) nor a video that can be "
                  "decoded",
                  path.string());
    check_frame_size(path, static_cast<uint64_t>(codec_->width),
                     static_cast<uint64_t>(codec_->height));
  }

  // Decodes the next frame, which has no image if it is damaged; false at the end.
  bool next() {
    for (;;) {
      const int status = avcodec_receive_frame(codec_.get(), frame_.get());
      if (status == AVERROR_EOF) return false;
      if (status == AVERROR(EAGAIN) && send_packet()) continue;
      has_image_ = status == 0 && frame_->decode_error_flags == 0;
      time_.reset();
      if (status == 0) {
        if ((frame_->flags & AV_FRAME_FLAG_DISCARD) != 0) continue;  // hidden by an edit list
        note_time();
      } else {
        if (++lost_ > packets_) return false;
        // A recording may start between two keyframes: frames that need the first one are not
        // shown.
        if (shown_ == 0) continue;
      }
      ++shown_;
      return true;
    }
  }

  bool has_image() const { return has_image_; }
  int orientation() const { return orientation_; }
  bool is_deep() const { return vpr::is_deep(codec_->pix_fmt); }

  // The frame as stored, not turned: blue, green and red of 8 bits or, if it is deep, gray or
  // color of 16 bits. Rows may be padded.
  cv::Mat image() {
    const int width = frame_->width;
    const int height = frame_->height;
    check_frame_size(path_, static_cast<uint64_t>(width), static_cast<uint64_t>(height));
    const auto from = static_cast<AVPixelFormat>(frame_->format);
    const bool is_gray = av_pix_fmt_desc_get(from)->nb_components < 3;
    const bool is_wide = vpr::is_deep(from);
    const AVPixelFormat to = !is_wide  ? AV_PIX_FMT_BGR24
                             : is_gray ? AV_PIX_FMT_GRAY16
                                       : AV_PIX_FMT_BGR48;
    const bool is_full = frame_->color_range == AVCOL_RANGE_JPEG && !is_wide;
    if (is_full != std::exchange(is_full_, is_full)) scaler_.reset();
    scaler_.reset(sws_getCachedContext(scaler_.release(), width, height, from, width, height, to,
                                       SWS_BICUBIC, nullptr, nullptr, nullptr));
    if (!scaler_) return {};
    if (is_full) set_full_range(*scaler_, from);
    constexpr int kBlock = 32;  // vector code writes whole blocks
    cv::Mat rows(height, (width / kBlock + 1) * kBlock,
                 is_wide ? (is_gray ? CV_16UC1 : CV_16UC3) : CV_8UC3);
    const std::array<uint8_t*, 4> planes = {rows.data};
    const std::array<int, 4> steps = {static_cast<int>(rows.step)};
    if (sws_scale(scaler_.get(), frame_->data, frame_->linesize, 0, height, planes.data(),
                  steps.data()) < 0)
      return {};
    return rows.colRange(0, width);
  }

  // In nanoseconds since the first frame.
  std::optional<int64_t> time_ns() const { return time_; }

  double frames_per_second() const {
    const AVRational mean = stream_->avg_frame_rate;
    if (mean.num > 0 && mean.den > 0) return av_q2d(mean);
    const AVRational nominal = av_guess_frame_rate(file_.get(), stream_, nullptr);
    return nominal.num > 0 && nominal.den > 0 ? av_q2d(nominal) : 0;
  }

  // By the last time; 0: unknown.
  double measured_rate() const {
    const double seconds = static_cast<double>(last_ns_) * 1e-9;
    return seconds > 0 ? static_cast<double>(timed_) / seconds : 0;
  }

  // The number of frames that are stored or, if the container does not count them, that the
  // duration suggests.
  double expected_frames() const {
    if (is_counted()) return static_cast<double>(stored_frames());
    return stated_seconds() * frames_per_second();
  }

  // 0: unknown.
  double stated_seconds() const {
    if (file_->duration_estimation_method != AVFMT_DURATION_FROM_STREAM ||
        stored_frames() < stream_->nb_frames)
      return 0;
    // AVI counts units of time, also those without a frame; without its index, FFmpeg's duration
    // ends with the file.
    const bool is_avi = std::string_view(file_->iformat->name) == "avi";
    const int64_t duration = std::max(stream_->duration, is_avi ? stored_frames() : 0);
    if (is_counted() && duration > 0)
      return static_cast<double>(duration) * av_q2d(stream_->time_base);
    return static_cast<double>(std::max<int64_t>(0, file_->duration)) / AV_TIME_BASE;
  }

  // The end of the last packet, or when the next frame was due.
  double reached_seconds() const {
    return std::max(end_seconds_, static_cast<double>(last_ns_ + longest_ns_) * 1e-9);
  }

  bool is_cut() const { return is_cut_; }

 private:
  // Whether the container states the frames and duration of the video itself.
  bool is_counted() const { return stored_frames() > 0; }

  // 0: unknown. An AVI that was written to a pipe has 2^30 instead.
  int64_t stored_frames() const {
    return stream_->nb_frames >= int64_t{1} << 30 ? 0 : stream_->nb_frames;
  }

  bool open_codec(size_t threads) {
    if (!file_ || avformat_find_stream_info(file_.get(), nullptr) < 0) return false;
    const AVCodec* decoder = nullptr;
    const int index = av_find_best_stream(file_.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0);
    if (index < 0) return false;
    stream_ = file_->streams[index];
    orientation_ = orientation_of(*stream_);
    codec_.reset(avcodec_alloc_context3(decoder));
    if (!codec_ || avcodec_parameters_to_context(codec_.get(), stream_->codecpar) < 0) return false;
    // Other decoders conceal damage; with several threads, neither the pixels nor the report of the
    // damage would be the same in each run.
    const AVCodecID id = codec_->codec_id;
    const bool reports_damage =
        id == AV_CODEC_ID_HEVC || id == AV_CODEC_ID_VP9 || id == AV_CODEC_ID_AV1;
    codec_->thread_count = reports_damage ? static_cast<int>(threads) : 1;
    codec_->pkt_timebase = stream_->time_base;
    // The end of another stream may be the stated one.
    for (unsigned i = 0; is_counted() && i < file_->nb_streams; ++i)
      if (file_->streams[i] != stream_) file_->streams[i]->discard = AVDISCARD_ALL;
    return packet_ && frame_ && avcodec_open2(codec_.get(), decoder, nullptr) == 0;
  }

  // Passes a packet, or the end of the file, to the decoder; false if the packet is damaged.
  bool send_packet() {
    for (;;) {
      const int status = av_read_frame(file_.get(), packet_.get());
      if (status == AVERROR(EAGAIN)) continue;
      if (status < 0) {
        is_cut_ = status != AVERROR_EOF;
        avcodec_send_packet(codec_.get(), nullptr);
        return true;
      }
      const AVStream* const stream = file_->streams[packet_->stream_index];
      const int64_t time = packet_->pts == AV_NOPTS_VALUE ? packet_->dts : packet_->pts;
      if (time != AV_NOPTS_VALUE && (stream == stream_ || !is_counted()))
        end_seconds_ = std::max(
            end_seconds_, (static_cast<double>(time) + static_cast<double>(packet_->duration)) *
                              av_q2d(stream->time_base));
      const bool is_sent =
          stream != stream_ || avcodec_send_packet(codec_.get(), packet_.get()) == 0;
      av_packet_unref(packet_.get());
      if (stream != stream_) continue;
      ++packets_;
      return is_sent;
    }
  }

  void note_time() {
    const int64_t time = frame_->best_effort_timestamp;
    // Formats such as raw H.264 have no times, so FFmpeg invents them.
    if (time == AV_NOPTS_VALUE || (file_->iformat->flags & AVFMT_NOTIMESTAMPS) != 0) return;
    if (!first_) first_ = time;
    int64_t difference = 0;
    if (__builtin_sub_overflow(time, *first_, &difference)) return;
    const int64_t ns = av_rescale_q(difference, stream_->time_base, kNanosecond);
    if (ns < -kMaxTime || ns > kMaxTime) return;
    time_ = ns;
    longest_ns_ = std::max(longest_ns_, ns - last_ns_);
    if (ns > last_ns_) {
      last_ns_ = ns;
      timed_ = shown_;
    }
  }

  const std::filesystem::path path_;
  Owned<AVFormatContext> file_;
  Owned<AVCodecContext> codec_;
  Owned<AVPacket> packet_{av_packet_alloc()};
  Owned<AVFrame> frame_{av_frame_alloc()};
  Owned<SwsContext> scaler_;
  bool is_full_ = false;  // the range that the scaler reads
  AVStream* stream_ = nullptr;
  int orientation_ = 1;
  bool has_image_ = false;
  bool is_cut_ = false;  // the file ends within a packet
  uint64_t packets_ = 0;
  uint64_t lost_ = 0;
  uint64_t shown_ = 0;
  std::optional<int64_t> first_;  // in units of the stream
  std::optional<int64_t> time_;
  int64_t last_ns_ = 0;
  int64_t longest_ns_ = 0;
  uint64_t timed_ = 0;  // frames before the one at last_ns_
  double end_seconds_ = 0;
};

VideoReader::VideoReader(const SequenceArgument& argument, std::optional<PixelFormat> format,
                         Unreadable unreadable)
    : argument_(argument), format_(format), unreadable_(unreadable), sequence_(argument.sequence) {
  refuse_text(argument.path);
  // After damage, the pixels of following frames depend on the number of threads.
  decoder_ =
      std::make_unique<Decoder>(argument.path, unreadable == Unreadable::skip ? 1 : thread_count());
}

VideoReader::~VideoReader() = default;

void VideoReader::find_range(const Monitor& monitor) {
  if (!decoder_->is_deep()) return;
  VideoReader reader(argument_, std::nullopt, unreadable_);
  for (IndexedFrame frame; reader.next(frame, monitor);)
    if (reader.decoder_->has_image())
      range_ = united(range_, range_of(in_format(reader.decoder_->image(), PixelFormat::gray)));
}

bool VideoReader::next(IndexedFrame& frame, const Monitor& monitor) {
  const FrameRange& range = argument_.range;
  const std::vector<uint32_t>& sources = sequence_.selection.sources;
  const size_t index = sequence_.frames;
  const bool is_over = !sources.empty() && index >= sources.size();
  const uint64_t source = sources.empty() || is_over ? index : sources[index];
  const uint64_t wanted = range.first + source * range.step;
  if (is_over || (range.last && wanted >= *range.last)) {
    // Checks that the video has as many frames as the range or the video states.
    decode_below(range.last.value_or(std::numeric_limits<uint64_t>::max()), monitor);
    return false;
  }
  if (!decode_below(wanted + 1, monitor)) return false;
  frame.index = sequence_.frames++;
  frame.recorded = wanted;
  frame.time_ns = decoder_->time_ns();
  sequence_.frame_names.push_back(fmt::format("#{}", wanted));
  cv::Mat image;
  if (format_ && decoder_->has_image()) image = decoder_->image();
  if (!image.empty()) {
    image = in_format(image, *format_);
    scale_to_8_bits(image, range_);
    turn_upright(image, decoder_->orientation());
    if (!image.isContinuous()) image = image.clone();
    if (!sequence_.size)
      sequence_.size = {static_cast<uint32_t>(image.cols), static_cast<uint32_t>(image.rows)};
  } else if (format_) {
    sequence_.unreadable.push_back(frame.index);
  }
  frame.image = std::move(image);
  return true;
}

Sequence VideoReader::finish(const Monitor& monitor) {
  const FrameRange& range = argument_.range;
  const std::string path = argument_.path.string();
  if (ended_ && (sequence_.frames == 0 || range.last))
    throw Error(range.is_all() ? ErrorKind::input : ErrorKind::usage,
                fmt::format("{}: has only {} to decode{}", path, counted(position_, "frame"),
                            range.is_all() ? "" : " for " + range_text(range)));
  constexpr double kOtherRate = 0.05;  // smaller differences are jitter
  const double fps = frames_per_second();
  const double rate = decoder_->measured_rate();
  if (sequence_.fps && std::abs(*sequence_.fps * static_cast<double>(range.step) - fps) < 1e-9 &&
      rate > 0 && std::abs(rate - fps) > kOtherRate * fps)
    sequence_.fps = rate / static_cast<double>(range.step);
  const double stated = decoder_->stated_seconds();
  const double reached = decoder_->reached_seconds();
  const bool is_short =
      ended_ && (decoder_->is_cut() || (fps > 0 && stated > reached * 1.02 + 2 / fps));
  const std::string short_text = fmt::format("{}: ends after {} and {:.1f} of {:.1f} s", path,
                                             counted(position_, "frame"), reached, stated);
  if (unreadable_ == Unreadable::fail && is_short)
    throw Error(ErrorKind::input,
                "{}. It is damaged. To use the existing frames, pass --skip-unreadable, or a "
                "folder of them: ffmpeg -i VIDEO -fps_mode passthrough FOLDER/%06d.png",
                short_text);
  if (unreadable_ == Unreadable::fail && !sequence_.unreadable.empty())
    throw Error(ErrorKind::input,
                "{}: frame {} can't be decoded. To omit it, use --skip-unreadable", path,
                sequence_.frame_names[sequence_.unreadable.front()]);
  if (is_short) warn(monitor, short_text);
  return std::move(sequence_);
}

size_t VideoReader::expected_frames() const {
  if (!sequence_.selection.is_all()) return sequence_.selection.frames();
  const double stated = decoder_->expected_frames();
  const FrameRange& range = argument_.range;
  if (!(stated > 0 && stated <= 1e12)) return 0;
  const uint64_t last = std::min(range.last.value_or(std::numeric_limits<uint64_t>::max()),
                                 static_cast<uint64_t>(std::llround(stated)));
  return frame_count({range.first, last, range.step}).value();
}

double VideoReader::frames_per_second() const { return decoder_->frames_per_second(); }

// Decodes frames until `position` is reached; false if there are fewer.
bool VideoReader::decode_below(uint64_t position, const Monitor& monitor) {
  for (; position_ < position; ++position_) {
    check_stop(monitor);
    ended_ = ended_ || !decoder_->next();
    if (ended_) return false;
  }
  return true;
}

std::vector<int64_t> read_video_times(const SequenceArgument& argument, const Monitor& monitor) {
  VideoReader reader(argument, std::nullopt, Unreadable::fail);
  std::vector<int64_t> times;
  std::vector<size_t> known;     // indices of frames with times
  std::vector<size_t> recorded;  // frames of the video
  bool do_rise = true;
  for (IndexedFrame frame; reader.next(frame, monitor);) {
    times.push_back(frame.time_ns.value_or(0));
    recorded.push_back(frame.recorded);
    if (!frame.time_ns) continue;
    do_rise = do_rise && (known.empty() || times.back() > times[known.back()]);
    known.push_back(times.size() - 1);
  }
  if (do_rise && known.size() == times.size()) return times;
  if (do_rise && known.size() >= 2) {
    // Along the line through the two nearest known times, at the ends at the mean rate.
    size_t next = 0;  // the first known time at or after the frame
    for (size_t i = 0; i < times.size(); ++i) {
      while (next < known.size() && known[next] < i) ++next;
      const bool is_between = next > 0 && next < known.size();
      const size_t a = is_between ? known[next - 1] : known.front();
      const size_t b = is_between ? known[next] : known.back();
      if (next < known.size() && known[next] == i) continue;
      const double step =
          static_cast<double>(times[b] - times[a]) / static_cast<double>(recorded[b] - recorded[a]);
      const size_t from = next == 0 ? known.front() : known[next - 1];
      times[i] = times[from] + std::llround(step * (static_cast<double>(recorded[i]) -
                                                    static_cast<double>(recorded[from])));
    }
    return times;
  }
  const double fps = reader.frames_per_second();
  if (!(fps > 1e-3 && fps < 1e6))
    throw Error(ErrorKind::input, "{}: has neither times of its frames nor a frame rate",
                argument.path.string());
  for (size_t i = 0; i < times.size(); ++i)
    times[i] = std::llround(static_cast<double>(recorded[i]) * 1e9 / fps);
  warn(monitor, "{}: {}, so they follow from its rate of {} frames per second",
       argument.path.string(),
       do_rise ? "the times of its frames are unknown" : "the times of its frames do not increase",
       fps);
  return times;
}

}  // namespace vpr
